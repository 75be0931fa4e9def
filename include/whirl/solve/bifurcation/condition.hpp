#pragma once
// Bifurcations as zeros of smooth functions of a solution: bordered test functions and their gradients.

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <memory>
#include <vector>

#include "whirl/solve/branch/continuation.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/cycle/cycle_quantity.hpp"
#include "whirl/solve/newton/adjoint.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

namespace whirl::solve {

/// The test whose zeros hold on to the time mesh only where the equations are smooth: check them on another one.
inline constexpr const char* generalised_flip = "generalised_flip";

/// A number whose zero along a curve of bifurcations is a point of codimension two.
struct CodimensionTest {
  const char* name;
  double value;
};

/// What tells one kind of bifurcation on a branch R(u) = 0: k equations g(u, z) = 0 in u and k - 1 inner unknowns z
/// (the frequency of a Hopf point, the cosine of a Neimark-Sacker angle).
///
/// g is the corner of a bordered matrix, [A b; c^T 0][v; g] = [0; 1] with A singular at the bifurcation: smooth
/// wherever A loses rank by one, without eigenvalues (Griewank and Reddien 1984; Govaerts 2000). Its derivative is
/// -w^T A' v with [A b; c^T 0]^T [w; g] = [0; 1]. Borders stay as they are between calls of update(), so that Newton's
/// method sees one function. Members are called with the branch problem linearised at u; gradients have the layout of
/// u. Collective on its communicator.
class Condition {
public:
  Condition() = default;
  Condition(const Condition&) = delete;
  Condition& operator=(const Condition&) = delete;
  virtual ~Condition() = default;

  /// Inner unknowns at the start [k - 1].
  [[nodiscard]] virtual Eigen::VectorXd start() const { return {}; }
  /// g [k].
  [[nodiscard]] virtual Eigen::VectorXd values(Vec u, const Eigen::VectorXd& inner) = 0;
  /// dg/dz [k x (k - 1)] and the gradients of g in u [k] where values() was called last. Throws core::DomainError.
  virtual void derivatives(Vec u, const Eigen::VectorXd& inner, Eigen::MatrixXd& d_inner,
                           std::vector<core::Vector>& gradients) = 0;
  /// Takes the null vectors where values() was called last as borders.
  virtual void update() = 0;
  /// The same names in the same order at every point; at the u where values() and derivatives() were called last,
  /// `along` the tangent of the branch R(u) = 0 there. A test that cannot be had is not a number.
  [[nodiscard]] virtual std::vector<CodimensionTest> tests(Vec u, const Eigen::VectorXd& inner, Vec along) = 0;
};

/// Folds of equilibria and cycles: g is the entry of the parameter in the tangent z of the branch, K z = e_last with
/// K = [dR/du; row], the border being dR/dparameter itself.
[[nodiscard]] std::unique_ptr<Condition> make_fold(ExtendedProblem& problem, Adjoint& adjoint);
/// Folds of cycles, with tests for further critical multipliers.
[[nodiscard]] std::unique_ptr<Condition> make_cyclic_fold(CycleProblem& problem);
/// A = M + I with the monodromy matrix M.
[[nodiscard]] std::unique_ptr<Condition> make_flip(CycleProblem& problem);
/// A = M^2 - 2 kappa M + I, which loses rank by two at a pair exp(+-i theta), kappa = cos theta; two combinations of
/// the corner [2 x 2] suffice (Govaerts 2000, 5.4). Regular at kappa = +-1, where the pair becomes real with product 1.
/// `multiplier` is a guess.
[[nodiscard]] std::unique_ptr<Condition> make_neimark_sacker(CycleProblem& problem, std::complex<double> multiplier);
/// A = dF/dx + i omega dF/d(dx/dt), complex; `omega` [rad/s] is a guess.
[[nodiscard]] std::unique_ptr<Condition> make_hopf(problem::System& system, EquilibriumProblem& problem, double omega);

/// How a place moves with the states x [n] (SI), in the unit of a CycleQuantity: p = a x + b.
struct LinearPlace {
  Eigen::Matrix2Xd a;  ///< [2 x n]; empty where no place counts
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double speed = 0;  ///< of the shaft [rad/s]

  /// The path of the place on a cycle, in two rows.
  [[nodiscard]] Cycle path(const Cycle& cycle) const;
};
/// Cycles with a quantity of the given value: g = quantity/value - 1; no bifurcation. `place` returns what holds of the
/// present equations where the first parameter is changed by `change` (SI); the derivative by that is a central
/// difference, all others are exact.
[[nodiscard]] std::unique_ptr<Condition> make_limit(CycleProblem& problem, CycleQuantity quantity, double value,
                                                    std::function<LinearPlace(double change)> place);

}  // namespace whirl::solve
