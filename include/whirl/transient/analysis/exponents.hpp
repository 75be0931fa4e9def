#pragma once
// Lyapunov exponents from the growth of deviations, with their uncertainty.

#include <vector>

namespace whirl::transient {

/// Means over time of the growth of orthonormalised deviations: lambda_k = sum log |R_kk|/sum duration [1/s].
///
/// Growth is kept span by span (a span is a revolution, say). Source: Benettin et al. (1980), Meccanica 15, 9.
class Exponents {
public:
  explicit Exponents(int count) : count_(count) {}

  /// The growth log |R_kk| of one span [count] and its duration [s].
  void add(const std::vector<double>& growth, double duration);
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] std::size_t spans() const { return durations_.size(); }

  /// lambda_k of the first `spans` spans (all by default), in the order of the directions: descending once these have
  /// settled [1/s].
  [[nodiscard]] std::vector<double> values() const { return values(spans()); }
  [[nodiscard]] std::vector<double> values(std::size_t spans) const;
  /// Half the width of the interval that holds the mean with 99 % probability, by the scatter of eight batches of equal
  /// length (Student's t, seven degrees of freedom: 3.499) [1/s]; infinite with fewer than 16 spans. On a cycle all
  /// batches agree, on a torus they differ by what is bounded over their length.
  [[nodiscard]] std::vector<double> uncertainties() const;

  // For checkpoints: growth [spans][count] and durations [spans].
  [[nodiscard]] const std::vector<double>& growth() const { return growth_; }
  [[nodiscard]] const std::vector<double>& durations() const { return durations_; }

private:
  int count_;
  std::vector<double> growth_, durations_;
};

/// j + (lambda_1 + ... + lambda_j)/|lambda_(j+1)| with j the last index of a sum that is not negative; NaN if the sum
/// of the exponents given is still positive. Source: Kaplan and Yorke (1979).
[[nodiscard]] double kaplan_yorke_dimension(const std::vector<double>& exponents);

}  // namespace whirl::transient
