#include "solve/bifurcation/bordered_monodromy.hpp"

#include <cmath>
#include <functional>

#include "whirl/core/agree.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void orthonormalise(MatrixXd& m) {
  for (Index j = 0; j < m.cols(); ++j) {
    for (Index i = 0; i < j; ++i) m.col(j) -= m.col(i).dot(m.col(j)) * m.col(i);
    m.col(j).normalize();
  }
}

// [A b; c^T 0] with A = sum a_e M^e, or its transpose, and what its preconditioner takes for A: a_0 I + to from^T.
struct Matrix {
  CycleProblem& problem;
  const std::vector<double>& a;
  bool transposed = false;
  const MatrixXd &b, &c, &from, &to;

  [[nodiscard]] Index states() const { return from.rows(); }
  [[nodiscard]] VectorXd product_with_m(const VectorXd& x) const {
    Composition& joined = problem.composition();
    return VectorXd(transposed ? joined.times_transposed(x) : joined.times(x));
  }
};

using Product = std::function<VectorXd(const VectorXd&)>;

// A square system that is known by what it and its preconditioner do to a vector.
struct Operator {
  Product multiply, precondition;
};

core::Action action_of(const Product& work) {
  return [&work](Vec x, Vec y) {
    const core::ReadArray in(x);
    const core::WriteArray out(y);
    Map<VectorXd>(out.data(), out.size()) = work(Map<const VectorXd>(in.data(), in.size()));
  };
}

Operator operator_of(const Matrix& s, const Product& times_m) {
  const Index n = s.states(), k = s.b.cols(), p = s.to.cols();
  const double a0 = s.a[0];
  Operator o;
  o.multiply = [&s, times_m, n, k, a0](const VectorXd& x) {
    VectorXd y(n + k), power = x.head(n);
    y.head(n) = a0 * power + s.b * x.tail(k);
    for (std::size_t e = 1; e < s.a.size(); ++e) {
      power = times_m(power);
      y.head(n) += s.a[e] * power;
    }
    y.tail(k) = s.c.transpose() * x.head(n);
    return y;
  };
  if (p + k == 0) {
    o.precondition = [a0](const VectorXd& x) { return VectorXd(x / a0); };
    return o;
  }
  MatrixXd small(p + k, p + k);
  small << a0 * MatrixXd::Identity(p, p) + s.from.transpose() * s.to, s.from.transpose() * s.b, s.c.transpose() * s.to,
      s.c.transpose() * s.b;
  o.precondition = [&s, lu = core::DenseLu<double>(small), n, k, p, a0](const VectorXd& x) {
    VectorXd z(p + k), y(n + k);
    z << s.from.transpose() * x.head(n), s.c.transpose() * x.head(n) - a0 * x.tail(k);
    z = lu.solve(z);
    y << (x.head(n) - s.to * z.head(p) - s.b * z.tail(k)) / a0, z.tail(k);
    return y;
  };
  return o;
}

// The answers for the columns of `rhs` on this rank alone.
void gmres(const Operator& o, const MatrixXd& rhs, MatrixXd& out) {
  const auto size = static_cast<PetscInt>(rhs.rows());
  core::Gate gate(PETSC_COMM_SELF);
  const core::Matrix shell = core::make_shell(PETSC_COMM_SELF, size, gate, action_of(o.multiply));
  const core::LinearSolver solver =
      core::make_krylov(shell.get(), gate, {"bordered_", KSPGMRES, 1e-12, 100, 100}, action_of(o.precondition));
  const core::Vector b = core::make_vector(PETSC_COMM_SELF, size, size), x = core::duplicate(b.get());
  for (Index j = 0; j < rhs.cols(); ++j) {
    {
      const core::WriteArray a(b.get());
      Map<VectorXd>(a.data(), size) = rhs.col(j);
    }
    gate.rethrow(KSPSolve(solver.get(), b.get(), x.get()));
    if (core::reason_of(solver.get()) < 0) {
      // Next to a singular system the last digits are rounding; normal forms need not have them.
      PetscReal left = 0;
      check(KSPGetResidualNorm(solver.get(), &left));
      if (!(left <= 1e-8 * rhs.col(j).norm()))
        throw core::NotConverged("a bordered system of the monodromy matrix does not converge");
    }
    const core::ReadArray a(x.get());
    out.col(j) = Map<const VectorXd>(a.data(), size);
  }
}

// Rank 0 iterates and decides; the others have their share in its products with M only.
MatrixXd iterate(const Matrix& s, const MatrixXd& rhs) {
  MatrixXd out(rhs.rows(), rhs.cols());
  VectorXd moved(s.states());
  core::lead(
      s.problem.comm(), 0,
      [&](const std::function<void()>& together) {
        const auto times_m = [&](const VectorXd& x) {
          moved = x;
          together();
          return moved;
        };
        gmres(operator_of(s, times_m), rhs, out);
      },
      [&] {
        core::share(s.problem.comm(), moved.data(), static_cast<std::size_t>(moved.size()));
        moved = s.product_with_m(moved);
      });
  core::share(s.problem.comm(), out.data(), static_cast<std::size_t>(out.size()));
  return out;
}

// sum a_e M^e where M is at hand.
MatrixXd whole_polynomial(const MatrixXd& m, const std::vector<double>& polynomial) {
  MatrixXd a = polynomial[0] * MatrixXd::Identity(m.rows(), m.cols()), power = m;
  for (std::size_t e = 1; e < polynomial.size(); ++e) {
    a += polynomial[e] * power;
    if (e + 1 < polynomial.size()) power *= m;
  }
  return a;
}

// V and U of A ~ a_0 I + U V^T.
void known_part(Composition& joined, const std::vector<double>& polynomial, MatrixXd& basis, MatrixXd& image) {
  MatrixXd power;
  joined.dominant(basis, power);
  const MatrixXd inside = basis.transpose() * power;
  image = MatrixXd::Zero(power.rows(), power.cols());
  for (std::size_t e = 1; e < polynomial.size(); ++e) {
    image += polynomial[e] * power;
    if (e + 1 < polynomial.size()) power *= inside;
  }
}

}  // namespace

MatrixXd solve_polynomial(CycleProblem& problem, const std::vector<double>& polynomial, const MatrixXd& rhs) {
  Composition& joined = problem.composition();
  if (joined.has_monodromy()) {
    MatrixXd x = core::DenseLu<double>(whole_polynomial(joined.monodromy(), polynomial)).solve(rhs);
    core::share(problem.comm(), x.data(), static_cast<std::size_t>(x.size()));
    return x;
  }
  MatrixXd basis, image;
  known_part(joined, polynomial, basis, image);
  const MatrixXd none(rhs.rows(), 0);
  return iterate({problem, polynomial, false, none, none, basis, image}, rhs);
}

BorderedMonodromy::BorderedMonodromy(CycleProblem& problem, Index k)
    : problem_(problem), b_(problem.state_scale().size(), k), c_(b_.rows(), k) {
  // Generic vectors, or combinations of the dominant subspace where there is one: film states would leave generic
  // vectors nearly orthogonal to null vectors, which are smooth.
  MatrixXd known, image;
  if (!problem.composition().has_monodromy()) {
    (void)problem.multipliers();  // leaves a dominant subspace
    problem.composition().dominant(known, image);
  }
  const bool few = known.cols() < k;
  const Index p = few ? b_.rows() : known.cols();
  MatrixXd left(p, k), right(p, k);
  for (Index j = 0; j < k; ++j)
    for (Index i = 0; i < p; ++i) {
      left(i, j) = std::sin(1.0 + static_cast<double>(i + p * j));
      right(i, j) = std::cos(2.0 + static_cast<double>(i) + static_cast<double>(p * j) / 3);
    }
  b_ = few ? left : MatrixXd(known * left);
  c_ = few ? right : MatrixXd(known * right);
  orthonormalise(b_);
  orthonormalise(c_);
}

void BorderedMonodromy::solve(const std::vector<double>& polynomial) {
  polynomial_ = polynomial;
  w_.resize(0, 0);
  Composition& joined = problem_.composition();
  const Index n = b_.rows(), k = b_.cols();
  if (joined.has_monodromy()) {
    const MatrixXd a = whole_polynomial(joined.monodromy(), polynomial);
    // The border in the size of A, so that neither disturbs the pivots of the other.
    const double size = std::max(a.norm() / std::sqrt(static_cast<double>(n)), 1e-300);
    MatrixXd whole(n + k, n + k), unit = MatrixXd::Zero(n + k, k);
    whole << a, size * b_, size * c_.transpose(), MatrixXd::Zero(k, k);
    unit.bottomRows(k) = size * MatrixXd::Identity(k, k);
    const core::DenseLu<double> lu(whole);
    MatrixXd right = lu.solve(unit), adjoint = lu.solve_transposed(unit);
    for (MatrixXd* m : {&right, &adjoint}) core::share(problem_.comm(), m->data(), static_cast<std::size_t>(m->size()));
    v = right.topRows(n);
    g = size * right.bottomRows(k);
    w_ = adjoint.topRows(n);
    return;
  }
  known_part(joined, polynomial, basis_, image_);
  const MatrixXd right = null_vectors(false);
  v = right.topRows(n);
  g = right.bottomRows(k);
}

const MatrixXd& BorderedMonodromy::left() {
  if (w_.size() == 0) w_ = null_vectors(true).topRows(b_.rows());
  return w_;
}

// Transposed, U and V, b and c change places.
MatrixXd BorderedMonodromy::null_vectors(bool transposed) const {
  const Index n = b_.rows(), k = b_.cols();
  MatrixXd unit = MatrixXd::Zero(n + k, k);
  unit.bottomRows(k).setIdentity();
  if (transposed) return iterate({problem_, polynomial_, true, c_, b_, image_, basis_}, unit);
  return iterate({problem_, polynomial_, false, b_, c_, basis_, image_}, unit);
}

void BorderedMonodromy::update() {
  b_ = left();
  c_ = v;
  orthonormalise(b_);
  orthonormalise(c_);
}

}  // namespace whirl::solve
