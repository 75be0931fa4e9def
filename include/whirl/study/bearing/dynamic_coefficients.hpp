#pragma once
// Stiffness and damping of one film at any frequency: of two translations and, where the film follows them, two tilts.

#include <optional>
#include <vector>

#include "whirl/deck/one_or_more.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

struct DynamicCoefficientsOptions {
  std::string name;
  std::string bearing;                 ///< its name; the first of the deck if empty
  std::vector<deck::Quantity> speeds;  ///< [rad/s]
  std::optional<double> eccentricity;  ///< of the journal, in clearances; 0 if neither it nor a load is given
  std::optional<double> attitude;      ///< of the journal, from +x counter-clockwise [rad]; 0 likewise
  deck::OneOrMore load;                ///< on the journal [N]: one number downwards, or x and y; empty: a given place
  std::vector<double> frequencies{1};  ///< omega/Omega
  bool tilt = false;                   ///< of both slopes too, whatever the film of the deck follows
};
void describe(deck::Description<DynamicCoefficientsOptions>& d);

/// K(omega) and B(omega): minus the force on the journal by its motion is K + i omega B, the states of the film
/// eliminated at this frequency.
class DynamicCoefficients final : public StudyWith<DynamicCoefficientsOptions> {
public:
  static constexpr std::string_view key = "dynamic_coefficients";
  [[nodiscard]] std::string_view kind() const override { return key; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
};

}  // namespace whirl::study
