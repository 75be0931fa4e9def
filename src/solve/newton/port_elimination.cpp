#include "solve/newton/port_elimination.hpp"

#include <algorithm>

#include "solve/newton/thin.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// Fails like a factorisation whose answer is of no use.
void require_answer(KSP ksp) {
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  check(KSPGetConvergedReason(ksp, &reason));
  if (reason < 0) throw core::NotConverged("the linearised equations of the parts are singular");
}

}  // namespace

PortElimination::PortElimination(MPI_Comm comm, const std::vector<problem::Field>& fields)
    : comm_(comm), fields_(problem::parts_of(fields)) {
  core::require(serves(fields_), "parts that elimination keeps apart");
}

std::size_t PortElimination::part_of(PetscInt row) const {
  return static_cast<std::size_t>(std::upper_bound(part_ends_.begin(), part_ends_.end(), row) - part_ends_.begin());
}

void PortElimination::make_layout(Mat a) {
  PetscInt local = 0;
  check(MatGetLocalSize(a, &local, nullptr));
  const PetscInt first = first_row(a);
  std::vector<PetscInt> hub, parts;
  std::vector<bool> taken(static_cast<std::size_t>(local), false);
  for (std::size_t f = 1; f < fields_.size(); ++f) {
    for (PetscInt i = fields_[f].begin; i < fields_[f].end; ++i) {
      parts.push_back(first + i);
      taken[static_cast<std::size_t>(i)] = true;
    }
    part_ends_.push_back(static_cast<PetscInt>(parts.size()));
  }
  for (PetscInt i = 0; i < local; ++i)
    if (!taken[static_cast<std::size_t>(i)]) hub.push_back(first + i);
  const auto set = [&](const std::vector<PetscInt>& rows, core::IndexSet& is) {
    check(ISCreateGeneral(comm_, static_cast<PetscInt>(rows.size()), rows.data(), PETSC_COPY_VALUES, is.put()));
  };
  set(hub, hub_rows_);
  set(parts, part_rows_);
  core::Vector whole = core::make_vector(comm_, local, PETSC_DETERMINE);
  part_rhs_ = core::make_vector(comm_, static_cast<PetscInt>(parts.size()), PETSC_DETERMINE);
  part_answer_ = core::duplicate(part_rhs_.get());
  hub_rhs_ = core::make_vector(comm_, static_cast<PetscInt>(hub.size()), PETSC_DETERMINE);
  hub_answer_ = core::duplicate(hub_rhs_.get());
  check(VecScatterCreate(whole.get(), part_rows_.get(), part_rhs_.get(), nullptr, part_scatter_.put()));
  check(VecScatterCreate(whole.get(), hub_rows_.get(), hub_rhs_.get(), nullptr, hub_scatter_.put()));
}

// Ports get the colours of a map: those that share a part differ.
void PortElimination::find_ports() {
  PetscInt n_hub = 0;
  check(VecGetSize(hub_rhs_.get(), &n_hub));
  std::vector<std::uint64_t> seen(static_cast<std::size_t>(n_hub), 0);
  for_rows(to_parts_.get(), [&](PetscInt i, const PetscInt* columns, const PetscScalar*, PetscInt count) {
    for (PetscInt k = 0; k < count; ++k) seen[static_cast<std::size_t>(columns[k])] |= std::uint64_t{1} << part_of(i);
  });
  std::vector<int> couples(static_cast<std::size_t>(n_hub), 0);
  const PetscInt first = first_row(to_hub_.get());
  for_rows(to_hub_.get(), [&](PetscInt i, const PetscInt*, const PetscScalar*, PetscInt count) {
    couples[static_cast<std::size_t>(first + i)] = count > 0;
  });
  MPI_Allreduce(MPI_IN_PLACE, seen.data(), static_cast<int>(n_hub), MPI_UINT64_T, MPI_BOR, comm_);
  MPI_Allreduce(MPI_IN_PLACE, couples.data(), static_cast<int>(n_hub), MPI_INT, MPI_MAX, comm_);
  std::vector<std::uint64_t> used;
  port_of_.assign(fields_.size() - 1, {});
  for (PetscInt c = 0; c < n_hub; ++c) {
    if (couples[static_cast<std::size_t>(c)]) coupled_.push_back(c);
    const std::uint64_t mask = seen[static_cast<std::size_t>(c)];
    if (mask == 0) continue;
    const auto free = std::find_if(used.begin(), used.end(), [&](std::uint64_t u) { return (u & mask) == 0; });
    const auto colour = free - used.begin();
    if (free == used.end()) used.push_back(0);
    used[static_cast<std::size_t>(colour)] |= mask;
    colour_.push_back(static_cast<int>(colour));
    ports_.push_back(c);
  }
  colours_ = static_cast<int>(used.size());
  for (auto& of : port_of_) of.assign(used.size(), -1);
  for (std::size_t k = 0; k < ports_.size(); ++k)
    for (std::size_t p = 0; p < port_of_.size(); ++p)
      if (seen[static_cast<std::size_t>(ports_[k])] >> p & 1)
        port_of_[p][static_cast<std::size_t>(colour_[k])] = static_cast<int>(k);
}

void PortElimination::solve_columns() {
  const PetscInt local = part_ends_.empty() ? 0 : part_ends_.back();
  x_.resize(local, colours_);
  if (!columns_) {
    for (core::Matrix* m : {&columns_, &answers_})
      check(MatCreateDense(comm_, local, PETSC_DECIDE, PETSC_DETERMINE, colours_, nullptr, m->put()));
    for (std::size_t k = 0; k < ports_.size(); ++k) colour_of_[ports_[k]] = colour_[k];
  }
  const auto with_array = [&](Mat m, auto&& use) {
    PetscScalar* a = nullptr;
    PetscInt stride = 0;
    check(MatDenseGetArray(m, &a));
    check(MatDenseGetLDA(m, &stride));
    use(Eigen::Map<MatrixXd, 0, Eigen::OuterStride<>>(a, local, colours_, Eigen::OuterStride<>(stride)));
    check(MatDenseRestoreArray(m, &a));
  };
  with_array(columns_.get(), [&](auto g) {
    g.setZero();
    for_rows(to_parts_.get(), [&](PetscInt i, const PetscInt* columns, const PetscScalar* values, PetscInt count) {
      for (PetscInt k = 0; k < count; ++k) g(i, colour_of_.at(columns[k])) += values[k];
    });
  });
  check(KSPMatSolve(part_solver_.get(), columns_.get(), answers_.get()));
  require_answer(part_solver_.get());
  with_array(answers_.get(), [&](auto x) { x_ = x; });
}

// Calls f(rows of a part here, its first row, port, column of X) for all ports of all parts.
template <class F>
void PortElimination::for_ports(F&& f) const {
  PetscInt begin = 0;
  for (std::size_t p = 0; p < part_ends_.size(); ++p) {
    for (int c = 0; c < colours_; ++c)
      if (const int k = port_of_[p][static_cast<std::size_t>(c)]; k >= 0) f(begin, part_ends_[p] - begin, k, c);
    begin = part_ends_[p];
  }
}

void PortElimination::form_hub() {
  core::Matrix transposed;
  check(MatTranspose(to_hub_.get(), MAT_INITIAL_MATRIX, transposed.put()));
  from_parts_ = thin(transposed.get(), coupled_);
  const auto place = [&](PetscInt row) {  // among the coupled rows, or their number
    const auto at = std::lower_bound(coupled_.begin(), coupled_.end(), row);
    return at != coupled_.end() && *at == row ? at - coupled_.begin() : static_cast<Index>(coupled_.size());
  };
  const auto n_coupled = static_cast<Index>(coupled_.size()), n_ports = static_cast<Index>(ports_.size());
  MatrixXd product = MatrixXd::Zero(n_coupled, n_ports);
  for_ports([&](PetscInt begin, PetscInt rows, int port, int colour) {
    product.col(port).noalias() +=
        from_parts_.middleRows(begin, rows).transpose() * x_.col(colour).segment(begin, rows);
  });
  MPI_Allreduce(MPI_IN_PLACE, product.data(), static_cast<int>(product.size()), MPI_DOUBLE, MPI_SUM, comm_);

  const PetscInt first = first_row(hub_.get());
  if (!schur_) {
    PetscInt local = 0;
    check(MatGetLocalSize(hub_.get(), &local, nullptr));
    std::vector<PetscInt> count(static_cast<std::size_t>(local), 0);
    for_rows(hub_.get(), [&](PetscInt i, const PetscInt*, const PetscScalar*, PetscInt k) {
      const bool couples = std::binary_search(coupled_.begin(), coupled_.end(), first + i);
      count[static_cast<std::size_t>(i)] = k + (couples ? static_cast<PetscInt>(n_ports) : 0);
    });
    schur_ = core::make_matrix(comm_, local, std::move(count));
  }
  check(MatZeroEntries(schur_.get()));
  std::vector<PetscScalar> row(static_cast<std::size_t>(n_ports));
  for_rows(hub_.get(), [&](PetscInt i, const PetscInt* columns, const PetscScalar* values, PetscInt count) {
    const PetscInt global = first + i;
    check(MatSetValues(schur_.get(), 1, &global, count, columns, values, ADD_VALUES));
    if (const Index at = place(global); at < n_coupled) {
      for (Index k = 0; k < n_ports; ++k) row[static_cast<std::size_t>(k)] = -product(at, k);
      check(MatSetValues(schur_.get(), 1, &global, static_cast<PetscInt>(n_ports), ports_.data(), row.data(),
                         ADD_VALUES));
    }
  });
  check(MatAssemblyBegin(schur_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(schur_.get(), MAT_FINAL_ASSEMBLY));
}

void PortElimination::factorise(Mat a) {
  const bool first = !parts_;
  if (first) make_layout(a);
  const auto block = [&](const core::IndexSet& rows, const core::IndexSet& columns, core::Matrix& m) {
    Mat raw = m.get();
    check(MatCreateSubMatrix(a, rows.get(), columns.get(), first ? MAT_INITIAL_MATRIX : MAT_REUSE_MATRIX,
                             first ? m.put() : &raw));
  };
  block(part_rows_, part_rows_, parts_);
  block(part_rows_, hub_rows_, to_parts_);
  block(hub_rows_, part_rows_, to_hub_);
  block(hub_rows_, hub_rows_, hub_);
  if (first) {
    find_ports();
    part_solver_ = core::make_direct_solver(comm_, "parts_");
    hub_solver_ = core::make_direct_solver(comm_, "hub_");
  }
  check(KSPSetOperators(part_solver_.get(), parts_.get(), parts_.get()));
  solve_columns();
  form_hub();
  check(KSPSetOperators(hub_solver_.get(), schur_.get(), schur_.get()));
  check(KSPSetUp(hub_solver_.get()));
}

void PortElimination::take(Vec whole) {
  check(VecScatterBegin(part_scatter_.get(), whole, part_rhs_.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(part_scatter_.get(), whole, part_rhs_.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterBegin(hub_scatter_.get(), whole, hub_rhs_.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(hub_scatter_.get(), whole, hub_rhs_.get(), INSERT_VALUES, SCATTER_FORWARD));
}

void PortElimination::give(Vec whole) {
  check(VecScatterBegin(part_scatter_.get(), part_answer_.get(), whole, INSERT_VALUES, SCATTER_REVERSE));
  check(VecScatterEnd(part_scatter_.get(), part_answer_.get(), whole, INSERT_VALUES, SCATTER_REVERSE));
  check(VecScatterBegin(hub_scatter_.get(), hub_answer_.get(), whole, INSERT_VALUES, SCATTER_REVERSE));
  check(VecScatterEnd(hub_scatter_.get(), hub_answer_.get(), whole, INSERT_VALUES, SCATTER_REVERSE));
}

VectorXd PortElimination::hub_values(const std::vector<PetscInt>& rows) const {
  VectorXd out = VectorXd::Zero(static_cast<Index>(rows.size()));
  const core::ReadArray a(hub_answer_.get());
  PetscInt first = 0;
  check(VecGetOwnershipRange(hub_answer_.get(), &first, nullptr));
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] >= first && rows[k] < first + a.size()) out(static_cast<Index>(k)) = a[rows[k] - first];
  MPI_Allreduce(MPI_IN_PLACE, out.data(), static_cast<int>(out.size()), MPI_DOUBLE, MPI_SUM, comm_);
  return out;
}

void PortElimination::take_from_hub(const std::vector<PetscInt>& rows, VectorXd shares) const {
  MPI_Allreduce(MPI_IN_PLACE, shares.data(), static_cast<int>(shares.size()), MPI_DOUBLE, MPI_SUM, comm_);
  const core::WriteArray a(hub_rhs_.get());
  PetscInt first = 0;
  check(VecGetOwnershipRange(hub_rhs_.get(), &first, nullptr));
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] >= first && rows[k] < first + a.size()) a[rows[k] - first] -= shares(static_cast<Index>(k));
}

void PortElimination::solve(Vec rhs, Vec x) {
  take(rhs);
  check(KSPSolve(part_solver_.get(), part_rhs_.get(), part_answer_.get()));
  require_answer(part_solver_.get());
  {
    const core::ReadArray y(part_answer_.get());
    take_from_hub(coupled_, from_parts_.transpose() * Eigen::Map<const VectorXd>(y.data(), y.size()));
  }
  check(KSPSolve(hub_solver_.get(), hub_rhs_.get(), hub_answer_.get()));
  require_answer(hub_solver_.get());
  const VectorXd at_ports = hub_values(ports_);
  {
    const core::WriteArray a(part_answer_.get());
    Eigen::Map<VectorXd> y(a.data(), a.size());
    for_ports([&](PetscInt first, PetscInt rows, int port, int colour) {
      y.segment(first, rows) -= at_ports(port) * x_.col(colour).segment(first, rows);
    });
  }
  give(x);
}

// x_p = A_pp^-T (b_p - F^T x_h),   (A_h - F X)^T x_h = b_h - X^T b_p
void PortElimination::solve_transposed(Vec rhs, Vec x) {
  take(rhs);
  VectorXd seen = VectorXd::Zero(static_cast<Index>(ports_.size()));
  {
    const core::ReadArray a(part_rhs_.get());
    const Eigen::Map<const VectorXd> b(a.data(), a.size());
    for_ports([&](PetscInt first, PetscInt rows, int port, int colour) {
      seen(port) += x_.col(colour).segment(first, rows).dot(b.segment(first, rows));
    });
  }
  take_from_hub(ports_, seen);
  check(KSPSolveTranspose(hub_solver_.get(), hub_rhs_.get(), hub_answer_.get()));
  require_answer(hub_solver_.get());
  const VectorXd forces = hub_values(coupled_);
  {
    const core::WriteArray a(part_rhs_.get());
    Eigen::Map<VectorXd>(a.data(), a.size()) -= from_parts_ * forces;
  }
  check(KSPSolveTranspose(part_solver_.get(), part_rhs_.get(), part_answer_.get()));
  require_answer(part_solver_.get());
  give(x);
}

}  // namespace whirl::solve
