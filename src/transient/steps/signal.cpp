#include "whirl/transient/steps/signal.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "transient/steps/butterworth.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/description.hpp"

namespace whirl::transient {
namespace {

using std::numbers::pi;
constexpr double never = std::numeric_limits<double>::infinity();

double first_after(double t, std::initializer_list<double> breaks) {
  double first = never;
  for (const double b : breaks)
    if (b > t) first = std::min(first, b);
  return first;
}

class StepSignal final : public Signal {
public:
  explicit StepSignal(const Step& o) : o_(o), end_(o.end.value_or(never)) {}
  double at(double t, double inside) const override {
    if (inside < o_.start || inside >= end_ + o_.rise) return 0;
    if (inside < o_.start + o_.rise) return o_.amplitude * flank((t - o_.start) / o_.rise);
    if (inside < end_) return o_.amplitude;
    return o_.amplitude * (1 - flank((t - end_) / o_.rise));
  }
  double next_break(double t) const override {
    return first_after(t, {o_.start, o_.start + o_.rise, end_, end_ + o_.rise});
  }
  bool constant(double begin, double end) const override {
    const auto apart = [&](double from, double to) { return end <= from || begin >= to; };
    return apart(o_.start, o_.start + o_.rise) && apart(end_, end_ + o_.rise);
  }

private:
  static double flank(double x) { return x * x * x * (10 + x * (6 * x - 15)); }
  Step o_;
  double end_;
};

class ImpulseSignal final : public Signal {
public:
  explicit ImpulseSignal(const Impulse& o) : o_(o) {}
  double at(double t, double inside) const override {
    if (inside < o_.start || inside >= o_.start + o_.duration) return 0;
    return o_.amplitude * std::sin(pi * (t - o_.start) / o_.duration);
  }
  double next_break(double t) const override { return first_after(t, {o_.start, o_.start + o_.duration}); }
  bool constant(double begin, double end) const override { return end <= o_.start || begin >= o_.start + o_.duration; }

private:
  Impulse o_;
};

class HarmonicSignal final : public Signal {
public:
  explicit HarmonicSignal(const Harmonic& o)
      : o_(o), end_(o.end.value_or(never)), duration_(o.sweep_duration.value_or(never)) {}
  double at(double t, double inside) const override {
    if (inside < o_.start || inside >= end_) return 0;
    const double s = t - o_.start, to = o_.sweep_to.value_or(o_.frequency);
    double turns = o_.frequency * s;
    if (o_.sweep_to) {
      if (inside < o_.start + duration_)
        turns += (to - o_.frequency) * s * s / (2 * duration_);
      else
        turns = (o_.frequency + to) / 2 * duration_ + to * (s - duration_);
    }
    return o_.amplitude * std::cos(2 * pi * turns + o_.phase);
  }
  double next_break(double t) const override { return first_after(t, {o_.start, o_.start + duration_, end_}); }
  bool constant(double begin, double end) const override { return end <= o_.start || begin >= end_; }

private:
  Harmonic o_;
  double end_, duration_;
};

class SeriesSignal final : public Signal {
public:
  explicit SeriesSignal(const Series& o) : points_(o.table) {}
  double at(double t, double inside) const override {
    const auto next = after(inside);
    if (next == points_.begin() || next == points_.end()) return 0;
    const Series::Point &a = *(next - 1), &b = *next;
    return a.force + (b.force - a.force) * (t - a.time) / (b.time - a.time);
  }
  double next_break(double t) const override {
    const auto next = after(t);
    return next == points_.end() ? never : next->time;
  }
  bool constant(double begin, double end) const override {
    return end <= points_.front().time || begin >= points_.back().time;
  }

private:
  [[nodiscard]] std::vector<Series::Point>::const_iterator after(double t) const {
    return std::upper_bound(points_.begin(), points_.end(), t,
                            [](double time, const Series::Point& p) { return time < p.time; });
  }
  std::vector<Series::Point> points_;
};

// A number of N(0, 1) for each seed and index: two mixes of SplitMix64 (Steele, Lea and Flood 2014) through Box and
// Muller's formula.
double normal(std::uint64_t seed, std::uint64_t index) {
  const auto mix = [](std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  };
  constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ULL;
  const std::uint64_t stream = mix(golden * (seed + 1));
  const auto uniform = [&](std::uint64_t k) {  // in (0, 1)
    return (static_cast<double>(mix(stream + golden * (k + 1)) >> 11) + 0.5) * 0x1p-53;
  };
  return std::sqrt(-2 * std::log(uniform(2 * index))) * std::cos(2 * pi * uniform(2 * index + 1));
}

double gain_of(const Random& o) {
  return o.rms / ButterworthLowPass(1.0 / o.oversampling).noise_gain();
}

class RandomSignal final : public Signal {
public:
  explicit RandomSignal(const Random& o)
      : o_(o), rate_(o.oversampling * o.cutoff), filter_(1.0 / o.oversampling), gain_(gain_of(o)) {}
  double at(double t, double inside) const override {
    if (inside < o_.start) return 0;
    const double k = std::floor((inside - o_.start) * rate_);
    const double x = (t - o_.start) * rate_ - k;
    const auto n = static_cast<std::size_t>(k);
    const double a = n > 0 ? sample(n - 1) : 0, b = sample(n), c = sample(n + 1), d = sample(n + 2);
    return b + x / 2 * (c - a + x * (2 * a - 5 * b + 4 * c - d + x * (3 * (b - c) + d - a)));
  }
  double next_break(double t) const override {
    if (t < o_.start) return o_.start;
    const double k = std::floor((t - o_.start) * rate_) + 1, next = o_.start + k / rate_;
    return next > t ? next : o_.start + (k + 1) / rate_;
  }
  bool constant(double /*begin*/, double end) const override { return end <= o_.start; }
  void prepare(double end) override {
    if (end < o_.start) return;
    const auto wanted = static_cast<std::size_t>(std::ceil((end - o_.start) * rate_)) + 3;
    while (samples_.size() < wanted)
      samples_.push_back(gain_ * filter_.next(normal(static_cast<std::uint64_t>(o_.seed), samples_.size())));
  }

private:
  [[nodiscard]] double sample(std::size_t k) const {
    core::require(k < samples_.size(), "a random signal is prepared before it is asked for");
    return samples_[k];
  }
  Random o_;
  double rate_;
  ButterworthLowPass filter_;
  double gain_;
  std::vector<double> samples_;
};

}  // namespace

std::unique_ptr<Signal> make_signal(const SignalOptions& options) {
  struct Make {
    std::unique_ptr<Signal> operator()(const Step& o) const { return std::make_unique<StepSignal>(o); }
    std::unique_ptr<Signal> operator()(const Impulse& o) const { return std::make_unique<ImpulseSignal>(o); }
    std::unique_ptr<Signal> operator()(const Harmonic& o) const { return std::make_unique<HarmonicSignal>(o); }
    std::unique_ptr<Signal> operator()(const Random& o) const { return std::make_unique<RandomSignal>(o); }
    std::unique_ptr<Signal> operator()(const Series& o) const { return std::make_unique<SeriesSignal>(o); }
  };
  return std::visit(Make{}, options);
}

double interpolation_gain(const Random& o, double frequency) {
  const double f = frequency / (o.oversampling * o.cutoff);
  const auto sinc = [](double x) { return std::sin(pi * x) / (pi * x); };
  if (f < 1e-4) return 1;
  // Fourier transform of the kernel of the cubic through four samples, slopes by central differences.
  const double square = (pi * f) * (pi * f), one = sinc(f), two = sinc(2 * f);
  return (3 * (one * one - two) - (3 * two * two - 2 * two - sinc(4 * f))) / square;
}

double spectral_density(const Random& o, double frequency) {
  const double rate = o.oversampling * o.cutoff, gain = gain_of(o), between = interpolation_gain(o, frequency);
  return 2 / rate * gain * gain * ButterworthLowPass(1.0 / o.oversampling).power_gain(frequency / rate) * between *
         between;
}

void describe(deck::Description<Step>& d) {
  d.add("amplitude", &Step::amplitude, "N", deck::any, "force, against the direction if negative").required();
  d.add("start", &Step::start, "s", deck::non_negative, "time at which it begins");
  d.add("end", &Step::end, "s", deck::positive, "time at which it ends; it stays if not given");
  d.add("rise", &Step::rise, "s", deck::non_negative, "time that it takes to begin and to end; 0 for a jump");
  d.check([](const Step& o, const deck::Report& r) {
    if (o.end && *o.end < o.start + o.rise)
      r.fail("end", "the force ends before it has begun: 'end' follows 'start' and 'rise'");
  });
}

void describe(deck::Description<Impulse>& d) {
  d.add("amplitude", &Impulse::amplitude, "N", deck::any, "largest force, against the direction if negative")
      .required();
  d.add("start", &Impulse::start, "s", deck::non_negative, "time at which it begins");
  d.add("duration", &Impulse::duration, "s", deck::positive, "time that it takes").required();
}

void describe(deck::Description<Harmonic>& d) {
  d.add("amplitude", &Harmonic::amplitude, "N", deck::any, "amplitude 0-peak of the force").required();
  d.add("frequency", &Harmonic::frequency, "Hz", deck::non_negative, "its frequency, at the start of a sweep")
      .required();
  d.add("phase", &Harmonic::phase, "rad", deck::any, "ahead of a cosine at the start");
  d.add("start", &Harmonic::start, "s", deck::non_negative, "time at which it begins");
  d.add("end", &Harmonic::end, "s", deck::positive, "time at which it ends; it goes on if not given");
  d.add("sweep_to", &Harmonic::sweep_to, "Hz", deck::non_negative, "frequency at the end of a sweep, which stays then");
  d.add("sweep_duration", &Harmonic::sweep_duration, "s", deck::positive,
        "time in which the frequency changes evenly from the one to the other");
  d.check([](const Harmonic& o, const deck::Report& r) {
    if (o.end && *o.end <= o.start) r.fail("end", "the force ends before it has begun: 'end' follows 'start'");
    if (o.sweep_to.has_value() != o.sweep_duration.has_value())
      r.fail(o.sweep_to ? "sweep_to" : "sweep_duration", "a sweep needs both 'sweep_to' and 'sweep_duration'");
  });
}

void describe(deck::Description<Random>& d) {
  d.add("rms", &Random::rms, "N", deck::positive, "root mean square of the filtered force").required();
  d.add("cutoff", &Random::cutoff, "Hz", deck::positive, "frequency at which the low pass halves the power");
  d.add("oversampling", &Random::oversampling, deck::in(3, 100),
        "samples per period of the cut-off frequency; each costs at least one step in time");
  d.add("seed", &Random::seed, deck::in(0, 1e9), "which noise; forces of equal seeds are the same noise");
  d.add("start", &Random::start, "s", deck::non_negative, "time at which it begins");
}

void describe(deck::Description<Series::Point>& d) {
  d.add("time", &Series::Point::time, "s", deck::non_negative, "since the beginning of the motion; rising").required();
  d.add("force", &Series::Point::force, "N", deck::any, "force at that time").required();
}

void describe(deck::Description<Series>& d) {
  d.table("table", &Series::table, "the force over the time; zero before the first and after the last point")
      .required();
  d.check([](const Series& o, const deck::Report& r) {
    if (o.table.size() < 2) r.fail("table", "a series needs at least two points");
    for (std::size_t k = 1; k < o.table.size(); ++k)
      if (!(o.table[k].time > o.table[k - 1].time))
        return r.fail("table", "the times of row " + std::to_string(k) + " and row " + std::to_string(k + 1) +
                                   " do not rise: each point is later than the one before");
  });
}

}  // namespace whirl::transient
