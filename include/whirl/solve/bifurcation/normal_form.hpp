#pragma once
// Normal-form coefficients: on which side of a bifurcation the new motions live, and whether they are stable.

#include <complex>
#include <functional>

#include "whirl/problem/system.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"

namespace whirl::solve {

/// How far a motion v [n_local], in scaled states, moves what the lengths of differences are measured by: a journal, in
/// clearances. Of the rows here, or collective on the ranks that share them.
using MotionSize = std::function<double(const Eigen::VectorXd& v)>;
/// The largest scaled state.
[[nodiscard]] inline double largest_state(const Eigen::VectorXd& v) {
  return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0;
}

/// Re(exp(-i theta) c_1) of the map y -> exp(i theta) y (1 + ...) + c_1 y |y|^2 that the motion over one period of a
/// forced cycle becomes at a Neimark-Sacker point: negative where the invariant circle is stable (supercritical).
///
/// Second and third derivatives of the map solve the variational equations of the collocation, with the derivatives of
/// F by central differences of its exact tangents along the critical motion; their share in the critical plane is found
/// without the left eigenvector. `problem` is linearised at u, `multiplier` is the critical one; strong resonances
/// (theta = pi, 2 pi/3, pi/2) have other normal forms. The critical vector has a root mean square of one in scaled
/// states. Differences of third order move `size` by step * 1.2e-4, those of second
/// order by as much if `step` is above one: over kinks of F that are narrower than that. Source: Kuznetsov (2004), 4.7
/// and (5.73). Cost: about 60 evaluations of the tangents along the cycle. Collective.
[[nodiscard]] double neimark_sacker_coefficient(PeriodicProblem& problem, Vec u, std::complex<double> multiplier,
                                                double step = 1, const MotionSize& size = largest_state);

/// w . (D^3 P(v, v, v) + 3 D^2 P(v, h))/6, (I - M) h = D^2 P(v, v), of the map P over one period of a forced cycle with
/// a multiplier of -1, M v = -v and M^T w = -w. It has no pole where w . v = 0 (resonance 1:2), but one where +1 is a
/// multiplier too (fold-flip). Else as below.
[[nodiscard]] double flip_cubic(CycleProblem& problem, Vec u, const Eigen::VectorXd& v, const Eigen::VectorXd& w,
                                double step = 1, const MotionSize& size = largest_state);

/// c = flip_cubic/(w . v) of the map y -> -y + c y^3 at a flip of a forced cycle: positive where the cycle of twice the
/// period is stable within the centre manifold (supercritical). Source: Kuznetsov (2004), (5.68). Else as above.
[[nodiscard]] double flip_coefficient(PeriodicProblem& problem, Vec u, double step = 1,
                                      const MotionSize& size = largest_state);

/// Re c_1 of y' = i omega y + c_1 y |y|^2 at a Hopf point x (SI) of F(0, x, dx/dt): omega times the first Lyapunov
/// coefficient, negative where the cycles are stable (supercritical). F may depend on dx/dt and x together; derivatives
/// by central differences of its exact tangents. The eigenvector has a root mean square of one in scaled states.
/// Source: Kuznetsov (2004), (5.39), for implicit equations. `step` as above, of the largest scaled state. Throws
/// core::NotConverged. Collective.
[[nodiscard]] double hopf_coefficient(problem::System& system, Vec x, double omega, double step = 1);

}  // namespace whirl::solve
