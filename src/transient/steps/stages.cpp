#include "transient/steps/stages.hpp"

#include <cmath>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/local_part.hpp"

namespace whirl::transient {

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
  const VectorXd wanted = (VectorXd(4) << 1, 1.0 / 2, 1.0 / 3, 1.0 / 6).finished();
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
      stage_(equations.make_stage()) {}

double StageTangents::propagate(double time, double length, const SdirkSteps& steps, const Tangents& tangents) {
  const Index s = tableau_.stages();
  MatrixXd before(steps.start().size(), tangents.count());
  for (int k = 0; k < tangents.count(); ++k) before.col(k) = get(tangents.column(k));
  solve::carry_stages(tableau_, 1, length, before, w_, slopes_, [&](Index i, const MatrixXd& w, auto dk) {
    const VectorXd value = steps.start() + length * (steps.slopes() * tableau_.a.row(i).transpose());
    equations_.keep(*stage_, time + length * tableau_.c(i), length * tableau_.a(i, i), value, steps.slopes().col(i));
    stage_->slopes(w, false, dk);
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

// (E + h J)^-1 E v = v + h dk with J (v + h dk) + E dk = 0.
void StageTangents::make_consistent(double time, double length, Vec u, Tangents& tangents) {
  const VectorXd value = get(u);
  equations_.keep(*stage_, time, length, value, VectorXd::Zero(value.size()));
  MatrixXd dk(value.size(), 1);
  for (int k = 0; k < tangents.count(); ++k) {
    const VectorXd v = get(tangents.column(k));
    stage_->slopes(v, false, dk);
    put(v + length * dk, tangents.column(k));
  }
}

}  // namespace whirl::transient
