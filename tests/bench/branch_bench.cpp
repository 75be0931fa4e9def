// Processor time per point of branches of synchronous cycles, multipliers included: a rigid rotor in short bearings
// (period 1 with its flips) and in compliant short bearings of growing film meshes; 40 Gauss intervals of degree 4.
// bench_branch [--quick] [--alone]: least of several runs; --alone leaves out the comparison with dense intervals.
#include <fmt/core.h>

#include <cmath>
#include <cstring>

#include "bench/timing.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/continuation.hpp"
#include "whirl/solve/cycle_problem.hpp"
#include "whirl/solve/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"
#include "whirl/system/start.hpp"

using namespace whirl;

namespace {

constexpr double kOmega0 = 160;  // rad/s, sqrt(load/(mass clearance)) of the machine of van de Vrande (2001), sec. 5.3
constexpr double kClearance = 25e-6;

// Half a rotor of 1 kg on each bearing, F0* = 1, a* = 0.2; `cells` 0: rigid liners.
system::Train train(int cells) {
  system::Train t;
  t.gravity = 0;
  t.rotor.type = rotor::Options::Type::rigid;
  system::Support s;
  s.node = 1;
  s.geometry = {film::Geometry::Bore::cylindrical, 0.005, 0.01, kClearance, 0, 0, 0};
  s.lubricant = {0.001, 1000};
  const int bearings = cells > 0 ? 1 : 2;
  t.rotor.mass = 0.5 * bearings;
  t.rotor.load = 0.32 * bearings;
  if (cells > 0) {
    s.film.kind = film::Options::Kind::compliant_short;
    s.film.compliance = 0.1;
    s.film.reference_speed = kOmega0;
    s.film.cells = {cells, 4};
  } else {
    s.film.kind = film::Options::Kind::short_bearing;
  }
  for (int k = 0; k < bearings; ++k) t.supports.push_back(s);
  t.unbalance = {{1, 0.2 * kClearance * t.rotor.mass, 0}};
  return t;
}

struct Branch {
  int points = 0, iterations = 0, unstable = 0;
  double last = 0;  // modulus of the leading multiplier at the end
};

// Follows the branch from `from` to `to` (in Omega_0) with steps of at most 0.2.
using Joining = solve::CycleOptions::Joining;

Branch follow(MPI_Comm comm, int cells, bool structure, Joining joining, double from, double to, int max_points) {
  system::RotorSystem s(PETSC_COMM_SELF, train(cells), from * kOmega0);
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  core::require(solve::find_equilibrium(s, x.get(), newton).converged, "no equilibrium to start from");
  s.set_forcing(true);
  const auto rest = s.gather(x.get());
  solve::CycleOptions options;
  options.degree = 4;
  options.points = solve::Points::gauss;
  options.use_structure = structure;
  options.joining = joining;
  options.state_weight = std::pow(32 / 0.5, 2);
  solve::CycleProblem p(comm, s, options, solve::uniform_mesh(40));
  solve::Cycle guess{p.mesh(), {}, 2 * M_PI / s.speed(), s.speed()};
  guess.x = Eigen::Map<const Eigen::VectorXd>(rest.data(), s.size()).replicate(1, 160);
  solve::ContinuationOptions c;
  c.from = from * kOmega0;
  c.to = to * kOmega0;
  c.initial_step = 8;
  c.min_step = 1e-3;
  c.max_step = 32;
  c.max_points = max_points;
  c.adapt_every = 0;
  solve::BranchCallbacks callbacks;
  callbacks.cycles = true;
  callbacks.stability = [&](Vec) {
    return solve::make_stability(p.multipliers(), [](auto mu) { return std::abs(mu) - 1; });
  };
  Branch b;
  callbacks.on_point = [&](const solve::BranchPoint& point, Vec) {
    b.iterations += point.newton_iterations;
    b.unstable += point.stability.unstable() > 0;
    b.last = std::abs(point.stability.values.front());
  };
  const auto end = solve::follow_branch(p, p.scatter(guess), c, callbacks);
  b.points = end.points;
  return b;
}

bench::Timing measure(const char* name, int cells, bool structure, Joining joining, double from, double to,
                      int max_points, int runs) {
  Branch b;
  const auto t = bench::least(MPI_COMM_WORLD, runs,
                              [&] { b = follow(MPI_COMM_WORLD, cells, structure, joining, from, to, max_points); });
  if (core::rank_of(MPI_COMM_WORLD) == 0)
    fmt::print("{:<34} {:6d} {:7d} {:10.2f} {:10d} {:12.8f} {:10.3f} {:10.3f}\n", name, b.points, cells + 4,
               static_cast<double>(b.iterations) / b.points, b.unstable, b.last, 1e3 * t.wall / b.points,
               1e3 * t.processor / b.points);
  return t;
}

}  // namespace

int main(int argc, char** argv) {
  const core::Session session(argc, argv);
  int runs = 8;
  bool alone = false;
  int only = -1;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--quick") == 0) runs = 1;
    if (std::strcmp(argv[k], "--alone") == 0) alone = true;
    if (std::strncmp(argv[k], "--cells=", 8) == 0) only = std::atoi(argv[k] + 8);
  }
  if (core::rank_of(MPI_COMM_WORLD) == 0)
    fmt::print("{:<34} {:>6} {:>7} {:>10} {:>10} {:>12} {:>10} {:>10}\n", "milliseconds per point", "points", "states",
               "iterations", "unstable", "last |mu|", "wall", "processor");
  for (const int cells : {0, 52, 202, 802, 2402, 4996}) {
    if (only >= 0 && cells != only) continue;
    const int points = cells > 1000 ? 4 : 400, few = cells > 500 ? 1 : runs;
    const double from = cells == 0 ? 2 : 3, to = cells == 0 ? 20 : cells > 500 ? 4 : 6.5;
    const auto row = [&](const char* name, bool structure, Joining joining, int times) {
      measure(name, cells, structure, joining, from, to, points, times);
    };
    row(cells == 0 ? "short bearings" : "compliant bearings", true, Joining::cheapest, few);
    if (alone) continue;
    if (cells > 0 && cells < 500) row("  joined by one dense matrix", true, Joining::dense, few);
    if (cells > 0 && cells < 500) row("  joined by sweeps", true, Joining::sweeps, few);
    if (cells < 100) row("  dense intervals", false, Joining::dense, 1);
  }
  return 0;
}
