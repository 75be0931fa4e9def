#include <cmath>
#include <functional>
#include <limits>

#include "solve/bifurcation/critical_vectors.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/solve/newton/adjoint.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Complex = std::complex<double>;

// A motion (x, dx/dt), scaled and whole on every rank; real or complex.
template <class T>
struct StateAndRate {
  Eigen::VectorX<T> value, rate;
};
using RealVector = Eigen::VectorXd;

const double third_order_length = std::pow(std::numeric_limits<double>::epsilon(), 0.25);

StateAndRate<double> part(const StateAndRate<Complex>& m, bool imaginary) {
  if (imaginary) return {m.value.imag(), m.rate.imag()};
  return {m.value.real(), m.rate.real()};
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
  using Real = StateAndRate<double>;
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
  ComplexVector second(const StateAndRate<Complex>& a, const StateAndRate<Complex>& b) {
    const Real ar = part(a, false), ai = part(a, true), br = part(b, false), bi = part(b, true);
    const RealVector rr = second(ar, br), ii = second(ai, bi), ri = second(ar, bi), ir = second(ai, br);
    return rr - ii + Complex(0, 1) * (ri + ir);
  }

private:
  // to = from + factor * scale * v
  void put(Vec from, double factor, const RealVector& v, Vec to) const {
    PetscInt begin = 0;
    check(VecGetOwnershipRange(x_, &begin, nullptr));
    const core::ReadArray f(from), s(state_scale_.get());
    const core::WriteArray t(to);
    for (PetscInt i = 0; i < t.size(); ++i) t[i] = f[i] + factor * s[i] * v(begin + i);
  }
  RealVector combine(const std::vector<std::pair<double, double>>& steps, const Real& a, const Real& b) {
    RealVector sum = RealVector::Zero(a.value.size());
    for (const auto& [h, weight] : steps) {
      put(x_, h, a.value, at_.get());
      put(rest_.get(), h, a.rate, rate_.get());
      for (const bool rates : {false, true}) {
        system_.jacobian(0, at_.get(), rate_.get(), rates ? 0 : 1, rates ? 1 : 0, jacobian_.get());
        put(rest_.get(), 1, rates ? b.rate : b.value, direction_.get());
        check(MatMult(jacobian_.get(), direction_.get(), y_.get()));
        check(VecPointwiseDivide(y_.get(), y_.get(), residual_scale_.get()));
        const std::vector<double> whole = core::gather(y_.get());
        sum += weight * Eigen::Map<const RealVector>(whole.data(), sum.size());
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
  FrequencyResolvent shifted(system);
  shifted.linearise(x);
  const auto [q, p] = critical_vectors(shifted, omega);
  const Complex i(0, 1);
  const auto with_rate = [](const ComplexVector& v, Complex exponent) {
    return StateAndRate<Complex>{v, exponent * v};
  };
  const StateAndRate<Complex> forward = with_rate(q, i * omega), backward = with_rate(q.conjugate(), -i * omega);
  Derivatives f(system, x, step, q.cwiseAbs().maxCoeff());
  const ComplexVector qq = -f.second(forward, forward), qc = -f.second(forward, backward);
  shifted.factorise({0, 2 * omega});
  const ComplexVector h20 = shifted.solve(qq);
  shifted.factorise(0);
  const ComplexVector h11 = shifted.solve(qc);
  const ComplexVector mean = f.second(forward, with_rate(h11, 0)),
                      twice = f.second(backward, with_rate(h20, 2.0 * i * omega));
  const StateAndRate<double> r = part(forward, false), s = part(forward, true);
  const ComplexVector cubic = f.third(r, r) + f.third(s, r) + i * (f.third(r, s) + f.third(s, s));
  return (-p.dot(cubic + 2.0 * mean + twice) / (2.0 * p.dot(shifted.rates_times(q)))).real();
}

}  // namespace whirl::solve
