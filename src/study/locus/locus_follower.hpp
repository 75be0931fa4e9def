#pragma once
// A curve of bifurcations, or of cycles that keep a quantity, in two parameters: what it is followed with.

#include <Eigen/Core>
#include <array>
#include <complex>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/bars/error_bar.hpp"
#include "study/bars/film_mesh.hpp"
#include "study/branch_state.hpp"
#include "study/common.hpp"
#include "study/cycle/cycle_branch.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "study/located.hpp"
#include "study/locus/curve_points.hpp"
#include "study/locus/locus.hpp"
#include "study/pieces.hpp"
#include "whirl/solve/bifurcation/augmented_problem.hpp"

namespace whirl::study {

/// Names of monitors behind the tests of the condition: for Hopf points, and where the curve turns in the second and in
/// the first parameter.
inline constexpr const char* generalised_hopf = "generalised_hopf";
inline constexpr const char* meeting = "meeting";
inline constexpr const char* meeting_over_second = "meeting_over_second";

/// Cells of the films over those of the deck.
using FilmFactor = std::array<double, 2>;

/// A point of a curve, SI; the amplitude of a self-excited cycle in clearances.
struct Row {
  double first = 0, second = 0, period = 0, angle = 0, amplitude = 0;
  int others_unstable = 0;
  double mesh_wave = 0;  ///< frequency of a growing wave of a film's mesh, which is left out; zero: none
  static constexpr double unknown_frequency = -1;  ///< of a wave that multipliers show
  void members(auto& archive) { archive(first, second, period, angle, amplitude, others_unstable, mesh_wave); }
};

/// The bar of a point of a curve, not a number where it is unknown.
struct RowBar {
  double normal = std::numeric_limits<double>::quiet_NaN();  ///< of the distance normal to the curve, scaled
  double first = std::numeric_limits<double>::quiet_NaN();   ///< of the first parameter at a fixed second one [SI]
  double second = std::numeric_limits<double>::quiet_NaN();  ///< of the second parameter at a fixed first one [SI]
  bool computed = false;                                     ///< else between its neighbours'
};
/// Share of a parameter in the normal of a curve, both scaled, below which that parameter has no bar of its own: the
/// curve runs along it.
inline constexpr double least_share = 0.1;

/// Coefficients of normal forms on the curve, a little behind and ahead of a point of it, and what lies between the two
/// in the scaled parameters.
struct Beside {
  double behind = 0, ahead = 0;
  Eigen::Vector2d moved = Eigen::Vector2d::Zero();
};

/// The equations of a curve about a point of it, on the films of one machine and one mesh of time.
struct CurveProblem {
  std::unique_ptr<system::RotorSystem> other = {};       ///< a machine of its own; null: that of the curve
  std::unique_ptr<solve::CycleProblem> cycles = {};      ///< of a branch of cycles, else null
  std::unique_ptr<solve::EquilibriumProblem> rest = {};  ///< of a branch of equilibria, else null
  solve::ExtendedProblem* branch = nullptr;              ///< the one of both that there is
  std::unique_ptr<solve::Condition> condition = {};
  std::unique_ptr<solve::AugmentedProblem> problem = {};
  core::Vector whole = {};  ///< the point

  [[nodiscard]] bool autonomous() const { return cycles && cycles->options().autonomous; }
  /// The cycle, and the equilibrium [SI], of a point.
  [[nodiscard]] solve::Cycle cycle(Vec at) const { return cycles->gather(problem->branch_part(at).get()); }
  [[nodiscard]] core::Vector state(system::RotorSystem& system, Vec at) const;
  /// Both scaled parameters.
  [[nodiscard]] Eigen::Vector2d place(Vec at) const {
    return {problem->first_parameter(at), solve::last_entry(problem->comm(), at)};
  }
};

/// The branch problem at the bifurcation that the curve begins with, in both parameters.
class LocusFollower {
public:
  LocusFollower(Context& context, const LocusOptions& options);
  StudyResult run();
  /// What a checkpoint holds beside the last point.
  void members(auto& archive) {
    archive(second_way_, done_, done_spread_, done_end_, rows_, start_, inner_sign_, length_, spread_, zeros_,
            seed_.sensitivity, generalised_);
  }

private:
  static constexpr std::size_t points_each_way = 8;  // that are kept with their solutions
  // System, branch problem and condition at the start of the curve.
  void begin();
  [[nodiscard]] solve::CycleOptions cycle_options() const;
  // About `point` with that critical eigenvalue or multiplier, on a system with `film` and on the time mesh `times`.
  // Without inner unknowns of the point those of the condition.
  [[nodiscard]] CurveProblem problem_at(const CurvePoint& point, std::complex<double> critical,
                                        system::RotorSystem& system, const FilmFactor& film,
                                        const std::vector<double>& times);
  // At a first parameter and the present second one.
  [[nodiscard]] system::Train train_at(double first, const FilmFactor& film = {1, 1}) const;
  /// Who holds a system, and who shares the intervals of cycles on `mesh`.
  [[nodiscard]] MPI_Comm space() const;
  [[nodiscard]] MPI_Comm time(const std::vector<double>& mesh) const;
  [[nodiscard]] std::unique_ptr<system::RotorSystem> make_system(double first, const FilmFactor& film = {1, 1}) const;
  [[nodiscard]] solve::SecondParameter second(system::RotorSystem& system, const FilmFactor& film = {1, 1});
  [[nodiscard]] Row row_at(Vec whole, double second) const;
  [[nodiscard]] std::vector<solve::CodimensionTest> tests(Vec whole, Vec tangent);
  // `error` in scaled second parameter; not a number: unknown.
  void record(const std::string& type, double second, double error, Vec whole);
  void record_row(const std::string& type, const Row& row, double error);
  // A zero of the coefficient of a normal form, if it is one of the equations.
  void record_generalised(const std::string& type, double second, double bracket, Vec whole);
  // On the discretisation of the curve, or on another one.
  [[nodiscard]] Beside beside(Vec whole, bool other, double reach);
  // Whether the zero of the coefficient at `whole` is one on another discretisation too: its error in scaled second
  // parameter, or not a number; and whether there is another one near.
  struct Verdict {
    double error = std::numeric_limits<double>::quiet_NaN();
    bool unclear = false;
  };
  [[nodiscard]] Verdict judge(Vec whole, double reach);
  // The condition of cycles on the films of a system.
  [[nodiscard]] std::unique_ptr<solve::Condition> condition_of(solve::CycleProblem& cycles, system::RotorSystem& system,
                                                               std::complex<double> critical,
                                                               const FilmFactor& film = {1, 1});
  // Of a limit: d(quantity/value)/d(first parameter) along the branch; when its peaks are, with a warning where another
  // one takes over.
  [[nodiscard]] double slope_of_limit(Vec whole);
  void watch_peaks(Vec whole, const Row& before);
  // The curve and its points of codimension two on other meshes.
  [[nodiscard]] MeshLaw law() const;
  [[nodiscard]] std::vector<OtherMesh> meshes() const;
  [[nodiscard]] CurvePoint point_at(Vec whole) const;
  [[nodiscard]] std::optional<CurveProblem> carried_to(const OtherMesh& mesh, const CurvePoint& given);
  [[nodiscard]] std::vector<double> beside_curve(const OtherMesh& mesh, const CurvePoint& point,
                                                 const Eigen::Vector2d& along);
  [[nodiscard]] std::vector<double> zero_on(const OtherMesh& mesh, const CurvePoint& near, const std::string& type);
  [[nodiscard]] std::vector<double> direction_at(const CurvePoint& point);
  [[nodiscard]] Bar bar_beside(const std::string& name, const CurvePoint& point, const Eigen::Vector2d& along);
  [[nodiscard]] double tolerance_at(const Eigen::Vector2d& place) const;
  // Bars of both parameters; `location` as of record().
  void put_bars(io::CodimensionTwo& c, Vec whole, double location);
  // Of the whole curve, the start of which is row `start`: a few are computed, and those between them interpolated.
  [[nodiscard]] std::vector<RowBar> bars_of(const std::vector<Row>& rows, std::size_t start);
  void put_curve(const std::vector<Row>& rows, const std::vector<RowBar>& bars);
  // What the curve is one of.
  void put_kind();
  // Puts the unstable eigenvalues or multipliers beside the critical ones into `at`.
  void put_others(Vec whole, Row& at);
  [[nodiscard]] std::vector<double> films(Vec whole) const;
  // The cycle at `whole` as it swings about its mean, and how far a place does.
  [[nodiscard]] Eigen::MatrixXd swing(Vec whole) const;
  [[nodiscard]] double amplitude_of(const Eigen::MatrixXd& swing) const;
  // Positive as long as cycles of a fold are large enough to go on.
  [[nodiscard]] double margin_of_amplitude(Vec whole) const;
  [[nodiscard]] std::vector<Row> smallest_cycles() const;
  [[nodiscard]] bool end_at_generalised_hopf();
  void suspect(double from, double to, const std::string& reason);
  // Points in one direction from the start, without it.
  std::vector<Row> follow(double to, double back, solve::BranchEnd& end);
  [[nodiscard]] solve::Restart restore(Vec like);
  void save(const solve::ResumePoint& at, Vec whole, Vec tangent);

  Context& context_;
  const LocusOptions& options_;
  std::optional<CycleBranchOptions> of_cycles_;
  const EquilibriumBranchOptions* of_rest_ = nullptr;
  Located seed_;
  Parameter first_;
  std::vector<std::string> unbalance_;
  deck::Range first_range_;
  double first_scale_ = 1, second_scale_ = 1;   // SI values of one unit of the scaled parameters: widths of the ranges
  double start_second_ = 0, second_value_ = 0;  // SI: at the start, and to which the system is set
  solve::ContinuationOptions continuation_;
  std::unique_ptr<system::RotorSystem> system_;
  CurveProblem curve_;
  std::unique_ptr<Pieces> pieces_;
  bool interrupted_ = false;  // an earlier run, whose checkpoint the present direction goes on from
  bool second_way_ = false;   // the first direction is done:
  std::vector<Row> done_;     // its points
  solve::BranchEnd done_end_;
  std::vector<Row> rows_;  // of the present one
  double inner_sign_ = 0;  // of the inner unknown at its first point
  int zeros_ = 0;          // generalised points looked at so far
  Row start_, last_;
  double length_ = 0;                                                    // from the start, scaled
  SpreadPoints spread_{points_each_way}, done_spread_{points_each_way};  // of the present direction, and the other one
  Eigen::MatrixXd last_swing_;                                           // of the last point
  std::vector<double> peak_times_;                                       // likewise
  // Generalised points that are confirmed: both parameters, and how far around was looked at, scaled.
  struct Confirmed {
    double first = 0, second = 0, looked = 0;
    void members(auto& archive) { archive(first, second, looked); }
  };
  std::vector<Confirmed> generalised_;
  bool left_ = false, ended_ = false;
};

}  // namespace whirl::study
