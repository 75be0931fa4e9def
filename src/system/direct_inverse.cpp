#include "direct_inverse.hpp"

#include <algorithm>
#include <complex>
#include <limits>
#include <optional>

#include "whirl/core/direct_solver.hpp"
#include "whirl/core/entry_stream.hpp"
#include "whirl/core/pivoted_lu.hpp"
#include "whirl/film/algebra/film_matrix.hpp"

namespace whirl::system {
namespace {

using core::check;
using Complex = std::complex<double>;

template <class Scalar>
void not_finite(std::span<Scalar> x) {
  std::fill(x.begin(), x.end(), std::numeric_limits<double>::quiet_NaN());
}

/// Of a film on one rank.
template <class Scalar>
class LocalFactors {
public:
  LocalFactors(MPI_Comm /*comm*/, const film::Share& whole) : matrix_(whole, whole.d_states, &whole.d_rates) {
    lu_.analyse(matrix_.pattern());
  }
  void set(const film::StateDerivatives& at, double alpha, Scalar sigma) {
    lu_.factorise(matrix_.filled(at.states, at.rates, alpha, sigma));
  }
  void solve(bool transposed, std::span<const Scalar> r, std::span<Scalar> x) {
    if (!lu_.regular()) return not_finite(x);
    const Eigen::Index n = matrix_.pattern().rows(), columns = static_cast<Eigen::Index>(r.size()) / n;
    if (transposed)
      lu_.solve_transposed(r.data(), x.data(), columns);
    else
      lu_.solve(r.data(), x.data(), columns);
  }

private:
  film::FilmMatrix<Scalar> matrix_;
  core::PivotedLu<Scalar> lu_;
};

/// Of a film on several ranks; a complex number a + i b is the block [a -b; b a].
template <class Scalar>
class SharedFactors {
public:
  SharedFactors(MPI_Comm comm, const film::Share& share) : comm_(comm), rows_(share.rows()) {
    std::vector<PetscInt> count(static_cast<std::size_t>(width * rows_), 0);
    const auto take = [&](const film::Places& places, std::vector<Place>& to) {
      film::for_entries(share, places, {}, [&](int row, int state, double) {
        to.push_back({share.begin + row, state});
        for (PetscInt d = 0; d < width; ++d) count[static_cast<std::size_t>(width * row + d)] += width;
      });
    };
    take(share.d_states, states_);
    take(share.d_rates, rates_);
    PetscInt all = width * rows_;
    MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPIU_INT, MPI_SUM, comm);
    for (PetscInt& c : count) c = std::min(c, all);
    matrix_ = core::make_matrix(comm, width * rows_, std::move(count));
    check(KSPCreate(comm, solver_.put()));
    core::make_direct(solver_.get());
  }
  void set(const film::StateDerivatives& at, double alpha, Scalar sigma) {
    check(MatZeroEntries(matrix_.get()));
    entries_.begin(matrix_.get());
    for (std::size_t k = 0; k < states_.size(); ++k) add(states_[k], Scalar(alpha * at.states[k]));
    for (std::size_t k = 0; k < rates_.size(); ++k) add(rates_[k], sigma * at.rates[k]);
    entries_.end();
    check(KSPSetOperators(solver_.get(), matrix_.get(), matrix_.get()));
    check(KSPSetUp(solver_.get()));
    PC pc = nullptr;
    PCFailedReason reason = PC_NOERROR;
    check(KSPGetPC(solver_.get(), &pc));
    check(PCGetFailedReason(pc, &reason));
    regular_ = reason == PC_NOERROR;
  }
  void solve(bool transposed, std::span<const Scalar> r, std::span<Scalar> x) {
    if (!regular_) return not_finite(x);
    auto* const right = const_cast<double*>(reinterpret_cast<const double*>(r.data()));
    auto* const answer = reinterpret_cast<double*>(x.data());
    const auto columns = static_cast<PetscInt>(r.size()) / rows_;
    core::Matrix b, y;
    for (const auto& [m, data] : {std::pair{&b, right}, std::pair{&y, answer}})
      check(MatCreateDense(comm_, width * rows_, PETSC_DECIDE, PETSC_DETERMINE, columns, data, m->put()));
    if (!transposed) return check(KSPMatSolve(solver_.get(), b.get(), y.get()));
    for (PetscInt k = 0; k < columns; ++k) {
      Vec from = nullptr, to = nullptr;
      check(MatDenseGetColumnVecRead(b.get(), k, &from));
      check(MatDenseGetColumnVecWrite(y.get(), k, &to));
      check(KSPSolveTranspose(solver_.get(), from, to));
      check(MatDenseRestoreColumnVecRead(b.get(), k, &from));
      check(MatDenseRestoreColumnVecWrite(y.get(), k, &to));
    }
  }

private:
  static constexpr PetscInt width = sizeof(Scalar) / sizeof(double);
  struct Place {
    PetscInt row, column;
  };
  void add(Place p, double value) { entries_.add(p.row, p.column, value); }
  void add(Place p, Complex value) {
    for (PetscInt d = 0; d < 2; ++d) entries_.add(2 * p.row + d, 2 * p.column + d, value.real());
    entries_.add(2 * p.row, 2 * p.column + 1, -value.imag());
    entries_.add(2 * p.row + 1, 2 * p.column, value.imag());
  }

  MPI_Comm comm_;
  PetscInt rows_;
  std::vector<Place> states_, rates_;
  core::Matrix matrix_;
  core::EntryStream entries_;
  core::LinearSolver solver_;
  bool regular_ = false;
};

/// Keeps what its factors are made from: those of a complex frequency are made when first wanted.
template <template <class> class Factors>
class DirectInverse final : public film::ExactStateInverse {
public:
  DirectInverse(MPI_Comm comm, const film::Share& share) : comm_(comm), share_(share), real_(comm, share) {}
  void set(const film::StateDerivatives& at, double alpha, double sigma) override { real_.set(at, alpha, sigma); }
  void apply(std::span<const double> r, std::span<double> x) override { real_.solve(false, r, x); }
  void apply_transposed(std::span<const double> r, std::span<double> x) override { real_.solve(true, r, x); }
  void set_at(const film::StateDerivatives& at, Complex lambda) override {
    if (!complex_) complex_.emplace(comm_, share_);
    complex_->set(at, 1.0, lambda);
  }
  void apply_at(std::span<const Complex> r, std::span<Complex> x) override { complex_->solve(false, r, x); }

private:
  MPI_Comm comm_;
  film::Share share_;
  Factors<double> real_;
  std::optional<Factors<Complex>> complex_;
};

}  // namespace

std::unique_ptr<film::StateInverse> make_direct_inverse(MPI_Comm comm, const film::Share& share) {
  if (core::size_of(comm) > 1) return std::make_unique<DirectInverse<SharedFactors>>(comm, share);
  return std::make_unique<DirectInverse<LocalFactors>>(comm, share);
}

}  // namespace whirl::system
