#include "film/closed/impedance.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numbers>
#include <string>

#include "film/closed/long_inlet.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

double dot(const Pair& a, const Pair& b) {
  return a[0] * b[0] + a[1] * b[1];
}

// Integrals over the half circle -pi/2 < chi < pi/2 about the squeeze direction, h = 1 - a cos chi - b sin chi:
// I = int 1/h = 2 A/r with A = atan((1 + a - b)/r) + atan((1 + a + b)/r), r^2 = 1 - a^2 - b^2. Every derivative of I is
// polynomial in a, b, q = 1/r^2, B = 1/(1 - b^2) and g = A/r^3, since r dA = da + a b B db.
struct HalfCircle {
  double a, b, q, B, g;
  HalfCircle(double along, double across) : a(along), b(across) {
    const double r2 = 1.0 - a * a - b * b, r = std::sqrt(r2);
    q = 1.0 / r2;
    B = 1.0 / (1.0 - b * b);
    g = (std::atan2(1.0 + a - b, r) + std::atan2(1.0 + a + b, r)) / (r2 * r);
  }
  [[nodiscard]] double I() const { return 2.0 * g / q; }
  [[nodiscard]] double I_a() const { return 2.0 * (q + a * g); }
  [[nodiscard]] double I_b() const { return 2.0 * b * (a * q * B + g); }
};

// Impedance components along and across the squeeze velocity with their derivatives in a and b.
struct Components {
  Pair value;
  std::array<Pair, 2> d;
};

// Short: W = (L/D)^2 (I_aa, I_ab), which is 2 (L/D)^2 int (cos^2, cos sin)/h^3.
Components short_components(const HalfCircle& c, double ld) {
  const double a = c.a, b = c.b, q = c.q, B = c.B, g = c.g, q2 = q * q, scale = ld * ld;
  const double aab =
      a * b * q2 * (24.0 * q + 2.0 * B + 6.0 * a * a * B * q) + 6.0 * b * q * g * (1.0 + 5.0 * a * a * q);
  const double aaa = 8.0 * q2 + 30.0 * a * a * q2 * q + a * q * g * (18.0 + 30.0 * a * a * q);
  const double abb = q2 * (4.0 + 2.0 * a * a * B) * (1.0 + 4.0 * b * b * q) +
                     a * a * b * b * B * q2 * (4.0 * B + 6.0 * q) + a * q * g * (6.0 + 30.0 * b * b * q);
  return {{scale * (6.0 * a * q2 + 2.0 * g * (1.0 + 3.0 * a * a * q)),
           scale * b * (q2 * (4.0 + 2.0 * a * a * B) + 6.0 * a * q * g)},
          {{{scale * aaa, scale * aab}, {scale * aab, scale * abb}}}};
}

// Long, about the direction of greatest pressure slope: W = 3 int (cos^2, cos sin)(1/h + 1/h^2) = 3 q ((1 - b^2) I + 2
// a, b (a I + 2)).
Components long_components(const HalfCircle& c) {
  const double a = c.a, b = c.b, q = c.q, I = c.I(), I_a = c.I_a(), I_b = c.I_b();
  const double u = (1.0 - b * b) * I + 2.0 * a, w = b * (a * I + 2.0);
  return {
      {3.0 * q * u, 3.0 * q * w},
      {{{3.0 * q * (2.0 * a * q * u + (1.0 - b * b) * I_a + 2.0),
         3.0 * q * (2.0 * b * q * u + (1.0 - b * b) * I_b - 2.0 * b * I)},
        {3.0 * q * (2.0 * a * q * w + b * (I + a * I_a)), 3.0 * q * (2.0 * b * q * w + a * I + 2.0 + a * b * I_b)}}}};
}

// From components about a velocity v to x, y. Turning v by d(beta) turns the components and moves (a, b) by (b, -a)
// d(beta), and |v| d(beta) is the step across v: no division by |v|.
template <class Law>
Impedance resolve(const Pair& e, const Pair& v, const Law& law) {
  const double size = std::hypot(v[0], v[1]);
  const Pair n = {v[0] / size, v[1] / size}, t = {-n[1], n[0]};
  const double a = dot(e, n), b = dot(e, t);
  const Components W = law(HalfCircle(a, b));
  const std::array<Pair, 2> axes = {n, t};
  const std::array<Pair, 2> turn = {{{W.value[0], b * W.d[0][0] - a * W.d[0][1] - W.value[1]},
                                     {W.value[1], b * W.d[1][0] - a * W.d[1][1] + W.value[0]}}};
  Impedance out;
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      out.force[i] -= size * axes[k][i] * W.value[k];
      for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t l = 0; l < 2; ++l) {
          out.d_eccentricity[i][j] -= size * axes[k][i] * W.d[k][l] * axes[l][j];
          out.d_squeeze[i][j] -= axes[k][i] * turn[k][l] * axes[l][j];
        }
    }
  }
  return out;
}

Impedance short_film(double ld, const Pair& e, const Pair& v) {
  return resolve(e, v, [ld](const HalfCircle& c) { return short_components(c, ld); });
}

// The pressure of the long film is that of a squeeze along w = (2 v + e (e . v))/(2 + e^2), cos chi (1/h + 1/h^2).
Impedance long_film(const Pair& e, const Pair& v) {
  const double s = 2.0 + dot(e, e), ev = dot(e, v);
  const Pair w = {(2.0 * v[0] + e[0] * ev) / s, (2.0 * v[1] + e[1] * ev) / s};
  const Impedance inner = resolve(e, w, long_components);
  Impedance out;
  out.force = inner.force;
  out.d_eccentricity = inner.d_eccentricity;
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t j = 0; j < 2; ++j) {
      const double same = k == j ? 1.0 : 0.0;
      const double w_v = (2.0 * same + e[k] * e[j]) / s, w_e = (same * ev + e[k] * v[j] - 2.0 * w[k] * e[j]) / s;
      for (std::size_t i = 0; i < 2; ++i) {
        out.d_squeeze[i][j] += inner.d_squeeze[i][k] * w_v;
        out.d_eccentricity[i][j] += inner.d_squeeze[i][k] * w_e;
      }
    }
  return out;
}

struct Harmonic {
  double value, d_x, d_y;
};

// 1/(1/x + 1/y); where the signs differ and that has a pole, the continuation x y (x + y)/(x^2 + y^2) with the same
// value and slopes where either changes its sign.
Harmonic harmonic_sum(double x, double y) {
  if (x == 0.0 && y == 0.0) return {0.0, 0.25, 0.25};
  if (x * y >= 0.0) {
    const double s = 1.0 / (x + y);
    return {x * y * s, y * y * s * s, x * x * s * s};
  }
  const double s = 1.0 / (x * x + y * y), value = x * y * (x + y) * s;
  return {value, (y * (2.0 * x + y) - 2.0 * x * value) * s, (x * (x + 2.0 * y) - 2.0 * y * value) * s};
}

// Moes and Bosma (1981): harmonic sums of the components along and across the eccentricity.
Impedance finite_film(double ld, const Pair& e, const Pair& v) {
  const Impedance s = short_film(ld, e, v), l = long_film(e, v);
  const double eps = std::hypot(e[0], e[1]);
  // Short and long film are both isotropic at the centre: any axes do on which neither component vanishes.
  const bool centred = eps < 1e-9;
  const Pair u = centred ? Pair{v[0] - v[1], v[0] + v[1]} : e;
  const double norm = 1.0 / std::hypot(u[0], u[1]);
  const std::array<Pair, 2> axes = {{{norm * u[0], norm * u[1]}, {-norm * u[1], norm * u[0]}}};
  Impedance out;
  std::array<Harmonic, 2> h;
  for (std::size_t k = 0; k < 2; ++k) {
    h[k] = harmonic_sum(dot(axes[k], s.force), dot(axes[k], l.force));
    for (std::size_t i = 0; i < 2; ++i) {
      out.force[i] += axes[k][i] * h[k].value;
      for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t m = 0; m < 2; ++m) {
          const double to = axes[k][i] * axes[k][m];
          out.d_eccentricity[i][j] += to * (h[k].d_x * s.d_eccentricity[m][j] + h[k].d_y * l.d_eccentricity[m][j]);
          out.d_squeeze[i][j] += to * (h[k].d_x * s.d_squeeze[m][j] + h[k].d_y * l.d_squeeze[m][j]);
        }
    }
  }
  if (centred) return out;
  // The axes turn with the eccentricity.
  const double along = h[0].d_x * dot(axes[1], s.force) + h[0].d_y * dot(axes[1], l.force) - h[1].value;
  const double across = h[0].value - h[1].d_x * dot(axes[0], s.force) - h[1].d_y * dot(axes[0], l.force);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      out.d_eccentricity[i][j] += (axes[0][i] * along + axes[1][i] * across) * axes[1][j] / eps;
  return out;
}

void require_inside(const Pair& e) {
  const double eps = std::hypot(e[0], e[1]);
  if (!(eps < 1.0)) throw core::DomainError("eccentricity is not below 1: " + fmt::format("{:.9g}", eps));
}

}  // namespace

Impedance impedance(ClosedForm kind, double ld, const Pair& e, const Pair& v) {
  require_inside(e);
  const double size = std::hypot(v[0], v[1]), eps = std::hypot(e[0], e[1]);
  const Pair unit = size > 0.0  ? Pair{v[0] / size, v[1] / size}
                    : eps > 0.0 ? Pair{e[1] / eps, -e[0] / eps}
                                : Pair{1.0, 0.0};
  Impedance out;
  switch (kind) {
    case ClosedForm::short_bearing:
      out = short_film(ld, e, unit);
      break;
    case ClosedForm::long_bearing:
      out = long_film(e, unit);
      break;
    case ClosedForm::long_inlet:
      out = long_inlet_film(e, unit);
      break;
    case ClosedForm::finite_approximate:
      out = finite_film(ld, e, unit);
      break;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    out.force[i] *= size;
    for (std::size_t j = 0; j < 2; ++j) out.d_eccentricity[i][j] *= size;
  }
  return out;
}

double mid_pressure(ClosedForm kind, double ld, const Pair& e, const Pair& v, double theta) {
  require_inside(e);
  const auto h = [&](double at) { return 1.0 - e[0] * std::cos(at) - e[1] * std::sin(at); };
  const auto along = [&](const Pair& w, double at) { return w[0] * std::cos(at) + w[1] * std::sin(at); };
  if (kind == ClosedForm::short_bearing) return std::max(0.0, ld * ld * along(v, theta) / std::pow(h(theta), 3));
  core::require(kind == ClosedForm::long_bearing || kind == ClosedForm::long_inlet,
                "this kind of film has no pressure");
  const double s = 2.0 + dot(e, e), ev = dot(e, v);
  const Pair w = {(2.0 * v[0] + e[0] * ev) / s, (2.0 * v[1] + e[1] * ev) / s};
  const auto p = [&](double at) { return along(w, at) * (1.0 / h(at) + 1.0 / (h(at) * h(at))); };
  const double inlet = kind == ClosedForm::long_inlet ? p(0.5 * std::numbers::pi) : 0.0;
  return std::max(0.0, p(theta) - inlet);
}

}  // namespace whirl::film
