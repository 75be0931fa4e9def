#pragma once
// Limit cycles, forced or self-excited, over a parameter, with multipliers and bifurcations.

#include <optional>

#include "study/parameter.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

struct CycleBranchOptions {
  enum class Method { collocation, shooting, multiple_shooting, finite_difference, newton_picard };
  /// One-step schemes of all methods but collocation.
  enum class Stepping { sdirk_2, sdirk_4, radau_iia_2, radau_iia_3, improved_euler, third_order, classical };
  enum class Points { radau, gauss };
  /// Where the branch begins: forced cycles about the equilibrium, or self-excited ones at the first Hopf point of the
  /// range.
  enum class Origin { equilibrium, hopf };
  std::string name;
  Origin origin = Origin::equilibrium;
  std::vector<std::string> unbalance;  ///< names of the machine's unbalances, applied together
  Parameter parameter;
  std::optional<deck::Quantity> start;  ///< value of the parameter to start at; that of range.from if absent
  std::optional<deck::Quantity> speed;  ///< [rad/s], where the parameter is not the speed
  Method method = Method::collocation;
  Stepping scheme = Stepping::sdirk_4;
  int intervals = 60;             ///< of the time mesh, whose states are unknowns; single shooting has one
  std::optional<int> steps;       ///< of the scheme in each interval (or in the period); see steps_of()
  double radius = 0.3;            ///< of solve::NewtonPicardOptions
  int degree = 2;                 ///< of the polynomials
  Points points = Points::radau;  ///< of collocation
  bool adapt_mesh = true;
  int adapt_every = 5;             ///< points between adaptations
  double mesh_tolerance = 1e-3;    ///< estimated error per interval, relative to the size of the orbit
  double tolerance = 1e-9;         ///< of Newton's method: root mean square of the scaled residual
  std::vector<deck::Quantity> at;  ///< parameters at which the cycle is solved and reported
  int multipliers = 6;             ///< Floquet multipliers to report, the largest
  int period = 1;                  ///< revolutions per cycle
  int max_points = 500;
  double picture_tolerance = default_picture_tolerance;
  std::optional<double> max_eccentricity;  ///< of a journal per clearance, at which a branch ends as in contact
  std::vector<Event> detect{Event::cyclic_fold, Event::flip, Event::neimark_sacker};
  bool follow_flips = false;  ///< also follow the cycles of twice the period born at the flips found
  std::vector<int> flips;     ///< of which flips, 1-based in the order found; of all if empty
  std::vector<int> nodes;     ///< of the shaft, whose amplitudes are recorded beside the bearings
  int orbits = 20;            ///< cycles whose time history is stored, spread over the branch
  bool checkpoint = true;
};
/// Steps in each interval (in the whole period for single shooting): those asked for, or as many as make 120 a period.
[[nodiscard]] int steps_of(const CycleBranchOptions& options);
/// Those of the branches of twice the period born at the flips of that branch: the same steps over twice the time.
[[nodiscard]] CycleBranchOptions of_twice_the_period(const CycleBranchOptions& options);
[[nodiscard]] std::span<const deck::Name<CycleBranchOptions::Method>> names(CycleBranchOptions::Method);
[[nodiscard]] std::span<const deck::Name<CycleBranchOptions::Stepping>> names(CycleBranchOptions::Stepping);
[[nodiscard]] std::span<const deck::Name<CycleBranchOptions::Points>> names(CycleBranchOptions::Points);
[[nodiscard]] std::span<const deck::Name<CycleBranchOptions::Origin>> names(CycleBranchOptions::Origin);
void describe(deck::Description<CycleBranchOptions>& d);

class CycleBranch final : public StudyWith<CycleBranchOptions, "cycle_branch"> {
public:
  [[nodiscard]] bool needs_rotor() const override { return false; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] bool may_add(std::string_view other) const override;
  /// Whether the branch born at this flip, 1-based, is wanted.
  [[nodiscard]] bool follows(std::size_t flip) const;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
  [[nodiscard]] std::vector<std::unique_ptr<Study>> further(const io::Group& result) const override;
};

/// The options of the branch called `name` if that is `study` itself or one born at its flips; nothing otherwise.
[[nodiscard]] std::optional<CycleBranchOptions> branch_called(const Study& study, const std::string& name);

}  // namespace whirl::study
