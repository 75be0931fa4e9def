#include "transient/steps/stages.hpp"

#include <algorithm>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"

namespace whirl::transient {

using core::check;

Eigen::VectorXd embedded_weights(const solve::Tableau& t) {
  core::require(t.order == 4 && t.stages() == 5, "the estimate is that of the scheme of order 4");
  Eigen::MatrixXd conditions(4, 4);
  conditions.row(0).setOnes();
  conditions.row(1) = t.c.head(4);
  conditions.row(2) = t.c.head(4).cwiseAbs2();
  conditions.row(3) = (t.a * t.c).head(4);
  const Eigen::VectorXd wanted = Eigen::Vector4d(1, 1.0 / 2, 1.0 / 3, 1.0 / 6);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(5);
  b.head(4) = core::DenseLu<double>(conditions).solve(wanted);
  return b;
}

Eigen::MatrixXd continuous_weights(const solve::Tableau& t) {
  core::require(t.order == 4 && t.stages() == 5, "the continuation is that of the scheme of order 4");
  Eigen::MatrixXd conditions(5, 5);
  conditions.row(0).setOnes();
  conditions.row(1) = t.c;
  conditions.row(2) = t.c.cwiseAbs2();
  conditions.row(3) = t.a * t.c;
  conditions.row(4) = t.c.array().cube();
  Eigen::MatrixXd wanted = Eigen::MatrixXd::Zero(5, 4);
  wanted(0, 0) = 1;
  wanted(1, 1) = 1.0 / 2;
  wanted(2, 2) = 1.0 / 3;
  wanted(3, 2) = 1.0 / 6;
  wanted(4, 3) = 1.0 / 4;
  return core::DenseLu<double>(conditions).solve(wanted);
}

StageTangents::StageTangents(Equations& equations, const solve::Tableau& tableau)
    : equations_(equations), tableau_(tableau), estimate_(tableau.b - embedded_weights(tableau)) {
  z_ = equations.make_state();
  rhs_ = equations.make_state();
  for (Eigen::Index i = 0; i < tableau.stages(); ++i) {
    values_.push_back(equations.make_state());
    slopes_.push_back(equations.make_state());
  }
  matrix_ = equations.make_matrix();
  at_rest_ = equations.make_matrix();
  check(KSPCreate(equations.system().comm(), solver_.put()));
  check(KSPSetOptionsPrefix(solver_.get(), "motion_tangents_"));
  equations.configure(solver_.get());
  check(KSPSetFromOptions(solver_.get()));
}

void StageTangents::keep(PetscInt stage, Vec value) {
  check(VecCopy(value, values_[static_cast<std::size_t>(stage)].get()));
}

double StageTangents::propagate(double time, double length, Vec u, const Tangents& tangents) {
  const auto directions = static_cast<std::size_t>(tangents.count());
  const std::size_t stages = values_.size();
  while (deviations_.size() < directions) {
    deviations_.emplace_back();
    for (std::size_t i = 0; i < stages; ++i) deviations_.back().push_back(equations_.make_state());
    ends_.push_back(equations_.make_state());
  }
  const auto a = [&](std::size_t i, std::size_t j) {
    return length * tableau_.a(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  };
  for (std::size_t i = 0; i < stages; ++i) {
    const double own = a(i, i), at = time + length * tableau_.c(static_cast<Eigen::Index>(i));
    Vec slope = slopes_[i].get();
    check(VecCopy(u, z_.get()));
    for (std::size_t j = 0; j < i; ++j) check(VecAXPY(z_.get(), a(i, j), slopes_[j].get()));
    check(VecWAXPY(slope, -1, z_.get(), values_[i].get()));
    check(VecScale(slope, 1 / own));
    equations_.jacobian(at, values_[i].get(), slope, own, 1, matrix_.get());
    equations_.jacobian(at, values_[i].get(), slope, 1, 0, at_rest_.get());
    check(KSPSetOperators(solver_.get(), matrix_.get(), matrix_.get()));
    for (std::size_t k = 0; k < directions; ++k) {
      auto& dk = deviations_[k];
      check(VecCopy(tangents.column(static_cast<int>(k)), z_.get()));
      for (std::size_t j = 0; j < i; ++j) check(VecAXPY(z_.get(), a(i, j), dk[j].get()));
      check(MatMult(at_rest_.get(), z_.get(), rhs_.get()));
      check(VecScale(rhs_.get(), -1));
      check(KSPSolve(solver_.get(), rhs_.get(), dk[i].get()));
      if (i + 1 == stages) check(VecWAXPY(ends_[k].get(), own, dk[i].get(), z_.get()));
    }
  }
  double largest = 0;
  for (std::size_t k = 0; k < directions; ++k) {
    check(VecSet(rhs_.get(), 0));
    for (std::size_t i = 0; i < stages; ++i)
      check(VecAXPY(rhs_.get(), length * estimate_(static_cast<Eigen::Index>(i)), deviations_[k][i].get()));
    double error = 0, before = 0;
    check(VecNorm(rhs_.get(), NORM_2, &error));
    check(VecNorm(tangents.column(static_cast<int>(k)), NORM_2, &before));
    largest = std::max(largest, error / before);
  }
  return largest;
}

void StageTangents::accept(Tangents& tangents) {
  for (int k = 0; k < tangents.count(); ++k)
    check(VecCopy(ends_[static_cast<std::size_t>(k)].get(), tangents.column(k)));
}

void StageTangents::make_consistent(double time, double length, Vec u, Tangents& tangents) {
  check(VecSet(z_.get(), 0));
  equations_.jacobian(time, u, z_.get(), length, 1, matrix_.get());
  equations_.jacobian(time, u, z_.get(), 0, 1, at_rest_.get());
  check(KSPSetOperators(solver_.get(), matrix_.get(), matrix_.get()));
  for (int k = 0; k < tangents.count(); ++k) {
    check(MatMult(at_rest_.get(), tangents.column(k), rhs_.get()));
    check(KSPSolve(solver_.get(), rhs_.get(), tangents.column(k)));
  }
}

}  // namespace whirl::transient
