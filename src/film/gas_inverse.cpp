#include "film/gas_inverse.hpp"

#include <algorithm>

namespace whirl::film {

using Eigen::Index;

GasInverse::GasInverse(MPI_Comm comm, int lines, int line, const Share& share, std::vector<int> nodes)
    : comm_(comm),
      begin_(share.begin),
      held_(std::min(share.end, lines * line) - share.begin),
      owns_(!nodes.empty() && share.end > lines * line),
      alone_(held_ == lines * line),
      nodes_(std::move(nodes)),
      ring_(comm, lines, line, Lines{begin_ / line, (begin_ + held_) / line}) {}

void GasInverse::sum_over_ranks(Eigen::Ref<Eigen::MatrixXd> values) const {
  if (!alone_) MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm_);
}

Eigen::VectorXd GasInverse::at_orifices(const double* x) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Index>(nodes_.size()));
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    if (node(k) >= 0) out(static_cast<Index>(k)) = x[node(k)];
  sum_over_ranks(out);
  return out;
}

void GasInverse::set(std::span<const double> d_states, std::span<const double> d_rates, double alpha, double sigma) {
  const std::size_t between = 5 * static_cast<std::size_t>(held_);
  ring_.set(d_states.first(between), d_rates, alpha, sigma);
  const auto count = static_cast<Index>(nodes_.size());
  if (count == 0) return;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(count, 3);
  const double* entry = d_states.data() + between;
  for (Index k = 0; k < count; ++k) {
    if (node(static_cast<std::size_t>(k)) >= 0) all(k, 0) = alpha * *entry++;
    if (!owns_) continue;
    all(k, 1) = alpha * *entry++;
    all(k, 2) = alpha * *entry++;
  }
  sum_over_ranks(all);
  to_node_ = all.col(0);
  to_orifice_ = all.col(1);
  fed_.resize(held_, count);
  Eigen::MatrixXd small = all.col(2).asDiagonal();
  Eigen::VectorXd source = Eigen::VectorXd::Zero(held_);
  const auto nodes = static_cast<std::size_t>(held_);
  for (Index k = 0; k < count; ++k) {
    const int here = node(static_cast<std::size_t>(k));
    if (here >= 0) source(here) = to_node_(k);
    ring_.apply({source.data(), nodes}, {fed_.col(k).data(), nodes});
    if (here >= 0) source(here) = 0;
    small.col(k) -= to_orifice_.cwiseProduct(at_orifices(fed_.col(k).data()));
  }
  small_.compute(small);
}

void GasInverse::apply(std::span<const double> r, std::span<double> x) {
  const auto nodes = static_cast<std::size_t>(held_);
  ring_.apply(r.first(nodes), x.first(nodes));
  const auto count = static_cast<Index>(nodes_.size());
  if (count == 0) return;
  Eigen::VectorXd behind = Eigen::VectorXd::Zero(count);
  if (owns_) behind = Eigen::Map<const Eigen::VectorXd>(r.data() + held_, count);
  sum_over_ranks(behind);
  behind = small_.solve(behind - to_orifice_.cwiseProduct(at_orifices(x.data()))).eval();
  Eigen::Map<Eigen::VectorXd>(x.data(), held_).noalias() -= fed_ * behind;
  if (owns_) Eigen::Map<Eigen::VectorXd>(x.data() + held_, count) = behind;
}

}  // namespace whirl::film
