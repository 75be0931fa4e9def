#pragma once
// One branch of cycles from its first guess to its tables.

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common.hpp"
#include "cycle_record.hpp"
#include "located.hpp"
#include "pieces.hpp"
#include "whirl/solve/periodic_problem.hpp"
#include "whirl/study/cycle_branch.hpp"

namespace whirl::study {

/// A located flip and the direction [n x N m] (SI) in which the cycle of twice its period leaves: the linearised motion
/// of the multiplier -1 over one lap, reversed on the second one.
struct FlipSeed {
  solve::Cycle cycle, direction;
};
void write_seeds(io::Group& group, const std::vector<FlipSeed>& seeds);
[[nodiscard]] std::vector<FlipSeed> read_seeds(const io::Group& group);

/// A bifurcation found again on another film mesh.
struct Relocated {
  Located found;
  double bracket = 0;  ///< scaled width left by the location
  int solves = 0;      ///< cycles that were solved
};

/// The solver's problem, what is recorded of the branch, and how to restart it. Collective throughout.
class CycleFollower {
public:
  /// Follows the branch of `options`; with a seed, the one of twice the period that is born at that flip (then the
  /// options are those of that branch: period and intervals doubled).
  CycleFollower(Context& context, CycleBranchOptions options, std::optional<FlipSeed> seed = std::nullopt);
  /// Solves and records. The study that runs is finished.
  [[nodiscard]] StudyResult run();
  [[nodiscard]] const system::Plant& system() const { return *system_; }
  /// Finds the bifurcation that `other` found on another film mesh. Throws core::NotConverged or core::DomainError.
  [[nodiscard]] Relocated relocate(const Located& from, const CycleFollower& other);
  /// How far the steps in time leave the bifurcation uncertain, scaled; NaN if that cannot be told.
  [[nodiscard]] double time_error(const Located& at);

private:
  [[nodiscard]] std::unique_ptr<system::Plant> make_system(bool half_film) const;
  /// Who shares a system: its states are distributed by solvers that are parallel in space.
  [[nodiscard]] MPI_Comm space() const;
  /// The solver asked for, for cycles of `turns` revolutions of `system` on `mesh`, with time steps
  /// half as long if `doubled`.
  [[nodiscard]] std::unique_ptr<solve::PeriodicProblem> make_problem(system::Plant& system, int turns,
                                                                     std::vector<double> mesh, bool doubled) const;
  /// A change of the root mean square state by half a clearance counts as one longest step.
  [[nodiscard]] double state_weight() const { return std::pow(continuation_.max_step / 0.5, 2); }
  [[nodiscard]] std::unique_ptr<solve::PeriodicProblem> twice_the_period(const FlipSeed& seed) const;
  [[nodiscard]] solve::Restart leave_flip(const solve::PeriodicProblem& twice, const FlipSeed& seed) const;
  [[nodiscard]] core::Vector start(const solve::PeriodicProblem& problem) const;
  [[nodiscard]] solve::Restart start_at_hopf();
  [[nodiscard]] solve::Restart start_at_flip();
  [[nodiscard]] FlipSeed seed_at(const solve::Cycle& cycle);
  /// Reads off, on the branch through u along the unit `tangent`, whether a branch born at a bifurcation lives where
  /// the old one is unstable (supercritical) or where it is stable; `sensitivity` is the slope of the old one's
  /// distance from its border of stability over the scaled parameter.
  void set_criticality(io::Bifurcation& b, solve::PeriodicProblem& problem, Vec u, Vec tangent,
                       double sensitivity) const;
  void set_normal_form(io::Bifurcation& b, const solve::LocatedEvent& found, Vec u);
  [[nodiscard]] io::Bifurcation bifurcation_here(io::BifurcationType type, double value) const;
  void record_hopf(const solve::LocatedEvent& hopf, const solve::Restart& leaving, double omega);
  [[nodiscard]] Eigen::MatrixXd lap_difference(const solve::Cycle& orbit) const;
  /// On a branch born at a flip: the laps are alike, or have just exchanged their places.
  [[nodiscard]] bool at_simple_cycle(const solve::Cycle& orbit) const;
  [[nodiscard]] bool returned(const solve::Cycle& orbit);
  [[nodiscard]] bool autonomous() const { return options_.origin == CycleBranchOptions::Origin::hopf; }
  [[nodiscard]] solve::Stability stability();
  void on_point(const solve::BranchPoint& point, Vec u);
  void on_event(const solve::LocatedEvent& found, Vec u);
  /// Name of a piece of work about the event that comes next.
  [[nodiscard]] std::string piece(const std::string& what) const;
  void report_between(const solve::Cycle& a, const solve::Cycle& b);
  [[nodiscard]] double shift(const solve::LocatedEvent& found, const solve::Cycle& cycle, bool doubled_mesh,
                             bool half_film) const;
  /// The cycle with the own states of its films on the meshes of `to`.
  [[nodiscard]] solve::Cycle on_film_of(const system::Plant& to, solve::Cycle cycle) const;
  void correct(Vec u, Vec row, double offset, const solve::NewtonOptions& newton, Relocated& out);
  void relocate_crossing(core::Vector& u, Relocated& out);
  void relocate_fold(core::Vector& u, Relocated& out);
  void renew_phase(Vec u, Vec tangent);
  void save(const solve::BranchPoint& point, Vec u, Vec tangent, double next_step);
  [[nodiscard]] std::optional<solve::Restart> restore();

  Context& context_;
  CycleBranchOptions options_;
  std::optional<FlipSeed> seed_;
  std::string unit_;
  double scale_;  // SI value of one unit of the range
  solve::NewtonOptions newton_;
  solve::ContinuationOptions continuation_;
  std::unique_ptr<system::Plant> system_;
  std::unique_ptr<solve::PeriodicProblem> problem_;
  CycleRecord record_;
  std::optional<solve::Cycle> last_;
  std::unique_ptr<Pieces> pieces_;  // of the study that runs
  int events_ = 0;                  // seen so far
  std::vector<FlipSeed> seeds_;
  bool keeps_located_;              // a locus of the deck starts from one of them
  std::vector<Located> located_;    // one for each bifurcation of the summary
  Eigen::MatrixXd lap_difference_;  // first lap minus second one, of the last point of a branch born at a flip
  double largest_difference_ = 0;   // its largest norm so far
  bool returned_ = false, contact_ = false;
};

/// Signed distance of a Floquet multiplier from the unit circle.
[[nodiscard]] double distance_of_multiplier(std::complex<double> mu);

}  // namespace whirl::study
