// Real modes of a shaft at rest as a basis whose coordinates hold the masters.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "eigen.hpp"
#include "reduction.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/least_squares.hpp"
#include "whirl/core/symmetric.hpp"

namespace whirl::rotor {

using core::check;

namespace {

struct Modes {
  Eigen::MatrixXd rows;         // this rank's, one column a mode
  std::vector<double> squares;  // of their frequencies, one more than columns if there is one
};

Modes lowest_modes(const Planar& planar, const Reduction& reduction, const std::vector<int>& masters) {
  core::Matrix k;
  check(MatDuplicate(planar.stiffness.get(), MAT_COPY_VALUES, k.put()));
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(k.get(), &begin, &end));
  for (const int m : masters)
    if (m % 2 == 0 && m >= begin && m < end) check(MatSetValue(k.get(), m, m, reduction.support, ADD_VALUES));
  check(MatAssemblyBegin(k.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(k.get(), MAT_FINAL_ASSEMBLY));
  // Below all of them, also where the shaft is free; far from the elastic ones a shift costs digits of the rigid ones.
  core::Vector stiff, heavy;
  check(MatCreateVecs(k.get(), stiff.put(), heavy.put()));
  check(MatGetDiagonal(k.get(), stiff.get()));
  check(MatGetDiagonal(planar.mass.get(), heavy.get()));
  check(VecPointwiseDivide(stiff.get(), stiff.get(), heavy.get()));
  double lowest = 0;
  check(VecMin(stiff.get(), nullptr, &lowest));
  const double shift = -1e-6 * lowest;
  Modes out;
  out.rows = Eigen::MatrixXd::Zero(end - begin, reduction.modes);
  out.squares = lowest_eigenvalues(k.get(), planar.mass.get(), shift, reduction.modes + 1, {}, [&](PetscInt i, Vec v) {
    if (i >= reduction.modes) return;
    const core::ReadArray a(v);
    out.rows.col(i) = Eigen::Map<const Eigen::VectorXd>(a.data(), a.size());
  });
  return out;
}

}  // namespace

PlanarBasis modal_basis(const Planar& planar, const Reduction& reduction) {
  const Mat k = planar.stiffness.get();
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(k));
  const std::vector<int> masters = planar_masters(reduction);
  const auto n = static_cast<Eigen::Index>(masters.size());
  const Modes modes = lowest_modes(planar, reduction, masters);
  PetscInt begin = 0, end = 0;
  check(MatGetOwnershipRange(k, &begin, &end));
  Eigen::MatrixXd mine = Eigen::MatrixXd::Zero(n, modes.rows.cols());
  for (Eigen::Index m = 0; m < n; ++m) {
    const int row = masters[static_cast<std::size_t>(m)];
    if (row >= begin && row < end) mine.row(m) = modes.rows.row(row - begin);
  }
  const Eigen::MatrixXd at_masters = sum_over_ranks(mine, comm);
  // The pseudo-inverse of at_masters moves the masters; what it does not reach, an eigenspace of the projector
  // I - pseudo at_masters, holds them.
  const Eigen::Index all_modes = modes.rows.cols();
  Eigen::MatrixXd pseudo;
  core::SymmetricPairs projector;
  core::agree(comm, [&] {
    pseudo = core::least_squares(at_masters, Eigen::MatrixXd::Identity(n, n));
    const Eigen::MatrixXd beside = Eigen::MatrixXd::Identity(all_modes, all_modes) - pseudo * at_masters;
    projector = core::symmetric_pairs((beside + beside.transpose()) / 2, "what holds the masters");
    if (projector.values.sum() > static_cast<double>(all_modes - n) + 0.5)
      throw core::InputError("the modes of the shaft do not tell its masters apart: more modes, or fewer masters");
  });
  // Any basis of that space would do, and rounding decides which one is found. So all ranks use that of rank 0.
  core::share(comm, pseudo.data(), static_cast<std::size_t>(pseudo.size()));
  core::share(comm, projector.vectors.data(), static_cast<std::size_t>(projector.vectors.size()));
  const Eigen::MatrixXd held = modes.rows * projector.vectors.rightCols(all_modes - n);
  PlanarBasis basis;
  basis.offset = Eigen::VectorXd::Zero(end - begin);
  basis.rows.resize(end - begin, modes.rows.cols());
  Eigen::MatrixXd moved = modes.rows * pseudo;
  if (held.cols() > 0) {
    const Eigen::MatrixXd stiffness = projected(k, held), mass = projected(planar.mass.get(), held);
    core::SymmetricPairs own;
    core::agree(comm, [&] {
      own = core::symmetric_pairs(stiffness, mass, "the mass of the shaft with its masters held");
      if (!(own.values(0) > 0)) throw core::NotConverged(std::string(held_stiffness) + " is not positive definite");
    });
    Eigen::MatrixXd inner = held * own.vectors;
    // The sign by a generic direction, as the same shaft on other ranks.
    Eigen::RowVectorXd generic = Eigen::RowVectorXd::Zero(inner.cols());
    for (Eigen::Index r = 0; r < inner.rows(); ++r)
      generic += (1 + std::cos(static_cast<double>(begin + r))) * inner.row(r);
    generic = sum_over_ranks(generic, comm);
    for (Eigen::Index c = 0; c < inner.cols(); ++c)
      if (generic(c) < 0) inner.col(c) *= -1;
    Eigen::MatrixXd all(moved.rows(), n + inner.cols());
    all << moved, inner;
    const Eigen::MatrixXd coupling = projected(k, all).bottomLeftCorner(inner.cols(), n);
    moved -= inner * own.values.cwiseInverse().asDiagonal() * coupling;
    basis.rows.rightCols(inner.cols()) = inner;
  }
  // What is a master moves by itself, without rounding.
  for (Eigen::Index m = 0; m < n; ++m) {
    const int row = masters[static_cast<std::size_t>(m)];
    if (row < begin || row >= end) continue;
    moved.row(row - begin).setZero();
    moved(row - begin, m) = 1;
    basis.rows.row(row - begin).setZero();
  }
  basis.rows.leftCols(n) = moved;
  const auto kept = static_cast<std::size_t>(modes.rows.cols());
  basis.quality.retained = std::sqrt(std::max(modes.squares[kept - 1], 0.0));
  basis.quality.neglected =
      modes.squares.size() > kept ? std::sqrt(modes.squares.back()) : std::numeric_limits<double>::infinity();
  return basis;
}

}  // namespace whirl::rotor
