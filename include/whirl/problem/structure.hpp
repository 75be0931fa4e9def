#pragma once
// What a system may tell beyond F and J: it is linear except for thin couplings, and its films' own states see only
// their neighbours.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "whirl/core/port_response.hpp"

namespace whirl::problem {

/// Blocks are sparse, by columns and compressed: those of a whole shaft couple neighbours only.
using SparseBlock = Eigen::SparseMatrix<double>;

/// Where a derivative has an entry.
struct EntryPlace {
  int row, column;
};

/// One film with own states s: k of all own states, which see some of the inputs and make some of the forces.
struct OwnStates {
  Eigen::Index first = 0, count = 0;         ///< among the own states of the system
  Eigen::Index first_input = 0, inputs = 0;  ///< among the inputs
  Eigen::Index first_force = 0, forces = 0;  ///< among the forces
  std::vector<EntryPlace> states, rates;     ///< entries of dg/ds and dg/ds', rows and columns counted from `first`
  /// g is linear in s but for the set of full nodes: a whole step of Newton's method on s alone finds the next set.
  bool settles = false;
};

/// The nonlinear part at one point: f, g and their derivatives.
struct Films {
  Eigen::VectorXd forces;    ///< f [r]
  Eigen::VectorXd residual;  ///< g [k]
  // Only with tangents:
  Eigen::MatrixXd d_inputs;             ///< df/dw [r x w] at constant s
  Eigen::VectorXd d_speed;              ///< df/dOmega [r], then dg/dOmega [k]
  std::vector<core::PartResponse> own;  ///< of the films with own states
};

/// With the state (x, s), x [n] coordinates and rates, s [k] own states of films:
///
///     F = L1 xdot + L0(p) x - l(angle; p) - B f(C x, s, sdot; p)     [n]
///     G = g(C x, s, sdot; p)                                         [k]
///
/// L1, L0 [n x n] are constant along a cycle, l [n] is the constant load and the forcing, f [r] the nonlinear forces
/// (journal forces of the films) that depend on the thin inputs C x [w] (positions and velocities of the journals in
/// their bearings) and on own states only, r, w << n. All on one rank, SI. References stay valid for the life of the
/// system; the blocks behind them follow its parameter. Those who want them dense convert them.
class BlockStructure {
public:
  virtual ~BlockStructure() = default;

  /// n, r, w.
  [[nodiscard]] virtual Eigen::Index size() const = 0;
  [[nodiscard]] virtual Eigen::Index n_forces() const = 0;
  [[nodiscard]] virtual Eigen::Index n_inputs() const = 0;
  /// Films with own states, in their order; k is the sum of their counts.
  [[nodiscard]] virtual const std::vector<OwnStates>& own() const = 0;

  [[nodiscard]] virtual const SparseBlock& l1() = 0;
  /// L0 at the present parameter.
  [[nodiscard]] virtual const SparseBlock& l0() = 0;
  [[nodiscard]] virtual const SparseBlock& b() const = 0;
  [[nodiscard]] virtual const SparseBlock& c() const = 0;

  /// l(angle) [n].
  virtual void load(double angle, Eigen::VectorXd& load) = 0;
  /// f and g, and with `tangents` their derivatives. `own` and `rates` [k] are null if there are none. Throws
  /// core::DomainError outside the validity of a film.
  virtual void films(const Eigen::VectorXd& inputs, const double* own, const double* rates, bool tangents,
                     Films& films) = 0;
  /// out [n + k] = d(F, G)/dp at (x, s) with rates (xdot, sdot) [n + k]; `films` holds what films() gave there, with
  /// tangents.
  virtual void parameter_derivative(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd& xdot,
                                    const Films& films, Eigen::VectorXd& out) = 0;
};

}  // namespace whirl::problem
