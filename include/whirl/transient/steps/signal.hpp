#pragma once
// Forces as functions of time: what a deck says of them, and their values.

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::transient {

/// A force f(t) [N] that is smooth between its breaks. Not collective; the same on every rank.
class Signal {
public:
  Signal() = default;
  Signal(const Signal&) = delete;
  Signal& operator=(const Signal&) = delete;
  virtual ~Signal() = default;
  /// f(t) of the smooth piece that holds the time `inside`. At a break this is the limit from the side of `inside`:
  /// so a step that ends at a jump does not see what comes behind it.
  [[nodiscard]] virtual double at(double t, double inside) const = 0;
  /// The first break later than t: a jump of f or of one of its derivatives [s]; infinite if there is none.
  [[nodiscard]] virtual double next_break(double t) const = 0;
  /// f does not change between these times.
  [[nodiscard]] virtual bool constant(double begin, double end) const = 0;
  /// Before values up to `end` are asked for: signals that are made as time passes get as far.
  virtual void prepare(double /*end*/) {}
};

/// `amplitude` between `start` and `end`, if need be with smooth flanks: A s((t - start)/rise) with
/// s(x) = x^3 (10 - 15 x + 6 x^2); the fall begins at `end` and takes as long.
struct Step {
  static constexpr std::string_view key = "step", text = "constant from one time on, or between two times";
  double amplitude = 0;         // N
  double start = 0;             // s
  std::optional<double> end{};  // s
  double rise = 0;              // s, 0: a jump
};

/// Half a wave A sin(pi (t - start)/duration): a momentum of 2 A duration/pi.
struct Impulse {
  static constexpr std::string_view key = "impulse", text = "half a sine";
  double amplitude = 0;  // N
  double start = 0;      // s
  double duration = 0;   // s
};

/// A cos(2 pi (f t' + (f_1 - f) t'^2/(2 D)) + phase), t' = t - start, of frequency f_1 once t' > D; without a sweep of
/// constant frequency.
struct Harmonic {
  static constexpr std::string_view key = "harmonic", text = "of a frequency that need not be that of the shaft";
  double amplitude = 0;                    // N
  double frequency = 0;                    // Hz
  double phase = 0;                        // rad
  double start = 0;                        // s
  std::optional<double> end{};             // s
  std::optional<double> sweep_to{};        // Hz, f_1
  std::optional<double> sweep_duration{};  // s, D
};

/// Gaussian white noise through a low pass.
///
/// Numbers of N(0, 1), `oversampling` x `cutoff` of them a second, made of (seed, number of the sample) alone, pass a
/// Butterworth filter of order four (bilinear, at rest before `start`). Between its samples f is the cubic of
/// Catmull-Rom through four of them, so that a step from sample to sample integrates it exactly. Samples are breaks:
/// an integrator takes at least one step for each.
struct Random {
  static constexpr std::string_view key = "random", text = "white noise through a low pass";
  double rms = 0;        // N, of the samples
  double cutoff = 10e3;  // Hz, at which the filter halves the power
  int oversampling = 4;
  int seed = 1;
  double start = 0;  // s
};

/// Straight lines between the points of a table; zero before its first and after its last one.
struct Series {
  struct Point {
    double time = 0;   // s
    double force = 0;  // N
  };
  static constexpr std::string_view key = "series", text = "straight lines between the points of a table";
  std::vector<Point> table;
};

using SignalOptions = std::variant<Step, Impulse, Harmonic, Random, Series>;

void describe(deck::Description<Step>& d);
void describe(deck::Description<Impulse>& d);
void describe(deck::Description<Harmonic>& d);
void describe(deck::Description<Random>& d);
void describe(deck::Description<Series>& d);
void describe(deck::Description<Series::Point>& d);

[[nodiscard]] std::unique_ptr<Signal> make_signal(const SignalOptions& options);

/// What the cubic between the samples of a Random signal makes of their Fourier transform at `frequency` [Hz], below
/// half the sample rate: 0.94 at a quarter of it. Source: Keys (1981), IEEE Trans. Acoust. Speech Signal Process. 29,
/// 1153, with a = -1/2.
[[nodiscard]] double interpolation_gain(const Random& options, double frequency);

/// One-sided power spectral density of a Random signal at `frequency` [N^2/Hz]: that of the noise, times the power
/// gains of filter and interpolation.
[[nodiscard]] double spectral_density(const Random& options, double frequency);

}  // namespace whirl::transient
