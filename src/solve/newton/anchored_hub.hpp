#pragma once
// The bordered Jacobian of an equilibrium on the ports of a machine, around factors that many points share.

#include <Eigen/Core>
#include <utility>

#include "solve/newton/hub_lu.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/problem/thin_blocks.hpp"

namespace whirl::solve {

/// With the forces of the films on a machine whose films have no states, B f(C x) and D = df/dw,
///
///     [ L0 - B D C   column ] [ x ]   [ y   ]
///     [ row          corner ] [ p ] = [ y_p ]
///
/// L0 alone may be that of a free shaft, which is singular. M = L0 - B D0 C is factorised in its place. D0 are the
/// tangents of the first point, 1.1 times these where M would be singular or nearly so. D - D0 enters at the ports,
///
///     x = M^-1 y + M^-1 B f - M^-1 column p,     f = (D - D0) C x
///
/// and is solved with the border as a matrix of size r + 1 (Woodbury 1950), which is regular at folds too. Columns of
/// rates meet the kinematic rows alone: M leaves them out, and one step of refinement puts that right. So M serves at
/// all points with the same other columns: a shaft has one at all speeds, unless damping turns with it.
class AnchoredHub {
public:
  /// D [r x w], column [n], row [n + 1] with the corner; `blocks` outlive the solves. False if M is singular, and then
  /// nothing can be solved.
  [[nodiscard]] bool set(const problem::ThinBlocks& blocks, const Eigen::MatrixXd& tangents, Eigen::VectorXd column,
                         Eigen::VectorXd row);
  /// Of [n + 1]: products with the matrix above, with the L0 that its blocks hold now, with its inverse, and with the
  /// inverse of its transpose.
  [[nodiscard]] Eigen::VectorXd multiply(const Eigen::VectorXd& x) const;
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& y) const;
  [[nodiscard]] Eigen::VectorXd solve_transposed(const Eigen::VectorXd& y) const;

  /// D0, empty before there is one: solves with the same one round alike.
  [[nodiscard]] const Eigen::MatrixXd& anchor() const { return anchor_; }
  void set_anchor(Eigen::MatrixXd anchor) {
    anchor_ = std::move(anchor);
    made_ = false;
  }

private:
  [[nodiscard]] bool factorise(const Eigen::MatrixXd& anchor);
  /// With tangents of its own, or with others near them.
  [[nodiscard]] bool anchor_at(const Eigen::MatrixXd& tangents);
  /// The present L0 without couplings of rates.
  [[nodiscard]] problem::SparseBlock without_rates() const;
  [[nodiscard]] Eigen::VectorXd multiply_transposed(const Eigen::VectorXd& x) const;
  [[nodiscard]] Eigen::VectorXd apply(const Eigen::VectorXd& y) const;
  [[nodiscard]] Eigen::VectorXd apply_transposed(const Eigen::VectorXd& y) const;

  const problem::ThinBlocks* blocks_ = nullptr;
  HubLu lu_;
  bool made_ = false, exact_ = false;         // factors; of all columns of the present L0
  problem::SparseBlock l0_, b_, c_;           // of the factors, l0_ without couplings of rates
  Eigen::MatrixXd anchor_;                    // and their D0
  Eigen::MatrixXd tangents_, moved_;          // D and D - D0
  Eigen::VectorXd column_, row_, by_column_;  // by_column_: M^-1 column
  core::DenseLu<double> small_;
};

}  // namespace whirl::solve
