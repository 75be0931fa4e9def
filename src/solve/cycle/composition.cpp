#include "whirl/solve/cycle/composition.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<MatrixXd> Run::loads() const {
  std::vector<MatrixXd> out = columns;
  for (std::size_t i = 0; i < intervals.size(); ++i) intervals[i]->solve(out[i]);
  return out;
}

void Run::carry(MatrixXd& state, MatrixXd& added, const std::vector<MatrixXd>& loads) const {
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    intervals[i]->carry(rows[i], state, added);
    if (loads.empty()) continue;
    state.rightCols(borders) -= loads[i].bottomRows(n);
    added.rightCols(borders).noalias() -= rows[i] * loads[i];
  }
}

VectorXd Run::drive(const double* rhs, const VectorXd& start, const VectorXd* border, double* x,
                    VectorXd& added) const {
  VectorXd state = start;
  MatrixXd z;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const Index size = rows[i].cols(), offset = static_cast<Index>(i) * size;
    z = -intervals[i]->start(state);
    if (rhs) z += Map<const VectorXd>(rhs + offset, size);
    if (border) z.noalias() -= columns[i] * *border;
    intervals[i]->solve(z);
    if (x) Map<VectorXd>(x + offset, size) = z.col(0);
    added.noalias() += rows[i] * z.col(0);
    state = z.col(0).tail(n);
  }
  return state;
}

VectorXd Run::drive_back(const double* rhs, const VectorXd& lambda, const VectorXd& sigma, double* z,
                         VectorXd& seen) const {
  VectorXd state = lambda;
  MatrixXd part;
  for (std::size_t i = intervals.size(); i-- > 0;) {
    const Index size = rows[i].cols(), offset = static_cast<Index>(i) * size;
    part = -rows[i].transpose() * sigma;
    if (rhs) part += Map<const VectorXd>(rhs + offset, size);
    part.bottomRows(n) += state;
    intervals[i]->solve_transposed(part);
    if (z) Map<VectorXd>(z + offset, size) = part.col(0);
    seen.noalias() += columns[i].transpose() * part.col(0);
    state = -intervals[i]->start_transposed(part);
  }
  return state;
}

}  // namespace whirl::solve
