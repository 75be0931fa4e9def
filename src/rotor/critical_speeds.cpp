#include "whirl/rotor/critical_speeds.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "planar.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/core/symmetric.hpp"
#include "whirl/rotor/hinges.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Matrices of shaft, springs and stands in one plane; the displacements of stands come last.
struct Plane {
  MatrixXd stiffness, mass, gyroscopic;
};

Plane plane_of(const Planar& planar, const std::vector<SpringAt>& springs, double stiffness,
               const std::vector<Stand>& stands, std::size_t direction) {
  const MatrixXd shaft = core::dense(planar.stiffness.get());
  const Index n = shaft.rows(), all = n + static_cast<Index>(stands.size());
  Plane out{MatrixXd::Zero(all, all), MatrixXd::Zero(all, all), MatrixXd::Zero(all, all)};
  out.stiffness.topLeftCorner(n, n) = shaft;
  out.mass.topLeftCorner(n, n) = core::dense(planar.mass.get());
  out.gyroscopic.topLeftCorner(n, n) = core::dense(planar.gyroscopic.get());
  for (std::size_t k = 0; k < stands.size(); ++k) {
    const Index at = n + static_cast<Index>(k);
    out.stiffness(at, at) = stands[k].stiffness[direction];
    out.mass(at, at) = stands[k].mass[direction];
  }
  for (const SpringAt& s : springs) {
    const Index at = 2 * (s.node - 1);
    out.stiffness(at, at) += stiffness;
    if (s.stand < 0) continue;
    const Index below = n + s.stand;
    out.stiffness(below, below) += stiffness;
    out.stiffness(at, below) -= stiffness;
    out.stiffness(below, at) -= stiffness;
  }
  return out;
}

}  // namespace

// K is definite, M -+ G may be not: of (M -+ G) v = K v/Omega^2 the positive eigenvalues count.
std::vector<double> critical_speeds(const Options& options, const std::vector<SpringAt>& springs, double stiffness,
                                    Whirl whirl, int count, const std::vector<Stand>& stands) {
  validate(options);
  std::vector<int> nodes;
  for (const SpringAt& s : springs) nodes.push_back(s.node);
  if (nodes.size() < 2) throw core::InputError("rotor: a shaft on springs needs two of them");
  if (!(stiffness > 0)) throw core::InputError("rotor: the stiffness of springs must be positive");
  const Planar planar = assemble_planar(PETSC_COMM_SELF, options);
  for (const int node : nodes)
    if (node < 1 || node > n_nodes(options))
      throw core::InputError(fmt::format("rotor: node {} is not in 1..{}", node, n_nodes(options)));
  if (const auto loose = loose_part(options, nodes))
    throw core::InputError("rotor: " + words(*loose, options, "on springs"));
  const bool isotropic = std::all_of(stands.begin(), stands.end(), [](const Stand& s) {
    return s.mass[0] == s.mass[1] && s.stiffness[0] == s.stiffness[1];
  });
  const Plane x = plane_of(planar, springs, stiffness, stands, 0);
  const Index n = x.mass.rows();
  MatrixXd k = x.stiffness, inertia = x.mass + (whirl == Whirl::forward ? -1 : 1) * x.gyroscopic;
  if (!isotropic) {
    const Plane y = plane_of(planar, springs, stiffness, stands, 1);
    k = MatrixXd::Zero(2 * n, 2 * n);
    k << x.stiffness, MatrixXd::Zero(n, n), MatrixXd::Zero(n, n), y.stiffness;
    inertia = k;
    inertia << x.mass, -x.gyroscopic, -x.gyroscopic, y.mass;
  }
  const auto pairs = core::symmetric_pairs(std::move(inertia), std::move(k),
                                           "critical speeds: the stiffness of the shaft on its springs", !isotropic);
  std::vector<double> out;
  const Eigen::VectorXd& inverse = pairs.values;
  const double rounding = 1e-14 * inverse.cwiseAbs().maxCoeff();
  const auto turns_so = [&](Index i) {
    if (isotropic) return true;
    const Eigen::VectorXd u = pairs.vectors.col(i).head(n), v = pairs.vectors.col(i).tail(n);
    const double across = u.dot(x.mass * v), size = u.dot(x.mass * u) + v.dot(x.mass * v);
    return (across >= -1e-9 * size) == (whirl == Whirl::forward);
  };
  for (Index i = inverse.size() - 1; i >= 0 && static_cast<int>(out.size()) < count; --i)
    if (inverse(i) > rounding && turns_so(i)) out.push_back(1 / std::sqrt(inverse(i)));
  return out;
}

}  // namespace whirl::rotor
