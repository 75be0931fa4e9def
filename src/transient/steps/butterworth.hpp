#pragma once
// A digital low pass.

#include <array>

namespace whirl::transient {

/// Butterworth's low pass of order four as two sections of second order, by the bilinear transform with its cut-off
/// frequency put where it belongs; at rest at the start. Source: Oppenheim and Schafer (2010), Discrete-Time Signal
/// Processing, sec. 7.2.
class ButterworthLowPass {
public:
  /// `cutoff`: frequency at which the power is halved, per sample rate; below 0.5.
  explicit ButterworthLowPass(double cutoff);
  /// The output for the next input.
  double next(double input);
  /// Square of the magnitude of its transfer function at `frequency` per sample rate; zero from 0.5 on is not asked
  /// for: the transfer function of samples repeats itself.
  [[nodiscard]] double power_gain(double frequency) const;
  /// Root mean square of the output for white noise of unit variance.
  [[nodiscard]] double noise_gain() const;

private:
  // y_k = gain (x_k + 2 x_(k-1) + x_(k-2)) - a_1 y_(k-1) - a_2 y_(k-2)
  struct Section {
    double gain, a1, a2;
    std::array<double, 2> x{}, y{};
  };
  std::array<Section, 2> sections_;
};

}  // namespace whirl::transient
