// Cost of one pad of 60 x 16 cells against one banded factorisation of the same pressure equation.
// Pads with heat stand against one linear solve of their equations.
// OPENBLAS_NUM_THREADS=1 bench_film; the counter `per_factorisation` is the ratio to dpbtrf measured in the same run.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <vector>

#include "bench/pad.hpp"
#include "film/algebra/film_matrix.hpp"
#include "film/use/condensed.hpp"
#include "support/film_of.hpp"
#include "whirl/film/contract/film.hpp"

extern "C" {
void dpbtrf_(const char* uplo, const int* n, const int* kd, double* ab, const int* ldab, int* info);
void dgbtrf_(const int* m, const int* n, const int* kl, const int* ku, double* ab, const int* ldab, int* pivots,
             int* info);
}

namespace {

using namespace whirl;
using namespace whirl::film;

using bench::heated, bench::kAlong, bench::kAround, bench::loaded, bench::one_pad;

constexpr int kSize = (kAround - 1) * (kAlong - 1), kBand = kAlong - 1;

// The five-point operator of a film with h^3 varying by a factor of 30 around the pad, lower band storage.
std::vector<double> pressure_matrix(int rows_above, int stride) {
  std::vector<double> ab(static_cast<std::size_t>(stride) * kSize, 0.0);
  const auto a = [](double i) { return std::pow(1.0 + 0.5 * std::cos(0.05 * i), 3); };
  for (int i = 1; i < kAround; ++i) {
    for (int j = 0; j < kBand; ++j) {
      const int k = (i - 1) * kBand + j;
      const auto set = [&](int row, int column, double value) {
        if (row >= kSize || (rows_above == 0 && row < column)) return;
        ab[static_cast<std::size_t>(column) * static_cast<std::size_t>(stride) +
           static_cast<std::size_t>(rows_above + row - column)] = value;
      };
      set(k, k, a(i - 0.5) + a(i + 0.5) + 2.0 * a(i));
      set(k + kBand, k, -a(i + 0.5));
      if (j + 1 < kBand) set(k + 1, k, -a(i));
      if (rows_above == 0) continue;
      if (i > 1) set(k - kBand, k, -a(i - 0.5));
      if (j > 0) set(k - 1, k, -a(i));
    }
  }
  return ab;
}

void banded_cholesky(benchmark::State& state) {
  const int stride = kBand + 1;
  const std::vector<double> original = pressure_matrix(0, stride);
  std::vector<double> ab;
  int info = 0;
  for (auto _ : state) {
    ab = original;
    dpbtrf_("L", &kSize, &kBand, ab.data(), &stride, &info);
    benchmark::DoNotOptimize(ab.data());
  }
  if (info != 0) state.SkipWithError("not positive definite");
}

void banded_lu(benchmark::State& state) {
  const int stride = 3 * kBand + 1;
  const std::vector<double> original = pressure_matrix(2 * kBand, stride);
  std::vector<double> ab;
  std::vector<int> pivots(kSize);
  int info = 0;
  for (auto _ : state) {
    ab = original;
    dgbtrf_(&kSize, &kSize, &kBand, &kBand, ab.data(), &stride, pivots.data(), &info);
    benchmark::DoNotOptimize(ab.data());
  }
  if (info != 0) state.SkipWithError("singular");
}

// Microseconds of one dpbtrf, best of several runs: the yardstick of the ratios below.
double factorisation_time() {
  static const double best = [] {
    const int stride = kBand + 1;
    const std::vector<double> original = pressure_matrix(0, stride);
    double least = 1e9;
    for (int run = 0; run < 50; ++run) {
      constexpr int kTimes = 20;
      std::vector<double> ab;
      const auto start = std::chrono::steady_clock::now();
      for (int k = 0; k < kTimes; ++k) {
        int info = 0;
        ab = original;
        dpbtrf_("L", &kSize, &kBand, ab.data(), &stride, &info);
        benchmark::DoNotOptimize(ab.data());
      }
      const std::chrono::duration<double> t = std::chrono::steady_clock::now() - start;
      least = std::min(least, t.count() / kTimes);
    }
    return least;
  }();
  return best;
}

void evaluate(benchmark::State& state, Reynolds options, Need need) {
  options.cells = {kAround, kAlong};
  auto film = make_film(one_pad(), options, {0.0067, 850.0});
  JournalMotion m = loaded(options.tilt);
  StateResponse r;
  long count = 0;
  const double start = m.position[0];
  for (auto _ : state) {
    m.position[0] = start * (1.0 + 1e-3 * static_cast<double>(++count % 16));  // a moving journal, so a moving rupture
    film->evaluate(m, film->whole(), {}, {}, need, r);
    benchmark::DoNotOptimize(r);
  }
  state.counters["per_factorisation"] = benchmark::Counter(factorisation_time() * static_cast<double>(count),
                                                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// A film with own states around a moving journal, with rates; half of it carries. As solvers do it, who hand over what
// a share sees.
void evaluate_states(benchmark::State& state, testing::Elastic options, Need need) {
  const Geometry bore{Geometry::Bore::cylindrical, 0.005, 0.01, 25e-6, 0.0, 0.0, 0.0};
  options.compliance = 0.1;
  options.reference_speed = 160.0;
  auto film = make_film(bore, options, {0.001, 1000.0});
  JournalMotion m;
  m.position = {0.3 * bore.clearance, -0.5 * bore.clearance, 0.0, 0.0};
  m.velocity = {0.05 * bore.clearance * 320.0, -0.08 * bore.clearance * 320.0, 0.0, 0.0};
  m.speed = 320.0;
  std::vector<double> states(film->states());
  film->unloaded(m, states);
  relax(*film, m, states);
  const Share& all = film->whole();
  states = seen_of(all, states);
  const std::vector<double> rates(states.size(), 0.01 * bore.clearance * m.speed);
  StateResponse r;
  long count = 0;
  const double start = m.position[0];
  for (auto _ : state) {
    m.position[0] = start * (1.0 + 1e-3 * static_cast<double>(++count % 16));
    film->evaluate(m, all, states, rates, need, r);
    benchmark::DoNotOptimize(r);
  }
}

// Seconds of one linear solve of all equations of that film, pressure and energy: derivatives, factors, one right-hand
// side.
double linear_solve_time(int layers) {
  auto film = make_film(one_pad(), heated(layers, States::dynamic), {0.0067, 850.0});
  const JournalMotion m = loaded(false);
  std::vector<double> states(film->states()), rates(film->states(), 0.0);
  film->unloaded(m, states);
  relax(*film, m, states);
  FilmMatrix<double> matrix(film->whole(), film->whole().d_states);
  Eigen::VectorXd units(static_cast<Eigen::Index>(states.size()));
  for (const StateField& f : film->state_fields()) f.each([&](int k) { units(k) = f.scale; });
  core::BandLu band(matrix.pattern(), units);
  StateResponse r;
  double least = 1e9;
  for (int run = 0; run < 10; ++run) {
    const auto start = std::chrono::steady_clock::now();
    film->evaluate(m, states, rates, Need::tangents, r);
    if (!band.factor(matrix.filled(r.d_states))) return 0;
    const Eigen::Map<const Eigen::VectorXd> b(r.d_speed.data(), static_cast<Eigen::Index>(r.d_speed.size()));
    benchmark::DoNotOptimize(band.solve(b));
    const std::chrono::duration<double> t = std::chrono::steady_clock::now() - start;
    least = std::min(least, t.count());
  }
  return least;
}

// The force with all tangents of a journal that goes around an orbit of a tenth of the clearance in `points` steps, as
// at the points of a cycle; against one linear solve of the pad in the same run.
void heated_orbit(benchmark::State& state) {
  const auto layers = static_cast<int>(state.range(0)), points = static_cast<int>(state.range(1));
  Condensed film(make_film(one_pad(), heated(layers, States::dynamic), {0.0067, 850.0}));
  StateResponse r;
  JournalMotion m = loaded(false);
  const JournalMotion middle = m;
  const double turn = 2.0 * std::numbers::pi / points, radius = 0.05 * 0.0004;
  long count = 0;
  const auto go_on = [&] {
    const double phase = turn * static_cast<double>(count++);
    m.position[0] = middle.position[0] - 0.4 * 0.0004 + radius * std::cos(phase);
    m.position[1] = middle.position[1] + radius * std::sin(phase);
    m.velocity[0] = -radius * m.speed * std::sin(phase);
    m.velocity[1] = radius * m.speed * std::cos(phase);
    film.evaluate(m, film.whole(), {}, {}, Need::tangents, r);
  };
  for (int k = 0; k < points; ++k) go_on();  // warm
  const long factorisations = film.factorisations();
  count = 0;
  for (auto _ : state) go_on();
  const auto times = static_cast<double>(count);
  state.counters["factorisations"] = static_cast<double>(film.factorisations() - factorisations) / times;
  state.counters["per_linear_solve"] =
      benchmark::Counter(linear_solve_time(layers) * times, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

testing::Elastic compliant(testing::Kind kind, bool as_source) {
  testing::Elastic o;
  o.kind = kind;
  o.cells = {kind == testing::Kind::compliant_finite ? 100 : 50, 20};
  if (as_source) {
    o.quadrature = Compliant::Quadrature::simpson;
    o.differences = Compliant::Differences::upwind;
  }
  return o;
}

// A rubber that is damped, and asperities that touch where the film is thinnest.
testing::Elastic general(testing::Elastic o) {
  o.liner_damping = 1e-3;
  o.rubber_thickness = 1e-4;
  o.contact = Contact{4e-6, 1e6};
  return o;
}

Reynolds options(Reynolds::Cavitation cavitation, bool tilt, Turbulence turbulence = Turbulence::constantinescu) {
  Reynolds o;
  o.cavitation = cavitation;
  o.tilt = tilt;
  o.turbulence = turbulence;
  return o;
}

using C = Reynolds::Cavitation;
BENCHMARK(banded_cholesky)->Unit(benchmark::kMicrosecond);
BENCHMARK(banded_lu)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(evaluate, aligned_tangents, options(C::half_sommerfeld, false), Need::tangents)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(evaluate, aligned_force, options(C::half_sommerfeld, false), Need::force)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(evaluate, aligned_laminar_tangents, options(C::half_sommerfeld, false, Turbulence::laminar),
                  Need::tangents)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(evaluate, aligned_uncavitated_tangents, options(C::none, false), Need::tangents)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(evaluate, tilted_tangents, options(C::half_sommerfeld, true), Need::tangents)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(evaluate, reynolds_warm_tangents, options(C::reynolds, false), Need::tangents)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(evaluate, reynolds_tilted_warm_tangents, options(C::reynolds, true), Need::tangents)
    ->Unit(benchmark::kMicrosecond);

#define WHIRL_STATES(name, options)                                                              \
  BENCHMARK_CAPTURE(evaluate_states, name, options, Need::force)->Unit(benchmark::kMicrosecond); \
  BENCHMARK_CAPTURE(evaluate_states, name##_tangents, options, Need::tangents)->Unit(benchmark::kMicrosecond)
using K = testing::Kind;
WHIRL_STATES(short_as_source, compliant(K::compliant_short, true));
WHIRL_STATES(short_sub_cell, compliant(K::compliant_short, false));
WHIRL_STATES(short_general, general(compliant(K::compliant_short, false)));
WHIRL_STATES(long_as_source, compliant(K::compliant_long, true));
WHIRL_STATES(long_general, general(compliant(K::compliant_long, false)));
WHIRL_STATES(finite_100x20, compliant(K::compliant_finite, false));
WHIRL_STATES(finite_100x20_general, general(compliant(K::compliant_finite, false)));

BENCHMARK(heated_orbit)->ArgsProduct({{1, 8}, {60, 120, 480}})->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
