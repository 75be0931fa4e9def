#include "transient/steps/gauss.hpp"

#include <cmath>

#include "whirl/core/dense_lu.hpp"
#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::transient {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr int most_sweeps = 60;

// A^-1 and b of collocation: x_l = x_0 + h sum a(l,j) K_j inverts h K_j = sum_l slope(j,l) (x_l - x_0).
solve::Tableau gauss(int stages) {
  const solve::Scheme s = solve::make_scheme(stages, solve::Points::gauss);
  Eigen::VectorXd c = s.c, b(stages);
  MatrixXd powers(stages, stages), a(stages, stages), right(stages, stages);
  // sum_j a_ij c_j^(k-1) = c_i^k/k, sum_j b_j c_j^(k-1) = 1/k.
  Eigen::VectorXd whole(stages);
  for (Index k = 0; k < stages; ++k) {
    const auto power = static_cast<double>(k + 1);
    powers.row(k) = c.transpose().array().pow(power - 1);
    right.row(k) = c.transpose().array().pow(power) / power;
    whole(k) = 1 / power;
  }
  const core::DenseLu<double> lu(powers);
  a = lu.solve(right).transpose();
  b = lu.solve(whole);
  return {a, b, c, 2 * stages};
}

}  // namespace

GaussSteps::GaussSteps(Equations& equations, int stages, double tolerance)
    : equations_(equations),
      tableau_(gauss(stages)),
      tolerance_(tolerance),
      inverse_(core::DenseLu<double>(tableau_.a).inverse()),
      lower_(core::DenseLu<double>(solve::lower_factor(tableau_.a)).inverse()),
      end_weights_(inverse_.transpose() * tableau_.b),
      slope_(equations.make_state()),
      work_(equations.make_state()),
      rates_(equations.make_matrix()) {
  for (int i = 0; i < stages; ++i) {
    for (auto* list : {&values_, &changes_, &residuals_}) list->push_back(equations.make_state());
    matrices_.push_back(equations.make_matrix());
    solvers_.push_back(equations.make_solver("gauss_"));
  }
}

bool GaussSteps::attempt(double time, double length, Vec u) {
  const auto stages = values_.size();
  const auto entry = [](const MatrixXd& m, std::size_t i, std::size_t j) {
    return m(static_cast<Index>(i), static_cast<Index>(j));
  };
  for (auto& v : values_) check(VecCopy(u, v.get()));
  check(VecSet(slope_.get(), 0));
  equations_.jacobian(time, u, slope_.get(), 0, 1, rates_.get());
  for (std::size_t i = 0; i < stages; ++i)
    equations_.jacobian(time, u, slope_.get(), 1, entry(lower_, i, i) / length, matrices_[i].get());
  double last = 0;
  for (int k = 0; k < most_sweeps; ++k) {
    for (std::size_t i = 0; i < stages; ++i) {
      check(VecSet(slope_.get(), 0));
      for (std::size_t j = 0; j < stages; ++j) {
        check(VecWAXPY(work_.get(), -1, u, values_[j].get()));
        check(VecAXPY(slope_.get(), entry(inverse_, i, j) / length, work_.get()));
      }
      equations_.residual(time + length * tableau_.c(static_cast<Index>(i)), values_[i].get(), slope_.get(),
                          residuals_[i].get());
    }
    double moved = 0;
    for (std::size_t i = 0; i < stages; ++i) {
      check(VecSet(slope_.get(), 0));
      for (std::size_t j = 0; j < i; ++j) check(VecAXPY(slope_.get(), entry(lower_, i, j) / length, changes_[j].get()));
      check(MatMult(rates_.get(), slope_.get(), work_.get()));
      check(VecAYPX(work_.get(), -1, residuals_[i].get()));
      if (!equations_.solve(solvers_[i].get(), matrices_[i].get(), work_.get(), changes_[i].get())) return false;
      double norm = 0;
      check(VecNorm(changes_[i].get(), NORM_2, &norm));
      moved = std::max(moved, norm);
    }
    for (std::size_t i = 0; i < stages; ++i) check(VecAXPY(values_[i].get(), -1, changes_[i].get()));
    moved /= std::sqrt(static_cast<double>(equations_.system().size()));
    if (!std::isfinite(moved) || (k > 5 && moved > 10 * last)) return false;
    if (moved <= tolerance_) return true;
    last = moved;
  }
  return false;
}

Taken GaussSteps::step(double time, double wanted, Vec u) {
  const Taken taken = take_step(wanted, 1, [&](double h) -> std::optional<double> {
    return attempt(time, h, u) ? std::optional(0.0) : std::nullopt;
  });
  check(VecSet(slope_.get(), 0));
  for (std::size_t i = 0; i < values_.size(); ++i) {
    check(VecWAXPY(work_.get(), -1, u, values_[i].get()));
    check(VecAXPY(slope_.get(), end_weights_(static_cast<Index>(i)), work_.get()));
  }
  check(VecAXPY(u, 1, slope_.get()));
  return {taken.length, taken.length, taken.rejected, taken.why};
}

}  // namespace whirl::transient
