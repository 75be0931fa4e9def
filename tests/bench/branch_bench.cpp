// Time per point of branches of synchronous cycles, multipliers included: a rigid rotor in short bearings (period 1
// with its flips) and in compliant short bearings of growing film meshes; 40 intervals of degree 4. bench_branch
// [--quick] [--alone] [--cells=N]: least of several runs; --alone leaves out the comparison with dense intervals,
// --cells=N does one mesh only (0: the short bearings).
//
// The last table follows the same points from 56 to 5000 states, with the power of the number of states by which the
// time grows from row to row. The first point, found from rest, does not count there. It takes Radau points: Gauss
// points hardly damp modes of the film that are stiff for the time step, which then show as a dense band of
// multipliers.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "bench/timing.hpp"
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

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
    film::CompliantShort film;
    film.compliance = 0.1;
    film.reference_speed = kOmega0;
    film.cells = {cells, 4};
    s.film = film;
  } else {
    s.film = film::Short{};
  }
  for (int k = 0; k < bearings; ++k) t.supports.push_back(s);
  t.unbalance = {{1, 0.2 * kClearance * t.rotor.mass, 0}};
  return t;
}

struct Branch {
  int points = 0, iterations = 0, unstable = 0;
  double last = 0;         // modulus of the leading multiplier at the end
  double after_start = 0;  // processor time from the first point to the end [s]
};

// Follows the branch from `from` to `to` (in Omega_0) with steps of at most 0.2.
using Joining = solve::CycleOptions::Joining;

Branch follow(MPI_Comm comm, int cells, bool structure, Joining joining, solve::Points points, double from, double to,
              int max_points) {
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
  options.points = points;
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
    if (point.index == 0) b.after_start = -bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  };
  const auto end = solve::follow_branch(p, p.scatter(guess), c, callbacks);
  b.points = end.points;
  b.after_start += bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  return b;
}

void head(const char* title, const char* before, const char* last) {
  if (core::rank_of(MPI_COMM_WORLD) == 0)
    fmt::print("{:<30} {:>6} {:>7} {:>10} {:>9} {:>12} {:>10} {:>10}\n", title, "points", "states", "iterations",
               "unstable", "last |mu|", before, last);
}

struct Row {
  const char* name;
  int cells;
  bool structure = true;
  Joining joining = Joining::cheapest;
};

void measure(const Row& row, int runs) {
  Branch b;
  const double from = row.cells == 0 ? 2 : 3, to = row.cells == 0 ? 20 : 6.5;
  const auto t = bench::least(MPI_COMM_WORLD, runs, [&] {
    b = follow(MPI_COMM_WORLD, row.cells, row.structure, row.joining, solve::Points::gauss, from, to, 400);
  });
  if (core::rank_of(MPI_COMM_WORLD) == 0)
    fmt::print("{:<30} {:6d} {:7d} {:10.2f} {:9d} {:12.8f} {:10.3f} {:10.3f}\n", row.name, b.points, row.cells + 4,
               static_cast<double>(b.iterations) / b.points, b.unstable, b.last, 1e3 * t.wall / b.points,
               1e3 * t.processor / b.points);
}

void growth(const std::vector<int>& meshes, int runs) {
  double before = 0;
  int states_before = 0;
  for (const int cells : meshes) {
    Branch b;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < (cells > 500 ? 1 : runs); ++k) {
      b = follow(MPI_COMM_WORLD, cells, true, Joining::cheapest, solve::Points::radau, 3, 4, 400);
      least = std::min(least, b.after_start);
    }
    const int states = cells + 4;
    const double each = 1e3 * least / (b.points - 1);
    if (core::rank_of(MPI_COMM_WORLD) == 0)
      fmt::print(
          "{:<30} {:6d} {:7d} {:10.2f} {:9d} {:12.8f} {:10.3f} {:>10}\n", "compliant, Radau points", b.points, states,
          static_cast<double>(b.iterations) / b.points, b.unstable, b.last, each,
          before > 0 ? fmt::format("n^{:.2f}", std::log(each / before) / std::log(1.0 * states / states_before)) : "");
    before = each;
    states_before = states;
  }
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
  head("milliseconds per point", "wall", "processor");
  for (const int cells : {0, 52, 202}) {
    if (only >= 0 && cells != only) continue;
    measure({cells == 0 ? "short bearings" : "compliant bearings", cells}, runs);
    if (alone) continue;
    if (cells > 0) measure({"  joined by one dense matrix", cells, true, Joining::dense}, runs);
    if (cells > 0) measure({"  joined by sweeps", cells, true, Joining::sweeps}, runs);
    if (cells < 100) measure({"  dense intervals", cells, false, Joining::dense}, 1);
  }
  if (only == 0) return 0;
  head("ms per point after the first", "processor", "growth");
  growth(only > 0 ? std::vector<int>{only} : std::vector<int>{52, 202, 802, 2402, 4996}, runs);
  return 0;
}
