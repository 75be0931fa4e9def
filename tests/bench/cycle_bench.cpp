// Cost of one Newton iteration of the main job's cycle: the Guyan-reduced train (104 states), G2.5 at 3600 rpm, 60
// intervals of degree 2, films of 60 x 16 cells; with its parts, against dense intervals and assembled MUMPS, and
// against the whole shaft (1500 states) and its Craig-Bampton reduction (5 bearings, 16 modes a plane; 104 states).
// mpirun -n 1 bench_cycle; mpirun -n 2 bench_cycle. Least of several runs; --quick: few; --alone: no comparison;
// --shafts: whole and Craig-Bampton only.
#include <fmt/core.h>

#include <cmath>
#include <cstring>

#include "bench/timing.hpp"
#include "solve/cycle/linear_part.hpp"
#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

constexpr double kSpeed = 120 * M_PI;  // 3600 rpm
constexpr int kIntervals = 60;

void row(const char* name, const bench::Timing& t) {
  if (core::rank_of(MPI_COMM_WORLD) == 0) fmt::print("{:<58} {:9.3f} {:9.3f}\n", name, 1e3 * t.wall, 1e3 * t.processor);
}

struct Iteration {
  bench::Timing residual, linearise, solve, whole;
};

// The parts of an iteration and the whole, at the point u.
Iteration measure(solve::CycleProblem& p, Vec u, int runs) {
  core::Vector r = core::duplicate(u), x = core::duplicate(u), fix = core::duplicate(u);
  solve::parameter_row(p, fix.get());
  const auto residual = [&] {
    p.residual(u, r.get());
    solve::set_last_entry(MPI_COMM_WORLD, r.get(), 0);
  };
  const auto linearise = [&] { p.linearise(u, fix.get()); };
  const auto solve = [&] { (void)solve::solve_linear(p, r.get(), x.get(), "bench_"); };
  Iteration t;
  t.residual = bench::least(MPI_COMM_WORLD, runs, residual);
  t.linearise = bench::least(MPI_COMM_WORLD, runs, linearise);
  t.solve = bench::least(MPI_COMM_WORLD, runs, solve);
  t.whole = bench::least(MPI_COMM_WORLD, runs, [&] {
    residual();
    linearise();
    solve();
  });
  return t;
}

void parts(system::RotorSystem& s, solve::CycleProblem& p, Vec u, int runs) {
  const solve::Cycle cycle = p.gather(u);
  const Eigen::MatrixXd inputs = s.structure()->c() * cycle.x;
  const int size = core::size_of(MPI_COMM_WORLD);
  const Eigen::Index points = inputs.cols() / size;
  problem::Films films;
  row("films, forces only (own share of 120 points)", bench::least(MPI_COMM_WORLD, runs, [&] {
        for (Eigen::Index k = 0; k < points; ++k) s.structure()->films(inputs.col(k), nullptr, nullptr, false, films);
      }));
  row("films with tangents", bench::least(MPI_COMM_WORLD, runs, [&] {
        for (Eigen::Index k = 0; k < points; ++k) s.structure()->films(inputs.col(k), nullptr, nullptr, true, films);
      }));
  const Eigen::MatrixXd l1 = s.structure()->l1(), l0 = s.structure()->l0(), b = s.structure()->b(),
                        c = s.structure()->c();
  row("factorisation of the linear part (on every rank)", bench::least(MPI_COMM_WORLD, runs, [&] {
        const solve::LinearPart part(p.scheme(), cycle.period / kIntervals, {l1, l0, b, c, s.kinematic()});
      }));
  core::Vector v = core::duplicate(u), y = core::duplicate(u);
  core::check(VecCopy(u, v.get()));
  row("preconditioner, one application", bench::least(MPI_COMM_WORLD, runs, [&] { p.solve(v.get(), y.get()); }));
  row("product with the matrix", bench::least(MPI_COMM_WORLD, runs, [&] { p.multiply(v.get(), y.get()); }));
  const Eigen::MatrixXd monodromy = p.monodromy();
  Eigen::MatrixXd product = Eigen::MatrixXd::Identity(s.size(), s.size());
  row("one product 104 x 104 x 104", bench::least(MPI_COMM_WORLD, runs, [&] {
        const Eigen::MatrixXd next = monodromy * product;
        product(0, 0) = next(0, 0) != 0 ? 1 : 2;
      }));
  row("multipliers (per point of a branch)", bench::least(MPI_COMM_WORLD, runs, [&] { (void)p.multipliers(); }));
}

solve::NewtonOptions newton_options() {
  solve::NewtonOptions o;
  o.max_iterations = 40;
  return o;
}

// The cycle from the static equilibrium, resting there at all nodes; null if Newton fails.
core::Vector find_cycle(system::RotorSystem& s, solve::CycleProblem& p, int degree) {
  core::Vector x = system::static_guess(s);
  const auto newton = newton_options();
  if (!solve::find_equilibrium(s, x.get(), newton).converged) return {};
  const auto rest = s.gather(x.get());
  solve::Cycle guess{p.mesh(), {}, 2 * M_PI / kSpeed, kSpeed};
  guess.x = Eigen::Map<const Eigen::VectorXd>(rest.data(), s.size()).replicate(1, kIntervals * degree);
  core::Vector u = p.scatter(guess), fix = core::duplicate(u.get());
  solve::parameter_row(p, fix.get());
  solve::NewtonResult result;
  const auto solving =
      bench::least(MPI_COMM_WORLD, 1, [&] { result = solve::newton(p, u.get(), fix.get(), kSpeed, newton); });
  if (!result.converged) return {};
  if (core::rank_of(MPI_COMM_WORLD) == 0)
    fmt::print(
        "{} ranks, {} states; cycle from the equilibrium: {} Newton iterations, {} linear iterations, {:.3f} s\n",
        core::size_of(MPI_COMM_WORLD), s.size(), result.iterations, result.linear_iterations, solving.wall);
  return u;
}

void rows(const Iteration& i) {
  if (core::rank_of(MPI_COMM_WORLD) == 0) fmt::print("\n{:<58} {:>9} {:>9}\n", "", "wall ms", "cpu ms");
  row("residual", i.residual);
  row("linearise (films, condensation, transitions, small LU)", i.linearise);
  row("solve (GMRES)", i.solve);
  row("Newton iteration", i.whole);
}

// Newton's iteration of another shaft against the Guyan-reduced one's.
bool against(const char* name, const rotor::Reduction& reduction, const Iteration& guyan, int runs) {
  auto t = test::train({60, 16}, false);
  t.rotor.reduction = reduction;
  test::add_gen_pair(t, 2.5);
  system::RotorSystem s(PETSC_COMM_SELF, t, kSpeed);
  solve::CycleProblem p(MPI_COMM_WORLD, s, {}, solve::uniform_mesh(kIntervals));
  const bool root = core::rank_of(MPI_COMM_WORLD) == 0;
  if (root) fmt::print("\n{}\n", name);
  const core::Vector u = find_cycle(s, p, 2);
  if (!u) return false;
  const Iteration i = measure(p, u.get(), runs);
  rows(i);
  core::Vector fix = core::duplicate(u.get());
  solve::parameter_row(p, fix.get());
  row("multipliers after a linearisation", bench::least(MPI_COMM_WORLD, 2, [&] {
        p.linearise(u.get(), fix.get());
        (void)p.multipliers();
      }));
  if (root) fmt::print("ratio to the Guyan-reduced shaft {:.2f}\n", i.whole.processor / guyan.whole.processor);
  return true;
}

int run(int runs, bool alone, bool shafts) {
  auto t = test::train({60, 16}, true);
  test::add_gen_pair(t, 2.5);
  system::RotorSystem s(PETSC_COMM_SELF, t, kSpeed);
  solve::CycleOptions options;
  options.degree = 2;

  core::Vector u;
  Iteration reference;
  for (const auto& [name, structured, assembled] : {std::tuple{"low-rank intervals", true, false},
                                                    {"dense intervals", false, false},
                                                    {"assembled matrix, MUMPS", false, true}}) {
    if ((alone || shafts) && !structured) break;
    options.use_structure = structured;
    if (assembled) {
      core::check(PetscOptionsSetValue(nullptr, "-bench_pc_type", "lu"));
      core::check(PetscOptionsSetValue(nullptr, "-bench_pc_factor_mat_solver_type", "mumps"));
    }
    solve::CycleProblem p(MPI_COMM_WORLD, s, options, solve::uniform_mesh(kIntervals));
    const bool root = core::rank_of(MPI_COMM_WORLD) == 0;
    if (!u) u = find_cycle(s, p, options.degree);
    if (!u) return 1;
    if (root) fmt::print("\n{}", name);
    const Iteration i = measure(p, u.get(), structured ? runs : std::max(runs / 8, 2));
    rows(i);
    if (structured) {
      reference = i;
      if (root) fmt::print("of these:\n");
      if (!shafts) parts(s, p, u.get(), runs);
      if (root) fmt::print("iteration {:.6f} s\n", i.whole.wall);
    } else if (root) {
      fmt::print("ratio to low-rank intervals {:.2f}\n", i.whole.wall / reference.whole.wall);
    }
  }
  if (alone) return 0;
  std::vector<int> bearings;
  for (const auto& support : t.supports) bearings.push_back(support.node);
  using enum rotor::Reduction::Type;
  const bool done =
      against("Craig-Bampton: bearings and 16 modes a plane", {craig_bampton, bearings, 16}, reference, runs) &&
      against("the whole shaft", {none, {}, 0}, reference, runs);
  return done ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const whirl::core::Session session(argc, argv);
  int runs = 40;
  bool alone = false, shafts = false;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--quick") == 0) runs = 3;
    if (std::strcmp(argv[k], "--alone") == 0) alone = true;
    if (std::strcmp(argv[k], "--shafts") == 0) shafts = true;
  }
  return run(runs, alone, shafts);
}
