#pragma once
// One branch of cycles from its first guess to its tables.

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "study/bars/beyond.hpp"
#include "study/bars/film_limit.hpp"
#include "study/bars/film_mesh.hpp"
#include "study/common.hpp"
#include "study/cycle/cycle_branch.hpp"
#include "study/cycle/cycle_record.hpp"
#include "study/cycle/node_record.hpp"
#include "study/located.hpp"
#include "study/locus/limit.hpp"
#include "study/pieces.hpp"
#include "study/stored_vector.hpp"
#include "whirl/io/table.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"

namespace whirl::study {

/// A located flip and the direction [n x N m] (SI) in which the cycle of twice its period leaves: the linearised motion
/// of the multiplier -1 over one lap, reversed on the second one.
struct FlipSeed {
  solve::Cycle cycle, direction;
};
/// `like` as of write_cycle().
void write_seeds(io::Group& group, const std::vector<FlipSeed>& seeds, const SharedRows& like);
[[nodiscard]] std::vector<FlipSeed> read_seeds(const io::Group& group, const SharedRows& like);
/// Their number.
[[nodiscard]] std::size_t count_seeds(const io::Group& group);

/// A bifurcation found again on another film mesh.
struct Relocated {
  Located found;
  double bracket = 0;  ///< scaled width left by the location
  int solves = 0;      ///< cycles that were solved
};

/// The time meshes beside the one in use, if bars are wanted: half and twice the spacing or, where that cannot be, half
/// and a quarter. Two meshes alone may agree by chance.
[[nodiscard]] std::vector<OtherMesh> time_meshes(bool halves, const LayoutOptions& layout);
/// Every other point of a mesh of time; empty if fewer than eight intervals would be left.
[[nodiscard]] std::vector<double> merged(const std::vector<double>& mesh);

/// What a bifurcation of cycles is told by.
struct CycleNumbers {
  double place = 0;        ///< scaled parameter
  double angle = 0;        ///< of the critical multiplier [rad]
  double period = 0;       ///< [s]
  double coefficient = 0;  ///< of its normal form; of a fold the second derivative of the parameter
  [[nodiscard]] std::vector<double> list() const { return {place, angle, period, coefficient}; }
};

/// Every so many points of a branch the leading multiplier is computed on other meshes, which costs about as much as
/// seven points.
inline constexpr int points_per_bar = 25;
/// Where a branch knows the bar of its leading multiplier: point, parameter, modulus, bar by its parts, and whether it
/// is on one side of the unit circle for certain.
[[nodiscard]] io::Table multiplier_table(const std::string& unit);

/// The parameter of a branch of cycles near its birth, p = p_0 + curvature h^2, h the root mean square amplitude in
/// clearances.
struct Parabola {
  double curvature = 0, error = 0;
};

/// Signed distance of a Floquet multiplier from the unit circle.
[[nodiscard]] double distance_of_multiplier(std::complex<double> mu);
/// The Floquet multipliers of a cycle at which `problem` is linearised. Those that belong to waves of a film's mesh are
/// not among them but for strongly damped ones; Stability::mesh_waves has those outside the unit circle (of pairs the
/// one with imag > 0). Collective.
[[nodiscard]] solve::Stability cycle_stability(solve::PeriodicProblem& problem, system::Plant& system);

/// The solver's problem, what is recorded of the branch, and how to restart it. Collective throughout.
class CycleFollower {
public:
  /// Follows the branch of `options`.
  CycleFollower(Context& context, CycleBranchOptions options);
  /// Follows the branch of twice the period that is born at one of the flips in `group` (write_seeds()). The options
  /// are those of that branch: period and intervals doubled.
  void leave_from(const io::Group& flips, std::size_t which);
  /// Follows the branch that begins at a given forced cycle (write_cycle()).
  void begin_at(const io::Group& cycle);
  /// Solves and records. The study that runs is finished.
  [[nodiscard]] StudyResult run();
  [[nodiscard]] const system::Plant& system() const { return *system_; }
  /// Bifurcations as write_located() has them, whoever shares the states here.
  void write(io::Group& group, const std::vector<Located>& located) const { write_located(group, located, stored()); }
  [[nodiscard]] std::vector<Located> read(const io::Group& group) const { return read_located(group, stored()); }
  /// Finds the bifurcation that `other` found on another film mesh, with what the journal (may be null) knows of the
  /// way. Throws core::NotConverged or core::DomainError.
  [[nodiscard]] Relocated relocate(const Located& from, const CycleFollower& other, solve::ReplayLog* replay_log);
  /// How far the steps in time leave the bifurcation uncertain, scaled; NaN if that cannot be told.
  [[nodiscard]] double time_error(const Located& at);

private:
  [[nodiscard]] std::unique_ptr<system::Plant> make_system(const std::array<double, 2>& film_cells,
                                                           int shaft_parts = 1) const;
  /// Who shares the states of a system, or the intervals of a mesh.
  [[nodiscard]] Layout layout(std::size_t intervals = 1) const;
  /// The solver asked for, for cycles of `turns` revolutions of `system` on `mesh`, with `finer` (1/2, 1, 2, 4) times
  /// as many steps in time.
  [[nodiscard]] std::unique_ptr<solve::PeriodicProblem> make_problem(system::Plant& system, int turns,
                                                                     std::vector<double> mesh, double finer) const;
  [[nodiscard]] double state_weight() const { return state_weight_of(continuation_); }
  [[nodiscard]] std::unique_ptr<solve::PeriodicProblem> twice_the_period(const FlipSeed& seed, double finer = 1) const;
  [[nodiscard]] solve::Restart leave_flip(const solve::PeriodicProblem& twice, const FlipSeed& seed) const;
  [[nodiscard]] core::Vector start(const solve::PeriodicProblem& problem) const;
  /// Forced cycles beside the first one, at its parameter.
  [[nodiscard]] std::vector<solve::Cycle> coexisting();
  [[nodiscard]] solve::Restart start_at_hopf();
  [[nodiscard]] solve::Restart start_at_flip();
  [[nodiscard]] FlipSeed seed_at(const solve::Cycle& cycle);
  /// Reads off, on the branch through u along the unit `tangent`, whether a branch born at a bifurcation lives where
  /// the old one is unstable (supercritical) or where it is stable; `sensitivity` is the slope of the old one's
  /// distance from its border of stability over the scaled parameter. A verdict that `b` has already is only doubted.
  [[nodiscard]] std::optional<Parabola> parabola(solve::PeriodicProblem& problem, Vec u, Vec tangent) const;
  /// `elsewhere` is the parabola on another time mesh; without it the bar holds no time mesh.
  void set_criticality(io::Bifurcation& b, solve::PeriodicProblem& problem, Vec u, Vec tangent, double sensitivity,
                       const std::function<std::optional<Parabola>(const OtherMesh&)>& elsewhere = {}) const;
  [[nodiscard]] io::Bifurcation bifurcation_here(io::BifurcationType type, double value) const;
  /// How far the cycle is from contact and from `max_eccentricity`, per clearance.
  [[nodiscard]] double margin(const CycleOrbit& orbit) const;
  /// Of a point of the branch, for the slope at which it meets its limit.
  void add_margin(double parameter, const CycleOrbit& orbit);
  /// Where the branch comes to its contact at `place` (scaled) on other meshes; `last` is its last cycle.
  [[nodiscard]] std::vector<Sample> contacts_there(const solve::Cycle& last, double place);
  void doubt(BranchVerdict& verdict);
  /// Puts a pair that no mesh confirms among the suspicions instead.
  [[nodiscard]] bool left_as_doubtful(const io::Bifurcation& b, const solve::LocatedEvent& found);
  void doubt_at_birth(io::Bifurcation& b) const;
  void record_hopf(const solve::LocatedEvent& hopf, Vec equilibrium, const solve::Restart& leaving);
  /// Which rows of a state this rank stores.
  [[nodiscard]] SharedRows stored() const;
  /// What vanishes where the branch runs back into what it was born of [rows here x times]. Its sign changes beyond.
  [[nodiscard]] Eigen::MatrixXd vanishing(const solve::Cycle& orbit) const;
  /// The sum of products of entries, of all ranks.
  [[nodiscard]] double product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const;
  [[nodiscard]] bool may_return() const { return seed_ || autonomous(); }
  /// Little is left of that, or its sign has just changed.
  [[nodiscard]] bool at_its_origin(const solve::Cycle& orbit) const;
  [[nodiscard]] bool returned(const solve::Cycle& orbit);
  [[nodiscard]] BranchKind kind() const {
    return {true, autonomous(), options_.period, system::is_rotor(context_.machine)};
  }
  [[nodiscard]] bool autonomous() const { return options_.origin == CycleBranchOptions::Origin::hopf; }
  /// How far the cycle is from the eccentricity at which the branch is to end, per clearance.
  [[nodiscard]] double room(const CycleOrbit& orbit) const;
  /// The cycle u of the branch, at whose parameter the system is left.
  [[nodiscard]] CycleOrbit orbit_of(Vec u) const;
  void on_point(const solve::BranchPoint& point, Vec u);
  /// What pictures show of a solution, by their axes.
  [[nodiscard]] std::vector<std::vector<double>> drawn(Vec u);
  void on_event(const solve::LocatedEvent& found, Vec u);
  /// Name of a piece of work about the event that comes next.
  [[nodiscard]] std::string piece(const std::string& what) const;
  void report_between(const solve::Cycle& a, const solve::Cycle& b);
  /// A point of the branch and the modulus of its leading multiplier.
  struct Watched {
    int index = 0;
    double parameter = 0, modulus = 0;  // scaled
    solve::Cycle cycle;
    void members(auto& archive) { archive(index, parameter, modulus); }  // the cycle is stored by rows
  };
  /// Keeps the point whose leading multiplier is nearest to the unit circle. A branch that is born at a bifurcation
  /// leaves the circle first: points up to the farthest one do not count.
  void watch(const solve::BranchPoint& point, const solve::Cycle& cycle);
  /// The bar of the leading multiplier's modulus at a point of the branch.
  void judge_multiplier(const Watched& at);
  /// The same, of a branch whose points are all stable or all unstable, at the point nearest to the unit circle: unless
  /// it is `decided` there, a bifurcation may have been missed on this mesh. Then at the end of the branch as well,
  /// which bounds the stretch in doubt.
  void judge_nearest();
  /// Values of a cycle asked for with their bars, under `at.<key>.` in the summary.
  void report(const std::string& key, Vec u);
  /// cycle_stability() without the trivial multiplier of a self-excited cycle.
  [[nodiscard]] solve::Stability stability_of(solve::PeriodicProblem& problem, system::Plant& system) const;
  /// What is known of the errors of films and time steps.
  [[nodiscard]] MeshLaw law() const;
  [[nodiscard]] double order_of_scheme() const;
  [[nodiscard]] std::vector<OtherMesh> meshes() const;
  /// Whether the mesh of time, and not a number of steps in each interval, says how long steps are.
  [[nodiscard]] bool steps_are_intervals() const;
  /// The solver on another mesh; null where there is no such mesh.
  [[nodiscard]] std::unique_ptr<solve::PeriodicProblem> problem_on(const OtherMesh& mesh, system::Plant& system,
                                                                   const solve::Cycle& cycle) const;
  /// A cycle on another mesh.
  struct Elsewhere {
    std::unique_ptr<system::Plant> other;  // null: the system is the one followed
    system::Plant* system = nullptr;
    solve::Cycle cycle;  // as it was carried over
    std::unique_ptr<solve::PeriodicProblem> problem;
    core::Vector u;
    [[nodiscard]] CycleOrbit orbit(Vec at) const { return {problem->orbit(at), problem->orbit_scheme(), *system}; }
  };
  [[nodiscard]] std::optional<Elsewhere> carried_to(const OtherMesh& mesh, const solve::Cycle& given) const;
  /// Solves it there at the same parameter, and linearises.
  [[nodiscard]] bool correct_there(Elsewhere& there, const solve::Cycle& given) const;
  [[nodiscard]] std::optional<Elsewhere> corrected_on(const OtherMesh& mesh, const solve::Cycle& given) const;
  /// Rows that `work` makes on each of these meshes, pieces `name 1`, ...: shared between the ranks where each holds a
  /// whole machine, which then solves cycles by itself. `work` asks nothing of the cycles that are followed.
  using Rows = std::vector<std::vector<double>>;
  [[nodiscard]] Rows on_each(const std::vector<OtherMesh>& meshes, const std::string& name,
                             const std::function<std::vector<double>(const OtherMesh&)>& work);
  /// Direction of the branch at its fold; nothing of other bifurcations.
  [[nodiscard]] solve::Cycle along(const solve::LocatedEvent& found, const solve::Cycle& given) const;
  [[nodiscard]] std::optional<CycleNumbers> fold_on(const OtherMesh& mesh, const solve::LocatedEvent& found,
                                                    const solve::Cycle& given, const solve::Cycle& along) const;
  /// The same bifurcation on another mesh; nothing if it cannot be had.
  [[nodiscard]] std::optional<CycleNumbers> numbers_on(const OtherMesh& mesh, const solve::LocatedEvent& found,
                                                       const solve::Cycle& cycle, const solve::Cycle& along,
                                                       bool with_coefficient) const;
  /// Of the branch of twice the period that is born at `flip`, whose scaled place there is given.
  [[nodiscard]] std::optional<Parabola> born_on(const OtherMesh& mesh, const solve::Cycle& flip, double place) const;
  [[nodiscard]] double normal_form(solve::PeriodicProblem& problem, system::Plant& system, solve::Event event,
                                   std::complex<double> critical, Vec u, double step) const;
  /// Puts the bars of the event that comes next into `b`; returns numbers_on() all meshes(), empty where they cannot be
  /// had.
  Rows put_bars(io::Bifurcation& b, const solve::LocatedEvent& found, const solve::Cycle& cycle, Vec u);
  /// The cycle with the own states of its films on the meshes of `to`.
  [[nodiscard]] solve::Cycle on_film_of(const system::Plant& to, solve::Cycle cycle) const;
  void correct(Vec u, Vec row, double offset, const solve::NewtonOptions& newton, Relocated& out);
  [[nodiscard]] solve::ReplayLog::Answer read_off(Vec u, Vec row,
                                                  const std::function<void(solve::ReplayLog::Answer&)>& work);
  void relocate_crossing(core::Vector& u, Relocated& out);
  void relocate_fold(core::Vector& u, Relocated& out);
  void renew_phase(const solve::Cycle& cycle, Vec u, Vec tangent);
  void close_at_flip(double landed);
  void save(const solve::ResumePoint& at, Vec u, Vec tangent);
  [[nodiscard]] std::optional<solve::Restart> restore();

  Context& context_;
  CycleBranchOptions options_;
  std::optional<FlipSeed> seed_;
  std::optional<solve::Cycle> first_;
  std::vector<FlipSeed> siblings_;
  std::string unit_;
  double scale_;  // SI value of one unit of the range
  solve::NewtonOptions newton_;
  solve::ContinuationOptions continuation_;
  std::unique_ptr<system::Plant> system_;
  core::Vector stored_;  // rows of a state that ranks store, if they share it
  std::unique_ptr<solve::PeriodicProblem> problem_;
  CycleRecord record_;
  FilmLimit films_;
  MarginSlope margins_;
  NodeRecord nodes_;
  ShaftOrbits shafts_;
  io::Table multiplier_bars_;
  std::optional<solve::Cycle> last_;
  std::optional<Watched> nearest_;
  bool leaves_ = false;             // the bifurcation that the branch is born at
  std::unique_ptr<Pieces> pieces_;  // of the study that runs
  bool alone_ = false;              // this rank solves cycles by itself for a while
  int events_ = 0;                  // seen so far
  std::vector<FlipSeed> seeds_;
  std::vector<BranchChange> changes_;
  bool keeps_located_;            // a locus of the deck starts from one of them
  std::vector<Located> located_;  // one for each bifurcation of the summary
  LimitsOnBranch limits_;
  Eigen::MatrixXd vanishing_;  // of the last point of a branch that may return
  double largest_ = 0;         // its largest norm so far
  int filled_ = 0;             // points between the ends of steps so far
  int of_last_step_ = 0;       // points, with those between its ends
  bool returned_ = false;
};

}  // namespace whirl::study
