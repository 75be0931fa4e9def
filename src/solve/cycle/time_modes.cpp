#include "solve/cycle/time_modes.hpp"

#include <petscsys.h>

#include <petscblaslapack.h>  // wants the one before

#include <algorithm>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;

// Eigenvalues and right eigenvectors of a real matrix; Eigen's own solver takes ten times longer for some hundred rows.
void eigenpairs(MatrixXd a, Eigen::VectorXcd& values, MatrixXcd& vectors) {
  PetscBLASInt n = static_cast<PetscBLASInt>(a.rows()), one = 1, size = -1, info = 0;
  Eigen::VectorXd re(n), im(n), work(1);
  MatrixXd v(n, n);
  for (int pass = 0; pass < 2; ++pass) {
    LAPACKgeev_("N", "V", &n, a.data(), &n, re.data(), im.data(), nullptr, &one, v.data(), &n, work.data(), &size,
                &info);
    if (pass == 0) work.resize(size = static_cast<PetscBLASInt>(work(0)));
  }
  if (info != 0) throw core::NotConverged("the eigenvalues of differentiation in time do not converge");
  values.resize(n);
  vectors.resize(n, n);
  for (Index k = 0; k < n; ++k) {
    values(k) = {re(k), im(k)};
    vectors.col(k) = v.col(k);
    if (im(k) > 0) {
      vectors.col(k).imag() = v.col(k + 1);
      values(k + 1) = std::conj(values(k));
      vectors.col(k + 1) = vectors.col(k).conjugate();
      ++k;
    }
  }
}

}  // namespace

TimeModes time_modes(const MatrixXd& value, const MatrixXd& slope, int shares, Index multiple) {
  const Index points = value.rows();
  const core::DenseLu<double> lu(value);
  if (lu.rcond() < 1e-10) throw core::NotConverged("values at the collocation points do not determine a cycle");
  Eigen::VectorXcd values;
  MatrixXcd z;
  eigenpairs(lu.solve(slope), values, z);
  const core::DenseLu<std::complex<double>> basis(z);
  // Intervals of very different lengths have modes that are no basis for practical purposes.
  if (basis.rcond() < 1e-9) throw core::NotConverged("the modes in time of this mesh are no basis");
  const MatrixXcd into = basis.solve(lu.inverse().cast<std::complex<double>>()),
                  seen = value.cast<std::complex<double>>() * z;
  std::vector<Index> kept;
  for (Index k = 0; k < points; ++k)
    if (values(k).imag() >= 0) kept.push_back(k);
  TimeModes out;
  const auto count = static_cast<Index>(kept.size()), share = (count + shares - 1) / shares;
  out.lanes = (share + multiple - 1) / multiple * multiple;
  out.lambda.resize(shares * out.lanes);
  out.into = out.out = out.seen = MatrixXd::Zero(points, 2 * shares * out.lanes);
  for (Index lane = 0; lane < shares * out.lanes; ++lane) {
    const Index k = kept[static_cast<std::size_t>(std::min(lane, count - 1))];
    out.lambda(lane) = values(k);
    if (lane >= count) continue;
    const Index re = lane / out.lanes * 2 * out.lanes + lane % out.lanes, im = re + out.lanes;
    const double weight = values(k).imag() > 0 ? 2 : 1;
    out.into.col(re) = into.row(k).real().transpose();
    out.into.col(im) = into.row(k).imag().transpose();
    out.out.col(re) = weight * z.col(k).real();
    out.out.col(im) = -weight * z.col(k).imag();
    out.seen.col(re) = weight * seen.col(k).real();
    out.seen.col(im) = -weight * seen.col(k).imag();
  }
  return out;
}

TimeModes cycle_modes(const Scheme& scheme, const std::vector<double>& mesh, int shares) {
  const Index m = scheme.degree, points = m * (static_cast<Index>(mesh.size()) - 1);
  MatrixXd value = MatrixXd::Zero(points, points), slope = value;
  for (Index i = 0; i < points / m; ++i) {
    const double h = mesh[static_cast<std::size_t>(i) + 1] - mesh[static_cast<std::size_t>(i)];
    const Index before = (i * m + points - 1) % points;
    for (Index l = 0; l <= m; ++l) {
      const Index column = l == 0 ? before : i * m + l - 1;
      value.col(column).segment(i * m, m) += scheme.value.col(l);
      slope.col(column).segment(i * m, m) += scheme.slope.col(l) / h;
    }
  }
  constexpr Index register_width = 8;  // of vector registers, in numbers
  return time_modes(value, slope, shares, register_width);
}

TimeModes interval_modes(const Scheme& scheme, double length) {
  return time_modes(scheme.value.rightCols(scheme.degree), scheme.slope.rightCols(scheme.degree) / length, 1, 1);
}

}  // namespace whirl::solve
