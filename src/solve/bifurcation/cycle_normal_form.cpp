#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>
#include <vector>

#include "solve/bifurcation/bordered_monodromy.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/least_squares.hpp"
#include "whirl/solve/bifurcation/normal_form.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// A sum of motions over the same intervals.
Path sum(std::initializer_list<std::pair<double, const Path*>> parts) {
  Path out = *parts.begin()->second;
  out.start.setZero();
  out.nodes.setZero();
  for (const auto& [factor, path] : parts) {
    out.start += factor * path->start;
    out.nodes += factor * path->nodes;
  }
  return out;
}

// The map P over one period: DP = M, and its higher derivatives along solutions of the variational equations. Films are
// evaluated at cycles moved along a, for all b at once: they cost more than all the rest.
class PeriodMap {
public:
  PeriodMap(PeriodicProblem& problem, Vec u, double step, const MotionSize& size)
      : problem_(problem), u_(u), step_(step), size_(size) {}

  // D^2 R[a, b] at the collocation points, for each b.
  std::vector<MatrixXd> second(const Path& a, const std::vector<const Path*>& b) {
    // Differences that are to look over kinks do so in second derivatives as well.
    const double h = step_ > 1 ? reach(a) : difference_step(size(a));
    std::vector<MatrixXd> out = problem_.tangents(u_, h, a, b);
    const std::vector<MatrixXd> behind = problem_.tangents(u_, -h, a, b);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = (out[k] - behind[k]) / (2 * h);
    return out;
  }
  // D^3 R[a, a, b] for each b; `here` are tangents() of these b without a step.
  std::vector<MatrixXd> third(const Path& a, const std::vector<const Path*>& b, const std::vector<MatrixXd>& here) {
    const double h = reach(a);
    std::vector<MatrixXd> out = problem_.tangents(u_, h, a, b);
    const std::vector<MatrixXd> behind = problem_.tangents(u_, -h, a, b);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = (out[k] - 2 * here[k] + behind[k]) / (h * h);
    return out;
  }
  std::vector<MatrixXd> tangents(const std::vector<const Path*>& b) { return problem_.tangents(u_, 0, *b.front(), b); }
  // The end of the motion from rest under -y: D^2 P[a, b] for y = D^2 R[a, b].
  VectorXd end(const MatrixXd& y, Path* motion = nullptr) {
    VectorXd end;
    Path path = problem_.forced(y, end);
    if (motion) *motion = std::move(path);
    return end;
  }
  Path path(const VectorXd& v) const { return problem_.forward(v); }

private:
  double reach(const Path& a) const { return step_ * std::pow(std::numeric_limits<double>::epsilon(), 0.25) / size(a); }
  double size(const Path& a) const {
    double value = size_(a.start);
    for (Index k = 0; k < a.nodes.cols(); ++k) value = std::max(value, size_(a.nodes.col(k)));
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, problem_.comm());
    return value > 0 ? value : 1;
  }
  PeriodicProblem& problem_;
  Vec u_;
  double step_;
  const MotionSize& size_;
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
  const MatrixXd plane = core::least_squares(basis, product);
  return basis * spectral::eigenpairs(plane).nearest(mu);
}

// The start of the motion of a multiplier with a root mean square of one.
VectorXcd critical_vector(PeriodicProblem& problem, Complex multiplier) {
  VectorXcd q = problem.multiplier_vector(multiplier);
  int unknown = q.size() == 0 && problem.state_scale().size() > 0;
  MPI_Allreduce(MPI_IN_PLACE, &unknown, 1, MPI_INT, MPI_LOR, problem.comm());
  if (unknown != 0) core::agree(problem.comm(), [] { throw core::NotConverged("no such multiplier was found"); });
  double sums[] = {q.squaredNorm(), static_cast<double>(q.size())};
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_DOUBLE, MPI_SUM, problem.rows());
  return q * std::sqrt(sums[1] / sums[0]);
}

// D^3 P(v, v, v) + 3 D^2 P(v, h) with (I - M) h = D^2 P(v, v).
VectorXd cubic_end(PeriodicProblem& problem, Vec u, const VectorXd& v, double step, const MotionSize& size) {
  PeriodMap map(problem, u, step, size);
  const Path a = map.path(v);
  // D^3 P takes D^2 R along the motion that leads to D^2 P(v, v), as does D^2 P(v, h) along that from h: the same term.
  Path along;
  const VectorXd h = solve_polynomial(problem, {1, -1}, map.end(map.second(a, {&a})[0], &along));
  const Path more = map.path(h), b = sum({{1, &along}, {1, &more}});
  return map.end(map.third(a, {&a}, map.tangents({&a}))[0] + 3 * map.second(a, {&b})[0]);
}

// Of (M - mu)(M - conj mu).
std::vector<double> pair_polynomial(Complex mu) {
  return {std::norm(mu), -2 * mu.real(), 1};
}

}  // namespace

VectorXcd CycleProblem::multiplier_vector(Complex mu) {
  const bool real = mu.imag() == 0;
  BorderedMonodromy bordered(*this, real ? 1 : 2);
  find_null_vectors(bordered, real ? std::vector{-mu.real(), 1.0} : pair_polynomial(mu));
  if (real) return bordered.v.col(0).cast<Complex>();
  return eigenvector_in(bordered.v, times(bordered.v), mu);
}

double neimark_sacker_coefficient(PeriodicProblem& problem, Vec u, Complex multiplier, double step,
                                  const MotionSize& size) {
  const VectorXcd q = critical_vector(problem, multiplier);
  PeriodMap map(problem, u, step, size);
  const Complex i(0, 1);
  const Path r = map.path(q.real()), s = map.path(q.imag());
  Path along_rr, along_rs, along_ss;
  const auto at_r = map.second(r, {&r, &s});
  const VectorXd rr = map.end(at_r[0], &along_rr), rs = map.end(at_r[1], &along_rs),
                 ss = map.end(map.second(s, {&s})[0], &along_ss);
  const VectorXd h11 = solve_polynomial(problem, {1, -1}, rr + ss);
  // (nu - M)^-1 = (conj nu - M)(|nu|^2 - 2 Re nu M + M^2)^-1, nu = mu^2
  const Complex nu = multiplier * multiplier;
  MatrixXd parts(q.size(), 2);
  parts << rr - ss, 2 * rs;
  parts = solve_polynomial(problem, pair_polynomial(nu), parts);
  const MatrixXd moved = problem.times(parts);
  const VectorXcd h20 = std::conj(nu) * (parts.col(0) + i * parts.col(1)) - (moved.col(0) + i * moved.col(1));
  const Path mean = map.path(h11), x = map.path(h20.real()), y = map.path(h20.imag());
  // C(q, q, conj q) + 2 B(q, h11) + B(conj q, h20) of q = r + i s, h20 = x + i y. Of
  //
  //     D^3 P[a, a, b] = D^3 R[a, a, b] + 2 D^2 R[a, along_ab] + D^2 R[b, along_aa]   (the motions that these force)
  //
  // and of the others every second derivative has r or s as one of its directions.
  const Path with_r = sum({{3, &along_rr}, {1, &along_ss}, {2, &mean}, {1, &x}}), both = sum({{2, &along_rs}, {1, &y}}),
             with_s = sum({{1, &along_rr}, {3, &along_ss}, {2, &mean}, {-1, &x}});
  const auto twice_r = map.second(r, {&with_r, &both}), twice_s = map.second(s, {&both, &with_s}),
             here = map.tangents({&r, &s}), cubic_r = map.third(r, {&r, &s}, here),
             cubic_s = map.third(s, {&r, &s}, here);
  MatrixXd plane(q.size(), 2), ends(q.size(), 2);
  plane << q.real(), q.imag();
  ends << map.end(cubic_r[0] + cubic_s[0] + twice_r[0] + twice_s[0]),
      map.end(cubic_r[1] + cubic_s[1] + twice_r[1] + twice_s[1]);
  // Of a r + b s, complex a and b, the share of q is (a - i b)/2.
  const MatrixXd share = share_of_null_space(problem, pair_polynomial(multiplier), plane, ends);
  const Eigen::Vector2cd in_plane = share.col(0) + i * share.col(1);
  const Complex c1 = 0.25 * (in_plane(0) - i * in_plane(1));
  return (c1 / multiplier * std::abs(multiplier)).real();
}

double flip_cubic(CycleProblem& problem, Vec u, const VectorXd& v, const VectorXd& w, double step,
                  const MotionSize& size) {
  return w.dot(cubic_end(problem, u, v, step, size)) / 6;
}

double flip_coefficient(PeriodicProblem& problem, Vec u, double step, const MotionSize& size) {
  const VectorXd v = critical_vector(problem, -1).real();
  return share_of_null_space(problem, {1, 1}, v, cubic_end(problem, u, v, step, size))(0, 0) / 6;
}

}  // namespace whirl::solve
