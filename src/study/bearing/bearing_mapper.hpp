#pragma once
// The equilibria of one bearing over the eccentricity, as a checkpoint keeps them.

#include <mpi.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/bearing/bearing_map.hpp"
#include "study/bearing/journal_locus.hpp"
#include "study/bearing/one_bearing.hpp"
#include "study/pieces.hpp"
#include "whirl/system/dimensionless_groups.hpp"

namespace whirl::study {

/// A point of the locus with its coefficients at all frequencies.
struct MapPoint {
  BearingEquilibrium at;
  double thickness = 0;  ///< least one of the film [m]
  std::vector<BearingCoefficients> coefficients;
  void members(auto& archive) { archive(at, thickness, coefficients); }
};

/// Where the locus of a bearing that is not rigid ends before the largest eccentricity.
struct MapLimit {
  double eccentricity = 0;  ///< in clearances
  bool fold = false;        ///< it turns back there
  std::string why;          ///< nothing is found beyond; may be empty
};

/// A point at a load that was asked for.
struct LoadedPoint {
  double sommerfeld = 0;
  MapPoint point;
  BearingProfile profile;
};

/// What one rank computes by itself; each point is a piece of the checkpoint, its name begins with `head`.
class Mapper {
public:
  Mapper(Pieces& pieces, std::string head, const BearingMapOptions& options, const system::Support& support);
  /// Where no film is found the locus has a gap; some bores carry no vertical load at small eccentricities.
  void follow();
  /// The first place on the locus where `margin` changes its sign; the bearing is left there.
  [[nodiscard]] std::optional<MapPoint> find(const std::function<double(const BearingEquilibrium&)>& margin);
  /// Refuses a load that the map does not reach, with the reason: the results would have no values for it.
  void load();
  /// A rigid rotor of load F0* turns at Omega* = F0*/(n S); it is stable below the limit of its eccentricity. A soft
  /// film or one with own states is another one at every speed: its thresholds belong to branches of equilibria.
  void find_threshold(const std::optional<system::DimensionlessGroups>& groups);
  void squeeze();

  std::vector<MapPoint> locus;
  std::vector<LoadedPoint> loaded;
  std::optional<BearingEquilibrium> threshold;
  std::vector<double> radii, angles, along, across;
  std::vector<double> missing;  // eccentricities without a film that carries a load downwards
  std::string refused;          // loads that the map does not reach, with the reason
  std::optional<MapLimit> limit;
  std::vector<double> folds;  // eccentricities at which the locus turns back and forth, one after another

private:
  // From the smallest of these eccentricities at which there is an equilibrium; they do not depend on the points.
  void follow_curve(const BearingEquilibrium& centred);
  [[nodiscard]] std::optional<BearingEquilibrium> reach(const BearingEquilibrium& near, double wanted);
  void refuse(double s);
  [[nodiscard]] MapPoint complete(const BearingEquilibrium& e);
  // What `compute` finds, and the profile that it leaves; none if it finds none.
  [[nodiscard]] std::optional<MapPoint> piece(const std::string& name,
                                              const std::function<std::optional<MapPoint>()>& compute,
                                              BearingProfile* profile = nullptr);

  Pieces& pieces_;
  std::string head_;
  const BearingMapOptions& options_;
  OneBearing bearing_;
  std::optional<JournalLocus> curve_;  // of a bearing that is not rigid
};

}  // namespace whirl::study
