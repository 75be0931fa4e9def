#include "solve/cycle/spread_interval.hpp"

#include <cmath>

#include "whirl/core/agree.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/index.hpp"

namespace whirl::solve {

using core::at;
using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

SpreadStep::SpreadStep(MPI_Comm comm, PetscInt local, const Scheme& scheme)
    : comm_(comm), scheme_(&scheme), gate_(comm) {
  core::require(scheme.points == Points::radau, "intervals spread over ranks have Radau points");
  const Index m = scheme.degree;
  triangle_ =
      lower_factor(core::DenseLu<double>(scheme.slope.rightCols(m)).inverse()).inverse().triangularView<Eigen::Lower>();
  shift_ = std::pow(triangle_.diagonal().prod(), 1 / static_cast<double>(m));
  one_ = core::make_vector(comm, local, PETSC_DETERMINE);
  other_ = core::duplicate(one_.get());
  const auto size = static_cast<PetscInt>(m * local);
  rhs_ = core::make_vector(comm, size, PETSC_DETERMINE);
  answer_ = core::duplicate(rhs_.get());
  shell_ = core::make_shell(comm, size, gate_, [this](Vec v, Vec y) {
    const core::ReadArray x(v);
    const core::WriteArray out(y);
    interval_->multiply(nullptr, x.data(), out.data());
    if (held_) hold(*interval_->blocks_[0]->layout(), out.data(), scheme_->degree);
  });
  solver_ = core::make_krylov(shell_.get(), gate_, {.prefix = "interval_", .type = KSPFGMRES, .most = 200},
                              [this](Vec r, Vec y) {
                                const core::ReadArray in(r);
                                const core::WriteArray out(y);
                                interval_->precondition(in.data(), out.data());
                              });
}

void SpreadStep::hold(const PortLayout& layout, double* v, Index k) {
  VectorXd parts(layout.parts()), hub(layout.hub());
  for (Index c = 0; c < k; ++c) {
    double* column = v + c * layout.local();
    layout.take(column, parts.data(), hub.data());
    hub.setZero();
    layout.give(parts.data(), hub.data(), column);
  }
}

// With B = D + own J, J X = (B X - D X)/own.
void SpreadInterval::multiply(const double* start, const double* x, double* y) const {
  const Scheme& s = step_.scheme();
  const Index m = s.degree, n = blocks_[0]->layout()->local();
  const Map<const MatrixXd> nodes(x, n, m);
  VectorXd slope(n), part(n);
  for (Index j = 0; j < m; ++j) {
    const double own = this->own(j);
    slope.noalias() = nodes * s.slope.row(j).tail(m).transpose();
    if (start) slope += s.slope(j, 0) * Map<const VectorXd>(start, n);
    slope = slope / length_ - nodes.col(j) / own;
    rates_[at(j)]->multiply(slope.data(), part.data());
    Map<VectorXd> out(y + j * n, n);
    blocks_[at(j)]->multiply(x + j * n, out.data());
    out = out / own + part;
  }
}

// Point by point: B X_j = own (r_j - D/H sum_(l<j) triangle(j,l) X_l).
void SpreadInterval::precondition(const double* r, double* x) const {
  const Index m = step_.scheme().degree, n = blocks_[0]->layout()->local();
  const Map<MatrixXd> nodes(x, n, m);
  VectorXd earlier(n), part(n);
  for (Index j = 0; j < m; ++j) {
    part = Map<const VectorXd>(r + j * n, n);
    if (j > 0) {
      earlier.noalias() = nodes.leftCols(j) * step_.triangle().row(j).head(j).transpose() / -length_;
      VectorXd rates(n);
      rates_[at(j)]->multiply(earlier.data(), rates.data());
      part += rates;
    }
    {
      const core::WriteArray a(step_.one_.get());
      Map<VectorXd>(a.data(), n) = own(j) * part;
    }
    PortElimination& point = *similar_[similar_.size() > 1 ? at(j) : 0];
    if (step_.held_)
      point.solve_held(step_.one_.get(), step_.other_.get());
    else
      point.solve(step_.one_.get(), step_.other_.get());
    const core::ReadArray a(step_.other_.get());
    Map<VectorXd>(x + j * n, n) = Map<const VectorXd>(a.data(), n);
  }
}

void SpreadInterval::solve(MatrixXd& x, double tolerance, bool held) const {
  SpreadStep& s = step_;
  s.interval_ = this;
  s.held_ = held;
  check(KSPSetTolerances(s.solver_.get(), tolerance, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT));
  const auto fail = [&s] {
    core::agree(s.comm_, [] { throw core::DomainError("the linearised equations of an interval were not solved"); });
  };
  for (Index k = 0; k < x.cols(); ++k) {
    {
      const core::WriteArray a(s.rhs_.get());
      Map<VectorXd>(a.data(), x.rows()) = x.col(k);
    }
    try {
      s.gate_.rethrow(KSPSolve(s.solver_.get(), s.rhs_.get(), s.answer_.get()));
    } catch (const core::NotConverged&) {
      fail();
    }
    if (core::reason_of(s.solver_.get()) < 0) fail();
    const core::ReadArray a(s.answer_.get());
    x.col(k) = Map<const VectorXd>(a.data(), x.rows());
  }
}

}  // namespace whirl::solve
