#pragma once
// The equations of a whole film as a sparse matrix of Eigen.

#include <Eigen/SparseCore>
#include <span>
#include <vector>

#include "whirl/film/contract/share.hpp"

namespace whirl::film {

/// A = alpha dg/ds + sigma dg/ds' [states x states] of a film that one rank holds, filled over and over: where its
/// entries stand is found once. `Scalar` is double or std::complex<double>.
template <class Scalar>
class FilmMatrix {
public:
  using Sparse = Eigen::SparseMatrix<Scalar>;
  /// Entries at the places of dg/ds, and if wanted at those of dg/ds', of the share that holds all.
  FilmMatrix(const Share& whole, const Places& states, const Places* rates = nullptr);
  /// Its entries with whatever values.
  [[nodiscard]] const Sparse& pattern() const { return matrix_; }
  /// Of derivatives at their places.
  [[nodiscard]] const Sparse& filled(std::span<const double> d_states, std::span<const double> d_rates = {},
                                     double alpha = 1.0, Scalar sigma = 0.0);

private:
  Sparse matrix_;
  std::vector<std::size_t> of_states_, of_rates_;  // where each entry stands among the values
};

}  // namespace whirl::film
