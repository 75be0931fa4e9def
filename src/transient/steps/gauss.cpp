#include "transient/steps/gauss.hpp"

#include <cmath>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/index.hpp"
#include "whirl/core/local_part.hpp"
#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::transient {

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
      stages_(static_cast<std::size_t>(stages)) {
  forget();
}

void GaussSteps::forget() {
  for (auto& stage : stages_) stage = equations_.make_stage();
}

// With E = dF/d(du/dt), J = dF/du, own = h/l_ii and A = E + own J a change is own A^-1 (F - E s), where A^-1 E s = s +
// own dk with J (s + own dk) + E dk = 0.
bool GaussSteps::attempt(double time, double length) {
  const Index n = start_.size(), stages = tableau_.stages();
  values_ = start_.replicate(1, stages);
  changes_.resize(n, stages);
  residuals_.resize(n, stages);
  moved_.resize(n, 1);
  slope_.setZero(n);
  for (Index i = 0; i < stages; ++i)
    equations_.keep(*stages_[core::at(i)], time, length / lower_(i, i), start_, slope_);
  double last = 0;
  for (int k = 0; k < most_sweeps; ++k) {
    for (Index i = 0; i < stages; ++i) {
      slope_ = (values_.colwise() - start_) * inverse_.row(i).transpose() / length;
      value_ = values_.col(i);
      equations_.residual(*stages_[core::at(i)], time + length * tableau_.c(i), value_, slope_, f_);
      residuals_.col(i) = f_;
    }
    double moved = 0;
    for (Index i = 0; i < stages; ++i) {
      const double own = length / lower_(i, i);
      f_ = residuals_.col(i);
      stages_[core::at(i)]->solve(f_, equations_.tolerance());
      if (i > 0) {
        slope_ = changes_.leftCols(i) * lower_.row(i).head(i).transpose() / length;
        stages_[core::at(i)]->slopes(slope_, false, moved_);
        f_ -= slope_ + own * moved_;
      }
      changes_.col(i) = own * f_;
      const double part = equations_.root_mean(changes_.col(i).squaredNorm());
      if (!std::isfinite(part)) return false;
      moved = std::max(moved, part);
    }
    values_ -= changes_;
    if (k > 5 && moved > 10 * last) return false;
    if (moved <= tolerance_) return true;
    last = moved;
  }
  return false;
}

Taken GaussSteps::step(double time, double wanted, Vec u) {
  core::get(u, start_);
  const Taken taken = take_step(wanted, 1, [&](double h) -> std::optional<double> {
    return attempt(time, h) ? std::optional(0.0) : std::nullopt;
  });
  core::put(start_ + (values_.colwise() - start_) * end_weights_, u);
  return {taken.length, taken.length, taken.rejected, taken.why};
}

}  // namespace whirl::transient
