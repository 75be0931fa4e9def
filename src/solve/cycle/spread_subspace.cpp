// The subspace of a cycle spread over ranks and the multipliers in it.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "solve/cycle/dominant_subspace.hpp"
#include "solve/newton/local_part.hpp"
#include "whirl/solve/cycle/spread_cycle.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

namespace {

// Of a subspace that only preconditions.
constexpr double subspace_tolerance = 1e-3;

}  // namespace

// M V. While V is not invariant and gets better at once, V <- orth(M V): it spares linear iterations. Multipliers below
// the radius are near it or not, which does not change from one point to the next: what did not help is not tried
// again.
void SpreadCycle::find_image() {
  constexpr double invariant = 1e-7, at_once = 0.1;
  // Where each product is dear the one iteration that costs nothing has to do.
  const int most = rough_ ? 0 : 2;
  double last = 0;
  rough_image_ = rough_;
  image_known_ = true;
  for (int k = 0;; ++k) {
    image_ = monodromy_times(basis_, basis_added_);
    MatrixXd sizes(2, 1);
    sizes << complement(image_).squaredNorm(), image_.squaredNorm();
    sum(sizes);
    const double defect = sizes(1) > 0 ? std::sqrt(sizes(0) / sizes(1)) : 0;
    if (k > 0) contraction_ = defect / last;
    if (defect <= invariant || k == most || contraction_ > at_once) return;
    last = defect;
    basis_.resize(local_, 0);
    add_orthonormal(system_.comm(), basis_, image_);
  }
}

std::vector<std::complex<double>> SpreadCycle::find_subspace() {
  if (basis_.cols() == 0) basis_.resize(local_, 0);
  SubspaceOptions options;
  options.most = options_.multipliers;
  options.tolerance = rough_ ? subspace_tolerance : options_.multiplier_tolerance;
  DominantSubspace found = dominant_multipliers(
      system_.comm(), [this](const MatrixXd& v) { return times(v); }, basis_, options, radius_);
  limited_ = !found.values.empty() && std::abs(found.values.back()) > radius_;
  if (found.basis.cols() != basis_.cols()) contraction_ = 0;
  basis_ = std::move(found.basis);
  return found.values;
}

// Multipliers by orthogonal iteration on V and two generic vectors, which would show a multiplier that V does not know;
// those below the radius, which nothing depends on, to six digits. Empty if this does not converge at once, because
// there are multipliers just below the radius, or if their number has changed: then they are to be found anew.
std::vector<std::complex<double>> SpreadCycle::refined_multipliers() {
  constexpr Index probes = 2;
  constexpr int most = 2;
  constexpr double below_radius = 1e-6, slow = 1e-2;
  const Index p = basis_.cols();
  if (!image_known_ || p == 0 || p + probes > system_.size()) return {};
  if (limited_) return {};  // what V leaves out may have grown beyond what it holds
  MatrixXd x = basis_;
  add_orthonormal(system_.comm(), x, generic_columns(system_.comm(), local_, probes));
  if (rough_image_) image_ = monodromy_times(basis_, basis_added_);
  rough_image_ = false;
  MatrixXd y(local_, x.cols()), added(borders_, x.cols()), new_added;
  y.leftCols(p) = image_;
  y.rightCols(x.cols() - p) = monodromy_times(x.rightCols(x.cols() - p), new_added);
  added << basis_added_, new_added;
  for (int k = 0;; ++k) {
    MatrixXd projected = x.transpose() * y;
    sum(projected);
    if (!projected.allFinite()) return {};
    const auto modes = spectral::eigenpairs(projected);
    const Eigen::MatrixXcd defects = (y - x * projected) * modes.vectors;
    MatrixXd sizes = defects.colwise().squaredNorm().transpose();
    sum(sizes);
    bool converged = true;
    std::vector<std::complex<double>> values;
    for (Index c = 0; c < x.cols(); ++c) {
      values.push_back(modes.values(c));
      const double size = std::abs(values.back());
      converged =
          converged && std::sqrt(sizes(c)) <= (size > radius_ ? options_.multiplier_tolerance * size : below_radius);
    }
    std::stable_sort(values.begin(), values.end(), [](auto a, auto b) { return std::abs(a) > std::abs(b); });
    if (converged) {
      const auto large = std::count_if(values.begin(), values.end(), [&](auto z) { return std::abs(z) > radius_; });
      if (large != p) return {};
      if (k == 0) return values;
      basis_ = x.leftCols(p);
      image_ = y.leftCols(p);
      basis_added_ = added.leftCols(p);
      prepare();
      return values;
    }
    if (k == most || sizes.maxCoeff() > slow * slow) return {};
    x.resize(local_, 0);
    add_orthonormal(system_.comm(), x, y);
    y = monodromy_times(x, added);
  }
}

std::vector<std::complex<double>> SpreadCycle::multipliers() {
  auto values = refined_multipliers();
  if (values.empty()) {
    values = find_subspace();
    find_image();
    prepare();
  }
  exact_ = true;
  return values;
}

// In the basis the motion is the eigenvector of V^T M V.
VectorXcd SpreadCycle::multiplier_vector(std::complex<double> mu) {
  constexpr double same = 1e-3;  // a bifurcation is located to less than that
  if (!exact_) (void)multipliers();
  MatrixXd projected = basis_.transpose() * image_;
  sum(projected);
  const auto modes = spectral::eigenpairs(projected);
  if (modes.values.size() == 0 || (modes.values.array() - mu).abs().minCoeff() > same) return {};
  return basis_ * modes.nearest(mu);
}

MatrixXd SpreadCycle::critical_motion(double mu) {
  MatrixXd projected = basis_.transpose() * image_;
  sum(projected);
  const Path motion = forward(basis_ * spectral::eigenpairs(projected).nearest(mu).real().normalized());
  return groups_.joined(state_scale().asDiagonal() * motion.nodes, static_cast<Index>(mesh_.size()) - 1);
}

}  // namespace whirl::solve
