// The energy equation of an oil film over the mesh: Newton and Krylov iterations, time and memory.
// bench_energy [--order 1] [--eccentricity 0.9] [--recirculation 0.6] [cells ...], on any number of ranks; 10,000,000
// cells want 5 GB.
#include <fmt/format.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "support/heated_film.hpp"
#include "whirl/core/session.hpp"
#include "whirl/thermal/energy.hpp"

namespace {

using namespace whirl;

// MB, at its most, of all ranks.
double memory() {
  constexpr const char* what = "VmHWM:";
  double value = 0;
  char line[256];
  if (FILE* f = std::fopen("/proc/self/status", "r")) {
    while (std::fgets(line, sizeof line, f))
      if (std::string(line).rfind(what, 0) == 0) value = std::atof(line + std::string(what).size()) / 1024;
    std::fclose(f);
  }
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return value;
}

void row(double cells, double eccentricity, double recirculation, int order) {
  // Four nodes around to one along; more layers on finer meshes, as in 288 x 96 x 8.
  const int across = cells > 2e6 ? 24 : cells > 6e5 ? 16 : 8;
  const int along = static_cast<int>(std::sqrt(cells / across / 4));
  const auto film = test::heated_bearing(PETSC_COMM_WORLD, 4 * along, along, across, eccentricity, recirculation);
  const double n = 4.0 * along * (along + 1) * across;
  const double c = 2000, k = 0.13;
  thermal::Surroundings around{film->isothermal(k, 313.15), film->isothermal(k, 313.15), 313.15, {}, {}};
  thermal::Energy energy(film->rows, film->flow, {c, k, order}, film->thickness, around);
  core::Vector t = film->temperature(313.15);
  thermal::EnergySolve solved;
  const bench::Timing time = bench::least(PETSC_COMM_WORLD, 1, [&] { solved = energy.solve(t.get()); });
  const double most = memory();
  const thermal::EnergyBudget budget = energy.budget(t.get());
  double low = 0, high = 0, reversed[2] = {0, 0};
  core::check(VecMin(t.get(), nullptr, &low));
  core::check(VecMax(t.get(), nullptr, &high));
  for (const double m : film->flow.around) reversed[m < 0] += 1;
  MPI_Allreduce(MPI_IN_PLACE, reversed, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  core::Vector r = core::duplicate(t.get()), x = core::duplicate(t.get());
  energy.residual(t.get(), r.get());
  const bench::Timing lines = bench::least(PETSC_COMM_WORLD, 3, [&] { energy.precondition(r.get(), x.get()); });
  energy.linearise(t.get());
  const bench::Timing product =
      bench::least(PETSC_COMM_WORLD, 3, [&] { core::check(MatMult(energy.jacobian(), r.get(), x.get())); });
  if (core::rank_of(PETSC_COMM_WORLD) != 0) return;
  fmt::print(
      "{:9.0f} {:5.2f} {:5} {:7.1f} {:6} {:6} {:7.2f} {:7.1f} {:6.1f} {:6.1f} {:7.0f} {:6.0f} {:8.1e} {:7.2f} {}\n", n,
      eccentricity, order, 100 * reversed[1] / n, solved.newton, solved.krylov, time.processor,
      1e9 * time.processor / n / solved.krylov, 1e9 * lines.processor / n / energy.sweeps(),
      1e9 * product.processor / n, most, 1e6 * most / n, budget.residual() / budget.heat, high,
      solved.converged ? "" : "not converged");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  core::Session session(argc, argv);
  std::vector<double> meshes;
  std::vector<int> orders{1, 2};
  double recirculation = 0;
  std::vector<double> eccentricities{0.4, 0.8};
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--order" && k + 1 < argc)
      orders = {std::atoi(argv[++k])};
    else if (word == "--eccentricity" && k + 1 < argc)
      eccentricities = {std::atof(argv[++k])};
    else if (word == "--recirculation" && k + 1 < argc)
      recirculation = std::atof(argv[++k]);
    else
      meshes.push_back(std::stod(word));
  }
  if (meshes.empty()) meshes = {3e5, 1e6, 3e6};
  if (core::rank_of(PETSC_COMM_WORLD) == 0)
    fmt::print("{:>9} {:>5} {:>5} {:>7} {:>6} {:>6} {:>7} {:>7} {:>6} {:>6} {:>7} {:>6} {:>8} {:>7}\n", "cells", "ecc",
               "order", "rev. %", "newton", "krylov", "s", "ns/c/it", "sweep", "product", "MB", "B/c", "balance",
               "max K");
  for (const double cells : meshes)
    for (const double eccentricity : eccentricities)
      for (const int order : orders) row(cells, eccentricity, recirculation, order);
}
