#include <cmath>

#include "solve/newton/shifted_system.hpp"
#include "whirl/solve/bifurcation/condition.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Complex = std::complex<double>;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class HopfCondition : public Condition {
public:
  HopfCondition(problem::System& system, EquilibriumProblem& problem, double omega)
      : problem_(problem),
        shifted_(system),
        x_(core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE)),
        omega_(omega),
        b_(shifted_.size()),
        c_(shifted_.size()) {
    for (std::size_t i = 0; i < b_.size(); ++i) {
      const auto t = static_cast<double>(i);
      b_[i] = {std::sin(1 + t), std::cos(2 + 0.7 * t)};
      c_[i] = {std::cos(3 + 1.3 * t), std::sin(2 + 1.7 * t)};
    }
    normalise(b_);
    normalise(c_);
  }
  VectorXd start() const override { return VectorXd::Constant(1, omega_); }
  VectorXd values(Vec u, const VectorXd& inner) override {
    problem_.to_state(u, x_.get());
    shifted_.linearise(x_.get());
    shifted_.factorise(inner(0), b_, c_);
    const ComplexVector none(shifted_.size());
    Complex g = 1, other = 1;
    shifted_.solve(none, v_, g);
    shifted_.solve_adjoint(none, w_, other);
    return VectorXd{{g.real(), g.imag()}};
  }
  // dg = -w^* (dA/dx [dx] + i domega dF/d(dx/dt)) v; the motion v exp(i omega t) moves (x, dx/dt) by (v, i omega v).
  void derivatives(Vec u, const VectorXd& inner, MatrixXd& d_inner, std::vector<core::Vector>& gradients) override {
    Complex by_omega = 0;
    const ComplexVector rates = shifted_.rates_times(v_);
    for (std::size_t k = 0; k < rates.size(); ++k) by_omega -= std::conj(w_[k]) * Complex(0, 1) * rates[k];
    d_inner.resize(2, 1);
    d_inner << by_omega.real(), by_omega.imag();
    const auto part = [](bool real, Complex z) { return real ? z.real() : z.imag(); };
    core::Vector direction = core::duplicate(u), rate = core::duplicate(x_.get()), weight = core::duplicate(u),
                 seen = core::duplicate(u);
    gradients.clear();
    for (int k = 0; k < 2; ++k) {
      gradients.push_back(core::duplicate(u));
      check(VecSet(gradients.back().get(), 0.0));
    }
    for (const bool v_real : {true, false}) {
      fill(direction.get(), v_, [&](Complex z) { return part(v_real, z); });
      fill(rate.get(), v_, [&](Complex z) { return part(v_real, Complex(0, inner(0)) * z); });
      for (const bool w_real : {true, false}) {
        fill(weight.get(), w_, [&](Complex z) { return part(w_real, std::conj(z)); });
        problem_.curvature(u, direction.get(), rate.get(), weight.get(), seen.get());
        // -(w_r + i w_i)(v_r + i v_i) with w conjugated already
        const bool imaginary = v_real != w_real;
        const double sign = !v_real && !w_real ? 1 : -1;
        check(VecAXPY(gradients[imaginary ? 1 : 0].get(), sign, seen.get()));
      }
    }
  }
  void update() override {
    b_ = w_;
    c_ = v_;
    normalise(b_);
    normalise(c_);
  }
  std::vector<CodimensionTest> tests(Vec, const VectorXd& inner, Vec along) override {
    return {{"bogdanov_takens", inner(0)}, {"fold_hopf", last_entry(problem_.comm(), along)}};
  }

private:
  static void normalise(ComplexVector& z) {
    double sum = 0;
    for (const Complex& e : z) sum += std::norm(e);
    for (Complex& e : z) e /= std::sqrt(sum);
  }
  template <class F>
  void fill(Vec to, const ComplexVector& from, F f) const {
    PetscInt begin = 0;
    check(VecGetOwnershipRange(x_.get(), &begin, nullptr));
    const core::WriteArray a(to);
    for (PetscInt i = 0; i < a.size(); ++i) {
      const auto k = static_cast<std::size_t>(begin + i);
      a[i] = k < from.size() ? f(from[k]) : 0.0;  // behind the states stands the parameter
    }
  }

  EquilibriumProblem& problem_;
  ShiftedSystem shifted_;
  core::Vector x_;
  double omega_;
  ComplexVector b_, c_, v_, w_;
};

}  // namespace

std::unique_ptr<Condition> make_hopf(problem::System& system, EquilibriumProblem& problem, double omega) {
  return std::make_unique<HopfCondition>(system, problem, omega);
}

}  // namespace whirl::solve
