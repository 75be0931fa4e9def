#include <cmath>
#include <functional>
#include <limits>

#include "solve/newton/shifted_system.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/solve/newton/adjoint.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Complex = std::complex<double>;

// A motion (x, dx/dt), scaled and whole on every rank; real or complex.
template <class T>
struct Motion {
  std::vector<T> value, rate;
};
using RealVector = std::vector<double>;

const double third_order_length = std::pow(std::numeric_limits<double>::epsilon(), 0.25);

RealVector part(const ComplexVector& z, bool imaginary) {
  RealVector out(z.size());
  for (std::size_t k = 0; k < z.size(); ++k) out[k] = imaginary ? z[k].imag() : z[k].real();
  return out;
}

// Derivatives of F in (x, dx/dt) together, at a resting state. Lengths of differences are those of x: rates follow, by
// the frequency.
class Derivatives {
public:
  // The largest scaled state of motions along which differences are taken is `size`.
  Derivatives(problem::System& system, Vec x, double step, double size)
      : system_(system), x_(x), second_(difference_step(size)), third_(step * third_order_length / size) {
    // Differences that are to look over kinks do so in second derivatives as well.
    if (step > 1) second_ = third_;
    rest_ = core::duplicate(x);
    at_ = core::duplicate(x);
    rate_ = core::duplicate(x);
    y_ = core::duplicate(x);
    direction_ = core::duplicate(x);
    state_scale_ = core::duplicate(x);
    residual_scale_ = core::duplicate(x);
    system.scales(state_scale_.get(), residual_scale_.get());
    jacobian_ = system.make_jacobian();
  }
  using Real = Motion<double>;
  // B(a, b) and C(a, a, b), scaled and whole.
  RealVector second(const Real& a, const Real& b) {
    const double h = second_;
    return combine({{h, 1 / (2 * h)}, {-h, -1 / (2 * h)}}, a, b);
  }
  RealVector third(const Real& a, const Real& b) {
    const double h = third_;
    return combine({{h, 1 / (h * h)}, {0, -2 / (h * h)}, {-h, 1 / (h * h)}}, a, b);
  }
  // B of complex motions.
  ComplexVector second(const Motion<Complex>& a, const Motion<Complex>& b) {
    const auto real = [](const Motion<Complex>& m, bool imaginary) {
      return Real{part(m.value, imaginary), part(m.rate, imaginary)};
    };
    const RealVector rr = second(real(a, false), real(b, false)), ii = second(real(a, true), real(b, true)),
                     ri = second(real(a, false), real(b, true)), ir = second(real(a, true), real(b, false));
    ComplexVector out(rr.size());
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = {rr[k] - ii[k], ri[k] + ir[k]};
    return out;
  }

private:
  // to = from + factor * scale * v
  void put(Vec from, double factor, const RealVector& v, Vec to) const {
    PetscInt begin = 0;
    check(VecGetOwnershipRange(x_, &begin, nullptr));
    const core::ReadArray f(from), s(state_scale_.get());
    const core::WriteArray t(to);
    for (PetscInt i = 0; i < t.size(); ++i) t[i] = f[i] + factor * s[i] * v[static_cast<std::size_t>(begin + i)];
  }
  RealVector combine(const std::vector<std::pair<double, double>>& steps, const Real& a, const Real& b) {
    RealVector sum(a.value.size(), 0.0);
    for (const auto& [h, weight] : steps) {
      put(x_, h, a.value, at_.get());
      put(rest_.get(), h, a.rate, rate_.get());
      for (const bool rates : {false, true}) {
        system_.jacobian(0, at_.get(), rate_.get(), rates ? 0 : 1, rates ? 1 : 0, jacobian_.get());
        put(rest_.get(), 1, rates ? b.rate : b.value, direction_.get());
        check(MatMult(jacobian_.get(), direction_.get(), y_.get()));
        check(VecPointwiseDivide(y_.get(), y_.get(), residual_scale_.get()));
        const RealVector whole = core::gather(y_.get());
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * whole[k];
      }
    }
    return sum;
  }

  problem::System& system_;
  Vec x_;
  double second_, third_;
  core::Vector rest_, at_, rate_, y_, direction_, state_scale_, residual_scale_;
  core::Matrix jacobian_;
};

}  // namespace

// With x = z q + conj + z^2 h20/2 + z conj(z) h11 + ..., dx/dt follows from z' = i omega z + c_1 z |z|^2:
//     A(2 i omega) h20 = -B(q, q),  A(0) h11 = -B(q, conj q),
//     2 c_1 p^* E q = -p^* [C(q, q, conj q) + 2 B(q, h11) + B(conj q, h20)],  A(s) = dF/dx + s E, E = dF/d(dx/dt)
double hopf_coefficient(problem::System& system, Vec x, double omega, double step) {
  ShiftedSystem shifted(system);
  shifted.linearise(x);
  const std::size_t n = shifted.size();
  const auto [q, p] = critical_vectors(shifted, omega);
  const Complex i(0, 1);
  const auto with_rate = [&](const ComplexVector& v, Complex exponent) {
    Motion<Complex> m{v, v};
    for (Complex& e : m.rate) e *= exponent;
    return m;
  };
  ComplexVector conjugate = q;
  for (Complex& e : conjugate) e = std::conj(e);
  const Motion<Complex> forward = with_rate(q, i * omega), backward = with_rate(conjugate, -i * omega);
  double size = 0;
  for (const Complex& e : q) size = std::max(size, std::abs(e));
  Derivatives f(system, x, step, size);
  ComplexVector qq = f.second(forward, forward), qc = f.second(forward, backward), h20, h11;
  for (ComplexVector* v : {&qq, &qc})
    for (Complex& e : *v) e = -e;
  Complex unused = 0;
  shifted.factorise(2 * omega);
  shifted.solve(qq, h20, unused);
  shifted.factorise(0);
  shifted.solve(qc, h11, unused);
  const ComplexVector mean = f.second(forward, with_rate(h11, 0)),
                      twice = f.second(backward, with_rate(h20, 2.0 * i * omega));
  const Motion<double> r{part(forward.value, false), part(forward.rate, false)},
      s{part(forward.value, true), part(forward.rate, true)};
  const RealVector rrr = f.third(r, r), ssr = f.third(s, r), rrs = f.third(r, s), sss = f.third(s, s);
  const ComplexVector rates = shifted.rates_times(q);
  Complex above = 0, below = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Complex cubic(rrr[k] + ssr[k], rrs[k] + sss[k]);
    above -= std::conj(p[k]) * (cubic + 2.0 * mean[k] + twice[k]);
    below += 2.0 * std::conj(p[k]) * rates[k];
  }
  return (above / below).real();
}

}  // namespace whirl::solve
