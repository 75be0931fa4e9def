#include "study/locus/amplitude_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "whirl/core/least_squares.hpp"

namespace whirl::study {

AtZeroAmplitude at_zero_amplitude(const std::vector<double>& amplitudes, const std::vector<double>& values) {
  const auto n = static_cast<Eigen::Index>(amplitudes.size());
  const Eigen::Map<const Eigen::ArrayXd> a(amplitudes.data(), n);
  const Eigen::Map<const Eigen::VectorXd> v(values.data(), n);
  const Eigen::ArrayXd square = (a / a.maxCoeff()).square();
  const auto powers = [&](Eigen::Index terms) {
    Eigen::MatrixXd m(n, terms);
    for (Eigen::Index k = 0; k < terms; ++k) m.col(k) = square.pow(static_cast<double>(k)).matrix();
    return m;
  };
  const auto fit = [](const Eigen::MatrixXd& m, const Eigen::VectorXd& right) -> Eigen::VectorXd {
    return core::least_squares(m, right);
  };
  const Eigen::Index terms = n < 4 ? 2 : 3, others = n > terms ? terms + 1 : terms - 1;
  const Eigen::MatrixXd m = powers(terms);
  const Eigen::VectorXd c = fit(m, v);
  double left_out = 0;
  for (Eigen::Index k = 0; n > terms && k < n; ++k) {
    Eigen::MatrixXd rows(n - 1, terms);
    Eigen::VectorXd right(n - 1);
    rows << m.topRows(k), m.bottomRows(n - 1 - k);
    right << v.head(k), v.tail(n - 1 - k);
    left_out = std::max(left_out, std::abs(fit(rows, right)(0) - c(0)));
  }
  const double next_power = std::abs(fit(powers(others), v)(0) - c(0));
  return {c(0), (v - m * c).cwiseAbs().maxCoeff() + left_out + next_power};
}

}  // namespace whirl::study
