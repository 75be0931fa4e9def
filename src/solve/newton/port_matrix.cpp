#include "solve/newton/port_matrix.hpp"

#include <algorithm>

#include "solve/newton/stored.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

class Values {
public:
  explicit Values(Mat m) : m_(m) {
    if (m_) check(MatSeqAIJGetArrayRead(m_, &values_));
  }
  Values(const Values&) = delete;
  Values& operator=(const Values&) = delete;
  ~Values() {
    if (m_) (void)MatSeqAIJRestoreArrayRead(m_, &values_);
  }
  [[nodiscard]] const double* data() const { return values_; }

private:
  Mat m_;
  const PetscScalar* values_ = nullptr;
};

}  // namespace

PortLayout::Owner PortLayout::owner_of(PetscInt column) const {
  const auto rank = static_cast<std::size_t>(std::upper_bound(part_offsets_.begin(), part_offsets_.end(), column) -
                                             part_offsets_.begin() - 1);
  const PetscInt first = part_offsets_[rank];
  const auto ends = all_part_ends_.begin() + static_cast<std::ptrdiff_t>(rank * part_ends_.size());
  const auto part =
      std::upper_bound(ends, ends + static_cast<std::ptrdiff_t>(part_ends_.size()), column - first) - ends;
  return {static_cast<PetscMPIInt>(rank), first, part_offsets_[rank + 1] - first, static_cast<std::size_t>(part)};
}

void PortLayout::add_products(const Coloured& of, const MatrixXd& columns, const double* v, double* sums) const {
  for_parts([&](std::size_t part, PetscInt begin, PetscInt rows) {
    few_.noalias() = columns.middleRows(begin, rows).transpose() * Eigen::Map<const VectorXd>(v + begin, rows);
    for (std::size_t c = 0; c < of.at[part].size(); ++c)
      if (const int k = of.at[part][c]; k >= 0) sums[k] += few_(static_cast<Index>(c));
  });
}

void PortLayout::add_columns(const Coloured& of, const MatrixXd& columns, double sign, const double* hub,
                             double* v) const {
  for_parts([&](std::size_t part, PetscInt begin, PetscInt rows) {
    few_.setZero(columns.cols());
    for (std::size_t c = 0; c < of.at[part].size(); ++c)
      if (const int k = of.at[part][c]; k >= 0)
        few_(static_cast<Index>(c)) = sign * hub[of.numbers[static_cast<std::size_t>(k)]];
    Eigen::Map<VectorXd>(v + begin, rows).noalias() += columns.middleRows(begin, rows) * few_;
  });
}

void PortLayout::add_products(const MatrixXd& from, const MatrixXd& to, MatrixXd& sums) const {
  for_parts([&](std::size_t part, PetscInt begin, PetscInt rows) {
    const MatrixXd all = from.middleRows(begin, rows).transpose() * to.middleRows(begin, rows);
    for (std::size_t r = 0; r < coupled_.at[part].size(); ++r)
      for (std::size_t c = 0; c < ports_.at[part].size(); ++c)
        if (const int row = coupled_.at[part][r], column = ports_.at[part][c]; row >= 0 && column >= 0)
          sums(row, column) += all(static_cast<Index>(r), static_cast<Index>(c));
  });
}

core::ReadArray PortLayout::to_ghosts(const double* x) const {
  std::copy_n(x, parts(), core::WriteArray(part_vector_.get()).data());
  check(VecScatterBegin(to_ghosts_.get(), part_vector_.get(), ghosts_.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(to_ghosts_.get(), part_vector_.get(), ghosts_.get(), INSERT_VALUES, SCATTER_FORWARD));
  return core::ReadArray(ghosts_.get());
}

PetscInt PortLayout::count_of(std::size_t rank, std::size_t p) const {
  const std::size_t at = rank * part_ends_.size() + p;
  return all_part_ends_[at] - (p == 0 ? 0 : all_part_ends_[at - 1]);
}

PortLayout::PartRows PortLayout::part(std::size_t p) const {
  const auto here = static_cast<std::size_t>(core::rank_of(comm_)), ranks = hub_offsets_.size() - 1;
  PartRows out{p == 0 ? 0 : part_ends_[p - 1], count_of(here, p), 0, 0, false};
  PetscInt most = 0;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    if (rank == here) out.before = out.states;
    out.states += count_of(rank, p);
    most = std::max(most, count_of(rank, p));
  }
  out.alone = most == out.states;
  return out;
}

std::vector<PortLayout::PartEntry> PortLayout::entries_of(std::size_t p) const {
  const PartRows of = part(p);
  std::vector<PetscInt> ghosts;  // among the part's states, -1 of other parts
  for (const PetscInt column : ghost_columns_) {
    const Owner owner = owner_of(column);
    const auto rank = static_cast<std::size_t>(owner.rank);
    PetscInt number = column - owner.first - (p == 0 ? 0 : all_part_ends_[rank * part_ends_.size() + p - 1]);
    for (std::size_t lower = 0; lower < rank; ++lower) number += count_of(lower, p);
    ghosts.push_back(owner.part == p ? number : -1);
  }
  std::vector<PartEntry> out;
  std::size_t value = 0;
  const auto add = [&](const std::vector<Piece>& pieces, auto&& number) {
    for (const Piece& piece : pieces)
      for (PetscInt i = 0; i < piece.count; ++i, ++value) {
        const PetscInt row = piece.row + i - of.first;
        if (sources_[value] < 0 || row < 0 || row >= of.count) continue;
        if (const PetscInt column = number(piece.column + i); column >= 0)
          out.push_back({of.before + row, column, value});
      }
  };
  add(pieces_, [&](PetscInt c) { return c >= of.first && c < of.first + of.count ? of.before + c - of.first : -1; });
  add(ghost_pieces_, [&](PetscInt c) { return ghosts[static_cast<std::size_t>(c)]; });
  return out;
}

void PortLayout::share(const double* hub, VectorXd& all) const {
  const PetscInt n = whole_hub();
  if (core::size_of(comm_) > 1) {
    all.head(n).setZero();
    std::copy_n(hub, this->hub(), all.data() + first_of_hub());
    MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, comm_);
  } else {
    std::copy_n(hub, n, all.data());
  }
}

PortMatrix::PortMatrix(std::shared_ptr<const PortLayout> layout) : layout_(std::move(layout)) {
  const PortLayout& l = *layout_;
  values_.assign(l.sources_.size(), 0.0);
  hub_.resize(l.hub_entries_.size());
  f_values_.resize(l.f_sources_.size());
  g_.setZero(l.parts(), l.ports_.colours);
  f_ = std::make_shared<MatrixXd>(MatrixXd::Zero(l.parts(), l.coupled_.colours));
}

void PortMatrix::take(Mat a) {
  const Stored stored(a);
  const PetscInt n = stored.others ? stored.entries() : PETSC_MAX_INT;
  const Values own(stored.own), others(stored.others);
  place([n, here = own.data(), there = others.data()](PetscInt k) { return k < n ? here[k] : there[k - n]; });
}

void PortMatrix::take(std::span<const double> values) {
  place([from = values.data()](PetscInt k) { return from[k]; });
}

template <class Value>
void PortMatrix::place(const Value& value) {
  const PortLayout& l = *layout_;
  for (std::size_t k = 0; k < values_.size(); ++k)
    if (l.sources_[k] >= 0) values_[k] = value(l.sources_[k]);
  for (const auto& [k, source] : l.added_) values_[k] += value(source);
  for (std::size_t k = 0; k < hub_.size(); ++k) hub_[k] = value(l.hub_entries_[k].source);
  g_.setZero();
  for (std::size_t k = 0; k < l.g_sources_.size(); ++k) g_.data()[l.g_places_[k]] += value(l.g_sources_[k]);
  f_->setZero();
  for (std::size_t k = 0; k < l.f_sources_.size(); ++k) f_values_[k] = value(l.f_sources_[k]);
  check(PetscSFReduceBegin(l.to_f_.get(), MPI_DOUBLE, f_values_.data(), f_->data(), MPI_SUM));
  check(PetscSFReduceEnd(l.to_f_.get(), MPI_DOUBLE, f_values_.data(), f_->data(), MPI_SUM));
}

void PortMatrix::scale(Vec rows, Vec columns) {
  const PortLayout& l = *layout_;
  VectorXd of_parts[2], of_hub[2];
  for (const int side : {0, 1}) {
    of_parts[side].resize(l.parts());
    of_hub[side].resize(l.whole_hub());
    VectorXd here(l.hub());
    const core::ReadArray all(side == 0 ? rows : columns);
    l.take(all.data(), of_parts[side].data(), here.data());
    l.share(here.data(), of_hub[side]);
  }
  double* value = values_.data();
  const auto apply = [&](const std::vector<PortLayout::Piece>& pieces, const double* column) {
    for (const PortLayout::Piece& p : pieces)
      for (PetscInt i = 0; i < p.count; ++i) *value++ *= of_parts[0](p.row + i) * column[p.column + i];
  };
  apply(l.pieces_, of_parts[1].data());
  if (core::size_of(l.comm_) > 1) apply(l.ghost_pieces_, l.to_ghosts(of_parts[1].data()).data());
  const auto thin = [&](const PortLayout::Coloured& of, MatrixXd& m, const VectorXd& along, const VectorXd& hub) {
    l.for_parts([&](std::size_t part, PetscInt begin, PetscInt count) {
      for (std::size_t c = 0; c < of.at[part].size(); ++c)
        if (const int k = of.at[part][c]; k >= 0)
          m.col(static_cast<Index>(c)).segment(begin, count).array() *=
              hub(of.numbers[static_cast<std::size_t>(k)]) * along.segment(begin, count).array();
    });
  };
  thin(l.ports_, g_, of_parts[0], of_hub[1]);
  thin(l.coupled_, *f_, of_parts[1], of_hub[0]);
  for (std::size_t k = 0; k < hub_.size(); ++k)
    hub_[k] *= of_hub[0](l.hub_entries_[k].row) * of_hub[1](l.hub_entries_[k].column);
}

void PortMatrix::multiply_parts(const double* x, double* y) const {
  const PortLayout& l = *layout_;
  const double* value = values_.data();
  const auto add = [&](const std::vector<PortLayout::Piece>& pieces, const double* from) {
    for (const PortLayout::Piece& p : pieces) {
      const double* __restrict in = from + p.column;
      const double* __restrict factor = value;
      double* __restrict out = y + p.row;
      for (PetscInt i = 0; i < p.count; ++i) out[i] += factor[i] * in[i];
      value += p.count;
    }
  };
  std::fill_n(y, l.parts(), 0.0);
  add(l.pieces_, x);
  if (core::size_of(l.comm_) > 1) add(l.ghost_pieces_, l.to_ghosts(x).data());
}

void PortMatrix::multiply(const double* x, double* y) const {
  const PortLayout& l = *layout_;
  l.take(x, l.x_.data(), l.hub_x_.data());
  // What the hub's states are, and behind them what the parts do to it.
  const PetscInt n = l.whole_hub(), first = l.first_of_hub();
  l.shared_.tail(static_cast<Index>(l.coupled_.numbers.size())).setZero();
  l.add_products(l.coupled_, *f_, l.x_.data(), l.shared_.data() + n);
  l.share(l.hub_x_.data(), l.shared_);
  multiply_parts(l.x_.data(), l.y_.data());
  l.add_columns(l.ports_, g_, 1, l.shared_.data(), l.y_.data());
  l.hub_y_.setZero();
  for_hub([&](PetscInt row, PetscInt column, double v) { l.hub_y_(row - first) += v * l.shared_(column); });
  for (std::size_t k = 0; k < l.coupled_.numbers.size(); ++k)
    if (const PetscInt row = l.coupled_.numbers[k] - first; row >= 0 && row < l.hub())
      l.hub_y_(row) += l.shared_(n + static_cast<Index>(k));
  l.give(l.y_.data(), l.hub_y_.data(), y);
}

}  // namespace whirl::solve
