#include "solve/newton/port_elimination.hpp"

#include <algorithm>
#include <exception>

#include "whirl/core/agree.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

[[noreturn]] void fail() {
  throw core::NotConverged("the linearised equations of the parts are singular");
}

// Fails like a factorisation whose answer is of no use.
void require_answer(KSP ksp) {
  if (core::reason_of(ksp) < 0) fail();
}

// MUMPS tells of a singular matrix by a reason, KLU by an error.
void require_factors(KSP ksp) {
  PC pc = nullptr;
  PCFailedReason reason = PC_NOERROR;
  try {
    check(KSPSetUp(ksp));
    check(KSPGetPC(ksp, &pc));
    check(PCGetFailedReason(pc, &reason));
  } catch (const core::LibraryError&) {
    fail();
  }
  if (reason != PC_NOERROR) fail();
}

}  // namespace

PortElimination::PortElimination(std::vector<problem::Field> fields, std::unique_ptr<problem::PartInverse> inverse)
    : fields_(std::move(fields)), inverse_(std::move(inverse)) {
  any_ = problem::parts_of(fields_).size() > 1;
}

void PortElimination::make_solvers() {
  const MPI_Comm comm = layout_->comm();
  PetscBool once = PETSC_FALSE;
  all_hub_.setZero(layout_->whole_hub() + 1);
  of_parts_.setZero(layout_->parts(), 1);
  if (any_ && !inverse_) factors_ = std::make_unique<PartFactors<double>>(layout_);
  const std::vector<PetscInt>& offsets = layout_->hub_offsets();
  const auto rows_of = [&](int rank) {
    return offsets[static_cast<std::size_t>(rank) + 1] - offsets[static_cast<std::size_t>(rank)];
  };
  leader_ = 0;
  for (int rank = 1; rank < core::size_of(comm); ++rank)
    if (rows_of(rank) > rows_of(leader_)) leader_ = rank;
  // Rows that others lend travel whole.
  constexpr PetscInt most_lent = 8;
  lent_ = layout_->whole_hub() - rows_of(leader_);
  hub_alone_ = lent_ <= most_lent;
  if (!hub_alone_) lent_ = 0;
  own_hub_.setZero(layout_->hub());
  const MPI_Comm hub_comm = hub_alone_ ? PETSC_COMM_SELF : comm;
  hub_rhs_ = core::make_vector(hub_comm, solved_hub(), PETSC_DETERMINE);
  hub_answer_ = core::duplicate(hub_rhs_.get());
  check(KSPCreate(hub_comm, hub_solver_.put()));
  check(KSPSetOptionsPrefix(hub_solver_.get(), "hub_"));
  core::make_direct(hub_solver_.get(), layout_->whole_hub());
  check(KSPSetFromOptions(hub_solver_.get()));
  check(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(hub_solver_.get()), KSPPREONLY, &once));
  hub_once_ = once && hub_alone_;
}

PetscInt PortElimination::solved_hub() const {
  return !hub_alone_ ? layout_->hub() : leads() ? layout_->whole_hub() : 0;
}

PetscInt PortElimination::lent(PetscInt row) const {
  const auto leader = static_cast<std::size_t>(leader_);
  const PetscInt begin = layout_->hub_offsets()[leader], end = layout_->hub_offsets()[leader + 1];
  return row < begin ? row : row - (end - begin);
}

void PortElimination::form_hub(const PortMatrix& blocks) {
  const PortLayout& l = *layout_;
  const auto n_coupled = static_cast<Index>(l.coupled().numbers.size()),
             n_ports = static_cast<Index>(l.ports().numbers.size()), n_hub = static_cast<Index>(l.whole_hub());
  from_parts_ = blocks.from_parts();
  MatrixXd product = MatrixXd::Zero(n_coupled, n_ports);
  l.add_products(*from_parts_, x_, product);
  // Rows that are lent travel behind the products.
  VectorXd sums = VectorXd::Zero(product.size() + lent_ * n_hub);
  sums.head(product.size()) = Eigen::Map<const VectorXd>(product.data(), product.size());
  if (hub_alone_ && !leads())
    blocks.for_hub([&](PetscInt row, PetscInt column, double value) {
      sums(product.size() + lent(row) * n_hub + column) += value;
    });
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, l.comm());
  product = Eigen::Map<const MatrixXd>(sums.data(), n_coupled, n_ports);

  const PetscInt first = first_solved(), rows = solved_hub();
  const bool solves = !hub_alone_ || leads();
  std::vector<PetscInt> lent_rows;
  for (PetscInt k = 0, own = l.first_of_hub(); solves && lent_ > 0 && k < rows; ++k)
    if (k < own || k >= own + l.hub()) lent_rows.push_back(k);
  if (!schur_) {
    std::vector<PetscInt> count(static_cast<std::size_t>(rows), 0);
    if (solves) blocks.for_hub([&](PetscInt row, PetscInt, double) { ++count[static_cast<std::size_t>(row - first)]; });
    for (const PetscInt row : l.coupled().numbers)
      if (row >= first && row < first + rows)
        count[static_cast<std::size_t>(row - first)] += static_cast<PetscInt>(n_ports);
    for (const PetscInt row : lent_rows) count[static_cast<std::size_t>(row)] = l.whole_hub();
    for (PetscInt& c : count) c = std::min(c, l.whole_hub());
    schur_ = core::make_matrix(hub_alone_ ? PETSC_COMM_SELF : l.comm(), rows, std::move(count));
  }
  check(MatZeroEntries(schur_.get()));
  if (solves)
    blocks.for_hub([&](PetscInt row, PetscInt column, double value) {
      check(MatSetValue(schur_.get(), row, column, value, ADD_VALUES));
    });
  for (const PetscInt at : lent_rows)
    for (PetscInt column = 0; column < l.whole_hub(); ++column)
      check(MatSetValue(schur_.get(), at, column, sums(product.size() + lent(at) * n_hub + column), ADD_VALUES));
  std::vector<PetscScalar> row(static_cast<std::size_t>(n_ports));
  for (Index k = 0; k < n_coupled; ++k) {
    const PetscInt at = l.coupled().numbers[static_cast<std::size_t>(k)];
    if (at < first || at >= first + rows) continue;
    for (Index p = 0; p < n_ports; ++p) row[static_cast<std::size_t>(p)] = -product(k, p);
    check(MatSetValues(schur_.get(), 1, &at, static_cast<PetscInt>(n_ports), l.ports().numbers.data(), row.data(),
                       ADD_VALUES));
  }
  check(MatAssemblyBegin(schur_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(schur_.get(), MAT_FINAL_ASSEMBLY));
}

void PortElimination::factorise(Mat a) {
  if (!blocks_) blocks_ = std::make_unique<PortMatrix>(std::make_shared<const PortLayout>(a, fields_));
  blocks_->take(a);
  factorise(*blocks_);
}

void PortElimination::factorise_parts(const PortMatrix& blocks) {
  layout_ = blocks.layout();
  if (!hub_solver_) make_solvers();
  if (factors_) factors_->set(blocks);
}

void PortElimination::factorise(const PortMatrix& blocks) {
  factorise_parts(blocks);
  x_ = any_ ? solve_parts(blocks.to_parts(), false) : blocks.to_parts();
  form_hub(blocks);
  check(KSPSetOperators(hub_solver_.get(), schur_.get(), schur_.get()));
  if (!hub_alone_) check(KSPSetUp(hub_solver_.get()));  // by all ranks; below, each sees what became of it
  core::agree(layout_->comm(), [&] {
    if (!hub_alone_ || solved_hub() > 0) require_factors(hub_solver_.get());
  });
}

// The answer of the hub, on every rank. How many ranks failed travels behind the answer.
void PortElimination::solve_hub(bool transposed) {
  KSP ksp = hub_solver_.get();
  std::exception_ptr failed;
  if (!hub_alone_ || solved_hub() > 0) try {
      if (hub_once_) {
        PC pc = nullptr;
        check(KSPGetPC(ksp, &pc));
        check((transposed ? PCApplyTranspose : PCApply)(pc, hub_rhs_.get(), hub_answer_.get()));
      } else {
        check((transposed ? KSPSolveTranspose : KSPSolve)(ksp, hub_rhs_.get(), hub_answer_.get()));
        require_answer(ksp);
      }
    } catch (...) {
      failed = std::current_exception();
    }
  double& failures = all_hub_(layout_->whole_hub());
  failures = failed ? 1 : 0;
  {
    const core::ReadArray a(hub_answer_.get());
    if (!hub_alone_)
      layout_->share(a.data(), all_hub_);
    else
      std::copy_n(a.data(), a.size(), all_hub_.data());
  }
  if (hub_alone_ && core::size_of(layout_->comm()) > 1)
    MPI_Bcast(all_hub_.data(), static_cast<int>(all_hub_.size()), MPI_DOUBLE, leader_, layout_->comm());
  if (failures > 0)
    core::agree(layout_->comm(), [&] {
      if (failed) std::rethrow_exception(failed);
    });
}

void PortElimination::clear_shares(std::size_t rows) {
  shares_.setZero(static_cast<Index>(rows) + lent_);
}

// Rows that are lent travel behind the shares.
void PortElimination::take_from_hub(const std::vector<PetscInt>& rows) {
  const PetscInt own = layout_->first_of_hub();
  double* const lent_rows = shares_.data() + rows.size();
  if (hub_alone_ && !leads())
    for (PetscInt k = 0; k < layout_->hub(); ++k) lent_rows[lent(own + k)] = own_hub_(k);
  if (core::size_of(layout_->comm()) > 1)
    MPI_Allreduce(MPI_IN_PLACE, shares_.data(), static_cast<int>(shares_.size()), MPI_DOUBLE, MPI_SUM, layout_->comm());
  const core::WriteArray a(hub_rhs_.get());
  const PetscInt first = first_solved();
  if (a.size() > 0) std::copy_n(own_hub_.data(), own_hub_.size(), a.data() + (own - first));
  for (PetscInt k = 0; lent_ > 0 && k < a.size(); ++k)
    if (k < own || k >= own + layout_->hub()) a[k] = lent_rows[lent(k)];
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] >= first && rows[k] < first + a.size()) a[rows[k] - first] -= shares_(static_cast<Index>(k));
}

MatrixXd PortElimination::solve_parts(const MatrixXd& right, bool transposed) {
  if (factors_) {
    MatrixXd out = factors_->solve(right, transposed);
    core::agree(layout_->comm(), [&] {
      if (!out.allFinite() && right.allFinite()) fail();
    });
    return out;
  }
  MatrixXd out(right.rows(), right.cols());
  if (!any_) return out;
  core::require(!transposed || inverse_->exact() != nullptr, "transposes of exact inverses");
  if (transposed)
    inverse_->exact()->apply_transposed(core::span_of(right), core::span_of(out));
  else
    inverse_->apply(core::span_of(right), core::span_of(out));
  return out;
}

void PortElimination::take(Vec whole) {
  const core::ReadArray from(whole);
  layout_->take(from.data(), of_parts_.data(), own_hub_.data());
}

void PortElimination::give(Vec whole) const {
  const core::WriteArray to(whole);
  layout_->give(of_parts_.data(), all_hub_.data() + layout_->first_of_hub(), to.data());
}

void PortElimination::solve(Vec rhs, Vec x) {
  const PortLayout& l = *layout_;
  take(rhs);
  of_parts_ = solve_parts(of_parts_, false);
  clear_shares(l.coupled().numbers.size());
  l.add_products(l.coupled(), *from_parts_, of_parts_.data(), shares_.data());
  take_from_hub(l.coupled().numbers);
  solve_hub(false);
  l.add_columns(l.ports(), x_, -1, all_hub_.data(), of_parts_.data());
  give(x);
}

void PortElimination::solve_held(Vec rhs, Vec x) {
  take(rhs);
  of_parts_ = solve_parts(of_parts_, false);
  all_hub_.setZero();
  give(x);
}

// x_p = A_pp^-T (b_p - F^T x_h),   (A_h - F X)^T x_h = b_h - X^T b_p
void PortElimination::solve_transposed(Vec rhs, Vec x) {
  const PortLayout& l = *layout_;
  take(rhs);
  clear_shares(l.ports().numbers.size());
  l.add_products(l.ports(), x_, of_parts_.data(), shares_.data());
  take_from_hub(l.ports().numbers);
  solve_hub(true);
  l.add_columns(l.coupled(), *from_parts_, -1, all_hub_.data(), of_parts_.data());
  of_parts_ = solve_parts(of_parts_, true);
  give(x);
}

}  // namespace whirl::solve
