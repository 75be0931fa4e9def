#pragma once
// Spectral densities of sampled signals by Welch's method, and what they tell of the linear system between them.

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace whirl::transient {

/// Segments that overlap by half, each under Hann's window.
struct WelchOptions {
  int segments = 91;
};

/// One-sided densities of n signals in their units: S_ij = 2 <X_i conj(X_j)>/(duration of a segment), averaged over the
/// segments, of signals without their means.
struct SpectralMatrix {
  double resolution = 0;  ///< between lines [1/unit of the sampling interval]
  int samples = 0;        ///< of a segment
  int segments = 0;
  /// Number of independent segments that scatter as much as these do: neighbours under Hann's window share 1/36 of
  /// their power, so that 91 count as 86.3.
  double averages = 0;
  std::vector<Eigen::MatrixXcd> lines;  ///< S [n x n] at frequencies k resolution, k = 0 to samples/2

  [[nodiscard]] double frequency(std::size_t line) const { return static_cast<double>(line) * resolution; }
};

/// Of `signals` of equal length [samples >= (segments + 1)/2 x 4], sampled every `interval`. Samples at the end that
/// fill no segment are left out. Source: Welch (1967), IEEE Trans. Audio Electroacoust. 15, 70.
[[nodiscard]] SpectralMatrix spectral_matrix(const std::vector<std::vector<double>>& signals, double interval,
                                             const WelchOptions& options = {});

/// Averages of `segments` segments of `samples` samples under Hann's window that overlap by half: segments/(1 + 2
/// sum_j (1 - j/segments) rho_j), rho_j the square of the windows' normalised correlation. Source: Welch (1967).
[[nodiscard]] double equivalent_averages(int segments, int samples);

/// An interval in which a number lies with a given probability.
struct Bounds {
  double low = 0, high = 0;
};

/// Estimates at one line of q inputs f and p outputs g = H f + noise.
struct LineEstimate {
  Eigen::MatrixXcd h1;         ///< S_gf S_ff^-1 [p x q]: noise at the outputs does not shift it
  Eigen::MatrixXcd h2;         ///< S_gg S_fg^-1 [p x q]: noise at the inputs does not; empty unless p = q
  Eigen::MatrixXd ordinary;    ///< |S_gf|^2/(S_gg S_ff) of each output and input [p x q]
  Eigen::VectorXd multiple;    ///< of each output and all inputs together: S_gf S_ff^-1 S_fg/S_gg [p]
  double input_coherence = 0;  ///< largest ordinary coherence between two inputs
  Eigen::MatrixXd radius;      ///< |H - h1| is at most this, each with the probability asked for [p x q]
};

/// The estimates from S of the signals (f_1 ... f_q, g_1 ... g_p) at one line. With n averages
///
///     radius^2 = (a^(-1/(n - q)) - 1) (1 - gamma^2) S_gg [S_ff^-1]_jj,    a = 1 - probability,
///
/// the F distribution of 2 and 2 (n - q) degrees of freedom in closed form: for one coefficient at a time.
/// Where no input has power at a line all is zero and the radius infinite.
/// Source: Bendat and Piersol (2010), Random Data, secs. 7.4 and 9.3; for one input eq. (9.90) there.
[[nodiscard]] LineEstimate estimate(const Eigen::MatrixXcd& s, int inputs, double averages, double probability);

/// Interval of the coherence that an estimate `coherence` from `inputs` inputs stands for, by Fisher's z =
/// artanh(gamma) with the mean shifted by q/(2 (n - q)) and the variance 1/(2 (n - q)); ordinary coherence: one input.
/// Source: Bendat and Piersol (2010), sec. 9.2.3; the shift for several inputs by the same argument.
[[nodiscard]] Bounds coherence_bounds(double coherence, int inputs, double averages, double probability);

/// What unrelated signals exceed with the probability 1 - `probability`: 1 - a^(1/(n - 1)) for one input, and the beta
/// distribution of q and n - q for more.
[[nodiscard]] double coherence_of_chance(int inputs, double averages, double probability);

}  // namespace whirl::transient
