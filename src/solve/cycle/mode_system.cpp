// Products of the composition by time modes, and its small system.

#include "solve/cycle/mode_composition.hpp"
#include "whirl/core/dense_lu.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd ModeComposition::to_lanes(const MatrixXd& by_point, const double* y) const {
  const Index n = run_->n, width = 2 * modes_.lanes;
  const Map<const MatrixXd> points(y, n, local_);
  MatrixXd out(width, n);
  if (size_ == 1) {
    out.noalias() = by_point.transpose() * points.transpose();
    return out;
  }
  std::vector<double> parts(static_cast<std::size_t>(width * n * size_));
  for (int p = 0; p < size_; ++p)
    Map<MatrixXd>(parts.data() + width * n * p, width, n).noalias() =
        by_point.block(first_, p * width, local_, width).transpose() * points.transpose();
  MPI_Reduce_scatter_block(parts.data(), out.data(), static_cast<int>(width * n), MPI_DOUBLE, MPI_SUM, run_->comm);
  return out;
}

void ModeComposition::to_points(const MatrixXd& by_point, const MatrixXd& lanes, double* x) const {
  const Index n = run_->n, width = 2 * modes_.lanes;
  if (size_ == 1) {
    Map<MatrixXd>(x, n, points_).noalias() = lanes.transpose() * by_point.transpose();
    return;
  }
  const MatrixXd part = lanes.transpose() * by_point.middleCols(rank_ * width, width).transpose();
  std::vector<int> counts;
  for (const int c : counts_) counts.push_back(c * static_cast<int>(n));
  MPI_Reduce_scatter(part.data(), x, counts.data(), MPI_DOUBLE, MPI_SUM, run_->comm);
}

MatrixXd ModeComposition::own_lanes(const MatrixXd& by_point, const MatrixXd& y) const {
  return by_point.middleCols(rank_ * 2 * modes_.lanes, 2 * modes_.lanes).transpose() * y;
}

MatrixXd ModeComposition::all_points(const MatrixXd& by_point, const MatrixXd& lanes) const {
  MatrixXd out = by_point.middleCols(rank_ * 2 * modes_.lanes, 2 * modes_.lanes) * lanes;
  if (size_ > 1) MPI_Allreduce(MPI_IN_PLACE, out.data(), static_cast<int>(out.size()), MPI_DOUBLE, MPI_SUM, run_->comm);
  return out;
}

MatrixXd ModeComposition::changes(const MatrixXd& v, bool transposed) const {
  const problem::ThinBlocks& k = *run_->thin->blocks;
  MatrixXd out = MatrixXd::Zero(points_, transposed ? k.c.rows() : k.b.cols());
  for (const Change& c : changes_)
    out.col(transposed ? c.input : c.force).array() += c.values * v.col(transposed ? c.force : c.input).array();
  return out;
}

// The transpose takes the conjugate of each transfer function.
MatrixXd ModeComposition::receptance(const MatrixXd& v, bool transposed) const {
  const Index r = run_->thin->blocks->b.cols(), w = transfer_.cols() / r, lanes = modes_.lanes;
  const MatrixXd &to = transposed ? modes_.seen : modes_.into, &from = transposed ? modes_.into : modes_.seen,
                 in = to.transpose() * v;
  MatrixXd out = MatrixXd::Zero(in.rows(), transposed ? r : w);
  const double sign = transposed ? -1 : 1;
  for (Index a = 0; a < r; ++a)
    for (Index b = 0; b < w; ++b)
      for (Index share = 0; share < in.rows(); share += 2 * lanes) {
        const Index x = transposed ? b : a, y = transposed ? a : b;
        const auto re = transfer_.col(b + w * a).segment(share, lanes).array(),
                   im = transfer_.col(b + w * a).segment(share + lanes, lanes).array(),
                   xr = in.col(x).segment(share, lanes).array(), xi = in.col(x).segment(share + lanes, lanes).array();
        out.col(y).segment(share, lanes).array() += re * xr - sign * im * xi;
        out.col(y).segment(share + lanes, lanes).array() += re * xi + sign * im * xr;
      }
  return from * out;
}

double ModeComposition::dot(const MatrixXd& a, const MatrixXd& b) const {
  double sum = (a.array() * b.array()).sum();
  if (size_ > 1) MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, run_->comm);
  return sum;
}

void ModeComposition::small_product(const double* x, double* y, bool transposed) const {
  const Index nb = run_->borders, r = run_->thin->blocks->b.cols(), size = points_ * r;
  const Map<const MatrixXd> forces(x, points_, r);
  const Map<const VectorXd> border(x + size, nb);
  Map<MatrixXd> out(y, points_, r);
  Map<VectorXd> out_border(y + size, nb);
  if (transposed) {
    out = forces - receptance(changes(forces, true), true);
    out_border = corner_.transpose() * border;
  } else {
    out = forces - changes(receptance(forces));
    out_border = corner_ * border;
  }
  for (Index k = 0; k < nb; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const MatrixXd &loads = transposed ? row_forces_[at] : column_forces_[at],
                   &sees = transposed ? column_forces_[at] : row_forces_[at];
    if (loads.size() > 0) out += border(k) * loads;
    if (sees.size() > 0) out_border(k) += (sees.array() * forces.array()).sum();
  }
}

void ModeComposition::small_solve(MatrixXd& forces, VectorXd& border, bool transposed) {
  const Index size = forces.size(), nb = border.size();
  VectorXd answer(size + nb);
  {
    const core::WriteArray a(right_.get());
    Map<VectorXd>(a.data(), size + nb) << forces.reshaped(), border;
    answer = Map<const VectorXd>(a.data(), size + nb);
  }
  // No communication inside: ranks may differ in their rounding, not in their answer.
  if (rank_ == 0) {
    check(transposed ? KSPSolveTranspose(solver_.get(), right_.get(), answer_.get())
                     : KSPSolve(solver_.get(), right_.get(), answer_.get()));
    if (core::reason_of(solver_.get()) > 0) {
      const core::ReadArray a(answer_.get());
      answer = Map<const VectorXd>(a.data(), size + nb);
    } else {
      MatrixXd dense(size + nb, size + nb);
      VectorXd unit = VectorXd::Zero(size + nb);
      for (Index k = 0; k < size + nb; ++k) {
        unit(k) = 1;
        small_product(unit.data(), dense.col(k).data(), transposed);
        unit(k) = 0;
      }
      answer = core::DenseLu<double>(dense).solve(answer);
    }
  }
  if (size_ > 1) MPI_Bcast(answer.data(), static_cast<int>(size + nb), MPI_DOUBLE, 0, run_->comm);
  forces.reshaped() = answer.head(size);
  border = answer.tail(nb);
}

}  // namespace whirl::solve
