#pragma once
// One bearing by itself: impedance, equilibrium locus, stiffness, damping and Routh's criterion over eccentricity.

#include <vector>

#include "whirl/study/study.hpp"

namespace whirl::study {

struct BearingMapOptions {
  std::string name;
  std::string bearing;            ///< its name; the first of the deck if empty
  deck::Quantity speed;           ///< [rad/s]; rigid laminar films give the same nondimensional values at every speed
  double max_eccentricity = 0.9;  ///< [clearances]
  int points = 90;                ///< eccentricities, evenly spaced up to the largest
  int grid = 41;                  ///< eccentricities of the impedance plot
  /// omega/Omega at which stiffness and damping are tabulated, for films with own states.
  std::vector<double> frequencies{1};
  std::vector<double> sommerfeld;  ///< loads S at which position and pressure are reported
};
void describe(deck::Description<BearingMapOptions>& d);

class BearingMap final : public StudyWith<BearingMapOptions, "bearing_map"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
