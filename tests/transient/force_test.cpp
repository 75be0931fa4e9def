// External forces: exact answers of an oscillator and a free mass, signals piece by piece, noise of known density.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/small_system.hpp"
#include "whirl/transient/analysis/estimators.hpp"
#include "whirl/transient/steps/integrator.hpp"

using namespace whirl;
using namespace whirl::transient;
using test::SmallSystem;

namespace {

constexpr double pi = std::numbers::pi;

// m x'' + c x' + k x = f, in the rows of a rotor: momentum first.
struct Oscillator {
  double m, c, k;
  template <class T>
  test::Column<T> operator()(double, const test::Column<T>& x, const test::Column<T>& xdot, T) const {
    test::Column<T> f(2);
    f << m * xdot(1) + c * x(1) + k * x(0), xdot(0) - x(1);
    return f;
  }
};

Forces with(const SignalOptions& options) {
  Forces forces;
  forces.add(make_signal(options), {{0, 1.0}});
  return forces;
}

struct Played {
  std::vector<double> ends;
  Eigen::Vector2d end;
};

// From rest to `time`, with the ends of all steps.
Played played(const Oscillator& o, Forces& forces, double time, double tolerance, MPI_Comm comm = MPI_COMM_SELF) {
  SmallSystem s(comm, 2, 1, 1, o);
  s.set_scales(Eigen::Vector2d(1e-3, 1e-1), Eigen::Vector2d(7, 0.3));
  Played out;
  Integrator integrator(
      s, {1}, s.vector(Eigen::Vector2d::Zero()).get(),
      {.tolerance = tolerance, .forces = &forces, .after_step = [&](double t, double) { out.ends.push_back(t); }});
  integrator.advance(time);
  const core::Vector x = s.vector(Eigen::Vector2d::Zero());
  integrator.state(x.get());
  out.end = s.gather(x.get());
  return out;
}

bool has(const std::vector<double>& times, double t) {
  return std::find(times.begin(), times.end(), t) != times.end();
}

// Answer of the oscillator to a unit step at t = 0.
Eigen::Vector2d step_response(const Oscillator& o, double t) {
  if (t < 0) return Eigen::Vector2d::Zero();
  const double w = std::sqrt(o.k / o.m), decay = o.c / (2 * o.m), damped = std::sqrt(w * w - decay * decay);
  const double e = std::exp(-decay * t);
  return {(1 - e * (std::cos(damped * t) + decay / damped * std::sin(damped * t))) / o.k,
          e * std::sin(damped * t) / (o.m * damped)};
}

}  // namespace

TEST(Force, StepsOfAnOscillatorAreExact) {
  if (core::size_of(MPI_COMM_WORLD) > 2) GTEST_SKIP() << "every step of a distributed system costs messages";
  const Oscillator o{2, 3, 800};
  const Step step{.amplitude = 5, .start = 0.137, .end = 0.61};
  const bool alone = core::size_of(MPI_COMM_WORLD) == 1;
  const double end = alone ? 1.5 : 0.7;
  const Eigen::Vector2d wanted = 5 * (step_response(o, end - 0.137) - step_response(o, end - 0.61));
  double before = 0;
  for (const double tolerance : alone ? std::vector{1e-6, 1e-9} : std::vector{1e-5}) {
    Forces forces = with(step);
    const Played r = played(o, forces, end, tolerance, MPI_COMM_WORLD);
    const double error = (r.end - wanted).cwiseQuotient(Eigen::Vector2d(1e-3, 1e-1)).norm();
    EXPECT_LT(error, 20 * tolerance);
    EXPECT_TRUE(has(r.ends, 0.137) && has(r.ends, 0.61) && has(r.ends, end));
    if (before > 0) {
      EXPECT_LT(error, before);
    }
    before = error;
  }
  if (!alone) return;
  // A rise that is short against the period is a jump a half of it later, but for (0.02)^2/56.
  Forces smooth = with(Step{.amplitude = 5, .start = 0.137, .end = 0.61, .rise = 1e-3});
  const Eigen::Vector2d later = 5 * (step_response(o, end - 0.137 - 5e-4) - step_response(o, end - 0.61 - 5e-4));
  EXPECT_LT((played(o, smooth, end, 1e-8).end - later).cwiseQuotient(Eigen::Vector2d(6e-3, 0.12)).norm(), 3e-5);
}

TEST(Force, AnImpulseIsAJumpOfTheVelocity) {
  const double mass = 3, amplitude = 40, duration = 2e-3;
  Forces forces = with(Impulse{.amplitude = amplitude, .start = 0.1, .duration = duration});
  const Played r = played({mass, 0, 0}, forces, 0.5, 1e-10);
  const double jump = 2 * amplitude * duration / (pi * mass);
  EXPECT_NEAR(r.end(1), jump, 1e-9 * jump);
  EXPECT_NEAR(r.end(0), jump * (0.4 - duration / 2), 1e-9 * jump);
  EXPECT_TRUE(has(r.ends, 0.1) && has(r.ends, 0.1 + duration));
}

// A free mass moves along polynomials of degree three, which the scheme follows to rounding whatever its steps.
TEST(Force, ASeriesIsFollowedToRounding) {
  const double mass = 2;
  Forces forces = with(Series{{{0.1, 1}, {0.4, 7}, {0.45, -2}, {1.0, -2}}});
  const Played r = played({mass, 0, 0}, forces, 1.5, 1e-2);
  Eigen::Vector2d wanted = Eigen::Vector2d::Zero();
  const auto piece = [&](double h, double from, double to) {
    const double slope = (to - from) / h;
    wanted(0) += wanted(1) * h + (from / 2 + slope * h / 6) * h * h / mass;
    wanted(1) += (from + to) / 2 * h / mass;
  };
  piece(0.4 - 0.1, 1, 7);
  piece(0.45 - 0.4, 7, -2);
  piece(1.0 - 0.45, -2, -2);
  piece(0.5, 0, 0);
  EXPECT_LT((r.end - wanted).norm(), 1e-12);
  for (const double t : {0.1, 0.4, 0.45, 1.0}) EXPECT_TRUE(has(r.ends, t)) << t;
}

TEST(Force, AHarmonicForceHasItsOwnFrequency) {
  const Oscillator o{2, 30, 800};
  const double f = 1.7, phase = 0.4, end = 8;  // the transient dies by exp(-60)
  Forces forces = with(Harmonic{.amplitude = 3, .frequency = f, .phase = phase, .start = 0.25});
  const std::complex<double> i(0, 1), z = 3.0 / (o.k - o.m * std::pow(2 * pi * f, 2) + i * o.c * 2 * pi * f) *
                                          std::exp(i * (2 * pi * f * (end - 0.25) + phase));
  const Played r = played(o, forces, end, 1e-9);
  EXPECT_NEAR(r.end(0), z.real(), 1e-8 * std::abs(z));
  EXPECT_NEAR(r.end(1), (2 * pi * f * i * z).real(), 1e-8 * std::abs(2 * pi * f * z));
}

TEST(Force, ASweepChangesItsFrequencyEvenly) {
  const auto s =
      make_signal(Harmonic{.amplitude = 1, .frequency = 10, .start = 1, .end = 4, .sweep_to = 30, .sweep_duration = 2});
  // Turns: 10 t + 5 t^2 for two seconds, 40 by then, then 30 a second.
  for (const double t : {0.0, 0.3, 1.1, 1.9})
    EXPECT_NEAR(s->at(1 + t, 1 + t), std::cos(2 * pi * (10 * t + 5 * t * t)), 1e-12);
  EXPECT_NEAR(s->at(3.01, 3.01), std::cos(2 * pi * 0.3), 1e-12);
  EXPECT_EQ(s->at(4.01, 4.01), 0);
  EXPECT_EQ(s->next_break(0), 1);
  EXPECT_EQ(s->next_break(1), 3);
  EXPECT_EQ(s->next_break(3), 4);
  EXPECT_TRUE(std::isinf(s->next_break(4)));
}

TEST(Force, AJumpBelongsToTheSideThatIsAsked) {
  Forces forces = with(Step{.amplitude = 2, .start = 1, .end = 3});
  forces.enter(0, 1);
  EXPECT_EQ(forces.value(0, 1), 0);
  forces.enter(1, 3);
  EXPECT_EQ(forces.value(0, 1), 2);
  EXPECT_EQ(forces.value(0, 3), 2);
  forces.enter(3, 5);
  EXPECT_EQ(forces.value(0, 3), 0);
  EXPECT_TRUE(forces.constant(1, 3) && forces.constant(3, 9) && forces.constant(0, 1));
  EXPECT_FALSE(forces.constant(0.5, 1.5) || forces.constant(2, 3.1));
}

TEST(Force, ARestartRepeatsAMotionToTheBit) {
  const Oscillator o{2, 3, 800};
  const Random noise{.rms = 3, .cutoff = 50, .seed = 7};
  const auto integrator = [&](SmallSystem& s, Forces& forces) {
    return std::make_unique<Integrator>(s, problem::Drive{1}, s.vector(Eigen::Vector2d(0.1, 0)).get(),
                                        IntegratorOptions{.tolerance = 1e-6, .forces = &forces});
  };
  Forces one = with(noise), two = with(noise), three = with(noise);
  SmallSystem s(MPI_COMM_SELF, 2, 1, 1, o);
  const auto whole = integrator(s, one), first = integrator(s, two), second = integrator(s, three);
  whole->advance(0.7);
  whole->restart(whole->time(), whole->step());  // as at the end of a revolution
  whole->advance(1.1);
  first->advance(0.7);
  core::check(VecCopy(first->scaled(), second->scaled()));
  second->restart(first->time(), first->step());
  second->advance(1.1);
  EXPECT_EQ((s.gather(whole->scaled()) - s.gather(second->scaled())).cwiseAbs().maxCoeff(), 0);
  // Others hear other noise.
  Forces other = with(Random{.rms = 3, .cutoff = 50, .seed = 8});
  const auto deaf = integrator(s, other);
  deaf->advance(1.1);
  EXPECT_GT((s.gather(whole->scaled()) - s.gather(deaf->scaled())).norm(), 1e-3);
}

TEST(Force, NoiseHasTheDensityThatIsSaid) {
  const Random o{.rms = 2.5, .cutoff = 1000, .seed = 3};
  const auto signal = make_signal(o);
  const double fine = 16000;  // four times the samples of the noise
  const std::size_t n = 1 << 18;
  signal->prepare(static_cast<double>(n) / fine);
  std::vector<double> values, sampled;
  for (std::size_t k = 0; k < n; ++k) {
    const double t = (static_cast<double>(k) + 0.5) / fine;
    values.push_back(signal->at(t, t));
    if (k % 4 == 0) sampled.push_back(signal->at(static_cast<double>(k) / fine, (static_cast<double>(k) + 0.5) / fine));
  }
  double square = 0, mean = 0;
  for (const double v : sampled) {
    square += v * v / static_cast<double>(sampled.size());
    mean += v / static_cast<double>(sampled.size());
  }
  EXPECT_NEAR(std::sqrt(square), o.rms, 0.02 * o.rms);
  EXPECT_NEAR(mean, 0, 0.05 * o.rms);
  const SpectralMatrix s = spectral_matrix({values}, 1 / fine, {.segments = 255});
  // Over bands of 21 lines: 2 % of scatter.
  for (const double f : {100.0, 300.0, 700.0, 1000.0, 1500.0}) {
    double found = 0, wanted = 0;
    const auto middle = static_cast<std::size_t>(f / s.resolution);
    for (std::size_t k = middle - 10; k <= middle + 10; ++k) {
      found += s.lines[k](0, 0).real();
      wanted += spectral_density(o, s.frequency(k));
    }
    EXPECT_NEAR(found / wanted, 1, 0.06) << f;
  }
  // The low pass halves the power where it is said to, but for the interpolation (0.94^2).
  EXPECT_NEAR(spectral_density(o, 1000) / spectral_density(o, 1), 0.5 * 0.882, 0.002);
  EXPECT_LT(spectral_density(o, 3000) / spectral_density(o, 1), 2e-2);
  // One break a sample.
  EXPECT_NEAR(signal->next_break(0.00101), 0.00125, 1e-15);
}
