#pragma once
// Solutions that coexist: those found are taken out of the equations, so that Newton's method finds others.

#include <functional>
#include <vector>

#include "whirl/solve/newton/extended_problem.hpp"
#include "whirl/solve/newton/newton.hpp"

namespace whirl::solve {

/// m(u) R(u) = 0 with m = product over known solutions r of (1/|u - r|^p + 1).
///
/// It has the solutions of R but the known ones, and unlike R/|u - r|^p its residual does not vanish far away. Its
/// matrix is that of R, scaled, plus one of rank one, with K = [dR/du; row]:
///
///     [ m dR/du + R grad(m)^T ]        x = K^-1 D^-1 b - z (grad(m) . K^-1 D^-1 b)/(1 + grad(m) . z),
///     [         row           ]        z = K^-1 D^-1 [R; 0],   D = diag(m, ..., m, 1)
///
/// so that the Newton step at a constant parameter is that of R times a number. Distances are measured in the weights
/// of the problem over `unit`. Source: Gavalas (2022), eq. 3.1 with erratum 26; Farrell, Birkisson and Funke (2015),
/// SIAM J. Sci. Comput. 37, A2026. Cost: one more solve with K per linearisation.
class DeflatedProblem : public ExtendedProblem {
public:
  /// `problem` outlives this. `unit`: weight of a mean square of one in the scaled states.
  DeflatedProblem(ExtendedProblem& problem, double power, double unit);
  /// Takes out the solution u (copied), in the present layout of the problem.
  void take_out(Vec u);
  [[nodiscard]] std::size_t known() const { return known_.size(); }
  /// Distance of u from the nearest known solution. Collective.
  [[nodiscard]] double distance(Vec u) const;

  [[nodiscard]] MPI_Comm comm() const override { return problem_.comm(); }
  [[nodiscard]] core::Vector make_unknown() const override { return problem_.make_unknown(); }
  [[nodiscard]] Vec weights() const override { return problem_.weights(); }
  [[nodiscard]] double parameter_scale() const override { return problem_.parameter_scale(); }
  void residual(Vec u, Vec r) override;
  void linearise(Vec u, Vec row) override;
  void multiply(Vec v, Vec y) override;
  void solve(Vec rhs, Vec x) override;
  void equations_changed() override { problem_.equations_changed(); }
  [[nodiscard]] double linear_tolerance() const override { return problem_.linear_tolerance(); }

private:
  /// m(u), and grad(m) into `gradient` unless null. Throws core::DomainError at a known solution.
  double factor(Vec u, Vec gradient) const;
  [[nodiscard]] double square(Vec u, Vec known, Vec difference) const;
  /// y times m but for the last entry.
  void scale(Vec y, double by) const;

  ExtendedProblem& problem_;
  double power_, unit_, m_ = 1;
  std::vector<core::Vector> known_;
  core::Vector residual_, gradient_, z_;  // of the linearisation
};

struct DeflationOptions {
  int solutions = 2;          ///< wanted in all, those known included
  int attempts = 12;          ///< guesses tried
  double power = 2;           ///< p
  double separation = 1e-4;   ///< distance below which two solutions are the same
  NewtonOptions newton = {};  ///< of the search; answers are corrected with it without deflation
};

/// Further solutions at the parameter of the `known` ones (not empty): `guess(k)` is the k-th start, at that parameter,
/// null when there are no more; `copies(u)` are other unknowns for the same solution (a cycle of several turns begun
/// one turn later), none if empty. In the order found. Collective.
[[nodiscard]] std::vector<core::Vector> deflate(ExtendedProblem& problem, double unit,
                                                const std::vector<core::Vector>& known,
                                                const std::function<core::Vector(int k)>& guess,
                                                const DeflationOptions& options,
                                                const std::function<std::vector<core::Vector>(Vec)>& copies = {});

}  // namespace whirl::solve
