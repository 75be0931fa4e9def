#pragma once
// One film of gas: load, flow and losses over the eccentricity and under a load, meshes, maps of a design.

#include <optional>
#include <vector>

#include "whirl/deck/one_or_more.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

/// Loads over clearance and diameter of the orifices at one eccentricity.
struct GasMapOptions {
  std::vector<deck::Quantity> clearances, diameters;  ///< [m]
  double eccentricity = 0.5;                          ///< in clearances
};
void describe(deck::Description<GasMapOptions>& d);

struct GasBearingOptions {
  std::string name;
  std::string bearing;                 ///< its name; the first of the deck if empty
  std::vector<deck::Quantity> speeds;  ///< [rad/s]
  std::vector<double> eccentricities{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};  ///< in clearances
  double direction = 0;                                                             ///< of the journal, from +x [rad]
  deck::OneOrMore load;  ///< [N] of the equilibria; none if empty
  int meshes = 0;        ///< of the table of meshes
  std::optional<GasMapOptions> map;
};
void describe(deck::Description<GasBearingOptions>& d);

class GasBearing final : public StudyWith<GasBearingOptions, "gas_bearing"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
