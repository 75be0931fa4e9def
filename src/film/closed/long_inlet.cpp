// Long film with p = 0 at the top: h^3 dp/dtheta = l(theta) = 2 nu x v + k, nu = (cos, sin) theta, and k = -6 (e x
// v)/(2 + e^2) makes p periodic. The map z' = (z - delta)/(1 - conj(delta) z) of the unit circle, delta = e/(1 + sqrt(1
// - e^2)), is Sommerfeld's substitution about any e: with z' = exp(i zeta), r dtheta = h dzeta and both 1/h and nu/h
// are trigonometric polynomials of degree 1 in zeta. Integration by parts therefore leaves polynomials of degree 3.
#include "film/closed/long_inlet.hpp"

#include <cmath>
#include <complex>
#include <numbers>

namespace whirl::film {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

double cross(const Complex& a, const Complex& b) {
  return a.real() * b.imag() - a.imag() * b.real();
}
double dot(const Complex& a, const Complex& b) {
  return a.real() * b.real() + a.imag() * b.imag();
}

class InletIntegrals {
public:
  InletIntegrals(const Complex& e, const Complex& v)
      : e_(e),
        v_(v),
        r_(std::sqrt(1.0 - std::norm(e))),
        delta_(e / (1.0 + r_)),
        s_(2.0 + std::norm(e)),
        k_(-6.0 * cross(e, v) / s_),
        w_((2.0 * v + e * dot(e, v)) / s_) {
    const double n = std::norm(delta_);
    over_h_ = (1.0 + n) / ((1.0 - n) * (1.0 - n));
  }

  Impedance evaluate();

private:
  struct Point {
    Complex nu;
    double inverse_h;
  };
  [[nodiscard]] Point point(double zeta) const {
    const Complex z = std::polar(1.0, zeta), below = 1.0 + std::conj(delta_) * z;
    return {(z + delta_) / below, over_h_ * std::norm(below)};
  }
  [[nodiscard]] double zeta(const Complex& z) const { return std::arg((z - delta_) / (1.0 - std::conj(delta_) * z)); }
  [[nodiscard]] double pressure(const Point& at) const { return dot(at.nu, w_) * at.inverse_h * (1.0 + at.inverse_h); }
  [[nodiscard]] double root(double falling, double from, double to, double level) const;

  Complex e_, v_;
  double r_;
  Complex delta_;
  double s_, k_;
  Complex w_;
  double over_h_;
};

// Where the pressure passes `level` between two extremes, by Newton's method within a shrinking bracket.
double InletIntegrals::root(double falling, double from, double to, double level) const {
  double x = 0.5 * (from + to);
  for (int i = 0; i < 100 && to - from > 4e-16 * (1.0 + std::abs(x)); ++i) {
    const Point at = point(x);
    const double excess = pressure(at) - level;
    (excess * falling > 0.0 ? from : to) = x;
    const double slope = (2.0 * cross(at.nu, v_) + k_) * at.inverse_h * at.inverse_h / r_;
    const double next = x - excess / slope;
    const bool inside = next > from && next < to;
    if (inside && std::abs(next - x) <= 2e-16 * (1.0 + std::abs(x))) return next;
    x = inside ? next : 0.5 * (from + to);
  }
  return x;
}

Impedance InletIntegrals::evaluate() {
  // l = 0 at the extremes of p; the highest pressure is where the journal moves to.
  const double beta = std::arg(v_), lag = std::asin(-0.5 * k_ / std::abs(v_));
  const double low = zeta(std::polar(1.0, beta - pi + lag));
  const auto after = [low](double x) { return low + (x - low) - 2.0 * pi * std::floor((x - low) / (2.0 * pi)); };
  const double high = after(zeta(std::polar(1.0, beta - lag))), top = after(zeta(Complex(0.0, 1.0)));
  const double level = pressure(point(top));
  const bool rising = top <= high;  // at the inlet
  const double other = rising ? root(1.0, high, low + 2.0 * pi, level) : root(-1.0, low, high, level);
  const double from = rising ? top : other, to = rising ? other : top;
  const Complex free = point(other).nu;

  // int nu dp dtheta = i int (nu - nu_free) dp' dtheta: dp vanishes at the inlet, nu - nu_free at the other end.
  Impedance out;
  const Complex i_unit(0.0, 1.0);
  constexpr int kNodes = 7;  // interpolate degree 3 exactly
  const std::array<Complex, 2> axes = {Complex(1.0, 0.0), i_unit};
  for (int n = 0; n < kNodes; ++n) {
    const double node = 2.0 * pi * n / kNodes;
    double weight = to - from;
    for (int k = 1; k <= 3; ++k) weight += 2.0 / k * (std::sin(k * (to - node)) - std::sin(k * (from - node)));
    weight /= kNodes;
    const Point at = point(node);
    const double slow = weight * at.inverse_h * at.inverse_h / r_;  // dtheta/h^3
    const double l = 2.0 * cross(at.nu, v_) + k_;
    const Complex arm = -3.0 * i_unit * (at.nu - free);
    for (std::size_t j = 0; j < 2; ++j) {
      const double l_v = 2.0 * cross(at.nu, axes[j]) - 6.0 * cross(e_, axes[j]) / s_;
      const double k_e = (-6.0 * cross(axes[j], v_) - 2.0 * k_ * dot(e_, axes[j])) / s_;
      const Complex by_v = arm * (slow * l_v);
      const Complex by_e = arm * (slow * (k_e + 3.0 * l * dot(at.nu, axes[j]) * at.inverse_h));
      out.d_squeeze[0][j] += by_v.real();
      out.d_squeeze[1][j] += by_v.imag();
      out.d_eccentricity[0][j] += by_e.real();
      out.d_eccentricity[1][j] += by_e.imag();
    }
  }
  for (std::size_t i = 0; i < 2; ++i) out.force[i] = out.d_squeeze[i][0] * v_.real() + out.d_squeeze[i][1] * v_.imag();
  return out;
}

}  // namespace

Impedance long_inlet_film(const Pair& e, const Pair& v) {
  return InletIntegrals({e[0], e[1]}, {v[0], v[1]}).evaluate();
}

}  // namespace whirl::film
