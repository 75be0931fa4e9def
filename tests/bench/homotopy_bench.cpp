// Table 3.1 of van de Vrande (2001): what a point of a branch costs by each solver of periodic solutions. A rigid rotor
// in compliant short bearings, L/D = 1, F0* = 1, B = 0.1, Omega* = 2, N = 50, from the loaded equilibrium at a* = 0 to
// a* = 0.2, improved Euler with 100 steps a period where a scheme of steps is used. Processor time of one rank, with
// multipliers at every point; least of several runs.
//
// Single shooting of the document: phi_T(x_0) - x_0 = 0, the columns of the monodromy matrix and the derivative by the
// parameter by forward differences, so that a linearisation is n + 2 = 58 integrations of 100 steps with 2 evaluations
// of F each, no Jacobian, dense LU of size n + 1, all multipliers by LAPACK. dF/d(dx/dt) is inverted entry by entry
// once. It stands here twice: with F as every other user of problem::System gets it (sparse products, PETSc vectors),
// and with F by the system's structure, which is the quickest there is here and what Newton-Picard and collocation use.
// "Exact columns" is the program's own single shooting: all columns by the exact products of the stages.
//
// Columns of the table: errors at a* = 0.2 against collocation on 40 Gauss intervals of degree 4, of the modulus of the
// leading multiplier and of the journal's position at the end of the period, in clearances. bench_homotopy [--runs N]
// [--only WORDS_OF_A_ROW].
#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <utility>

#include "bench/timing.hpp"
#include "support/half_rotor.hpp"
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"
#include "whirl/solve/shooting/shooting_problem.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double clearance = 25e-6, reference_speed = 160, shaft_speed = 2 * reference_speed,
                 period = 2 * M_PI / shaft_speed;
constexpr int steps = 100;

// Half the rotor on one bearing, with the unbalance a* = 1.
system::Train train() {
  film::CompliantShort film;
  film.compliance = 0.1;
  film.reference_speed = reference_speed;
  film.cells = {50, 4};
  film.quadrature = film::Compliant::Quadrature::simpson;
  film.differences = film::Compliant::Differences::upwind;
  return test::half_rotor(film, clearance);
}

// Structure of the machine without unbalance, with the force a* Omega^2 u(angle) added to its load.
class ForcedStructure : public problem::BlockStructure {
public:
  ForcedStructure(problem::BlockStructure& rest, const std::function<void(double, double, double*)>& add,
                  const double& a)
      : rest_(rest), add_(add), a_(a) {}
  [[nodiscard]] Index size() const override { return rest_.size(); }
  [[nodiscard]] Index n_forces() const override { return rest_.n_forces(); }
  [[nodiscard]] Index n_inputs() const override { return rest_.n_inputs(); }
  [[nodiscard]] const std::vector<problem::OwnStates>& own() const override { return rest_.own(); }
  [[nodiscard]] const problem::SparseBlock& l1() override { return rest_.l1(); }
  [[nodiscard]] const problem::SparseBlock& l0() override { return rest_.l0(); }
  [[nodiscard]] const problem::SparseBlock& b() const override { return rest_.b(); }
  [[nodiscard]] const problem::SparseBlock& c() const override { return rest_.c(); }
  void load(double angle, VectorXd& load) override {
    rest_.load(angle, load);
    add_(angle, a_, load.data());
  }
  void films(const VectorXd& inputs, const double* own, const double* rates, bool tangents,
             problem::Films& films) override {
    rest_.films(inputs, own, rates, tangents, films);
  }
  void parameter_derivative(double angle, const VectorXd& x, const VectorXd&, const problem::Films&,
                            VectorXd& out) override {
    out.setZero(x.size());
    add_(angle, -1, out.data());
  }

private:
  problem::BlockStructure& rest_;
  std::function<void(double, double, double*)> add_;  // += a Omega^2 u(angle)
  const double& a_;
};

// The machine with the unbalance a* as parameter: F(angle, x, xdot) - a* Omega^2 u(angle).
class Homotopy : public problem::System {
public:
  Homotopy()
      : rotor_(PETSC_COMM_SELF, train(), shaft_speed),
        structure_(
            *rotor_.structure(), [this](double angle, double a, double* f) { force(angle, a, f); }, a_) {
    rotor_.set_forcing(false);
  }
  [[nodiscard]] MPI_Comm comm() const override { return PETSC_COMM_SELF; }
  [[nodiscard]] PetscInt size() const override { return rotor_.size(); }
  [[nodiscard]] PetscInt local_size() const override { return rotor_.size(); }
  [[nodiscard]] double parameter() const override { return a_; }
  void set_parameter(double a) override { a_ = a; }
  [[nodiscard]] double speed() const override { return rotor_.speed(); }
  [[nodiscard]] bool parameter_is_speed() const override { return false; }
  void residual(double angle, Vec x, Vec xdot, Vec f) override {
    rotor_.residual(angle, x, xdot, f);
    const core::WriteArray fa(f);
    force(angle, -a_, fa.data());
  }
  [[nodiscard]] core::Matrix make_jacobian() override { return rotor_.make_jacobian(); }
  void jacobian(double angle, Vec x, Vec xdot, double alpha, double sigma, Mat j) override {
    rotor_.jacobian(angle, x, xdot, alpha, sigma, j);
  }
  void parameter_derivative(double angle, Vec, Vec, Vec f) override {
    check(VecSet(f, 0));
    const core::WriteArray fa(f);
    force(angle, -1, fa.data());
  }
  [[nodiscard]] problem::BlockStructure* structure() override { return &structure_; }
  [[nodiscard]] std::vector<problem::KinematicRow> kinematic() const override { return rotor_.kinematic(); }
  void scales(Vec state, Vec residual) override { rotor_.scales(state, residual); }
  [[nodiscard]] VectorXd equilibrium() {
    core::Vector x = system::static_guess(rotor_);
    solve::NewtonOptions o;
    o.max_iterations = 40;
    core::require(solve::find_equilibrium(rotor_, x.get(), o).converged, "the loaded equilibrium is found");
    const auto whole = rotor_.gather(x.get());
    return Eigen::Map<const VectorXd>(whole.data(), rotor_.size());
  }

private:
  // f += a Omega^2 u(angle)
  void force(double angle, double a, double* f) const {
    const double square = a * rotor_.speed() * rotor_.speed();
    for (std::size_t i = 0; i < rotor_.forcing_cosine().size(); ++i)
      f[i] += square * (rotor_.forcing_cosine()[i] * std::cos(angle) + rotor_.forcing_sine()[i] * std::sin(angle));
  }
  system::RotorSystem rotor_;
  double a_ = 0;
  ForcedStructure structure_;
};

// Single shooting as Sec. 3.1 of the document describes it; F by the structure of the system or by System::residual().
class DifferenceShooting : public solve::ExtendedProblem {
public:
  DifferenceShooting(Homotopy& system, bool by_structure, const VectorXd& rest, double state_weight)
      : system_(system),
        by_structure_(by_structure),
        n_(system.size()),
        point_(system, system.structure()),
        sparse_(system, nullptr),
        still_(VectorXd::Zero(n_)),
        f_(n_),
        matrix_(n_ + 1, n_ + 1) {
    core::Vector x = core::make_vector(comm(), system.size(), PETSC_DETERMINE), rest_rate = core::duplicate(x.get());
    core::Matrix rates = system.make_jacobian();
    put(rest, x.get());
    system.jacobian(0, x.get(), rest_rate.get(), 0, 1, rates.get());
    inverse_.resize(n_);
    column_.resize(n_);
    for (PetscInt i = 0; i < system.size(); ++i) {
      PetscInt count = 0;
      const PetscInt* columns = nullptr;
      const PetscScalar* entries = nullptr;
      check(MatGetRow(rates.get(), i, &count, &columns, &entries));
      for (PetscInt k = 0; k < count; ++k)
        if (entries[k] != 0) {
          column_(i) = columns[k];
          inverse_(i) = point_.residual_scale()(i) / (entries[k] * point_.state_scale()(columns[k]));
        }
      check(MatRestoreRow(rates.get(), i, &count, &columns, &entries));
    }
    weights_ = make_unknown();
    const core::WriteArray w(weights_.get());
    for (Index k = 0; k < n_; ++k) w[static_cast<PetscInt>(k)] = state_weight / static_cast<double>(n_);
    w[static_cast<PetscInt>(n_)] = 1;
  }
  [[nodiscard]] MPI_Comm comm() const override { return PETSC_COMM_SELF; }
  [[nodiscard]] core::Vector make_unknown() const override {
    return core::make_vector(comm(), static_cast<PetscInt>(n_ + 1), PETSC_DETERMINE);
  }
  [[nodiscard]] Vec weights() const override { return weights_.get(); }
  [[nodiscard]] double parameter_scale() const override { return 1; }
  void residual(Vec u, Vec r) override {
    const VectorXd all = values(u), out = all.head(n_) - flow(all.head(n_), all(n_));
    const core::WriteArray ra(r);
    Eigen::Map<VectorXd>(ra.data(), n_) = out;
  }
  void linearise(Vec u, Vec row) override {
    const VectorXd all = values(u), start = all.head(n_);
    const double a = all(n_), step = 1e-7;
    const VectorXd end = flow(start, a);
    monodromy_.resize(n_, n_);
    for (Index k = 0; k < n_; ++k) {
      VectorXd moved = start;
      moved(k) += step;
      monodromy_.col(k) = (flow(moved, a) - end) / step;
    }
    matrix_.topLeftCorner(n_, n_) = MatrixXd::Identity(n_, n_) - monodromy_;
    matrix_.topRightCorner(n_, 1) = -(flow(start, a + step) - end) / step;
    matrix_.bottomRows(1) = values(row).transpose();
    lu_.compute(matrix_);
  }
  void multiply(Vec v, Vec y) override { put(matrix_ * values(v), y); }
  void solve(Vec rhs, Vec x) override { put(lu_.solve(values(rhs)), x); }
  [[nodiscard]] const MatrixXd& monodromy() const { return monodromy_; }

private:
  static VectorXd values(Vec v) {
    const core::ReadArray a(v);
    return Eigen::Map<const VectorXd>(a.data(), a.size());
  }
  static void put(const VectorXd& from, Vec v) {
    const core::WriteArray a(v);
    Eigen::Map<VectorXd>(a.data(), from.size()) = from;
  }
  VectorXd slope(double angle, const VectorXd& x) {
    (by_structure_ ? point_ : sparse_).residual(angle, x, still_, f_);
    VectorXd k(n_);
    for (Index i = 0; i < n_; ++i) k(column_(i)) = -inverse_(i) * f_(i);
    return k;
  }
  VectorXd flow(VectorXd x, double a) {
    system_.set_parameter(a);
    point_.refresh();
    const double h = period / steps, turn = 2 * M_PI / steps;
    for (int i = 0; i < steps; ++i) {
      const VectorXd first = slope(i * turn, x), second = slope((i + 1) * turn, x + h * first);
      x += h / 2 * (first + second);
    }
    return x;
  }
  Homotopy& system_;
  bool by_structure_;
  Index n_;
  problem::ScaledPoint point_, sparse_;
  VectorXd still_, f_, inverse_;  // inverse_: of the only entry in each row of dF/d(dx/dt), at column_
  Eigen::VectorX<PetscInt> column_;
  core::Vector weights_;
  MatrixXd matrix_, monodromy_;
  Eigen::PartialPivLU<MatrixXd> lu_;
};

struct Result {
  double seconds = 0;
  int points = 0, iterations = 0;
  std::complex<double> leading;
  std::array<double, 2> journal{};  // at the end of the period, in clearances
};

// The branch from a* = 0 to 0.2; steps between points as in the document, which has four.
Result follow(solve::ExtendedProblem& problem, const VectorXd& u0, Index states,
              const std::function<std::vector<std::complex<double>>()>& multipliers) {
  Result r;
  solve::ContinuationOptions o;
  o.from = 0;
  o.to = 0.2;
  o.initial_step = o.max_step = 0.0667;
  o.min_step = 1e-4;
  o.newton.tolerance = 1e-9;
  solve::BranchCallbacks c;
  c.cycles = true;
  c.stability = [&](Vec) { return solve::make_stability(multipliers(), [](auto z) { return std::abs(z) - 1; }); };
  c.on_point = [&](const solve::BranchPoint& p, Vec u) {
    r.iterations += p.newton_iterations;
    r.leading = p.stability.values.front();
    const core::ReadArray a(u);
    const double* end = a.data() + a.size() - 1 - states;
    r.journal = {end[0], end[2]};
  };
  core::Vector u = problem.make_unknown();
  {
    const core::WriteArray a(u.get());
    Eigen::Map<VectorXd>(a.data(), u0.size()) = u0;
    a[a.size() - 1] = 0;
  }
  const double begin = bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  const auto end = solve::follow_branch(problem, std::move(u), o, c);
  r.seconds = bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - begin;
  r.points = end.points;
  if (!end.completed) throw core::NotConverged("a* = 0.2 was not reached: " + end.reason);
  return r;
}

int run(int runs, const std::string& only) {
  Homotopy system;
  const VectorXd rest = system.equilibrium();
  constexpr double weight = 0.01;
  VectorXd scale;
  {
    core::Vector s = core::make_vector(PETSC_COMM_SELF, system.size(), PETSC_DETERMINE), r = core::duplicate(s.get());
    system.scales(s.get(), r.get());
    const core::ReadArray a(s.get());
    scale = Eigen::Map<const VectorXd>(a.data(), a.size());
  }
  const VectorXd still = rest.cwiseQuotient(scale);
  const auto least = [&](const std::function<Result()>& once) {
    Result best = once();
    for (int k = 1; k < runs; ++k)
      if (const Result r = once(); r.seconds < best.seconds) best = r;
    return best;
  };
  const auto periodic = [&](const std::function<std::unique_ptr<solve::PeriodicProblem>()>& make) {
    return least([&] {
      const auto problem = make();
      const Index nodes = static_cast<Index>(problem->mesh().size() - 1) * problem->scheme().degree;
      return follow(*problem, still.replicate(nodes, 1), still.size(), [&] { return problem->multipliers(); });
    });
  };
  solve::CycleOptions cycle;
  cycle.state_weight = weight;
  const auto shooting = [&](int intervals) {
    return periodic([&, intervals] {
      return std::make_unique<solve::ShootingProblem>(PETSC_COMM_SELF, system, cycle, solve::heun(), steps / intervals,
                                                      solve::uniform_mesh(intervals), true);
    });
  };
  const auto picard = [&](int intervals) {
    solve::NewtonPicardOptions o;
    o.state_weight = weight;
    o.constant_rates = true;
    return periodic([&, o, intervals] {
      return std::make_unique<solve::NewtonPicardProblem>(system, o, solve::heun(), steps / intervals,
                                                          solve::uniform_mesh(intervals));
    });
  };
  const auto collocation = [&](int intervals, int degree) {
    return periodic([&, intervals, degree] {
      solve::CycleOptions o = cycle;
      o.degree = degree;
      return std::make_unique<solve::CycleProblem>(PETSC_COMM_SELF, system, o, solve::uniform_mesh(intervals));
    });
  };
  const int repeated = std::exchange(runs, 1);
  const Result exact = collocation(40, 4);
  runs = repeated;
  double baseline = 0;
  fmt::print("{:<58} {:>6} {:>6} {:>11} {:>8} {:>9} {:>9}\n", "solver", "points", "Newton", "ms a point", "ratio",
             "|mu| off", "x, y off");
  const auto row = [&](const std::string& name, const std::function<Result()>& result) {
    if (name.find(only) == std::string::npos) return;
    const Result r = result();
    const double point = r.seconds / r.points;
    if (baseline == 0) baseline = point;
    fmt::print("{:<58} {:>6} {:>6} {:>11.3f} {:>8.1f} {:>9.1e} {:>9.1e}\n", name, r.points, r.iterations, 1e3 * point,
               baseline / point, std::abs(std::abs(r.leading) - std::abs(exact.leading)),
               std::max(std::abs(r.journal[0] - exact.journal[0]), std::abs(r.journal[1] - exact.journal[1])));
  };
  for (const bool by_structure : {false, true})
    row(by_structure ? "single shooting, forward differences, F by structure" : "single shooting, forward differences",
        [&, by_structure] {
          return least([&] {
            DifferenceShooting problem(system, by_structure, rest, weight);
            return follow(problem, still, still.size(), [&] { return spectral::eigenvalues(problem.monodromy()); });
          });
        });
  row("single shooting, exact columns", [&] { return shooting(1); });
  row("multiple shooting, 10 intervals", [&] { return shooting(10); });
  row("finite differences", [&] { return shooting(steps); });
  row("shooting-based Newton-Picard", [&] { return picard(1); });
  row("finite-difference-based Newton-Picard", [&] { return picard(steps); });
  row("collocation, 20 intervals of degree 2", [&] { return collocation(20, 2); });
  row("collocation, 12 intervals of degree 3", [&] { return collocation(12, 3); });
  row("collocation, 20 intervals of degree 3", [&] { return collocation(20, 3); });
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const core::Session session(argc, argv);
  int runs = 5;
  std::string only;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--runs") == 0 && k + 1 < argc) runs = std::stoi(argv[k + 1]);
    if (std::strcmp(argv[k], "--only") == 0 && k + 1 < argc) only = argv[k + 1];
  }
  return run(runs, only);
}
