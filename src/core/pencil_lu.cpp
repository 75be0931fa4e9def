#include "whirl/core/pencil_lu.hpp"

#include <algorithm>
#include <limits>

#include "whirl/core/direct_solver.hpp"

namespace whirl::core {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::Map;

namespace {

// Of the solution that a band is tried on: its exchanges of rows begin here; of entries of a matrix that is the same.
constexpr double digits_lost = 1e-11, same = 1e-12;

}  // namespace

template <class Scalar>
PencilLu<Scalar>::PencilLu(MPI_Comm comm, PetscInt rows, std::vector<Place> a, std::vector<Place> b, const char* prefix)
    : comm_(comm), rows_(rows), alone_(size_of(comm) == 1), a_(std::move(a)), b_(std::move(b)) {
  PetscInt reach = 0;
  for (const auto* places : {&a_, &b_})
    for (const Place& p : *places) reach = std::max(reach, std::abs(p.row - p.column));
  const bool narrow = rows > 0 && BandLu::pays(rows, reach);
  alone_ = alone_ && (narrow || width * rows <= most_by_klu);
  if (alone_) {
    std::vector<Eigen::Triplet<Scalar>> entries;
    for (const auto* places : {&a_, &b_})
      for (const Place& p : *places) entries.emplace_back(p.row, p.column, Scalar(1));
    matrix_.resize(rows, rows);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    for (const bool rates : {false, true})
      for (const Place& p : rates ? b_ : a_) {
        const auto* first = matrix_.innerIndexPtr();
        const auto* const column = matrix_.outerIndexPtr() + p.column;
        const auto* const found = std::lower_bound(first + column[0], first + column[1], p.row);
        (rates ? in_b_ : in_a_).push_back(found - first);
      }
    if constexpr (width == 1)
      if (narrow) band_.emplace(matrix_, Eigen::VectorXd(), digits_lost);
    if (!band_) lu_.analyse(matrix_);
    return;
  }
  PetscInt all = width * rows, begin = 0;
  MPI_Exscan(&rows, &begin, 1, MPIU_INT, MPI_SUM, comm);
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPIU_INT, MPI_SUM, comm);
  std::vector<PetscInt> count(static_cast<std::size_t>(width * rows), 0);
  for (const auto* places : {&a_, &b_})
    for (const Place& p : *places)
      for (PetscInt d = 0; d < width; ++d) count[static_cast<std::size_t>(width * (p.row - begin) + d)] += width;
  for (PetscInt& c : count) c = std::min(c, all);
  spread_ = make_matrix(comm, width * rows, std::move(count));
  if (prefix) {
    solver_ = make_direct_solver(comm, prefix);
    return;
  }
  check(KSPCreate(comm, solver_.put()));
  make_direct(solver_.get());
}

template <class Scalar>
void PencilLu<Scalar>::add(Place p, Complex value) {
  for (PetscInt d = 0; d < 2; ++d) stream_.add(2 * p.row + d, 2 * p.column + d, value.real());
  stream_.add(2 * p.row, 2 * p.column + 1, -value.imag());
  stream_.add(2 * p.row + 1, 2 * p.column, value.imag());
}

template <class Scalar>
void PencilLu<Scalar>::set(std::span<const double> a, std::span<const double> b, double alpha, Scalar sigma) {
  if (alone_) {
    using Values = Eigen::Array<Scalar, Eigen::Dynamic, 1>;
    Values values = Values::Zero(matrix_.nonZeros());
    for (std::size_t k = 0; k < in_a_.size(); ++k) values[in_a_[k]] += alpha * a[k];
    for (std::size_t k = 0; k < in_b_.size(); ++k) values[in_b_[k]] += sigma * b[k];
    Map<Values> known(matrix_.valuePtr(), values.size());
    if (regular_ && ((known - values).abs() <= same * values.abs()).all()) return;
    known = values;
    if constexpr (width == 1)
      if (band_) regular_ = band_->factor(matrix_);
    if (!band_) regular_ = lu_.factorise(matrix_);
    return;
  }
  check(MatZeroEntries(spread_.get()));
  stream_.begin(spread_.get());
  for (std::size_t k = 0; k < a_.size(); ++k) add(a_[k], Scalar(alpha * a[k]));
  for (std::size_t k = 0; k < b_.size(); ++k) add(b_[k], sigma * b[k]);
  stream_.end();
  check(KSPSetOperators(solver_.get(), spread_.get(), spread_.get()));
  check(KSPSetUp(solver_.get()));
  PC pc = nullptr;
  PCFailedReason reason = PC_NOERROR;
  check(KSPGetPC(solver_.get(), &pc));
  check(PCGetFailedReason(pc, &reason));
  regular_ = reason == PC_NOERROR;
}

template <class Scalar>
void PencilLu<Scalar>::solve(bool adjoint, std::span<const Scalar> r, std::span<Scalar> x) {
  if (!regular_) {
    std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
    return;
  }
  if (!alone_) return solve_spread(adjoint, r, x);
  const Index columns = static_cast<Index>(r.size()) / std::max<Index>(rows_, 1);
  if constexpr (width == 1)
    if (band_) return band_->solve(adjoint, r.data(), x.data(), columns);
  if (!adjoint) return lu_.solve(r.data(), x.data(), columns);
  const Columns conjugate = Map<const Columns>(r.data(), rows_, columns).conjugate();
  Map<Columns>(x.data(), rows_, columns) = lu_.solve_transposed(conjugate).conjugate();
}

// The transpose of the real form is the conjugate transpose.
template <class Scalar>
void PencilLu<Scalar>::solve_spread(bool adjoint, std::span<const Scalar> r, std::span<Scalar> x) {
  auto* const right = const_cast<double*>(reinterpret_cast<const double*>(r.data()));
  auto* const answer = reinterpret_cast<double*>(x.data());
  // A rank without rows has its share of the columns too.
  PetscInt columns = rows_ > 0 ? static_cast<PetscInt>(r.size()) / rows_ : 0;
  MPI_Allreduce(MPI_IN_PLACE, &columns, 1, MPIU_INT, MPI_MAX, comm_);
  Matrix b, y;
  for (const auto& [m, data] : {std::pair{&b, right}, std::pair{&y, answer}})
    check(MatCreateDense(comm_, width * rows_, PETSC_DECIDE, PETSC_DETERMINE, columns, data, m->put()));
  if (!adjoint) return check(KSPMatSolve(solver_.get(), b.get(), y.get()));
  for (PetscInt k = 0; k < columns; ++k) {
    Vec from = nullptr, to = nullptr;
    check(MatDenseGetColumnVecRead(b.get(), k, &from));
    check(MatDenseGetColumnVecWrite(y.get(), k, &to));
    check(KSPSolveTranspose(solver_.get(), from, to));
    check(MatDenseRestoreColumnVecRead(b.get(), k, &from));
    check(MatDenseRestoreColumnVecWrite(y.get(), k, &to));
  }
}

template class PencilLu<double>;
template class PencilLu<Complex>;

}  // namespace whirl::core
