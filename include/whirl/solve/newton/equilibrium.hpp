#pragma once
// Equilibria F(0, x, 0; p) = 0 and their branches.

#include <memory>
#include <string>
#include <vector>

#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/newton/adjoint.hpp"
#include "whirl/solve/newton/extended_problem.hpp"
#include "whirl/solve/newton/newton.hpp"

namespace whirl::solve {

class AnchoredHub;
class PortElimination;
class PortKrylov;
class PortMatrix;

/// R(u) = F(angle 0, x, 0; p), without forcing of order one in the angle: for balanced machines and static positions.
///
/// The matrix is [dF/dx dF/dp; row]. A machine on one rank that tells its structure, none of whose films has states, is
/// solved on its ports by factors that many points share (`anchored_hub`). Else films with own states are eliminated on
/// their ports (`port_elimination`), with the border part of what is left, by their own preconditioners where all have
/// one: from blocks that are spread like the films, and no matrix is assembled unless it is asked for. A machine
/// without films is all hub. All are regular at folds. Where iterations on approximate inverses do not come to the
/// tolerance (-equilibrium_ksp_rtol, 1e-12; -equilibrium_ksp_max_it, 100), and for transposes, such films are
/// factorised if the machine has at most -parts_whole_states (1,000,000). Otherwise solve() throws core::DomainError
/// with the reason, which ends Newton's method without convergence, and solve_transposed() core::NotConverged. The
/// Krylov method around preconditioners has the prefix "equilibrium_".
class EquilibriumProblem : public ExtendedProblem, public Adjoint {
public:
  /// `parameter_scale` is one unit of the scaled parameter in SI, `state_weight` the weight of the mean square scaled
  /// state in the arclength.
  EquilibriumProblem(problem::System& system, double parameter_scale, double state_weight);
  ~EquilibriumProblem() override;
  /// As if it were made now, with this scale; what the pattern of the matrix alone decides is kept.
  void renew(double parameter_scale);

  [[nodiscard]] MPI_Comm comm() const override { return system_.comm(); }
  [[nodiscard]] core::Vector make_unknown() const override;
  [[nodiscard]] Vec weights() const override { return weights_.get(); }
  [[nodiscard]] double parameter_scale() const override { return parameter_scale_; }
  [[nodiscard]] bool settles() const override;
  void residual(Vec u, Vec r) override;
  bool settle(Vec u) override;
  void linearise(Vec u, Vec row) override;
  void multiply(Vec v, Vec y) override;
  void solve(Vec rhs, Vec x) override;
  [[nodiscard]] Mat matrix() override;
  [[nodiscard]] std::vector<problem::Field> fields() const override { return system_.fields(); }
  void solve_transposed(Vec rhs, Vec x) override;
  void equations_changed() override;
  void curvature(Vec u, Vec v, Vec w, Vec out) override;
  /// The same along a motion: (x, dx/dt) moves by eps (v, rate), v with an entry for the parameter, `rate` [n] scaled
  /// like the states (null: none).
  void curvature(Vec u, Vec v, Vec rate, Vec w, Vec out);

  /// What solves on the ports round by (AnchoredHub::anchor()), to go on from: it moves answers within their rounding.
  [[nodiscard]] std::vector<double> anchor() const;
  void take_anchor(const std::vector<double>& anchor);

  [[nodiscard]] Vec state_scale() const { return state_scale_.get(); }
  [[nodiscard]] Vec residual_scale() const { return residual_scale_.get(); }
  /// Between the scaled unknown and the state in SI. Collective.
  void to_state(Vec u, Vec x) const;
  void from_state(Vec x, double parameter, Vec u) const;

private:
  void prepare(Vec u);
  /// dF/dx at x_ on the ports; false if it has to be eliminated otherwise.
  [[nodiscard]] bool linearise_on_ports();
  /// The matrix at x_ in blocks, and as entries where these are asked for.
  void assemble();
  /// to = the answer of the ports to `from`.
  void answer(Eigen::VectorXd (AnchoredHub::*by)(const Eigen::VectorXd&) const, Vec from, Vec to) const;
  /// The entries of the bordered matrix at x_, not scaled: dF/dp is f_.
  void list();
  void fill_bordered();
  void set_scales();
  /// Why it did not come far enough; empty if it did. The same on all ranks.
  [[nodiscard]] std::string solve_by_inverses(Vec rhs, Vec x);
  void solve_by_parts(bool transposed, Vec rhs, Vec x);
  void solve(bool transposed, Vec rhs, Vec x);
  problem::System& system_;
  double parameter_scale_;
  core::Vector weights_, state_scale_, residual_scale_, row_scale_, x_, rest_, f_;
  std::unique_ptr<problem::ScaledPoint> point_;  // of a machine that is solved on its ports,
  std::unique_ptr<AnchoredHub> hub_on_ports_;    // how,
  bool on_ports_ = false;                        // whether the present matrix is,
  double refreshed_at_ = 0;                      // the parameter that the point knows,
  problem::PointState at_;                       // the films there,
  Eigen::VectorXd scaled_, still_, value_;       // and work space
  core::Matrix jacobian_, bordered_;
  problem::Entries entries_;                            // of the bordered matrix,
  std::unique_ptr<PortMatrix> blocks_;                  // these in blocks, scaled by
  core::Vector rows_, columns_, row_;                   // these; and the last row
  std::vector<PetscInt> hub_;                           // numbers of the hub's states
  std::unique_ptr<PortElimination> ports_, exact_;      // by approximate inverses while these serve; by MUMPS
  std::unique_ptr<PortKrylov> krylov_;                  // around `ports_`
  bool factorised_ = false, exact_factorised_ = false;  // `ports_`, `exact_`: of the present matrix
  bool given_up_ = false;                               // inverses that have failed
};

/// Equilibria of one system at one parameter after another.
class Equilibria {
public:
  explicit Equilibria(problem::System& system) : system_(system), problem_(system, 1, 1) {}
  /// Solves F(0, x, 0) = 0 at the system's parameter from the guess in x. Collective.
  NewtonResult find(Vec x, const NewtonOptions& options);
  [[nodiscard]] problem::System& system() const { return system_; }
  /// Of the problem.
  [[nodiscard]] std::vector<double> anchor() const { return problem_.anchor(); }
  void take_anchor(const std::vector<double>& anchor) { problem_.take_anchor(anchor); }

private:
  problem::System& system_;
  EquilibriumProblem problem_;
};

/// The same of one.
inline NewtonResult find_equilibrium(problem::System& system, Vec x, const NewtonOptions& options) {
  return Equilibria(system).find(x, options);
}

}  // namespace whirl::solve
