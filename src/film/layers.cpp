#include "film/layers.hpp"

namespace whirl::film {

Layers::Layers(int n)
    : drag(n),
      pressure(n),
      couette(n),
      cross(n),
      poiseuille(n),
      d_pull(n),
      d_neutral(n),
      d_drag(n, n),
      d_pressure(n, n),
      d_couette(n, n),
      d_cross(n, n),
      d_poiseuille(n, n),
      phi_(n),
      a_(n),
      b_(n) {}

// f_0, f_1 and the integrals of J and I are linear in phi; all else follows from them.
void Layers::set(const Eigen::VectorXd& mu) {
  const Eigen::Index n = mu.size();
  const double d = 1.0 / static_cast<double>(n);
  const auto low = [d](Eigen::Index k) { return d * static_cast<double>(k); };
  const auto moment = [&](Eigen::Index k) { return d * (low(k) + 0.5 * d); };  // int zeta over a layer
  const auto inside = [&](Eigen::Index k) { return 0.5 * low(k) * d * d + d * d * d / 6.0; };
  phi_ = mu.cwiseInverse();
  double f0 = 0.0, f1 = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    a_(k) = d * f0 + 0.5 * d * d * phi_(k);
    b_(k) = d * f1 + inside(k) * phi_(k);
    f0 += d * phi_(k);
    f1 += moment(k) * phi_(k);
  }
  pull = 1.0 / f0;
  neutral = f1 / f0;
  drag = pull * a_;
  pressure = b_ - neutral * a_;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double from = low(k) - neutral, to = from + d;
    const double first = 0.5 * (to * to - from * from), second = (to * to * to - from * from * from) / 3.0;
    couette(k) = phi_(k) * pull * pull * d;
    cross(k) = 2.0 * phi_(k) * pull * first;
    poiseuille(k) = phi_(k) * second;
    for (Eigen::Index m = 0; m < n; ++m) {
      const double by_mu = -phi_(m) * phi_(m);
      const double pull_m = -pull * pull * d * by_mu, neutral_m = (moment(m) - neutral * d) * pull * by_mu;
      const double a_m = by_mu * (m < k ? d * d : m == k ? 0.5 * d * d : 0.0);
      const double b_m = by_mu * (m < k ? d * moment(m) : m == k ? inside(k) : 0.0);
      const double phi_m = m == k ? by_mu : 0.0;
      d_pull(m) = pull_m;
      d_neutral(m) = neutral_m;
      d_drag(k, m) = pull_m * a_(k) + pull * a_m;
      d_pressure(k, m) = b_m - neutral_m * a_(k) - neutral * a_m;
      d_couette(k, m) = d * pull * (phi_m * pull + 2.0 * phi_(k) * pull_m);
      d_cross(k, m) = 2.0 * ((phi_m * pull + phi_(k) * pull_m) * first - phi_(k) * pull * d * neutral_m);
      d_poiseuille(k, m) = phi_m * second - 2.0 * phi_(k) * first * neutral_m;
    }
  }
}

}  // namespace whirl::film
