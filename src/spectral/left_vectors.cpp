#include "spectral/left_vectors.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/from_options.hpp"

namespace whirl::spectral {

using core::check;

namespace {

std::vector<Complex> values_of(EPS eps) {
  PetscInt found = 0;
  check(EPSGetConverged(eps, &found));
  std::vector<Complex> out;
  for (PetscInt i = 0; i < found; ++i) out.push_back(pair_of(eps, i, nullptr, nullptr, false).value);
  return out;
}

// Eigenvalues that two searches find alike.
std::vector<PetscInt> near(const std::vector<Complex>& values, Complex value) {
  std::vector<PetscInt> out;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (std::abs(values[k] - value) <= 1e-7 * std::abs(value)) out.push_back(static_cast<PetscInt>(k));
  return out;
}

// Vector `i` of a solver and what `m` makes of it, whole on every rank.
struct Column {
  Eigen::VectorXcd vector, image;
};
Column column_of(EPS eps, PetscInt i, Mat m) {
  core::Vector re, im, product;
  check(MatCreateVecs(m, re.put(), product.put()));
  check(MatCreateVecs(m, im.put(), nullptr));
  PetscScalar x = 0, y = 0;
  check(EPSGetEigenpair(eps, i, &x, &y, re.get(), im.get()));
  const auto image = [&](Vec v) {
    check(MatMult(m, v, product.get()));
    return core::gather(product.get());
  };
  const std::vector<double> parts[] = {core::gather(re.get()), core::gather(im.get()), image(re.get()),
                                       image(im.get())};
  const auto n = static_cast<Eigen::Index>(parts[0].size());
  Column out{Eigen::VectorXcd(n), Eigen::VectorXcd(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto at = static_cast<std::size_t>(k);
    out.vector(k) = {parts[0][at], y != 0 ? parts[1][at] : 0.0};
    out.image(k) = {parts[2][at], y != 0 ? parts[3][at] : 0.0};
  }
  return out;
}

}  // namespace

LeftVectors::LeftVectors(Mat a, Mat b, const EigenOptions& options) : b_(b) {
  check(MatTranspose(a, MAT_INITIAL_MATRIX, a_turned_.put()));
  check(MatTranspose(b, MAT_INITIAL_MATRIX, b_turned_.put()));
  PetscInt n = 0;
  check(MatGetSize(a, &n, nullptr));
  check(EPSCreate(PetscObjectComm(reinterpret_cast<PetscObject>(a)), left_.put()));
  check(EPSSetOptionsPrefix(left_.get(), "modes_"));
  check(EPSSetOperators(left_.get(), a_turned_.get(), b_turned_.get()));
  check(EPSSetProblemType(left_.get(), EPS_GNHEP));
  search_near(left_.get(), a_turned_.get(), options.target, std::min<PetscInt>(options.count, n - 2), nullptr);
  core::set_from_options(left_.get());
  check(EPSSolve(left_.get()));
  values_ = values_of(left_.get());
}

LeftVectors::Vector LeftVectors::of(EPS right, PetscInt i) {
  const std::vector<Complex> values = values_of(right);
  const Complex value = values[static_cast<std::size_t>(i)];
  const std::vector<PetscInt> rights = near(values, value), lefts = near(values_, value);
  if (rights.size() != lefts.size()) return {};
  std::vector<Column> x, y;
  for (const PetscInt k : rights) x.push_back(column_of(right, k, b_));
  for (const PetscInt k : lefts) y.push_back(column_of(left_.get(), k, b_turned_.get()));
  const auto n = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXcd products(n, n);
  for (Eigen::Index l = 0; l < n; ++l)
    for (Eigen::Index r = 0; r < n; ++r)
      products(l, r) = y[static_cast<std::size_t>(l)].vector.cwiseProduct(x[static_cast<std::size_t>(r)].image).sum();
  const auto own = static_cast<Eigen::Index>(std::find(rights.begin(), rights.end(), i) - rights.begin());
  const Eigen::RowVectorXcd shares = core::DenseLu<Complex>(products).inverse().row(own);
  Eigen::VectorXcd row = Eigen::VectorXcd::Zero(y[0].vector.size()), image = row;
  for (Eigen::Index l = 0; l < n; ++l) {
    row += shares(l) * y[static_cast<std::size_t>(l)].vector;
    image += shares(l) * y[static_cast<std::size_t>(l)].image;
  }
  const double condition = x[static_cast<std::size_t>(own)].vector.norm() * image.norm();
  if (!std::isfinite(condition)) return {{}, std::numeric_limits<double>::infinity()};
  return {{row.begin(), row.end()}, condition};
}

}  // namespace whirl::spectral
