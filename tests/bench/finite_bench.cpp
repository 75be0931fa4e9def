// Newton-Picard on the film of finite length: processor time of a point of a branch (Newton from the neighbouring
// cycle, multipliers) over the number of film states, and what a second rank gains. Each mesh starts from the cycle of
// the one before, resampled.
//
//     bench_finite                    points on 50 x 10 to 200 x 40 cells, one rank; --all: to 400 x 80 (minutes)
//     mpirun -n 2 bench_finite        400 x 80: the parts of a Newton iteration by one rank and by all, in the same run
#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <optional>

#include "bench/timing.hpp"
#include "support/finite_rotor.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/shooting/newton_picard.hpp"

using namespace whirl;
using core::check;

namespace {

constexpr double speed = 2 * test::finite_speed_scale, step = 4;
constexpr int steps = 24;

// One mesh: system, solver, and the cycle on it.
struct Mesh {
  Mesh(MPI_Comm comm, int refinement)
      : system(comm, test::finite_rotor(50 * refinement, 10 * refinement), speed),
        problem(system, options(), solve::sdirk(4), steps, {0, 1}) {}
  static solve::NewtonPicardOptions options() {
    solve::NewtonPicardOptions o;
    o.parameter_scale = test::finite_speed_scale;
    o.constant_rates = true;
    return o;
  }
  // Corrects `guess` at `at` [rad/s]; the multipliers come with it.
  solve::Cycle solve(const solve::Cycle& guess, double at) {
    core::Vector u = problem.scatter(guess), row = core::duplicate(u.get());
    solve::parameter_row(problem, row.get());
    const auto result = solve::newton(problem, u.get(), row.get(), at / test::finite_speed_scale, {.tolerance = 1e-9});
    core::require(result.converged, "the cycle does not converge");
    problem.linearise(u.get(), row.get());
    (void)problem.multipliers();
    return problem.gather(u.get());
  }
  solve::Cycle from(const Mesh& other, solve::Cycle cycle) const {
    const Eigen::VectorXd x = cycle.x.col(0);
    const std::vector<double> here = system.resampled(other.system, x.data());
    cycle.x = Eigen::Map<const Eigen::VectorXd>(here.data(), system.size());
    return cycle;
  }
  system::RotorSystem system;
  solve::NewtonPicardProblem problem;
};

void points(bool all) {
  fmt::print("{:>10} {:>8} {:>12} {:>14} {:>10}\n", "cells", "states", "point, s", "us per state", "products");
  std::optional<solve::Cycle> cycle;
  std::unique_ptr<Mesh> coarse;
  for (const int refinement : {1, 2, 4, 8}) {
    if (refinement == 8 && !all) break;
    auto mesh = std::make_unique<Mesh>(PETSC_COMM_SELF, refinement);
    cycle = mesh->solve(coarse ? mesh->from(*coarse, *cycle) : test::finite_rotor_at_rest(mesh->system, speed), speed);
    const long before = mesh->problem.products();
    const double seconds = bench::least(PETSC_COMM_SELF, refinement < 4 ? 3 : 1, [&] {
                             (void)mesh->solve(*cycle, speed + step);
                           }).processor;
    const auto states = static_cast<double>(mesh->system.own_states());
    fmt::print("{:>4} x {:<3} {:>8.0f} {:>12.3f} {:>14.1f} {:>10}\n", 50 * refinement, 10 * refinement, states, seconds,
               1e6 * seconds / states, (mesh->problem.products() - before) / (refinement < 4 ? 3 : 1));
    coarse = std::move(mesh);
  }
}

struct Parts {
  double residual, linearise;
};

// What a Newton iteration consists of, on 400 x 80 cells, at a cycle from a coarser mesh. Wall time.
Parts iteration(MPI_Comm comm, const Mesh& coarse, const solve::Cycle& cycle) {
  Mesh mesh(comm, 8);
  core::Vector u = mesh.problem.scatter(mesh.from(coarse, cycle)), r = core::duplicate(u.get());
  solve::parameter_row(mesh.problem, r.get());
  const double linearise = bench::least(comm, 1, [&] { mesh.problem.linearise(u.get(), r.get()); }).wall;
  return {bench::least(comm, 2, [&] { mesh.problem.residual(u.get(), r.get()); }).wall, linearise};
}

void ranks() {
  const bool first = core::rank_of(MPI_COMM_WORLD) == 0;
  Mesh coarse(PETSC_COMM_SELF, 2);
  const solve::Cycle cycle = coarse.solve(test::finite_rotor_at_rest(coarse.system, speed), speed);
  Parts alone{};
  if (first) alone = iteration(PETSC_COMM_SELF, coarse, cycle);
  MPI_Barrier(MPI_COMM_WORLD);
  const Parts all = iteration(MPI_COMM_WORLD, coarse, cycle);
  if (!first) return;
  const auto print = [&](const char* name, double one, double together) {
    fmt::print("400 x 80 cells, {:<34} {:>7.2f} s on 1 rank, {:>7.2f} s on {}: {:.2f} times faster\n", name, one,
               together, core::size_of(MPI_COMM_WORLD), one / together);
  };
  print("residual (a turn of the film)", alone.residual, all.residual);
  print("linearisation with its products", alone.linearise, all.linearise);
}

}  // namespace

int main(int argc, char** argv) {
  core::Session session(argc, argv);
  const bool all = argc > 1 && std::strcmp(argv[1], "--all") == 0;
  if (core::size_of(MPI_COMM_WORLD) == 1)
    points(all);
  else
    ranks();
  return 0;
}
