// The least stable eigenvalues of the reduced train in cylindrical bores with soft liners, over the mesh of the films:
// by their transfer functions against the whole pencil.
//
//     mpirun -n N bench_modes [CELLS_AROUND...]      cells along are a fifth
#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>

#include "bench/timing.hpp"
#include "solve/newton/transfer_modes.hpp"
#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

constexpr std::size_t wanted = 10;

// The least stable first, one of each pair.
std::vector<spectral::Complex> least_stable(const std::vector<spectral::Mode>& modes) {
  std::vector<spectral::Complex> out;
  for (const auto& m : modes) out.push_back(m.lambda);
  std::sort(out.begin(), out.end(), [](auto a, auto b) { return a.real() > b.real(); });
  out.resize(std::min(out.size(), wanted));
  return out;
}

// A mesh and the equilibrium on it, from which that on the next one is found.
struct Rest {
  std::unique_ptr<system::RotorSystem> system;
  std::vector<double> x;
};

void row(int around, Rest& last) {
  auto made =
      std::make_unique<system::RotorSystem>(PETSC_COMM_WORLD, test::train_on_liners({around, around / 5}, 0.3), 377);
  system::RotorSystem& s = *made;
  core::Vector x = s.guess();
  if (last.system) core::fill(x.get(), s.resampled(*last.system, last.x.data()));
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  const auto rest = solve::find_equilibrium(s, x.get(), newton);
  if (!rest.converged && core::rank_of(PETSC_COMM_WORLD) == 0) fmt::print("{} cells: {}\n", around, rest.reason);
  spectral::EigenOptions whole;
  whole.count = 60;
  whole.dense_below = 0;
  whole.shapes = false;
  std::vector<spectral::Mode> nearest;
  const bench::Timing by_pencil =
      bench::least(PETSC_COMM_WORLD, 1, [&] { nearest = spectral::modes(s, x.get(), whole); });
  solve::TransferOptions region;
  region.frequency = 377;
  region.decay = 100;
  region.shapes = false;
  solve::TransferModes found;
  const bench::Timing by_transfer =
      bench::least(PETSC_COMM_WORLD, 1, [&] { found = solve::transfer_modes(s, x.get(), region); });
  double apart = 0;
  for (const auto& lambda : least_stable(found.modes)) {
    double nearest_one = 1e300;
    for (const auto& m : nearest) nearest_one = std::min(nearest_one, std::abs(m.lambda - lambda));
    apart = std::max(apart, nearest_one / std::abs(lambda));
  }
  if (core::rank_of(PETSC_COMM_WORLD) == 0)
    fmt::print("{:4} x {:3} {:8} {:9.2f} {:9.2f} {:6.1f} {:6} {:6} {:6} {:6} {:9.1e}\n", around, around / 5, s.size(),
               by_pencil.processor, by_transfer.processor, by_transfer.processor / by_pencil.processor, found.counted,
               found.missed, found.poles, found.solves, apart);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  core::Session session(argc, argv);
  if (core::rank_of(PETSC_COMM_WORLD) == 0)
    fmt::print("{:>10} {:>8} {:>9} {:>9} {:>6} {:>6} {:>6} {:>6} {:>6} {:>9}\n", "cells", "states", "whole s",
               "transf. s", "ratio", "count", "missed", "poles", "solves", "apart");
  std::vector<int> meshes;
  for (int k = 1; k < argc && argv[k][0] != '-'; ++k) meshes.push_back(std::stoi(argv[k]));
  if (meshes.empty()) meshes = {30, 60, 120};
  Rest rest;
  for (const int around : meshes) row(around, rest);
}
