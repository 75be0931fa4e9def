#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "bordered_monodromy.hpp"
#include "whirl/solve/normal_form.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// The map P over one period: DP = M, and its higher derivatives along solutions of the variational equations.
class PeriodMap {
public:
  using Path = CycleProblem::Path;
  PeriodMap(CycleProblem& problem, Vec u, double step = 1) : problem_(problem), u_(u), step_(step) {}

  // D^2 R[a, b] at the collocation points.
  MatrixXd second(const Path& a, const Path& b) {
    const double h = step_ * difference_step(size(a));
    return (problem_.tangent(u_, h, a, b) - problem_.tangent(u_, -h, a, b)) / (2 * h);
  }
  // D^3 R[a, a, b].
  MatrixXd third(const Path& a, const Path& b) {
    const double h = step_ * std::pow(std::numeric_limits<double>::epsilon(), 0.25) / size(a);
    return (problem_.tangent(u_, h, a, b) - 2 * problem_.tangent(u_, 0, a, b) + problem_.tangent(u_, -h, a, b)) /
           (h * h);
  }
  // D^2 P[a, b] and the motion that leads there.
  VectorXd bilinear(const Path& a, const Path& b, Path* motion = nullptr) {
    VectorXd end;
    Path path = problem_.forced(second(a, b), end);
    if (motion) *motion = std::move(path);
    return end;
  }
  // D^3 P[a, a, b].
  VectorXd trilinear(const Path& a, const Path& b) {
    Path aa, ab;
    (void)bilinear(a, a, &aa);
    (void)bilinear(a, b, &ab);
    VectorXd end;
    (void)problem_.forced(third(a, b) + second(a, ab) * 2 + second(b, aa), end);
    return end;
  }
  Path path(const VectorXd& v) const { return problem_.forward(v); }

private:
  double size(const Path& a) const {
    double value = std::max(a.start.cwiseAbs().maxCoeff(), a.nodes.cwiseAbs().maxCoeff());
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, problem_.comm());
    return value > 0 ? value : 1;
  }
  CycleProblem& problem_;
  Vec u_;
  double step_;
};

// The null vectors of a polynomial of M that loses rank by k; the first borders are generic, the second ones the null
// vectors themselves.
void find_null_vectors(BorderedMonodromy& bordered, const std::vector<double>& polynomial) {
  bordered.solve(polynomial);
  bordered.update();
  bordered.solve(polynomial);
}

// Of the invariant plane of `basis`, product = M basis, the complex eigenvector for the eigenvalue nearest to mu.
VectorXcd eigenvector_in(const MatrixXd& basis, const MatrixXd& product, Complex mu) {
  const MatrixXd plane = (basis.transpose() * basis).ldlt().solve(basis.transpose() * product);
  return basis * spectral::eigenpairs(plane).nearest(mu);
}

}  // namespace

double neimark_sacker_coefficient(CycleProblem& problem, Vec u, Complex multiplier, double step) {
  Composition& joined = problem.composition();
  BorderedMonodromy bordered(problem, 2);
  find_null_vectors(bordered, {1, -2 * multiplier.real() / std::abs(multiplier), 1});
  // p^* q = 1 and |q|^2 = n
  VectorXcd q = eigenvector_in(bordered.v, joined.times(bordered.v), multiplier),
            p = eigenvector_in(bordered.left(), joined.times_transposed(bordered.left()), std::conj(multiplier));
  q *= std::sqrt(static_cast<double>(q.size())) / q.norm();
  p /= std::conj(p.dot(q));
  PeriodMap map(problem, u, step);
  const Complex i(0, 1);
  const auto r = map.path(q.real()), s = map.path(q.imag());
  const VectorXd rr = map.bilinear(r, r), ss = map.bilinear(s, s), rs = map.bilinear(r, s);
  const VectorXd h11 = solve_polynomial(problem, {1, -1}, rr + ss);
  // (nu - M)^-1 = (conj nu - M)(|nu|^2 - 2 Re nu M + M^2)^-1, nu = mu^2
  const Complex nu = multiplier * multiplier;
  MatrixXd parts(q.size(), 2);
  parts << rr - ss, 2 * rs;
  parts = solve_polynomial(problem, {std::norm(nu), -2 * nu.real(), 1}, parts);
  const MatrixXd moved = joined.times(parts);
  const VectorXcd h20 = std::conj(nu) * (parts.col(0) + i * parts.col(1)) - (moved.col(0) + i * moved.col(1));
  const auto mean = map.path(h11), x = map.path(h20.real()), y = map.path(h20.imag());
  // C(q, q, conj q), B(q, h11), B(conj q, h20) of q = r + i s, h20 = x + i y
  const VectorXcd cubic = (map.trilinear(r, r) + map.trilinear(s, r)).cast<Complex>() +
                          i * (map.trilinear(r, s) + map.trilinear(s, s)).cast<Complex>();
  const VectorXcd with_mean = map.bilinear(r, mean).cast<Complex>() + i * map.bilinear(s, mean).cast<Complex>();
  const VectorXcd with_double = (map.bilinear(r, x) + map.bilinear(s, y)).cast<Complex>() +
                                i * (map.bilinear(r, y) - map.bilinear(s, x)).cast<Complex>();
  const Complex c1 = 0.5 * p.dot(cubic + 2.0 * with_mean + with_double);
  return (c1 / multiplier * std::abs(multiplier)).real();
}

double flip_cubic(CycleProblem& problem, Vec u, const VectorXd& v, const VectorXd& w, double step) {
  PeriodMap map(problem, u, step);
  const PeriodMap::Path a = map.path(v);
  // D^3 P takes D^2 R along the motion that leads to D^2 P(v, v), as does D^2 P(v, h) along that from h: the same term.
  PeriodMap::Path b;
  const VectorXd h = solve_polynomial(problem, {1, -1}, map.bilinear(a, a, &b));
  const PeriodMap::Path more = map.path(h);
  b.start += more.start;
  b.nodes += more.nodes;
  VectorXd end;
  (void)problem.forced(map.third(a, a) + 3 * map.second(a, b), end);
  return w.dot(end) / 6;
}

double flip_coefficient(CycleProblem& problem, Vec u, double step) {
  BorderedMonodromy bordered(problem, 1);
  find_null_vectors(bordered, {1, 1});
  const VectorXd w = bordered.left().col(0);
  VectorXd v = bordered.v.col(0).normalized();
  v *= std::sqrt(static_cast<double>(v.size()));
  return flip_cubic(problem, u, v, w, step) / w.dot(v);
}

}  // namespace whirl::solve
