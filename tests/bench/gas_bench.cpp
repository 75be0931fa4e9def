// An aerostatic bearing of eight orifices: cold starts and coefficients of a film by itself, and the equilibrium of a
// rotor on a large one on one rank and on all. Wall time, least of several.
//
//     bench_gas [AROUND ALONG]                   192 x 64 cells and this large mesh, 1536 x 512 unless said otherwise
//     mpirun -n 2 bench_gas [AROUND ALONG]
#include <fmt/core.h>

#include <cmath>
#include <cstdlib>

#include "bench/timing.hpp"
#include "film/gas_cases.hpp"
#include "solve/newton/port_krylov.hpp"
#include "support/half_rotor.hpp"
#include "system/start.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/session.hpp"
#include "whirl/film/use/coefficients.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/newton.hpp"

using namespace whirl;
using core::check;

namespace {

using Mesh = std::array<int, 2>;
constexpr double supply = 0.6e6, speed = 2000;

// Newton's method on the film alone, journal held, from the film between parallel plates; then 32 coefficients.
void film_alone(Mesh cells) {
  film::Gas options = film::testing::aerostatic(1, supply, cells);
  options.tilt = true;
  film::testing::SolvedGas s;
  const double cold = bench::least(PETSC_COMM_SELF, 3, [&] {
                        s = film::testing::solved(film::testing::spindle(), options, {0.036, -0.305}, speed);
                      }).wall;
  film::PortCoefficients k;
  const double coefficients =
      bench::least(PETSC_COMM_SELF, 3, [&] { k = port_coefficients(*s.film, s.motion, s.states, speed); }).wall;
  const double step = cold / static_cast<double>(s.factorisations);
  fmt::print("film alone, {} x {} cells: load {:.4f} N\n", cells[0], cells[1], film::testing::load_of(s));
  fmt::print("  cold start: {} factorisations, {:.1f} ms, {:.1f} ms each\n", s.factorisations, 1e3 * cold, 1e3 * step);
  fmt::print("  {} coefficients at one frequency: {:.1f} ms, {:.2f} Newton steps; kxx {:.4g} N/m\n",
             2 * k.ports * k.ports, 1e3 * coefficients, coefficients / step, k.stiffness[0][0]);
  constexpr int frequencies = 16;
  const double many = bench::least(PETSC_COMM_SELF, 3, [&] {
                        film::FrequencyCoefficients at(*s.film, s.motion, s.states);
                        for (int i = 1; i <= frequencies; ++i) k = at.at(speed * 4 * i / frequencies);
                      }).wall;
  fmt::print("  at {} frequencies up to four times the speed: {:.1f} ms, {:.2f} Newton steps\n", frequencies,
             1e3 * many, many / step);
  const double by_factors = bench::least(PETSC_COMM_SELF, 3, [&] {
                              const film::FrequencyCoefficients at(*s.film, s.motion, s.states);
                              (void)at.by_factors(speed);
                            }).wall;
  fmt::print("  by a complex factorisation: {:.1f} ms, {:.2f} Newton steps a frequency\n", 1e3 * by_factors,
             by_factors / step);
}

struct Cost {
  int steps = 0, krylov = 0;
  double seconds = 0;
};

system::Train machine_on(Mesh cells) {
  system::Train train = test::half_rotor(film::testing::aerostatic(1, supply, cells), 0);
  train.rotor.mass = 5;
  train.rotor.load = 5 * 9.81;
  train.supports[0].geometry = film::testing::spindle();
  train.supports[0].lubricant = film::testing::air();
  return train;
}

// A rotor of 5 kg on the film, from the solution with a mesh of 96 x 32 cells. Krylov iterations are those of the last
// Newton step.
Cost machine(MPI_Comm comm, Mesh cells, int runs) {
  system::RotorSystem small(PETSC_COMM_SELF, machine_on({96, 32}), speed), s(comm, machine_on(cells), speed);
  small.set_forcing(false);
  s.set_forcing(false);
  core::Vector at_first = system::static_guess(small);
  solve::NewtonOptions whole_steps;
  whole_steps.searches = false;
  core::require(solve::find_equilibrium(small, at_first.get(), whole_steps).converged, "no equilibrium");
  const std::vector<double> known = small.gather(at_first.get());
  Cost out;
  core::Vector x = core::make_vector(comm, s.local_size(), PETSC_DETERMINE);
  out.seconds = bench::least(comm, runs, [&] {
                  s.resample(small, known.data(), x.get());
                  solve::NewtonOptions options;
                  options.searches = false;
                  const solve::NewtonResult found = solve::find_equilibrium(s, x.get(), options);
                  if (!found.converged) throw core::NotConverged(found.reason);
                  out.steps = found.iterations;
                }).wall;
  core::Vector rest = core::duplicate(x.get()), b = core::duplicate(x.get()), y = core::duplicate(x.get());
  core::Vector scale = core::duplicate(x.get()), rows = core::duplicate(x.get());
  check(VecSet(rest.get(), 0));
  s.scales(scale.get(), rows.get());
  check(VecReciprocal(rows.get()));
  check(VecSet(b.get(), 1));
  core::Matrix a = s.make_jacobian();
  s.jacobian(0, x.get(), rest.get(), 1, 0, a.get());
  check(MatDiagonalScale(a.get(), rows.get(), scale.get()));
  solve::PortMatrix blocks(std::make_shared<const solve::PortLayout>(a.get(), s.fields()));
  blocks.take(a.get());
  solve::PortElimination elimination(s.fields(), s.make_part_inverse());
  solve::PortKrylov krylov(*blocks.layout(), "equilibrium_");
  elimination.inverse()->set({0, x.get(), rest.get()}, 1, 0);
  elimination.factorise(blocks);
  out.krylov = krylov.solve(blocks, elimination, b.get(), y.get(), 1e-10);
  return out;
}

void report(const char* name, Mesh cells, const Cost& c) {
  fmt::print("rotor on {} x {} cells, {}: {} Newton steps, {} Krylov iterations a step, {:.2f} s\n", cells[0], cells[1],
             name, c.steps, c.krylov, c.seconds);
}

}  // namespace

int main(int argc, char** argv) {
  core::Session session(argc, argv);
  const MPI_Comm all = PETSC_COMM_WORLD;
  const bool first = core::rank_of(all) == 0;
  const Mesh modest = {192, 64};
  Mesh large = {1536, 512};
  if (argc > 2) large = {std::atoi(argv[1]), std::atoi(argv[2])};
  Cost one, small;
  if (first) {
    film_alone(modest);
    small = machine(PETSC_COMM_SELF, modest, 3);
    report("1 rank", modest, small);
    one = machine(PETSC_COMM_SELF, large, 2);
    report("1 rank", large, one);
  }
  MPI_Barrier(all);
  if (core::size_of(all) == 1) return 0;
  const Cost shared = machine(all, large, 2);
  if (!first) return 0;
  report("all ranks", large, shared);
  fmt::print("{} ranks are {:.2f} times as fast as one; Krylov iterations {:.2f} times those of {} x {} cells\n",
             core::size_of(all), one.seconds / shared.seconds,
             static_cast<double>(shared.krylov) / static_cast<double>(small.krylov), modest[0], modest[1]);
  return 0;
}
