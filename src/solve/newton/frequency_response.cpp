#include "whirl/solve/newton/frequency_response.hpp"

#include "solve/newton/pencil.hpp"
#include "solve/newton/shifted_system.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Map;
using Eigen::MatrixXd;

// The nonzeros of a matrix on one rank by columns.
struct FrequencyResponse::Copy {
  Pencil::Matrix matrix;
  std::vector<PetscInt> place;  // of each stored entry among the values of `matrix`, -1 for a zero

  void take(Mat from) {
    PetscInt n = 0;
    const PetscInt *begin = nullptr, *columns = nullptr;
    const PetscScalar* values = nullptr;
    PetscBool done = PETSC_FALSE;
    check(MatGetRowIJ(from, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &done));
    check(MatSeqAIJGetArrayRead(from, &values));
    if (!fill(values)) {
      place.assign(static_cast<std::size_t>(begin[n]), -1);
      std::vector<Eigen::Triplet<double>> entries;  // with their numbers in place of their values
      for (PetscInt i = 0; i < n; ++i)
        for (PetscInt e = begin[i]; e < begin[i + 1]; ++e)
          if (values[e] != 0) entries.emplace_back(i, columns[e], e);
      matrix.resize(n, n);
      matrix.setFromTriplets(entries.begin(), entries.end());
      for (PetscInt k = 0; k < matrix.nonZeros(); ++k) place[static_cast<std::size_t>(matrix.valuePtr()[k])] = k;
      (void)fill(values);
    }
    check(MatSeqAIJRestoreArrayRead(from, &values));
    check(MatRestoreRowIJ(from, 0, PETSC_FALSE, PETSC_FALSE, &n, &begin, &columns, &done));
  }
  // False if an entry that was zero is none now.
  bool fill(const PetscScalar* values) {
    for (std::size_t e = 0; e < place.size(); ++e)
      if (place[e] >= 0)
        matrix.valuePtr()[place[e]] = values[e];
      else if (values[e] != 0)
        return false;
    return !place.empty();
  }
};

FrequencyResponse::FrequencyResponse(problem::System& system) : shifted_(std::make_unique<ShiftedSystem>(system)) {
  if (core::size_of(system.comm()) > 1) return;
  pencil_ = std::make_unique<Pencil>();
  copies_ = std::make_unique<std::array<Copy, 2>>();
}

FrequencyResponse::~FrequencyResponse() = default;

// Real parts in one row, imaginary parts in the other.
bool FrequencyResponse::solve_by_pencil(double omega, const double* right, double* amplitude) {
  (*copies_)[0].take(shifted_->by_state());
  (*copies_)[1].take(shifted_->by_rate());
  const Pencil::Matrix &l0 = (*copies_)[0].matrix, &l1 = (*copies_)[1].matrix;
  try {
    pencil_->compute(l1, l0, Eigen::ArrayXcd::Constant(1, {0, omega}));
  } catch (const core::NotConverged&) {
    return false;
  }
  const Map<const MatrixXd> b(right, 2, l0.rows());
  Map<MatrixXd> z(amplitude, 2, l0.rows());
  z.setZero();
  MatrixXd left = b, by_state, by_rate;
  const double rounding = 1e-15, enough = 1e-13;
  double size = 0, last = 0;
  for (int k = 0; k < 4; ++k) {
    pencil_->solve(left);
    z += left;
    by_state = z * l0.transpose();
    by_rate = omega * (z * l1.transpose());
    left = b - by_state;
    left.row(0) += by_rate.row(1);
    left.row(1) -= by_rate.row(0);
    size = b.norm() + by_state.norm() + by_rate.norm();
    last = left.norm();
    if (last <= rounding * size) break;
  }
  return last <= enough * size;
}

void FrequencyResponse::solve(Vec x, double omega, const std::vector<double>& right, std::vector<double>& amplitude) {
  shifted_->linearise(x);
  core::Vector b = shifted_->make_vector(), z = core::duplicate(b.get());
  {
    const core::ReadArray scale(shifted_->residual_scale());
    const core::WriteArray a(b.get()), answer(z.get());
    for (PetscInt i = 0; i < a.size(); ++i) a[i] = right[static_cast<std::size_t>(i)] / scale[i / 2];
    if (pencil_ && !solve_by_pencil(omega, a.data(), answer.data())) pencil_.reset();
  }
  if (!pencil_) {
    shifted_->factorise(omega);
    shifted_->solve(b.get(), z.get());
  }
  const core::ReadArray a(z.get()), scale(shifted_->state_scale());
  amplitude.resize(static_cast<std::size_t>(a.size()));
  for (PetscInt i = 0; i < a.size(); ++i) amplitude[static_cast<std::size_t>(i)] = a[i] * scale[i / 2];
}

}  // namespace whirl::solve
