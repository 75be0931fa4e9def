#pragma once
// Ways to solve A x = b, by libraries and by classes of our own, and a table of what they cost.

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "whirl/core/band_lu.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/index.hpp"
#include "whirl/core/inverse.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/core/pivoted_lu.hpp"
#include "whirl/core/sparse_lu.hpp"

extern "C" {
void dpbtrf_(const char*, const int* n, const int* kd, double* ab, const int* ldab, int* info);
void dpbtrs_(const char*, const int* n, const int* kd, const int* sides, const double* ab, const int* ldab, double* b,
             const int* ldb, int* info);
void dgbtrf_(const int* m, const int* n, const int* kl, const int* ku, double* ab, const int* ldab, int* pivots, int*);
void dgbtrs_(const char*, const int* n, const int* kl, const int* ku, const int* sides, const double* ab,
             const int* ldab, const int* pivots, double* b, const int* ldb, int* info);
void dgetrf_(const int* m, const int* n, double* a, const int* lda, int* pivots, int* info);
void dgetrs_(const char*, const int* n, const int* sides, const double* a, const int* lda, const int* pivots, double* b,
             const int* ldb, int* info);
}

namespace whirl::bench {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;

/// One way to solve A x = b; error() is that of the last solve.
struct Way {
  std::string name;
  std::function<void()> factorise, solve;
  std::function<double()> error;
};

inline double microseconds(const std::function<void()>& work, int times) {
  return 1e6 / times * least(PETSC_COMM_SELF, 1, [&] {
                         for (int k = 0; k < times; ++k) work();
                       }).processor;
}

/// Prints processor times of all ways, least of nine turns, in each of which every way runs for half a millisecond. The
/// ratio is the time of the first way, factors and solves together, over that of another.
inline void compare(const std::string& what, Index n, Index sides, const std::vector<Way>& ways) {
  fmt::print("\n{}: n = {}, {} right-hand sides\n{:<28} {:>13} {:>11} {:>8} {:>9}\n", what, n, sides, "",
             "factorise, us", "solve, us", "ratio", "error");
  constexpr double run = 500;  // us
  const auto times = [](const std::function<void()>& work) {
    return std::clamp(static_cast<int>(run / microseconds(work, 1)), 1, 500);
  };
  std::vector<std::array<double, 2>> best(ways.size(), {1e30, 1e30});
  for (int turn = 0; turn < 9; ++turn)
    for (std::size_t k = 0; k < ways.size(); ++k) {
      best[k][0] = std::min(best[k][0], microseconds(ways[k].factorise, times(ways[k].factorise)));
      best[k][1] = std::min(best[k][1], microseconds(ways[k].solve, times(ways[k].solve)));
    }
  const auto sum = [&](std::size_t k) { return best[k][0] + best[k][1]; };
  for (std::size_t k = 0; k < ways.size(); ++k)
    fmt::print("{:<28} {:>13.4g} {:>11.4g} {:>8.2f} {:>9.1e}\n", ways[k].name, best[k][0], best[k][1], sum(0) / sum(k),
               ways[k].error());
}

/// The largest part that is left of a row, of the terms that it is the sum of (Oettli and Prager 1964).
template <class Matrix, class Columns>
double left(const Matrix& a, const Columns& x, const Columns& b) {
  const MatrixXd rest = (a * x - b).cwiseAbs(), terms = a.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
  return (rest.array() / terms.array().max(1e-300)).maxCoeff();
}

inline Sparse made_of(Index n, const Entries& entries) {
  Sparse a(n, n);
  a.setFromTriplets(entries.begin(), entries.end());
  return a;
}

/// Right-hand sides without a pattern.
inline MatrixXd sides(Index n, Index count) {
  return MatrixXd::NullaryExpr(n, count, [n](Index i, Index k) { return std::sin(1.7 * (i + n * k) * (i + 1)); });
}

inline int bandwidth(const Sparse& a) {
  return core::BandLu::bandwidth(a);
}

/// Pads ask for the pressure first, then for four adjoints, of matrices that are not symmetric by the transpose.
inline double left_of_pad(const Sparse& a, const MatrixXd& x, const MatrixXd& b) {
  const auto k = b.cols() - 1;
  return std::max(left<Sparse, MatrixXd>(a, x.leftCols(1), b.leftCols(1)),
                  left<Sparse, MatrixXd>(a.transpose(), x.rightCols(k), b.rightCols(k)));
}

/// core::BandLu of a pad, its entries set in place.
inline Way band_in_place(const Sparse& a, const MatrixXd& b, bool symmetric) {
  struct State {
    core::BandLu band;
    MatrixXd x;
  };
  const auto n = static_cast<int>(a.rows());
  auto s = std::make_shared<State>(State{core::BandLu(n, bandwidth(a)), b});
  return {"BandLu, in place",
          [s, a] {
            s->band.clear();
            for (int j = 0; j < a.cols(); ++j)
              for (Sparse::InnerIterator e(a, j); e; ++e) s->band.entry(static_cast<int>(e.row()), j) = e.value();
            s->band.factor();
          },
          [s, b, symmetric] {
            s->band.solve(false, b.data(), s->x.data(), 1);
            s->band.solve(!symmetric, b.col(1).data(), s->x.col(1).data(), b.cols() - 1);
          },
          [s, a, b] { return left_of_pad(a, s->x, b); }};
}

/// dpbtrf (positive definite) or dgbtrf; of a pad as above.
inline Way lapack_band(const Sparse& a, const MatrixXd& b, bool positive = false, bool pad = false) {
  struct State {
    int n, w, ld, info = 0;
    MatrixXd original, ab, x;
    std::vector<int> pivots;
  };
  const int n = static_cast<int>(a.rows()), w = bandwidth(a), ld = positive ? w + 1 : 3 * w + 1;
  auto s = std::make_shared<State>(State{n, w, ld, 0, MatrixXd::Zero(ld, n), {}, b, std::vector<int>(core::at(n))});
  for (int j = 0; j < n; ++j)
    for (Sparse::InnerIterator e(a, j); e; ++e)
      if (!positive || e.row() >= j) s->original((positive ? 0 : 2 * w) + e.row() - j, j) = e.value();
  const auto solve = [s, positive](const char* how, double* x, int count) {
    positive ? dpbtrs_("L", &s->n, &s->w, &count, s->ab.data(), &s->ld, x, &s->n, &s->info)
             : dgbtrs_(how, &s->n, &s->w, &s->w, &count, s->ab.data(), &s->ld, s->pivots.data(), x, &s->n, &s->info);
  };
  return {positive ? "dpbtrf" : "dgbtrf",
          [s, positive] {
            s->ab = s->original;
            positive ? dpbtrf_("L", &s->n, &s->w, s->ab.data(), &s->ld, &s->info)
                     : dgbtrf_(&s->n, &s->n, &s->w, &s->w, s->ab.data(), &s->ld, s->pivots.data(), &s->info);
          },
          [s, b, pad, solve] {
            const auto count = static_cast<int>(b.cols()), first = pad ? 1 : count;
            s->x = b;
            solve("N", s->x.data(), first);
            if (first < count) solve("T", s->x.col(first).data(), count - first);
          },
          [s, a, b, pad] { return pad ? left_of_pad(a, s->x, b) : left(a, s->x, b); }};
}

/// KLU or MUMPS by PETSc.
inline Way petsc(const std::string& name, MatSolverType type, const Sparse& a, const MatrixXd& b) {
  struct State {
    Eigen::SparseMatrix<double, Eigen::RowMajor, PetscInt> rows;
    MatrixXd from, to;
    core::Matrix matrix, factors, b, x;
    MatFactorInfo info;
  };
  auto s = std::make_shared<State>();
  const auto n = static_cast<PetscInt>(a.rows()), count = static_cast<PetscInt>(b.cols());
  s->rows = a, s->from = b, s->to = b;
  core::check(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, s->rows.outerIndexPtr(), s->rows.innerIndexPtr(),
                                        s->rows.valuePtr(), s->matrix.put()));
  core::check(MatCreateSeqDense(PETSC_COMM_SELF, n, count, s->from.data(), s->b.put()));
  core::check(MatCreateSeqDense(PETSC_COMM_SELF, n, count, s->to.data(), s->x.put()));
  core::check(MatFactorInfoInitialize(&s->info));
  core::check(MatGetFactor(s->matrix.get(), type, MAT_FACTOR_LU, s->factors.put()));
  core::check(MatLUFactorSymbolic(s->factors.get(), s->matrix.get(), nullptr, nullptr, &s->info));
  return {name, [s] { core::check(MatLUFactorNumeric(s->factors.get(), s->matrix.get(), &s->info)); },
          [s] { core::check(MatMatSolve(s->factors.get(), s->b.get(), s->x.get())); },
          [s, a, b] { return left(a, s->to, b); }};
}
inline Way klu(const Sparse& a, const MatrixXd& b) {
  return petsc("KLU", MATSOLVERKLU, a, b);
}
inline Way mumps(const Sparse& a, const MatrixXd& b) {
  return petsc("MUMPS", MATSOLVERMUMPS, a, b);
}

/// Of a class of our own that factorises a matrix by `factorise` and solves with all columns by `solve`.
template <class Lu, class Matrix, class Columns, class Factorise, class Solve>
Way by(const std::string& name, std::shared_ptr<Lu> lu, const Matrix& a, const Columns& b, Factorise factorise,
       Solve solve) {
  auto x = std::make_shared<Columns>(b);
  return {name, [=] { factorise(*lu, a); }, [=] { *x = solve(*lu, b); }, [=] { return left(a, *x, b); }};
}
template <class Scalar>
Way pivoted(const Eigen::SparseMatrix<Scalar>& a, const MatrixXd& b) {
  auto lu = std::make_shared<core::PivotedLu<Scalar>>();
  lu->analyse(a);
  const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic> columns = b.cast<Scalar>();
  return by(
      "PivotedLu (KLU)", lu, a, columns, [](auto& l, const auto& m) { (void)l.factorise(m); },
      [](const auto& l, const auto& y) { return l.solve(y); });
}
inline Way sparse_lu(const Sparse& a, const MatrixXd& b) {
  return by(
      "SparseLu (PETSc)", std::make_shared<core::SparseLu>(), a, b, [](auto& l, const auto& m) { (void)l.compute(m); },
      [](const auto& l, const auto& y) { return l.solve(y); });
}
inline Way band_lu(const Sparse& a, const MatrixXd& b) {
  return by(
      "BandLu", std::make_shared<core::BandLu>(a), a, b, [](auto& l, const auto& m) { (void)l.factor(m); },
      [](const auto& l, const auto& y) { return l.solve(y); });
}
inline Way dense_lu(const MatrixXd& a, const MatrixXd& b) {
  return by(
      "DenseLu (Eigen)", std::make_shared<core::DenseLu<double>>(), a, b, [](auto& l, const auto& m) { l.compute(m); },
      [](const auto& l, const auto& y) { return l.solve(y); });
}
inline Way lapack_dense(const MatrixXd& a, const MatrixXd& b) {
  struct Factors {
    MatrixXd lu;
    std::vector<int> pivots;
  };
  const auto n = static_cast<int>(a.rows());
  return by(
      "dgetrf", std::make_shared<Factors>(Factors{a, std::vector<int>(core::at(n))}), a, b,
      [n](auto& f, const MatrixXd& m) {
        int info = 0;
        f.lu = m;
        dgetrf_(&n, &n, f.lu.data(), &n, f.pivots.data(), &info);
      },
      [n](const auto& f, const MatrixXd& y) {
        const auto count = static_cast<int>(y.cols());
        int info = 0;
        MatrixXd x = y;
        dgetrs_("N", &n, &count, f.lu.data(), &n, f.pivots.data(), x.data(), &n, &info);
        return x;
      });
}

/// A matrix after the other.
inline Way all_of(std::vector<Way> ways) {
  const auto all = std::make_shared<std::vector<Way>>(std::move(ways));
  return {all->front().name,
          [all] {
            for (const Way& w : *all) w.factorise();
          },
          [all] {
            for (const Way& w : *all) w.solve();
          },
          [all] {
            double most = 0;
            for (const Way& w : *all) most = std::max(most, w.error());
            return most;
          }};
}

}  // namespace whirl::bench
