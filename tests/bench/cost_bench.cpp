// ways where one has to be chosen, about the size at which they cost the same. Processor time, least of several.
//
//     bench_cost                 all
//     mpirun -n 2 bench_cost     messages, which want two ranks
#include <fmt/core.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "bench/timing.hpp"
#include "support/half_rotor.hpp"
#include "support/uniform_shaft.hpp"
#include "system/start.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/session.hpp"
#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Joining = solve::CycleOptions::Joining;

namespace {

constexpr double clearance = 25e-6, speed = 480;

double seconds(int runs, const std::function<void()>& work) {
  return bench::least(PETSC_COMM_SELF, runs, work).processor;
}

// Half a rigid rotor in a compliant short bearing: as many states as cells and four.
system::Train rigid(int cells) {
  film::CompliantShort film;
  film.compliance = 0.1;
  film.reference_speed = 160;
  film.cells = {cells, 4};
  return test::half_rotor(film, 0.2 * clearance);
}

core::Vector at_rest(system::RotorSystem& s) {
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  core::require(solve::find_equilibrium(s, x.get(), newton).converged, "no equilibrium");
  s.set_forcing(true);
  return x;
}

// A point of a branch of cycles [ms]: three iterations of Newton's method with the tangent, and the multipliers.
double point(const system::Train& train, solve::CycleOptions options, Joining joining, int intervals) {
  options.joining = joining;
  system::RotorSystem s(PETSC_COMM_SELF, train, speed);
  const core::Vector x = at_rest(s);
  solve::CycleProblem p(PETSC_COMM_SELF, s, options, solve::uniform_mesh(intervals));
  const auto rest = s.gather(x.get());
  solve::Cycle guess{p.mesh(), {}, 2 * M_PI / speed, speed};
  guess.x = Eigen::Map<const VectorXd>(rest.data(), s.size()).replicate(1, intervals * options.degree);
  core::Vector u = p.scatter(guess), fix = core::duplicate(u.get()), r = core::duplicate(u.get()),
               d = core::duplicate(u.get());
  solve::parameter_row(p, fix.get());
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  core::require(solve::newton(p, u.get(), fix.get(), speed, newton).converged, "no cycle");
  p.linearise(u.get(), fix.get());
  (void)p.multipliers();  // from here on the last point's subspace is known
  return 1e3 * seconds(5, [&] {
           for (int k = 0; k < 3; ++k) {
             p.residual(u.get(), r.get());
             solve::set_last_entry(PETSC_COMM_SELF, r.get(), 0);
             p.linearise(u.get(), fix.get());
             (void)solve::solve_linear(p, r.get(), d.get(), "bench_");
           }
           (void)p.multipliers();
         });
}

// A Jacobian of a step in time with its factors and a solve [ms].
std::pair<double, double> step(const system::Train& train) {
  system::RotorSystem s(PETSC_COMM_SELF, train, speed);
  const core::Vector x = at_rest(s), rest = core::duplicate(x.get());
  check(VecSet(rest.get(), 0));
  const auto n = static_cast<Index>(s.size());
  core::Matrix a = s.make_jacobian();
  const core::Vector b = core::duplicate(x.get()), y = core::duplicate(x.get());
  check(VecSet(b.get(), 1));
  const core::LinearSolver solver = core::make_direct_solver(PETSC_COMM_SELF, "bench_");
  const double sparse = seconds(5, [&] {
    for (int k = 0; k < 10; ++k) {
      s.jacobian(0, x.get(), rest.get(), 1, 1e4, a.get());
      check(KSPSetOperators(solver.get(), a.get(), a.get()));
      check(KSPSolve(solver.get(), b.get(), y.get()));
    }
  });
  problem::ScaledPoint p(s, s.structure());
  p.refresh();
  MatrixXd jx, jxdot;
  core::Matrix m;
  check(MatCreateSeqDense(PETSC_COMM_SELF, s.size(), s.size(), nullptr, m.put()));
  core::LinearSolver lu;
  check(KSPCreate(PETSC_COMM_SELF, lu.put()));
  check(KSPSetType(lu.get(), KSPPREONLY));
  PC pc = nullptr;
  check(KSPGetPC(lu.get(), &pc));
  check(PCSetType(pc, PCLU));
  const VectorXd at = VectorXd::Zero(n);
  VectorXd scaled(n);
  {
    const core::ReadArray values(x.get());
    for (Index i = 0; i < n; ++i) scaled(i) = values[static_cast<PetscInt>(i)] / p.state_scale()(i);
  }
  const double dense = seconds(5, [&] {
    for (int k = 0; k < 10; ++k) {
      p.linearise(0, scaled, at, jx, jxdot, nullptr);
      PetscScalar* out = nullptr;
      check(MatDenseGetArrayWrite(m.get(), &out));
      Eigen::Map<MatrixXd>(out, n, n) = jx + 1e4 * jxdot;
      check(MatDenseRestoreArrayWrite(m.get(), &out));
      check(MatAssemblyBegin(m.get(), MAT_FINAL_ASSEMBLY));
      check(MatAssemblyEnd(m.get(), MAT_FINAL_ASSEMBLY));
      check(KSPSetOperators(lu.get(), m.get(), m.get()));
      check(KSPSolve(lu.get(), b.get(), y.get()));
    }
  });
  return {100 * dense, 100 * sparse};
}

void constants() {
  constexpr Index n = 104, many = 60;
  std::vector<MatrixXd> a(many, MatrixXd::Random(n, n) / n);
  MatrixXd product = MatrixXd::Identity(n, n), next = product;
  const double unit = seconds(20,
                              [&] {
                                for (const MatrixXd& m : a) {
                                  next.noalias() = m * product;
                                  product.swap(next);
                                }
                              }) /
                      (many * n * n * n);
  VectorXd v = VectorXd::Ones(n), w = v;
  const double one = seconds(20,
                             [&] {
                               for (const MatrixXd& m : a) {
                                 w.noalias() = m * v;
                                 v.swap(w);
                               }
                             }) /
                     (many * n * n);
  fmt::print("one multiply-add of products of matrices {:.3f} ns; of a matrix that is read for one vector: {:.1f}\n",
             1e9 * unit, one / unit);
  for (const Index size : {30, 54, 104, 208}) {
    const MatrixXd m = MatrixXd::Random(size, size);
    const double t = seconds(5, [&] { (void)spectral::eigenvalues(m); });
    fmt::print("eigenvalues of {0} x {0}: {1:.0f} n^3\n", size, t / unit / std::pow(size, 3));
  }
}

void messages() {
  std::vector<double> mine(80), others(80);
  const int other = 1 - core::rank_of(MPI_COMM_WORLD);
  const auto t = bench::least(MPI_COMM_WORLD, 20, [&] {
    for (int k = 0; k < 1000; ++k)
      MPI_Sendrecv(mine.data(), 80, MPI_DOUBLE, other, 0, others.data(), 80, MPI_DOUBLE, other, 0, MPI_COMM_WORLD,
                   MPI_STATUS_IGNORE);
  });
  if (other == 1) fmt::print("exchange of 80 numbers {:.2f} us\n", 1e3 * t.wall);
}

}  // namespace

int main(int argc, char** argv) {
  const core::Session session(argc, argv);
  if (core::size_of(MPI_COMM_WORLD) == 2) {
    messages();
    return 0;
  }
  constants();
  fmt::print("\ncycles in films with states, ms a point{:>22} {:>8} {:>8}\n", "states", "dense", "sweeps");
  for (const auto& [degree, intervals] : {std::pair{4, 40}, {2, 60}})
    for (const int cells : {12, 20, 28, 36, 44, 52, 76}) {
      solve::CycleOptions o;
      o.degree = degree;
      const double dense = point(rigid(cells), o, Joining::dense, intervals),
                   sweeps = point(rigid(cells), o, Joining::sweeps, intervals);
      fmt::print("{:>39} {:>21} {:8.2f} {:8.2f}\n", fmt::format("degree {}, {} intervals", degree, intervals),
                 cells + 4, dense, sweeps);
    }
  fmt::print("\ncycles of whole shafts, ms a point{:>27} {:>8} {:>8}\n", "states", "dense", "modes");
  for (const int segments : {8, 14, 20, 26, 32, 44}) {
    const double dense = point(test::uniform_shaft(segments), {}, Joining::one_by_one, 60),
                 modes = point(test::uniform_shaft(segments), {}, Joining::modes, 60);
    fmt::print("{:>61} {:8.2f} {:8.2f}\n", 8 * (segments + 1), dense, modes);
  }
  fmt::print("\nsteps in time, ms{:>44} {:>8} {:>8}\n", "states", "dense", "MUMPS");
  for (const int segments : {4, 8, 12, 16, 20, 26, 32}) {
    const auto [dense, sparse] = step(test::uniform_shaft(segments));
    fmt::print("{:>61} {:8.3f} {:8.3f}\n", 8 * (segments + 1), dense, sparse);
  }
  return 0;
}
