#include "transient/steps/stages.hpp"

#include <cmath>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/local_part.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"

namespace whirl::transient {

using core::check;
using core::get;
using core::put;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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
    : equations_(equations),
      tableau_(tableau),
      estimate_(tableau.b - embedded_weights(tableau)),
      to_slopes_(core::DenseLu<double>(tableau.a).inverse().transpose()) {
  for (core::Vector* v : {&z_, &rhs_, &change_}) *v = equations.make_state();
  matrix_ = equations.make_matrix();
  at_rest_ = equations.make_matrix();
  solver_ = equations.make_solver("motion_tangents_");
}

double StageTangents::propagate(double time, double length, Vec u, Stepper& stepper, const Tangents& tangents) {
  const Index s = tableau_.stages();
  const VectorXd start = get(u);
  MatrixXd values(start.size(), s), before(start.size(), tangents.count());
  for (Index i = 0; i < s; ++i) values.col(i) = get(stepper.stage(static_cast<int>(i)));
  for (int k = 0; k < tangents.count(); ++k) before.col(k) = get(tangents.column(k));
  const MatrixXd slopes = (values.colwise() - start) * to_slopes_ / length;
  solve::carry_stages(tableau_, 1, length, before, w_, slopes_, [&](Index i, const MatrixXd& w, auto dk) {
    const double own = length * tableau_.a(i, i), at = time + length * tableau_.c(i);
    put(values.col(i), z_.get());
    put(slopes.col(i), rhs_.get());
    equations_.jacobian(at, z_.get(), rhs_.get(), own, 1, matrix_.get());
    equations_.jacobian(at, z_.get(), rhs_.get(), 1, 0, at_rest_.get());
    check(KSPSetOperators(solver_.get(), matrix_.get(), matrix_.get()));
    for (Index k = 0; k < w.cols(); ++k) {
      put(-w.col(k), z_.get());
      check(MatMult(at_rest_.get(), z_.get(), rhs_.get()));
      check(KSPSolve(solver_.get(), rhs_.get(), change_.get()));
      dk.col(k) = get(change_.get());
    }
  });
  ends_ = before;
  MatrixXd error = MatrixXd::Zero(before.rows(), before.cols());
  for (Index i = 0; i < s; ++i) {
    const auto dk = slopes_.middleRows(i * before.rows(), before.rows());
    ends_ += length * tableau_.b(i) * dk;
    error += length * estimate_(i) * dk;
  }
  MatrixXd sums(2, before.cols());
  sums.row(0) = error.colwise().squaredNorm();
  sums.row(1) = before.colwise().squaredNorm();
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM,
                equations_.system().comm());
  return std::sqrt((sums.row(0).array() / sums.row(1).array()).maxCoeff());
}

void StageTangents::accept(Tangents& tangents) {
  for (int k = 0; k < tangents.count(); ++k) put(ends_.col(k), tangents.column(k));
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
