#pragma once
// What the studies share.

#include <algorithm>
#include <string>
#include <vector>

#include "findings.hpp"
#include "layout.hpp"
#include "study/parameter.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/study/study.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// Stiffness and damping of every film about the equilibrium x [size()] at the frequency `omega` [rad/s]: its tangents,
/// or with own states minus its transfer function from the motion of the journal to the force. Collective.
[[nodiscard]] std::vector<film::PortCoefficients> film_coefficients(system::RotorSystem& system,
                                                                    const std::vector<double>& x, double omega);

/// The equilibrium without forcing from the guess x, which it replaces: by whole steps where a line search ends without
/// it, which a film that starts without its pressure needs. Collective.
solve::NewtonResult find_rest(system::Plant& system, Vec x);
/// The same of one of many equilibria of `system`.
solve::NewtonResult find_rest(solve::Equilibria& equilibria, system::Plant& system, Vec x);

/// Equilibria at one speed after another, each from the last one; a speed that Newton cannot reach directly is
/// approached by halved steps.
class Walker {
public:
  explicit Walker(system::Plant& system) : system_(system), equilibria_(system) {}
  /// The equilibrium at `speed` [rad/s]; the system is left at that speed. Collective; throws core::NotConverged.
  Vec at(double speed);
  /// Where it stands, for a resumed run to go on from.
  [[nodiscard]] Trail trail();

private:
  bool attempt(double speed);
  void start_at(double speed);
  [[nodiscard]] bool walk_to(double speed);
  system::Plant& system_;
  solve::Equilibria equilibria_;
  core::Vector x_, trial_;
  double last_ = 0;
  std::string reason_;
};

/// Eigenvalues of the system at x, as stability facts with distance Re(lambda). Growing waves of a film's mesh are
/// apart (solve::Stability::mesh_waves).
[[nodiscard]] solve::Stability equilibrium_stability(system::Plant& system, Vec x);

/// What searches for eigenvalues missed (solve::Stability::missed), for the summary.
class MissedModes {
public:
  void add(int missed) {
    most_ = std::max(most_, missed);
    unsure_ = unsure_ || missed < 0;
  }
  /// Adds a warning, and the value "missed_eigenvalues" where some are known to be missing.
  void warn(io::StudySummary& summary) const;

private:
  int most_ = 0;
  bool unsure_ = false;
};

/// Names and clearances of the bearings, into `group`/bearings.
void put_bearings(io::Group& group, const system::Machine& machine);
/// Names, roles and ends of the elements, into `group`/elements; nothing if there are none.
void put_elements(io::Group& group, const system::Machine& machine);
/// What the outputs of a plant are: the bearings of a rotor, or names into `group`/places.
void put_places(io::Group& group, const system::Machine& machine, const system::Plant& plant);
[[nodiscard]] std::vector<std::string> names_of_bearings(const system::Machine& machine);

/// "3600" for 376.99 rad/s in rpm: the shortest text with six digits, for dotted names.
[[nodiscard]] std::string number_text(double value_si, const std::string& unit);

/// The nondimensional groups of a rigid rotor in equal bearings, as nondimensional.*; nothing for other machines.
void put_groups(io::StudySummary& summary, const system::Train& train);
void put_groups(io::StudySummary& summary, const std::optional<system::DimensionlessGroups>& groups);

/// How a branch goes over a parameter in units of `scale` (SI), but for its ends: as `p` says, or with these parts of
/// its range as first and as longest step.
[[nodiscard]] solve::ContinuationOptions continuation_of(const Parameter& p, double scale, double first,
                                                         double longest);
/// The weight of the states in the arclength: a change of the root mean square state by half a clearance counts as one
/// longest step.
[[nodiscard]] double state_weight_of(const solve::ContinuationOptions& continuation);

/// "completed", or why and where the branch ended; the last parameter is a scaled one, in `unit`.
[[nodiscard]] std::string branch_status(const solve::BranchEnd& end, const std::string& unit);

}  // namespace whirl::study
