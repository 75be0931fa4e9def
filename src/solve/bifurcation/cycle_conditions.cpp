// Conditions of cycles by their monodromy matrix M. A motion v from x(0) and weights w of its end give the gradient of
// w . M v as the sum of second derivatives of all collocation equations along the cycle.

#include <cmath>
#include <limits>
#include <optional>

#include "solve/bifurcation/bordered_monodromy.hpp"
#include "solve/bifurcation/condition_fold.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The corner for M - sign I.
double corner(double sign, BorderedMonodromy& bordered) {
  bordered.solve({-sign, 1});
  return bordered.g(0, 0);
}

// A multiplier of -1 beside another at -1 shows in w . v of its null vectors, beside one at +1 in the slope dp/ds of
// the branch; the cycles of twice the period turn round where the cubic coefficient of the normal form vanishes.
class FlipCondition : public Condition {
public:
  explicit FlipCondition(CycleProblem& problem) : problem_(problem), bordered_(problem, 1) {
    (void)corner(-1, bordered_);
    bordered_.update();
  }
  VectorXd values(Vec, const VectorXd&) override { return VectorXd::Constant(1, corner(-1, bordered_)); }
  void derivatives(Vec u, const VectorXd&, MatrixXd& d_inner, std::vector<core::Vector>& gradients) override {
    d_inner.resize(1, 0);
    gradients =
        problem_.gradients(u, problem_.forward(bordered_.v.col(0)), {problem_.backward(bordered_.left().col(0))});
  }
  void update() override { bordered_.update(); }
  std::vector<CodimensionTest> tests(Vec u, const VectorXd&, Vec along) override {
    const double slope = last_entry(problem_.comm(), along);
    std::vector<CodimensionTest> all = {{"resonance_1_2", bordered_.left().col(0).dot(bordered_.v.col(0))},
                                        {"fold_flip", slope}};
    if (!problem_.options().autonomous) all.push_back({generalised_flip, slope * cubic(u)});
    return all;
  }

private:
  // Smooth along the curve: neither normalised by w . v, which vanishes at a resonance 1:2, nor by I - M, which is
  // singular where the slope of the branch vanishes.
  double cubic(Vec u) {
    VectorXd v = bordered_.v.col(0).normalized();
    v *= std::sqrt(static_cast<double>(v.size()));
    try {
      return flip_cubic(problem_, u, v, bordered_.left().col(0).normalized());
    } catch (const core::NotConverged&) {
      return std::numeric_limits<double>::quiet_NaN();
    } catch (const core::DomainError&) {
      return std::numeric_limits<double>::quiet_NaN();
    }
  }

  CycleProblem& problem_;
  BorderedMonodromy bordered_;
};

class CyclicFoldCondition : public FoldCondition {
public:
  explicit CyclicFoldCondition(CycleProblem& problem) : FoldCondition(problem, problem), cycles_(problem) {}
  std::vector<CodimensionTest> tests(Vec u, const VectorXd& inner, Vec along) override {
    std::vector<CodimensionTest> all = FoldCondition::tests(u, inner, along);
    if (!flip_) flip_.emplace(cycles_, 1);
    all.push_back({"fold_flip", corner(-1, *flip_)});
    // The trivial multiplier of a self-excited cycle makes +1 double at every fold.
    if (!cycles_.options().autonomous) {
      if (!one_) one_.emplace(cycles_, 1);
      (void)corner(1, *one_);
      all.push_back({"resonance_1_1", one_->left().col(0).dot(one_->v.col(0))});
    }
    return all;
  }

private:
  CycleProblem& cycles_;
  std::optional<BorderedMonodromy> one_, flip_;  // made when asked for: a location does without
};

// With k = (w^T v, w^T M v) made orthonormal as the two combinations n_k of the corner: near the bifurcation the corner
// is ((trace - 2 kappa) M_2 + (1 - det) I) in the bases of the critical pair, M_2 its block of M.
class NeimarkSackerCondition : public Condition {
public:
  NeimarkSackerCondition(CycleProblem& problem, std::complex<double> multiplier)
      : problem_(problem), kappa_(multiplier.real() / std::abs(multiplier)), bordered_(problem, 2) {
    bordered_.solve({1, -2 * kappa_, 1});
    bordered_.update();
    bordered_.solve({1, -2 * kappa_, 1});
    choose();
  }
  VectorXd start() const override { return VectorXd::Constant(1, kappa_); }
  VectorXd values(Vec, const VectorXd& inner) override {
    bordered_.solve({1, -2 * inner(0), 1});
    return VectorXd{{(n_[0].array() * bordered_.g.array()).sum(), (n_[1].array() * bordered_.g.array()).sum()}};
  }
  void derivatives(Vec u, const VectorXd& inner, MatrixXd& d_inner, std::vector<core::Vector>& gradients) override {
    Composition& m = problem_.composition();
    const MatrixXd &v = bordered_.v, &w = bordered_.left(), mv = m.times(v);
    d_inner.resize(2, 1);
    gradients.clear();
    // d(n : g) = -sum_j y_j . (M' (M - 2 kappa) + M M') v_j + 2 dkappa y_j . M v_j, y = w n
    const MatrixXd y[2] = {w * n_[0], w * n_[1]};
    for (int k = 0; k < 2; ++k) d_inner(k, 0) = 2 * (y[k].array() * mv.array()).sum();
    for (Index j = 0; j < 2; ++j) {
      const VectorXd other = mv.col(j) - 2 * inner(0) * v.col(j);
      std::vector<MatrixXd> direct, through;
      for (int k = 0; k < 2; ++k) {
        direct.push_back(problem_.backward(y[k].col(j)));
        through.push_back(problem_.backward(m.times_transposed(y[k].col(j))));
      }
      add(problem_.gradients(u, problem_.forward(other), direct), gradients);
      add(problem_.gradients(u, problem_.forward(v.col(j)), through), gradients);
    }
  }
  void update() override {
    bordered_.update();
    // In the new bases, which span the same spaces.
    choose();
  }
  std::vector<CodimensionTest> tests(Vec, const VectorXd& inner, Vec along) override {
    return {{"resonance_1_1", inner(0) - 1},
            {"resonance_1_2", inner(0) + 1},
            {"resonance_1_3", inner(0) + 0.5},
            {"resonance_1_4", inner(0)},
            {"fold_neimark_sacker", last_entry(problem_.comm(), along)}};
  }

private:
  void choose() {
    const MatrixXd& w = bordered_.left();
    n_[0] = w.transpose() * bordered_.v;
    n_[1] = w.transpose() * problem_.composition().times(bordered_.v);
    n_[0] /= n_[0].norm();
    n_[1] -= (n_[0].array() * n_[1].array()).sum() * n_[0];
    n_[1] /= n_[1].norm();
  }
  static void add(std::vector<core::Vector> more, std::vector<core::Vector>& sum) {
    if (sum.empty()) {
      sum = std::move(more);
      return;
    }
    for (std::size_t k = 0; k < sum.size(); ++k) check(VecAXPY(sum[k].get(), 1, more[k].get()));
  }

  CycleProblem& problem_;
  double kappa_;
  BorderedMonodromy bordered_;
  MatrixXd n_[2];
};

}  // namespace

std::unique_ptr<Condition> PeriodicProblem::condition(Event /*event*/, std::complex<double> /*critical*/) {
  return nullptr;
}

std::unique_ptr<Condition> CycleProblem::condition(Event event, std::complex<double> critical) {
  switch (event) {
    case Event::cyclic_fold:
      return make_cyclic_fold(*this);
    case Event::flip:
      return make_flip(*this);
    case Event::neimark_sacker:
      return make_neimark_sacker(*this, critical);
    default:
      return nullptr;
  }
}

std::unique_ptr<Condition> make_cyclic_fold(CycleProblem& problem) {
  return std::make_unique<CyclicFoldCondition>(problem);
}

std::unique_ptr<Condition> make_flip(CycleProblem& problem) {
  return std::make_unique<FlipCondition>(problem);
}

std::unique_ptr<Condition> make_neimark_sacker(CycleProblem& problem, std::complex<double> multiplier) {
  return std::make_unique<NeimarkSackerCondition>(problem, multiplier);
}

}  // namespace whirl::solve
