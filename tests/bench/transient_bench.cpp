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
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"

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

// Signals and their rates at the end of a step. The cubic through two of them samples the motion between: some of
// PETSc's methods have no interpolation of their own.
struct Knot {
  double time = 0;
  Signals value{}, rate{};

  Knot() = default;
  Knot(const system::RotorSystem& s, double at, const double* x) : time(at) {
    const auto journals = s.journals(x);
    for (std::size_t b = 0; b < 5; ++b)
      for (std::size_t d = 0; d < 2; ++d) {
        value[2 * b + d] = journals[b].position[d];
        rate[2 * b + d] = journals[b].velocity[d];
      }
  }
};

Signals between(const Knot& a, const Knot& b, double time) {
  const double h = b.time - a.time, t = (time - a.time) / h;
  Signals out{};
  for (std::size_t k = 0; k < kSignals; ++k)
    out[k] = (1 - t) * (1 - t) * ((1 + 2 * t) * a.value[k] + t * h * a.rate[k]) +
             t * t * ((3 - 2 * t) * b.value[k] - (1 - t) * h * b.rate[k]);
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

Collocated collocate(system::RotorSystem& s, Vec x, int intervals, int degree, int runs) {
  Collocated out;
  solve::CycleOptions options;
  options.degree = degree;
  const auto whole = s.gather(x);
  solve::Cycle cycle;
  solve::Scheme scheme;
  // Processor time, as for the integration below: other work on the machine then costs neither.
  out.seconds = bench::least(PETSC_COMM_SELF, runs, [&] {
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
                }).processor;
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
  // The fastest of the integrators and tolerances tried (docs/speed.md) that reach the accuracy asked for.
  std::vector<std::string> words{"-ts_type",      "rosw",  "-ts_rtol",  "1e-4",    "-ts_atol", "1e-4",
                                 "-ts_rosw_type", "grk4t", "-ksp_type", "preonly", "-pc_type", "lu"};
  bool quick = false;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (word == "--quick")
      quick = true;
    else
      words.push_back(word);
  }
  const core::Session session(1, argv);
  core::Session::set_options(words);

  auto train = test::train({60, 16}, true);
  test::add_gen_pair(train, 2.5);
  system::RotorSystem s(PETSC_COMM_SELF, train, kSpeed);
  core::Vector x = equilibrium(s);
  // The yardstick of both sides; each must come within `accuracy` of its peak to peak in every bearing and direction.
  constexpr double accuracy = 1e-4;
  const Range reference = collocate(s, x.get(), 120, 4, 1).range;
  Collocated cycle;
  cycle.seconds = 1e9;
  for (const auto& [intervals, degree] : {std::pair{60, 2}, {90, 2}, {20, 3}, {30, 3}, {60, 3}, {12, 4}, {20, 4}}) {
    const Collocated c = collocate(s, x.get(), intervals, degree, 5);
    const double error = difference(c.range, reference);
    fmt::print(
        "collocation, {:3d} intervals of degree {}: {} Newton iterations, {:.4f} s, peak to peak within {:.1e}\n",
        intervals, degree, c.iterations, c.seconds, error);
    if (error < accuracy && c.seconds < cycle.seconds) cycle = c;
  }
  core::require(cycle.iterations > 0, "no collocation is accurate enough");

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
  core::check(TSSetFromOptions(ts.get()));
  core::check(TSSetSolution(ts.get(), u.get()));
  core::check(TSSetUp(ts.get()));

  // Peak to peak per period by sampling between steps; sampling is not timed.
  const int limit = quick ? 60 : 1200;
  double seconds = 0;
  long steps = 0;
  int sample = 0, periods = 0;
  Range current;
  double last_difference = 1;
  bool settled = false;
  TSType type = nullptr;
  core::check(TSGetType(ts.get(), &type));
  const auto knot = [&](double time) {
    core::check(VecPointwiseMult(at.get(), u.get(), motion.state_scale.get()));
    return Knot(s, time, core::ReadArray(at.get()).data());
  };
  Knot before_step, after_step = knot(0);
  while (periods < limit) {
    const double before = bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
    try {
      core::check(TSStep(ts.get()));
    } catch (const core::DomainError& e) {
      fmt::print("TS {} leaves the validity of the films after {} periods: {}\n", type, periods, e.what());
      return 1;
    }
    seconds += bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - before;
    ++steps;
    PetscReal time = 0;
    core::check(TSGetTime(ts.get(), &time));
    before_step = after_step;
    after_step = knot(time);
    for (; (sample + 1) * kPeriod / kSamples <= time; ++sample) {
      current.add(between(before_step, after_step, (sample + 1) * kPeriod / kSamples));
      if ((sample + 1) % kSamples != 0) continue;
      ++periods;
      last_difference = difference(current, reference);
      current = {};
      if (periods % 50 == 0)
        fmt::print("  period {:4d}: {:.3e} from the cycle, {:.1f} s, {} steps\n", periods, last_difference, seconds,
                   steps);
      settled = settled || last_difference < accuracy;
    }
    if (settled) break;
  }
  fmt::print("TS {}: {} periods, {} steps, {} residuals, {} Jacobians, {:.2f} s; within {:.1e}\n", type, periods, steps,
             motion.residuals, motion.jacobians, seconds, last_difference);
  double whole = seconds;
  if (quick && !settled) {
    const double needed = periods + std::log(last_difference / accuracy) / -std::log(0.990);
    whole *= needed / periods;
    fmt::print("extrapolated with the leading multiplier 0.990 to {:.0f} periods: {:.1f} s\n", needed, whole);
  }
  if (!quick && !settled) fmt::print("the integrator did not come as near as asked: its tolerance is too loose\n");
  fmt::print("ratio {:.0f}\n", whole / cycle.seconds);
  return 0;
}
