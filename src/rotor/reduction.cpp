#include "reduction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "eigen.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/symmetric.hpp"

namespace whirl::rotor {
namespace {

using core::check;

MPI_Comm comm_of(Mat m) {
  return PetscObjectComm(reinterpret_cast<PetscObject>(m));
}

core::IndexSet make_set(MPI_Comm comm, const std::vector<PetscInt>& indices) {
  core::IndexSet set;
  check(ISCreateGeneral(comm, static_cast<PetscInt>(indices.size()), indices.data(), PETSC_COPY_VALUES, set.put()));
  return set;
}

core::Matrix block(Mat a, IS rows, IS columns) {
  core::Matrix b;
  check(MatCreateSubMatrix(a, rows, columns, MAT_INITIAL_MATRIX, b.put()));
  return b;
}

// An eigenvector is known up to its sign. A fixed generic direction decides it, the same for every rank count; the
// largest entry would not do, since an antisymmetric mode has two of the same size.
void fix_sign(Vec v) {
  core::Vector direction = core::duplicate(v);
  PetscInt begin = 0;
  check(VecGetOwnershipRange(v, &begin, nullptr));
  {
    const core::WriteArray d(direction.get());
    for (PetscInt i = 0; i < d.size(); ++i) d[i] = 1 + std::cos(static_cast<double>(begin + i));
  }
  double product = 0;
  check(VecDot(v, direction.get(), &product));
  if (product < 0) check(VecScale(v, -1));
}

// The same small matrix on all ranks, as an AIJ matrix split by PETSc.
core::Matrix distribute(const Eigen::MatrixXd& a, MPI_Comm comm) {
  PetscInt local = PETSC_DECIDE, n = a.rows(), begin = 0, end = 0;
  check(PetscSplitOwnership(comm, &local, &n));
  core::Matrix m;
  check(MatCreateAIJ(comm, local, local, n, n, local, nullptr, n - local, nullptr, m.put()));
  check(MatGetOwnershipRange(m.get(), &begin, &end));
  for (PetscInt i = begin; i < end; ++i)
    for (PetscInt j = 0; j < n; ++j) check(MatSetValue(m.get(), i, j, a(i, j), INSERT_VALUES));
  check(MatAssemblyBegin(m.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(m.get(), MAT_FINAL_ASSEMBLY));
  return m;
}

}  // namespace

std::vector<int> planar_masters(const Reduction& reduction) {
  std::vector<int> out;
  for (const int node : reduction.masters) out.push_back(2 * (node - 1));
  for (const int node : reduction.slopes) out.push_back(2 * (node - 1) + 1);
  std::sort(out.begin(), out.end());
  return out;
}

PlanarBasis planar_basis(const Planar& planar, const Reduction& reduction) {
  const Mat k = planar.stiffness.get();
  const MPI_Comm comm = comm_of(k);
  const std::vector<int> masters = planar_masters(reduction);

  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(k, &begin, &end));
  std::vector<PetscInt> m, s;
  for (PetscInt i = begin; i < end; ++i) {
    const bool master = std::binary_search(masters.begin(), masters.end(), static_cast<int>(i));
    (master ? m : s).push_back(i);
  }
  const core::IndexSet master_set = make_set(comm, m), slave_set = make_set(comm, s);
  const core::Matrix k_ss = block(k, slave_set.get(), slave_set.get()),
                     k_sm = block(k, slave_set.get(), master_set.get());
  const core::Matrix m_ss = block(planar.mass.get(), slave_set.get(), slave_set.get());
  const core::LinearSolver solver = direct_solver(k_ss.get());

  if (reduction.type == Reduction::Type::modal) {
    PlanarBasis basis = modal_basis(planar, reduction);
    core::Vector f = core::make_vector(comm, static_cast<PetscInt>(s.size()), PETSC_DETERMINE),
                 x = core::duplicate(f.get());
    {
      const core::ReadArray w(planar.weight.get());
      const core::WriteArray a(f.get());
      for (std::size_t i = 0; i < s.size(); ++i) a[static_cast<PetscInt>(i)] = w[s[i] - begin];
    }
    check(KSPSolve(solver.get(), f.get(), x.get()));
    const core::ReadArray shape(x.get()), w(planar.weight.get());
    for (std::size_t i = 0; i < s.size(); ++i) basis.offset(s[i] - begin) = shape[static_cast<PetscInt>(i)];
    // Without what the coordinates carry of it that hold the masters.
    const Eigen::Index held = basis.rows.cols() - static_cast<Eigen::Index>(masters.size());
    const Eigen::MatrixXd own = basis.rows.rightCols(held);
    const Eigen::MatrixXd load =
        sum_over_ranks(own.transpose() * Eigen::Map<const Eigen::VectorXd>(w.data(), w.size()), comm);
    if (held == 0) return basis;
    const Eigen::MatrixXd stiffness = projected(k, own);
    core::agree(comm, [&] { basis.offset -= own * core::solve_definite(stiffness, load, held_stiffness); });
    return basis;
  }
  const bool with_modes = reduction.type == Reduction::Type::craig_bampton;
  const PetscInt n_masters = static_cast<PetscInt>(masters.size()), n_modes = with_modes ? reduction.modes : 0;
  PlanarBasis basis;
  basis.rows = Eigen::MatrixXd::Zero(end - begin, n_masters + n_modes);
  basis.offset = Eigen::VectorXd::Zero(end - begin);
  auto scatter = [&](Vec slave, auto&& column, double scale) {
    const core::ReadArray a(slave);
    for (std::size_t i = 0; i < s.size(); ++i) column(s[i] - begin) += scale * a[static_cast<PetscInt>(i)];
  };

  core::Vector unit, x, f;
  check(MatCreateVecs(k_sm.get(), unit.put(), f.put()));
  x = core::duplicate(f.get());
  PetscInt first_master = 0;
  check(VecGetOwnershipRange(unit.get(), &first_master, nullptr));
  for (std::size_t i = 0; i < m.size(); ++i) basis.rows(m[i] - begin, first_master + static_cast<PetscInt>(i)) = 1;
  for (PetscInt j = 0; j < n_masters; ++j) {
    check(VecSet(unit.get(), 0));
    if (j >= first_master && j < first_master + static_cast<PetscInt>(m.size()))
      check(VecSetValue(unit.get(), j, 1, INSERT_VALUES));
    check(VecAssemblyBegin(unit.get()));
    check(VecAssemblyEnd(unit.get()));
    check(MatMult(k_sm.get(), unit.get(), f.get()));
    check(KSPSolve(solver.get(), f.get(), x.get()));
    scatter(x.get(), basis.rows.col(j), -1);
  }

  {
    const core::ReadArray w(planar.weight.get());
    const core::WriteArray a(f.get());
    for (std::size_t i = 0; i < s.size(); ++i) a[static_cast<PetscInt>(i)] = w[s[i] - begin];
  }
  check(KSPSolve(solver.get(), f.get(), x.get()));
  scatter(x.get(), basis.offset, 1);

  // One mode more than kept tells where the reduced model ends.
  std::vector<double> values;
  values = lowest_eigenvalues(k_ss.get(), m_ss.get(), 0.0, n_modes + 1, {}, [&](PetscInt i, Vec v) {
    if (i >= n_modes) return;
    fix_sign(v);
    scatter(v, basis.rows.col(n_masters + i), 1);
  });
  core::agree(comm, [&] {
    if (!values.empty() && !(values.front() > 0))
      throw core::NotConverged(std::string(held_stiffness) + " is not positive definite");
  });
  // Taken out of the offset: what the modes carry of the static shape.
  for (PetscInt i = 0; i < n_modes; ++i) {
    const auto mode = basis.rows.col(n_masters + i);
    const core::ReadArray w(planar.weight.get());
    double mine = 0, product = 0;
    for (PetscInt row = 0; row < w.size(); ++row) mine += mode(row) * w[row];
    MPI_Allreduce(&mine, &product, 1, MPI_DOUBLE, MPI_SUM, comm);
    basis.offset -= product / values[static_cast<std::size_t>(i)] * mode;
  }
  if (n_modes > 0) basis.quality.retained = std::sqrt(values[static_cast<std::size_t>(n_modes - 1)]);
  basis.quality.neglected = static_cast<PetscInt>(values.size()) > n_modes ? std::sqrt(values.back())
                                                                           : std::numeric_limits<double>::infinity();
  return basis;
}

core::Matrix matrix_of(const Eigen::MatrixXd& rows, PetscInt columns, MPI_Comm comm) {
  PetscInt begin = 0, column_end = 0;
  MPI_Scan(&columns, &column_end, 1, MPIU_INT, MPI_SUM, comm);
  std::vector<PetscInt> here, elsewhere;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const auto inside = rows.row(i).segment(column_end - columns, columns).array() != 0;
    const PetscInt n_inside = static_cast<PetscInt>(inside.count());
    here.push_back(n_inside);
    elsewhere.push_back(static_cast<PetscInt>((rows.row(i).array() != 0).count()) - n_inside);
  }
  core::Matrix t;
  check(MatCreateAIJ(comm, static_cast<PetscInt>(rows.rows()), columns, PETSC_DETERMINE,
                     static_cast<PetscInt>(rows.cols()), 0, here.data(), 0, elsewhere.data(), t.put()));
  check(MatGetOwnershipRange(t.get(), &begin, nullptr));
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    for (Eigen::Index j = 0; j < rows.cols(); ++j)
      if (rows(i, j) != 0)
        check(MatSetValue(t.get(), begin + static_cast<PetscInt>(i), static_cast<PetscInt>(j), rows(i, j),
                          INSERT_VALUES));
  check(MatAssemblyBegin(t.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(t.get(), MAT_FINAL_ASSEMBLY));
  return t;
}

core::Matrix to_matrix(const PlanarBasis& basis, MPI_Comm comm) {
  PetscInt local = PETSC_DECIDE, n = basis.rows.cols();
  check(PetscSplitOwnership(comm, &local, &n));
  return matrix_of(basis.rows, local, comm);
}

Eigen::MatrixXd sum_over_ranks(const Eigen::MatrixXd& mine, MPI_Comm comm) {
  Eigen::MatrixXd sum(mine.rows(), mine.cols());
  MPI_Allreduce(mine.data(), sum.data(), static_cast<int>(mine.size()), MPI_DOUBLE, MPI_SUM, comm);
  return sum;
}

Eigen::MatrixXd projected(Mat a, const Eigen::MatrixXd& rows) {
  const Eigen::Index n = rows.cols();
  core::Vector x, y;
  check(MatCreateVecs(a, x.put(), y.put()));
  Eigen::MatrixXd mine(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    {
      const core::WriteArray to(x.get());
      Eigen::Map<Eigen::VectorXd>(to.data(), to.size()) = rows.col(j);
    }
    check(MatMult(a, x.get(), y.get()));
    const core::ReadArray from(y.get());
    mine.col(j) = rows.transpose() * Eigen::Map<const Eigen::VectorXd>(from.data(), from.size());
  }
  const Eigen::MatrixXd sum = sum_over_ranks(mine, comm_of(a));
  return (sum + sum.transpose()) / 2;
}

core::Matrix project(Mat a, const PlanarBasis& basis) {
  return distribute(projected(a, basis.rows), comm_of(a));
}

core::Vector project(Vec f, const PlanarBasis& basis) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(f));
  const core::ReadArray from(f);
  const Eigen::VectorXd mine = basis.rows.transpose() * Eigen::Map<const Eigen::VectorXd>(from.data(), from.size());
  Eigen::VectorXd sum(mine.size());
  MPI_Allreduce(mine.data(), sum.data(), static_cast<int>(mine.size()), MPI_DOUBLE, MPI_SUM, comm);
  core::Vector v = core::make_vector(comm, PETSC_DECIDE, static_cast<PetscInt>(sum.size()));
  PetscInt begin = 0;
  check(VecGetOwnershipRange(v.get(), &begin, nullptr));
  const core::WriteArray to(v.get());
  for (PetscInt i = 0; i < to.size(); ++i) to[i] = sum(begin + i);
  return v;
}

}  // namespace whirl::rotor
