#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "whirl/solve/normal_form.hpp"

namespace whirl::solve {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// The map P over one period: DP = M, and its higher derivatives along solutions of the variational equations.
class Map {
public:
  using Path = CycleProblem::Path;
  Map(CycleProblem& problem, Vec u, double step = 1) : problem_(problem), u_(u), step_(step) {}

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

// Right and left eigenvectors for a simple eigenvalue, p^* q = 1 and |q|^2 = n.
void eigenvectors(const MatrixXd& m, Complex mu, VectorXcd& q, VectorXcd& p) {
  const Index n = m.rows();
  const MatrixXcd shifted = m.cast<Complex>() - mu * (1 + 1e-10) * MatrixXcd::Identity(n, n);
  const Eigen::PartialPivLU<MatrixXcd> lu(shifted), adjoint(shifted.adjoint());
  q.resize(n);
  for (Index k = 0; k < n; ++k) q(k) = {std::sin(1.0 + static_cast<double>(k)), std::cos(2.0 * static_cast<double>(k))};
  p = q;
  for (int k = 0; k < 4; ++k) {
    q = lu.solve(q).normalized();
    p = adjoint.solve(p).normalized();
  }
  q *= std::sqrt(static_cast<double>(n));
  p /= std::conj(p.dot(q));
}

}  // namespace

double neimark_sacker_coefficient(CycleProblem& problem, Vec u, Complex multiplier) {
  const MatrixXd m = problem.monodromy();
  const Index n = m.rows();
  const MatrixXd one = MatrixXd::Identity(n, n);
  VectorXcd q, p;
  eigenvectors(m, multiplier, q, p);
  Map map(problem, u);
  const Complex i(0, 1);
  const auto r = map.path(q.real()), s = map.path(q.imag());
  const VectorXd rr = map.bilinear(r, r), ss = map.bilinear(s, s), rs = map.bilinear(r, s);
  const VectorXd h11 = (one - m).partialPivLu().solve(rr + ss);
  const VectorXcd h20 = (multiplier * multiplier * one.cast<Complex>() - m.cast<Complex>())
                            .partialPivLu()
                            .solve((rr - ss).cast<Complex>() + 2.0 * i * rs.cast<Complex>());
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

double flip_coefficient(CycleProblem& problem, Vec u, double step) {
  const MatrixXd m = problem.monodromy();
  VectorXcd q, p;
  eigenvectors(m, -1, q, p);
  // The complex vectors of a real eigenvalue are real ones times a common factor.
  Index largest = 0;
  q.cwiseAbs().maxCoeff(&largest);
  const Complex factor = std::abs(q(largest)) / q(largest);
  const VectorXd v = (factor * q).real();
  const VectorXd w = (p / std::conj(factor) / std::norm(factor)).real();
  Map map(problem, u, step);
  const auto a = map.path(v);
  const VectorXd h = (MatrixXd::Identity(m.rows(), m.rows()) - m).partialPivLu().solve(map.bilinear(a, a));
  return w.dot(map.trilinear(a, a) + 3 * map.bilinear(a, map.path(h))) / (6 * w.dot(v));
}

}  // namespace whirl::solve
