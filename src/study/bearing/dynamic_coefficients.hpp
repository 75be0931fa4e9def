#pragma once
// Stiffness and damping of the film of one bearing over speed and frequency, of two translations and two tilts.

#include <array>
#include <optional>
#include <vector>

#include "whirl/deck/one_or_more.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

struct DynamicCoefficientsOptions {
  enum class Method { perturbation, enforced };
  std::string name;
  std::string bearing;                 ///< its name; the first of the deck if empty
  std::vector<deck::Quantity> speeds;  ///< [rad/s]
  std::optional<double> eccentricity;  ///< of the journal, in clearances; 0 if neither it nor a load is given
  std::optional<double> attitude;      ///< of the journal, from +x counter-clockwise [rad]; 0 likewise
  deck::OneOrMore load;                ///< on the journal [N]: one number downwards, or x and y; empty: a given place
  bool tilt = false;                   ///< tilts and moments as well
  std::vector<double> frequencies{1};  ///< omega/Omega, in the summary and the tables
  std::optional<std::array<double, 2>> frequency_range;  ///< omega/Omega, lowest and highest, in the tables only
  int points = 30;                                       ///< frequencies in that range
  Method method = Method::perturbation;
  /// of enforced motion, along x and y in clearances; a slope's is as much over twice the length of the bearing
  std::vector<double> amplitudes;

  /// Those of the list, then those of the range.
  [[nodiscard]] std::vector<double> all_frequencies() const;
};
[[nodiscard]] std::span<const deck::Name<DynamicCoefficientsOptions::Method>> names(DynamicCoefficientsOptions::Method);
void describe(deck::Description<DynamicCoefficientsOptions>& d);

class DynamicCoefficients final : public StudyWith<DynamicCoefficientsOptions, "dynamic_coefficients"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
