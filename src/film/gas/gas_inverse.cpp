#include "film/gas/gas_inverse.hpp"

#include <algorithm>

namespace whirl::film {

using Eigen::Index;

GasInverse::GasInverse(MPI_Comm comm, int lines, int line, const Share& share, std::vector<int> nodes, int unknowns)
    : comm_(comm),
      begin_(share.begin),
      held_(std::min(share.end, lines * line) - share.begin),
      owns_(unknowns > 0 && share.end > lines * line),
      alone_(held_ == lines * line),
      nodes_(std::move(nodes)),
      ring_(comm, lines, line, Lines{begin_ / line, (begin_ + held_) / line}) {
  std::ranges::sort(nodes_);
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  reads_ = Eigen::MatrixXd::Zero(unknowns, static_cast<Index>(nodes_.size()));
  fed_ = Eigen::MatrixXd::Zero(held_, unknowns);
  const int all = lines * line;
  const auto collect = [&](const Places& places, std::size_t between, bool states) {
    std::size_t k = 0;
    for_entries(share, places, {}, [&](int row, int column, double /*value*/) {
      const std::size_t value = k++;
      if (value < between) return;
      if (row < held_)
        to_node_.push_back({value, row, column - all});
      else if (column < all)
        to_orifice_.push_back({value, row - held_, std::ranges::lower_bound(nodes_, column) - nodes_.begin()});
      else
        (states ? between_ : by_rate_).push_back({value, row - held_, column - all});
    });
  };
  const auto here = static_cast<std::size_t>(held_);
  collect(share.d_states, 5 * here, true);
  collect(share.d_rates, here, false);
}

void GasInverse::sum_over_ranks(Eigen::Ref<Eigen::MatrixXd> values) const {
  if (!alone_) MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, comm_);
}

Eigen::VectorXd GasInverse::read(const double* x) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(static_cast<Index>(nodes_.size()));
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    if (nodes_[k] >= begin_ && nodes_[k] < begin_ + held_) out(static_cast<Index>(k)) = x[nodes_[k] - begin_];
  sum_over_ranks(out);
  return out;
}

void GasInverse::set(const StateDerivatives& at, double alpha, double sigma) {
  const auto nodes = static_cast<std::size_t>(held_);
  ring_.set({at.states.first(5 * nodes), at.rates.first(nodes)}, alpha, sigma);
  const Index count = reads_.rows();
  if (count == 0) return;
  reads_.setZero();
  for (const Entry& e : to_orifice_) reads_(e.row, e.column) += alpha * at.states[e.value];
  sum_over_ranks(reads_);
  Eigen::MatrixXd small = Eigen::MatrixXd::Zero(count, count);
  for (const Entry& e : between_) small(e.row, e.column) += alpha * at.states[e.value];
  for (const Entry& e : by_rate_) small(e.row, e.column) += sigma * at.rates[e.value];
  sum_over_ranks(small);
  Eigen::MatrixXd given = Eigen::MatrixXd::Zero(held_, count);
  for (const Entry& e : to_node_) given(e.row, e.column) += alpha * at.states[e.value];
  for (Index k = 0; k < count; ++k) {
    ring_.apply({given.col(k).data(), nodes}, {fed_.col(k).data(), nodes});
    small.col(k) -= reads_ * read(fed_.col(k).data());
  }
  small_.compute(small);
}

void GasInverse::apply(std::span<const double> r, std::span<double> x) {
  const auto rows = static_cast<std::size_t>(held_ + (owns_ ? reads_.rows() : 0));
  for (std::size_t first = 0; first < r.size(); first += rows)
    apply_to_one(r.subspan(first, rows), x.subspan(first, rows));
}

void GasInverse::apply_to_one(std::span<const double> r, std::span<double> x) {
  const auto nodes = static_cast<std::size_t>(held_);
  ring_.apply(r.first(nodes), x.first(nodes));
  const Index count = reads_.rows();
  if (count == 0) return;
  Eigen::VectorXd own = Eigen::VectorXd::Zero(count);
  if (owns_) own = Eigen::Map<const Eigen::VectorXd>(r.data() + held_, count);
  sum_over_ranks(own);
  own = small_.solve(own - reads_ * read(x.data()));
  Eigen::Map<Eigen::VectorXd>(x.data(), held_).noalias() -= fed_ * own;
  if (owns_) Eigen::Map<Eigen::VectorXd>(x.data() + held_, count) = own;
}

}  // namespace whirl::film
