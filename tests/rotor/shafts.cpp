#include "rotor/shafts.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <complex>

#include "support/dense.hpp"
#include "whirl/rotor/rotor.hpp"

namespace whirl::test {

std::vector<Whirl> whirl_modes(const rotor::Options& options, const std::vector<IsotropicBearing>& bearings,
                               double speed) {
  const rotor::Rotor r(MPI_COMM_WORLD, options);
  const Eigen::Index n = r.size() / 2;
  const auto every_other = [n](const Eigen::MatrixXd& a, Eigen::Index row, Eigen::Index column) {
    Eigen::MatrixXd b(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < n; ++j) b(i, j) = a(2 * i + row, 2 * j + column);
    return b;
  };
  const Eigen::MatrixXd m = every_other(dense(r.matrices().mass.get()), 0, 0);
  const Eigen::MatrixXd g = every_other(dense(r.matrices().gyroscopic.get()), 0, 1);
  Eigen::MatrixXd k = every_other(dense(r.matrices().stiffness.get()), 0, 0);
  Eigen::MatrixXd c = every_other(dense(r.matrices().damping.get()), 0, 0);
  for (const IsotropicBearing& b : bearings) {
    const Eigen::Index at = r.coordinate(b.node, rotor::Freedom::x) / 2;
    k(at, at) += b.stiffness;
    c(at, at) += b.damping;
  }
  // State (sqrt(K) q, q') in modal coordinates: its matrix has the size of the highest frequency, not of its square, so
  // that the low roots keep their digits.
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> rest(k, m);
  const Eigen::MatrixXd& v = rest.eigenvectors();
  const Eigen::MatrixXd root_k = rest.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
  Eigen::MatrixXcd a = Eigen::MatrixXcd::Zero(2 * n, 2 * n);
  a.topRightCorner(n, n) = root_k;
  a.bottomLeftCorner(n, n) = -root_k;
  a.bottomRightCorner(n, n).real() = -(v.transpose() * c * v);
  a.bottomRightCorner(n, n).imag() = speed * (v.transpose() * g * v);
  if (r.matrices().circulatory) {
    const Eigen::MatrixXd circulatory = every_other(dense(r.matrices().circulatory.get()), 0, 1);
    const Eigen::VectorXd inverse_root = rest.eigenvalues().cwiseSqrt().cwiseInverse();  // on springs: K > 0
    a.bottomLeftCorner(n, n).imag() = speed * (v.transpose() * circulatory * v * inverse_root.asDiagonal());
  }
  const Eigen::VectorXcd roots = a.eigenvalues();
  std::vector<Whirl> modes;
  for (const auto& root : roots) modes.push_back({root.imag(), root.real()});
  std::sort(modes.begin(), modes.end(),
            [](const Whirl& p, const Whirl& q) { return std::abs(p.frequency) < std::abs(q.frequency); });
  return modes;
}

}  // namespace whirl::test
