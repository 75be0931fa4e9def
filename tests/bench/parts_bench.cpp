// The linear equations of a machine on a compliant film of finite length, with the film solved by its own
// preconditioner or by MUMPS: of a stage of a Runge-Kutta step and of an equilibrium. Processor time, least of several.
//
//     bench_parts                30 x 6 to 480 x 96 cells
#include <fmt/core.h>

#include <cmath>

#include "bench/timing.hpp"
#include "solve/newton/port_krylov.hpp"
#include "support/finite_rotor.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/session.hpp"

using namespace whirl;
using core::check;

namespace {

constexpr double speed = 2 * test::finite_speed_scale;

struct Cost {
  int iterations = 0;
  double prepare = 0, solve = 0;  // ms
};

// alpha dF/dx + sigma dF/d(dx/dt) of the machine at rest.
Cost cost(system::RotorSystem& s, Vec x, double alpha, double sigma, bool own) {
  core::Vector rest = core::duplicate(x), scale = core::duplicate(x), rows = core::duplicate(x), b = core::duplicate(x),
               y = core::duplicate(x);
  check(VecSet(rest.get(), 0));
  s.scales(scale.get(), rows.get());
  check(VecReciprocal(rows.get()));
  core::Matrix a = s.make_jacobian();
  s.jacobian(0, x, rest.get(), alpha, sigma, a.get());
  check(MatDiagonalScale(a.get(), rows.get(), scale.get()));
  solve::PortMatrix blocks(std::make_shared<const solve::PortLayout>(a.get(), s.fields()));
  blocks.take(a.get());
  {
    const core::WriteArray values(b.get());
    for (PetscInt i = 0; i < values.size(); ++i)
      values[i] = std::sin(0.7 * static_cast<double>(i) * static_cast<double>(i));
  }
  solve::PortElimination elimination(s.fields(), own ? s.make_part_inverse() : nullptr);
  solve::PortKrylov krylov(*blocks.layout(), "stage_");
  Cost out;
  out.prepare = 1e3 * bench::least(PETSC_COMM_SELF, 3, [&] {
                        if (own) elimination.inverse()->set({0, x, rest.get()}, alpha, sigma);
                        elimination.factorise(blocks);
                      }).processor;
  try {
    out.solve = 1e3 * bench::least(PETSC_COMM_SELF, 3, [&] {
                        out.iterations = krylov.solve(blocks, elimination, b.get(), y.get(), 1e-9);
                      }).processor;
  } catch (const core::DomainError&) {
    out.iterations = -1;
  }
  return out;
}

void rows(const char* name, double alpha, double sigma) {
  fmt::print("{}\n{:>10} {:>8} {:>12} {:>14} {:>10} {:>14} {:>10}\n", name, "cells", "states", "iterations",
             "prepare, ms", "solve, ms", "MUMPS", "solve");
  for (const int m : {1, 2, 4, 8, 16}) {
    system::RotorSystem s(PETSC_COMM_SELF, test::finite_rotor(30 * m, 6 * m), speed);
    core::Vector x = system::static_guess(s);
    const Cost own = cost(s, x.get(), alpha, sigma, true), direct = cost(s, x.get(), alpha, sigma, false);
    fmt::print("{:>4} x {:<3} {:>8} {:>12} {:>14.3f} {:>10.3f} {:>14.3f} {:>10.3f}\n", 30 * m, 6 * m, s.own_states(),
               own.iterations, own.prepare, own.solve, direct.prepare, direct.solve);
  }
}

}  // namespace

int main(int argc, char** argv) {
  core::Session session(argc, argv);
  // SDIRK of order 4, 24 steps a turn.
  rows("stage of a step", 6.28318 / speed / 24 / 4, 1);
  rows("equilibrium", 1, 0);
  return 0;
}
