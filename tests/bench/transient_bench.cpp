// One limit cycle by collocation against integration in time by PETSc TS until the transient has died out: the
// Guyan-reduced train (104 states), G2.5 at 3600 rpm, films of 60 x 16 cells, both from the static equilibrium.
// bench_transient [--quick] [-ts_type ... -ts_rtol ...]; --quick integrates 60 periods and extrapolates with the
// measured decay of the peak to peak.
#include <fmt/core.h>
#include <petscts.h>

#include <array>
#include <cmath>

#include "bench/timing.hpp"
#include "support/train_system.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/cycle_problem.hpp"
#include "whirl/solve/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"
#include "whirl/system/start.hpp"

using namespace whirl;

namespace {

constexpr double kSpeed = 120 * M_PI;  // 3600 rpm
constexpr double kPeriod = 2 * M_PI / kSpeed;
constexpr int kSamples = 360;
constexpr int kSignals = 10;  // x, y of five bearings

using Signals = std::array<double, kSignals>;

Signals signals(const system::RotorSystem& s, const double* x) {
  Signals out{};
  const auto journals = s.journals(x);
  for (std::size_t b = 0; b < 5; ++b)
    for (std::size_t d = 0; d < 2; ++d) out[2 * b + d] = journals[b].position[d];
  return out;
}

struct Range {
  Signals low, high;
  Range() {
    low.fill(1e9);
    high.fill(-1e9);
  }
  void add(const Signals& s) {
    for (std::size_t k = 0; k < kSignals; ++k) {
      low[k] = std::min(low[k], s[k]);
      high[k] = std::max(high[k], s[k]);
    }
  }
  [[nodiscard]] double peak_to_peak(std::size_t k) const { return high[k] - low[k]; }
};

double difference(const Range& a, const Range& b) {
  double largest = 0;
  for (std::size_t k = 0; k < kSignals; ++k)
    largest = std::max(largest, std::abs(a.peak_to_peak(k) / b.peak_to_peak(k) - 1));
  return largest;
}

core::Vector equilibrium(system::RotorSystem& s) {
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  s.set_forcing(false);
  core::require(solve::find_equilibrium(s, x.get(), newton).converged, "no equilibrium");
  s.set_forcing(true);
  return x;
}

struct Collocated {
  Range range;
  double seconds = 0;
  int iterations = 0;
};

Collocated collocate(system::RotorSystem& s, Vec x, int intervals, int degree) {
  Collocated out;
  solve::CycleOptions options;
  options.degree = degree;
  const auto whole = s.gather(x);
  solve::Cycle cycle;
  solve::Scheme scheme;
  out.seconds = bench::least(PETSC_COMM_SELF, 3, [&] {
                  solve::CycleProblem p(PETSC_COMM_SELF, s, options, solve::uniform_mesh(intervals));
                  solve::Cycle guess{p.mesh(), {}, kPeriod, kSpeed};
                  guess.x = Eigen::Map<const Eigen::VectorXd>(whole.data(), s.size()).replicate(1, intervals * degree);
                  core::Vector u = p.scatter(guess), row = core::duplicate(u.get());
                  solve::parameter_row(p, row.get());
                  const auto r = solve::newton(p, u.get(), row.get(), kSpeed, {});
                  core::require(r.converged, "no cycle");
                  out.iterations = r.iterations;
                  cycle = p.gather(u.get());
                  scheme = p.scheme();
                }).wall;
  for (int k = 0; k < kSamples; ++k) {
    const Eigen::VectorXd z = cycle.at(scheme, static_cast<double>(k) / kSamples);
    out.range.add(signals(s, z.data()));
  }
  return out;
}

// What TS works on: states and equations scaled as in the other solvers, time in seconds.
struct Motion {
  system::RotorSystem& system;
  core::Vector state_scale, residual_scale, x, xdot;
  long residuals = 0, jacobians = 0;

  void unscale(Vec u, Vec udot) {
    core::check(VecPointwiseMult(x.get(), u, state_scale.get()));
    core::check(VecPointwiseMult(xdot.get(), udot, state_scale.get()));
  }
};

PetscErrorCode form_residual(TS, PetscReal t, Vec u, Vec udot, Vec f, void* raw) {
  auto& m = *static_cast<Motion*>(raw);
  ++m.residuals;
  m.unscale(u, udot);
  m.system.residual(kSpeed * t, m.x.get(), m.xdot.get(), f);
  return VecPointwiseDivide(f, f, m.residual_scale.get());
}

PetscErrorCode form_jacobian(TS, PetscReal t, Vec u, Vec udot, PetscReal shift, Mat j, Mat, void* raw) {
  auto& m = *static_cast<Motion*>(raw);
  ++m.jacobians;
  m.unscale(u, udot);
  m.system.jacobian(kSpeed * t, m.x.get(), m.xdot.get(), 1, shift, j);
  core::check(VecReciprocal(m.residual_scale.get()));
  core::check(MatDiagonalScale(j, m.residual_scale.get(), m.state_scale.get()));
  return VecReciprocal(m.residual_scale.get());
}

}  // namespace

int main(int argc, char** argv) {
  const core::Session session(argc, argv,
                              {"-ts_type", "bdf", "-ts_bdf_order", "3", "-ts_adapt_type", "basic", "-snes_lag_jacobian",
                               "1", "-ksp_type", "preonly", "-pc_type", "lu"});
  PetscBool quick = PETSC_FALSE;
  core::check(PetscOptionsHasName(nullptr, nullptr, "--quick", &quick));
  core::check(PetscOptionsHasName(nullptr, nullptr, "-quick", &quick));
  for (int k = 1; k < argc; ++k)
    if (std::string(argv[k]) == "--quick") quick = PETSC_TRUE;

  auto train = test::train({60, 16}, true);
  test::add_gen_pair(train, 2.5);
  system::RotorSystem s(PETSC_COMM_SELF, train, kSpeed);
  core::Vector x = equilibrium(s);
  const Collocated cycle = collocate(s, x.get(), 60, 2), fine = collocate(s, x.get(), 60, 4);
  fmt::print(
      "collocation, 60 intervals of degree 2: {} Newton iterations, {:.3f} s, peak to peak within {:.1e} of that "
      "of degree 4\n",
      cycle.iterations, cycle.seconds, difference(cycle.range, fine.range));

  Motion motion{s, core::duplicate(x.get()), core::duplicate(x.get()), core::duplicate(x.get()),
                core::duplicate(x.get())};
  s.scales(motion.state_scale.get(), motion.residual_scale.get());
  core::Vector u = core::duplicate(x.get()), at = core::duplicate(x.get());
  core::check(VecPointwiseDivide(u.get(), x.get(), motion.state_scale.get()));
  core::Matrix j = s.make_jacobian();
  core::Handle<TS, TSDestroy> ts;
  core::check(TSCreate(PETSC_COMM_SELF, ts.put()));
  core::check(TSSetProblemType(ts.get(), TS_NONLINEAR));
  core::check(TSSetEquationType(ts.get(), TS_EQ_ODE_IMPLICIT));
  core::check(TSSetIFunction(ts.get(), nullptr, form_residual, &motion));
  core::check(TSSetIJacobian(ts.get(), j.get(), j.get(), form_jacobian, &motion));
  core::check(TSSetTimeStep(ts.get(), kPeriod / 400));
  core::check(TSSetExactFinalTime(ts.get(), TS_EXACTFINALTIME_STEPOVER));
  core::check(TSSetMaxSteps(ts.get(), 100000000));
  core::check(TSSetMaxTime(ts.get(), 1e9));
  core::check(TSSetTolerances(ts.get(), 1e-5, nullptr, 1e-5, nullptr));
  core::check(TSSetFromOptions(ts.get()));
  core::check(TSSetSolution(ts.get(), u.get()));
  core::check(TSSetUp(ts.get()));

  // Peak to peak per period by sampling the integrator's own interpolant; sampling is not timed.
  const int limit = quick ? 60 : 5000;
  double seconds = 0;
  long steps = 0;
  int sample = 0, periods = 0;
  std::vector<Range> ranges;
  Range current;
  double last_difference = 1, largest_step = 0;
  int settled = 0;
  TSType type = nullptr;
  core::check(TSGetType(ts.get(), &type));
  std::vector<double> history;
  const double start = bench::clock_seconds(CLOCK_MONOTONIC);
  while (periods < limit) {
    const double before = bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    core::check(TSStep(ts.get()));
    seconds += bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - before;
    ++steps;
    PetscReal time = 0, previous = 0;
    core::check(TSGetTime(ts.get(), &time));
    core::check(TSGetPrevTime(ts.get(), &previous));
    largest_step = std::max(largest_step, time - previous);
    for (; (sample + 1) * kPeriod / kSamples <= time; ++sample) {
      core::check(TSInterpolate(ts.get(), (sample + 1) * kPeriod / kSamples, at.get()));
      core::check(VecPointwiseMult(at.get(), at.get(), motion.state_scale.get()));
      const core::ReadArray a(at.get());
      current.add(signals(s, a.data()));
      if ((sample + 1) % kSamples != 0) continue;
      ++periods;
      last_difference = difference(current, cycle.range);
      history.push_back(last_difference);
      ranges.push_back(current);
      current = {};
      if (periods % 50 == 0)
        fmt::print("  period {:4d}: {:.3e} from the cycle, {:.1f} s, {} steps\n", periods, last_difference, seconds,
                   steps);
      settled = last_difference < 1e-4 ? settled + 1 : 0;
    }
    if (settled > 0) break;
    // The integrator's own cycle differs from the collocated one by its error: settled when nothing moves any more.
    if (ranges.size() > 400 && difference(ranges.back(), ranges[ranges.size() - 100]) < 2e-6) break;
  }
  (void)start;
  fmt::print(
      "TS {}: {} periods, {} steps, {} residuals, {} Jacobians, {:.2f} s; {:.1e} from the collocated cycle, {:.1e} "
      "from that of degree 4\n",
      type, periods, steps, motion.residuals, motion.jacobians, seconds, last_difference,
      difference(ranges.back(), fine.range));
  double whole = seconds;
  if (quick && settled == 0) {
    const double needed = periods + std::log(last_difference / 1e-4) / -std::log(0.990);
    whole *= needed / periods;
    fmt::print("extrapolated with the leading multiplier 0.990 to {:.0f} periods: {:.1f} s\n", needed, whole);
  }
  fmt::print("ratio {:.0f}\n", whole / cycle.seconds);
  return 0;
}
