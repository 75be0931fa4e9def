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
  if (core::size_of(l.comm_) > 1) {
    {
      const core::WriteArray v(l.part_vector_.get());
      std::copy_n(of_parts[1].data(), of_parts[1].size(), v.data());
    }
    check(VecScatterBegin(l.to_ghosts_.get(), l.part_vector_.get(), l.ghosts_.get(), INSERT_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(l.to_ghosts_.get(), l.part_vector_.get(), l.ghosts_.get(), INSERT_VALUES, SCATTER_FORWARD));
    const core::ReadArray ghosts(l.ghosts_.get());
    apply(l.ghost_pieces_, ghosts.data());
  }
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

void PortMatrix::multiply(const double* x, double* y) const {
  const PortLayout& l = *layout_;
  l.take(x, l.x_.data(), l.hub_x_.data());
  // What the hub's states are, and behind them what the parts do to it.
  const PetscInt n = l.whole_hub(), first = l.first_of_hub();
  l.shared_.tail(static_cast<Index>(l.coupled_.numbers.size())).setZero();
  l.add_products(l.coupled_, *f_, l.x_.data(), l.shared_.data() + n);
  l.share(l.hub_x_.data(), l.shared_);
  const double* value = values_.data();
  const auto add = [&](const std::vector<PortLayout::Piece>& pieces, const double* from) {
    for (const PortLayout::Piece& p : pieces) {
      const double* __restrict in = from + p.column;
      const double* __restrict factor = value;
      double* __restrict out = l.y_.data() + p.row;
      for (PetscInt i = 0; i < p.count; ++i) out[i] += factor[i] * in[i];
      value += p.count;
    }
  };
  l.y_.setZero();
  add(l.pieces_, l.x_.data());
  if (core::size_of(l.comm_) > 1) {
    {
      const core::WriteArray v(l.part_vector_.get());
      std::copy_n(l.x_.data(), l.x_.size(), v.data());
    }
    check(VecScatterBegin(l.to_ghosts_.get(), l.part_vector_.get(), l.ghosts_.get(), INSERT_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(l.to_ghosts_.get(), l.part_vector_.get(), l.ghosts_.get(), INSERT_VALUES, SCATTER_FORWARD));
    const core::ReadArray ghosts(l.ghosts_.get());
    add(l.ghost_pieces_, ghosts.data());
  }
  l.add_columns(l.ports_, g_, 1, l.shared_.data(), l.y_.data());
  l.hub_y_.setZero();
  for_hub([&](PetscInt row, PetscInt column, double v) { l.hub_y_(row - first) += v * l.shared_(column); });
  for (std::size_t k = 0; k < l.coupled_.numbers.size(); ++k)
    if (const PetscInt row = l.coupled_.numbers[k] - first; row >= 0 && row < l.hub())
      l.hub_y_(row) += l.shared_(n + static_cast<Index>(k));
  l.give(l.y_.data(), l.hub_y_.data(), y);
}

}  // namespace whirl::solve
