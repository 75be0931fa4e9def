#pragma once
// Inverse of the equations of a film whose states stand in columns, on the ranks that hold them.

#include <mpi.h>

#include <Eigen/Core>
#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// A^-1 to rounding, A = alpha dg/ds + sigma dg/ds', of films whose rows see their neighbours before, after, below and
/// above in strips of columns (one strip a pad). A strip on one rank is a ColumnChain. Where ranks cut a strip, the
/// first column behind the cut separates them: what lies before the first cut is eliminated up to it, what lies behind
/// the last one back to it, both at the same time, and the columns at cuts are solved by all as one dense matrix.
/// Cost: ColumnChain; a rank between two cuts of a strip takes three times as much.
class StripInverse final : public ExactStateInverse {
public:
  using Complex = std::complex<double>;
  /// A strip: its first state in the film, and its columns.
  struct Extent {
    int first, columns;
  };
  /// What inverses of one film have in common: factors that one of them made serve another one at the same derivatives.
  struct Latest;
  static std::shared_ptr<Latest> nothing_yet();

  /// `line` states in each column; every rank of `comm` holds a share that is not empty. Collective.
  StripInverse(MPI_Comm comm, const Share& share, int line, const std::vector<Extent>& strips,
               std::shared_ptr<Latest> latest);
  ~StripInverse() override;

  /// Makes no factors if those at hand belong to the same derivatives, to rounding (1e-12 of each).
  void set(const StateDerivatives& at, double alpha, double sigma) override;
  void apply(std::span<const double> r, std::span<double> x) override;
  void apply_transposed(std::span<const double> r, std::span<double> x) override;
  void set_at(const StateDerivatives& at, Complex lambda) override;
  void apply_at(std::span<const Complex> r, std::span<Complex> x) override;
  /// Factorisations so far, of this inverse.
  [[nodiscard]] long factorisations() const { return factorisations_; }

private:
  enum Place { before, after, below, above, itself, places };
  template <class Scalar>
  using Entries = Eigen::Array<Scalar, Eigen::Dynamic, 1>;  // [5 rows]
  template <class Scalar>
  class Piece;
  template <class Scalar>
  struct Factors;
  struct Cut {  // of a strip: columns here, the cuts of all ranks, this rank's and the next one's among them or -1
    int row, columns, cuts, mine, next;
  };
  template <class Scalar>
  [[nodiscard]] Entries<Scalar> entries(const StateDerivatives& at, double alpha, Scalar sigma) const;
  template <class Scalar>
  void solve(const Factors<Scalar>& factors, bool transposed, std::span<const Scalar> r, std::span<Scalar> x) const;
  // Factors of these from those at hand, `known` ones or anew.
  template <class Scalar>
  void find(Entries<Scalar> entries, std::shared_ptr<Factors<Scalar>>& at_hand, std::shared_ptr<Factors<Scalar>> known);

  MPI_Comm comm_;
  int line_, rows_;
  bool shared_ = false;  // a strip is cut
  std::vector<Cut> cuts_;
  std::vector<int> state_places_, rate_places_;  // of derivatives among five entries a row
  std::shared_ptr<Factors<double>> factors_;
  std::shared_ptr<Factors<Complex>> factors_at_;  // of a complex frequency
  std::shared_ptr<Latest> latest_;
  long factorisations_ = 0;
};

}  // namespace whirl::film
