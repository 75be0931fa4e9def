#include "solve/cycle/mode_composition.hpp"

#include "whirl/core/agree.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Composition& ModeComposition::sweeps() {
  if (!sweeps_) sweeps_ = make_sweep_composition();
  if (!swept_) sweeps_->compose(*run_);
  swept_ = true;
  return *sweeps_;
}

void ModeComposition::set_up() {
  rank_ = core::rank_of(run_->comm);
  size_ = core::size_of(run_->comm);
  const std::vector<double>& mesh = *run_->thin->mesh;
  core::agree(run_->comm, [&] { modes_ = cycle_modes(*run_->thin->scheme, mesh, size_); });
  const Index m = run_->thin->scheme->degree, intervals = static_cast<Index>(mesh.size()) - 1;
  points_ = m * intervals;
  counts_.resize(static_cast<std::size_t>(size_));
  first_ = 0;
  for (int p = 0; p < size_; ++p) {
    const Index count = m * (intervals * (p + 1) / size_ - intervals * p / size_);
    counts_[static_cast<std::size_t>(p)] = static_cast<int>(count);
    if (p < rank_) first_ += count;
  }
  local_ = counts_[static_cast<std::size_t>(rank_)];

  const auto size = static_cast<PetscInt>(points_ * run_->thin->blocks->b.cols() + run_->borders);
  right_ = core::make_vector(PETSC_COMM_SELF, size, size);
  answer_ = core::duplicate(right_.get());
  const auto product = [this](bool transposed) {
    return [this, transposed](Vec v, Vec y) {
      const core::ReadArray in(v);
      const core::WriteArray out(y);
      small_product(in.data(), out.data(), transposed);
    };
  };
  shell_ = core::make_shell(PETSC_COMM_SELF, size, gate_, product(false), product(true));
  constexpr int most = 200;  // a dense matrix costs as much as some hundred products
  // Its error is made good by the iteration around this composition.
  solver_ = core::make_krylov(shell_.get(), gate_, {"forces_", KSPGMRES, 1e-10, most, most}, {});
  mesh_ = mesh;
}

std::vector<double> ModeComposition::warm_start() {
  return sweeps_ ? sweeps_->warm_start() : std::vector<double>{};
}

void ModeComposition::take_warm_start(const std::vector<double>& warm) {
  if (!sweeps_) sweeps_ = make_sweep_composition();
  sweeps_->take_warm_start(warm);
}

void ModeComposition::compose(const Run& run) {
  run_ = &run;
  swept_ = false;
  core::require(run.thin.has_value(), "time modes want equations that are linear but for thin forces");
  if (mesh_ != *run.thin->mesh) set_up();
  MatrixXd mean;
  gather_tangents(mean);
  core::agree(run.comm, [&] {
    const problem::ThinBlocks& k = *run.thin->blocks;
    Pencil::Matrix held = k.l0 - Pencil::Matrix(k.b * Pencil::Matrix(mean.sparseView()) * k.c);
    held.makeCompressed();
    pencil_.compute(k.l1, held, k.kinematic,
                    modes_.lambda.segment(rank_ * modes_.lanes, modes_.lanes) / run.thin->period);
  });
  find_receptances();
  find_border();
}

// Tangents of all points on all ranks, and their mean over the cycle [r x w].
void ModeComposition::gather_tangents(MatrixXd& mean) {
  const ThinRun& thin = *run_->thin;
  const Index m = thin.scheme->degree, r = thin.blocks->b.cols(), w = thin.blocks->c.rows();
  MatrixXd all(r * w, points_);
  for (Index j = 0; j < local_; ++j) all.col(first_ + j) = thin.tangents[static_cast<std::size_t>(j)]->reshaped();
  if (size_ > 1) {
    std::vector<int> counts, offsets{0};
    for (const int c : counts_) {
      counts.push_back(c * static_cast<int>(r * w));
      offsets.push_back(offsets.back() + counts.back());
    }
    MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, all.data(), counts.data(), offsets.data(), MPI_DOUBLE,
                   run_->comm);
  }
  VectorXd weight(points_);
  for (Index k = 0; k < points_; ++k) {
    const auto i = static_cast<std::size_t>(k / m);
    weight(k) = (mesh_[i + 1] - mesh_[i]) * thin.scheme->weight(k % m);
  }
  mean = (all * weight).reshaped(r, w);
  changes_.clear();
  for (Index b = 0; b < w; ++b)
    for (Index a = 0; a < r; ++a) {
      const auto row = all.row(a + r * b);
      if ((row.array() != 0).any()) changes_.push_back({a, b, row.transpose().array() - mean(a, b)});
    }
}

void ModeComposition::find_receptances() {
  const ThinRun& thin = *run_->thin;
  const Index r = thin.blocks->b.cols(), w = thin.blocks->c.rows(), n = run_->n, lanes = modes_.lanes;
  MatrixXd own = MatrixXd::Zero(2 * lanes, w * r), x;
  constexpr Index together = 5;  // right-hand sides that share one pass over the factors
  for (Index first = 0; first < r; first += together) {
    const Index columns = std::min(together, r - first), count = lanes * columns;
    x = MatrixXd::Zero(2 * count, n);
    for (Index q = 0; q < columns; ++q)
      for (Pencil::Matrix::InnerIterator it(thin.blocks->b, first + q); it; ++it)
        x.col(it.row()).segment(q * lanes, lanes).setConstant(it.value());
    pencil_.solve(x, columns);
    for (Index s = 0; s < n; ++s)
      for (Pencil::Matrix::InnerIterator it(thin.blocks->c, s); it; ++it)
        for (Index q = 0; q < columns; ++q) {
          auto out = own.col(it.row() + w * (first + q));
          out.head(lanes) += it.value() * x.col(s).segment(q * lanes, lanes);
          out.tail(lanes) += it.value() * x.col(s).segment(count + q * lanes, lanes);
        }
  }
  if (size_ == 1) {
    transfer_ = std::move(own);
    return;
  }
  std::vector<double> all(static_cast<std::size_t>(own.size() * size_));
  MPI_Allgather(own.data(), static_cast<int>(own.size()), MPI_DOUBLE, all.data(), static_cast<int>(own.size()),
                MPI_DOUBLE, run_->comm);
  transfer_.resize(2 * lanes * size_, w * r);
  for (int p = 0; p < size_; ++p)
    transfer_.middleRows(2 * lanes * p, 2 * lanes) = Map<const MatrixXd>(all.data() + own.size() * p, 2 * lanes, w * r);
}

void ModeComposition::find_border() {
  const Index nb = run_->borders, size = run_->thin->scheme->degree * run_->n, n = run_->n;
  const auto borders = static_cast<std::size_t>(nb);
  for (auto* list : {&column_, &column_answer_, &column_forces_, &row_, &row_answer_, &row_forces_})
    list->assign(borders, MatrixXd());
  MatrixXd line(n, local_);
  int rows = 0;
  for (const MatrixXd& part : run_->rows) rows = rows || (part.array() != 0).any();
  MPI_Allreduce(MPI_IN_PLACE, &rows, 1, MPI_INT, MPI_MAX, run_->comm);
  with_rows_ = rows != 0;
  corner_ = run_->corner;
  for (Index k = 0; k < nb; ++k) {
    const auto at = static_cast<std::size_t>(k);
    for (std::size_t i = 0; i < run_->columns.size(); ++i)
      Map<VectorXd>(line.data() + static_cast<Index>(i) * size, size) = run_->columns[i].col(k);
    column_[at] = column_answer_[at] = to_lanes(modes_.into, line.data());
    pencil_.solve(column_answer_[at]);
    column_forces_[at] = changes(all_points(modes_.seen, column_answer_[at] * run_->thin->blocks->c.transpose()));
    if (!with_rows_) continue;
    for (std::size_t i = 0; i < run_->rows.size(); ++i)
      Map<VectorXd>(line.data() + static_cast<Index>(i) * size, size) = run_->rows[i].row(k).transpose();
    row_[at] = row_answer_[at] = to_lanes(modes_.out, line.data());
    pencil_.solve_adjoint(row_answer_[at]);
    row_forces_[at] = all_points(modes_.into, row_answer_[at] * run_->thin->blocks->b);
  }
  if (!with_rows_) return;
  for (Index k = 0; k < nb; ++k)
    for (Index l = 0; l < nb; ++l)
      corner_(k, l) -= dot(row_[static_cast<std::size_t>(k)], column_answer_[static_cast<std::size_t>(l)]);
}

void ModeComposition::solve(const double* rhs, VectorXd& border, double* x) {
  const ThinRun& thin = *run_->thin;
  const auto nb = static_cast<std::size_t>(run_->borders);
  MatrixXd answer = to_lanes(modes_.into, rhs);
  pencil_.solve(answer);
  MatrixXd forces = changes(all_points(modes_.seen, answer * thin.blocks->c.transpose()));
  if (with_rows_)
    for (std::size_t k = 0; k < nb; ++k) border(static_cast<Index>(k)) -= dot(row_[k], answer);
  small_solve(forces, border, false);
  MatrixXd driven = own_lanes(modes_.into, forces) * thin.blocks->b.transpose();
  pencil_.solve(driven);
  answer += driven;
  for (std::size_t k = 0; k < nb; ++k) answer -= border(static_cast<Index>(k)) * column_answer_[k];
  to_points(modes_.out, answer, x);
}

// z = W^-T (rhs - rows^T sigma + C^T (S - S_0)^T psi) with psi = B^T z, from the small system transposed.
void ModeComposition::solve_transposed(const double* rhs, VectorXd& border, double* x) {
  const ThinRun& thin = *run_->thin;
  const auto nb = static_cast<std::size_t>(run_->borders);
  MatrixXd answer = to_lanes(modes_.out, rhs);
  pencil_.solve_adjoint(answer);
  MatrixXd seen = all_points(modes_.into, answer * thin.blocks->b);
  for (std::size_t k = 0; k < nb; ++k) border(static_cast<Index>(k)) -= dot(column_[k], answer);
  small_solve(seen, border, true);
  MatrixXd driven = own_lanes(modes_.seen, changes(seen, true)) * thin.blocks->c;
  pencil_.solve_adjoint(driven);
  answer += driven;
  if (with_rows_)
    for (std::size_t k = 0; k < nb; ++k) answer -= border(static_cast<Index>(k)) * row_answer_[k];
  to_points(modes_.into, answer, x);
}

std::unique_ptr<Composition> make_mode_composition() {
  return std::make_unique<ModeComposition>();
}

}  // namespace whirl::solve
