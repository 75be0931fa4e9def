#include "solve/bifurcation/critical_vectors.hpp"
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
        borders_(generic_vectors(shifted_.size())) {}
  VectorXd start() const override { return VectorXd::Constant(1, omega_); }
  VectorXd values(Vec u, const VectorXd& inner) override {
    problem_.to_state(u, x_.get());
    shifted_.linearise(x_.get());
    const Complex g = null_vectors(shifted_, inner(0), borders_, null_);
    return VectorXd{{g.real(), g.imag()}};
  }
  // dg = -w^* (dA/dx [dx] + i domega dF/d(dx/dt)) v; the motion v exp(i omega t) moves (x, dx/dt) by (v, i omega v).
  void derivatives(Vec u, const VectorXd& inner, MatrixXd& d_inner, std::vector<core::Vector>& gradients) override {
    const ComplexVector &v = null_.q, &w = null_.p, rate_v = Complex(0, inner(0)) * v;
    const Complex by_omega = -Complex(0, 1) * w.dot(shifted_.rates_times(v));
    d_inner.resize(2, 1);
    d_inner << by_omega.real(), by_omega.imag();
    core::Vector direction = core::duplicate(u), rate = core::duplicate(x_.get()), weight = core::duplicate(u),
                 seen = core::duplicate(u);
    gradients.clear();
    for (int k = 0; k < 2; ++k) {
      gradients.push_back(core::duplicate(u));
      check(VecSet(gradients.back().get(), 0.0));
    }
    for (const bool v_real : {true, false}) {
      fill(direction.get(), v_real ? VectorXd(v.real()) : VectorXd(v.imag()));
      fill(rate.get(), v_real ? VectorXd(rate_v.real()) : VectorXd(rate_v.imag()));
      for (const bool w_real : {true, false}) {
        fill(weight.get(), w_real ? VectorXd(w.real()) : VectorXd(-w.imag()));
        problem_.curvature(u, direction.get(), rate.get(), weight.get(), seen.get());
        // -(w_r + i w_i)(v_r + i v_i) with w conjugated already
        const bool imaginary = v_real != w_real;
        const double sign = !v_real && !w_real ? 1 : -1;
        check(VecAXPY(gradients[imaginary ? 1 : 0].get(), sign, seen.get()));
      }
    }
  }
  void update() override {
    borders_ = null_;
    for (ComplexVector* v : {&borders_.q, &borders_.p}) v->normalize();
  }
  std::vector<CodimensionTest> tests(Vec, const VectorXd& inner, Vec along) override {
    return {{"bogdanov_takens", inner(0)}, {"fold_hopf", last_entry(problem_.comm(), along)}};
  }

private:
  // Behind the states of an unknown stands the parameter.
  void fill(Vec to, const VectorXd& states) const {
    PetscInt begin = 0;
    check(VecGetOwnershipRange(x_.get(), &begin, nullptr));
    const core::WriteArray a(to);
    for (PetscInt i = 0; i < a.size(); ++i) a[i] = begin + i < states.size() ? states(begin + i) : 0.0;
  }

  EquilibriumProblem& problem_;
  FrequencyResolvent shifted_;
  core::Vector x_;
  double omega_;
  CriticalVectors borders_, null_;  // c and b; v and w
};

}  // namespace

std::unique_ptr<Condition> make_hopf(problem::System& system, EquilibriumProblem& problem, double omega) {
  return std::make_unique<HopfCondition>(system, problem, omega);
}

}  // namespace whirl::solve
