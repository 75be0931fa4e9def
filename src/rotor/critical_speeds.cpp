#include "whirl/rotor/critical_speeds.hpp"

#include <fmt/core.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "planar.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/dense.hpp"
#include "whirl/rotor/hinges.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

// K is definite, M -+ G may be not: of (M -+ G) v = K v/Omega^2 the positive eigenvalues count.
std::vector<double> critical_speeds(const Options& options, const std::vector<int>& nodes, double stiffness,
                                    Whirl whirl, int count) {
  validate(options);
  if (nodes.size() < 2) throw core::InputError("rotor: a shaft on springs needs two of them");
  if (!(stiffness > 0)) throw core::InputError("rotor: the stiffness of springs must be positive");
  const Planar planar = assemble_planar(PETSC_COMM_SELF, options);
  Eigen::MatrixXd k = dense(planar.stiffness.get());
  for (const int node : nodes) {
    if (node < 1 || node > n_nodes(options))
      throw core::InputError(fmt::format("rotor: node {} is not in 1..{}", node, n_nodes(options)));
    k(2 * (node - 1), 2 * (node - 1)) += stiffness;
  }
  if (const auto loose = loose_part(options, nodes))
    throw core::InputError("rotor: " + words(*loose, options, "on springs"));
  // The eigenvalue solver factorises K and does not say whether that went well.
  (void)definite(k, "critical speeds: the stiffness of the shaft on its springs");
  const double sign = whirl == Whirl::forward ? -1 : 1;
  const Eigen::MatrixXd inertia = dense(planar.mass.get()) + sign * dense(planar.gyroscopic.get());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(inertia, k, Eigen::EigenvaluesOnly);
  std::vector<double> out;
  if (solver.info() != Eigen::Success) throw core::NotConverged("critical speeds: no eigenvalues");
  const Eigen::VectorXd& inverse = solver.eigenvalues();  // ascending
  const double rounding = 1e-14 * inverse.cwiseAbs().maxCoeff();
  for (Eigen::Index i = inverse.size() - 1; i >= 0 && static_cast<int>(out.size()) < count; --i)
    if (inverse(i) > rounding) out.push_back(1 / std::sqrt(inverse(i)));
  return out;
}

}  // namespace whirl::rotor
