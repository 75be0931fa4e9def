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

using Product = std::function<VectorXd(const VectorXd&)>;

// [A b; c^T 0] with A = sum a_e M^e, or its transpose, and what its preconditioner takes for A: a_0 I + to from^T.
// Vectors have this rank's rows of a state and, on the last of the ranks that share it, behind them the k of the
// border.
struct Matrix {
  PeriodicProblem& problem;
  const std::vector<double>& a;
  Product times_m;  // or the transposed product
  const MatrixXd &b, &c, &from, &to;

  [[nodiscard]] Index states() const { return from.rows(); }
  [[nodiscard]] bool last() const { return core::rank_of(problem.rows()) == core::size_of(problem.rows()) - 1; }
  [[nodiscard]] Index local() const { return states() + (last() ? b.cols() : 0); }
  [[nodiscard]] MatrixXd sum(MatrixXd values) const {
    MPI_Allreduce(MPI_IN_PLACE, values.data(), static_cast<int>(values.size()), MPI_DOUBLE, MPI_SUM, problem.rows());
    return values;
  }
  [[nodiscard]] VectorXd border_of(const VectorXd& x) const {
    VectorXd border = VectorXd::Zero(b.cols());
    if (last()) border = x.tail(b.cols());
    return sum(std::move(border));
  }
  [[nodiscard]] MatrixXd joined(const MatrixXd& states, const MatrixXd& border) const {
    MatrixXd x(local(), states.cols());
    x.topRows(states.rows()) = states;
    if (last()) x.bottomRows(border.rows()) = border;
    return x;
  }
};

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
  o.multiply = [&s, times_m, n, a0](const VectorXd& x) {
    VectorXd power = x.head(n), y = a0 * power + s.b * s.border_of(x);
    for (std::size_t e = 1; e < s.a.size(); ++e) {
      power = times_m(power);
      y += s.a[e] * power;
    }
    return VectorXd(s.joined(y, s.sum(s.c.transpose() * x.head(n))));
  };
  if (p + k == 0) {
    o.precondition = [a0](const VectorXd& x) { return VectorXd(x / a0); };
    return o;
  }
  MatrixXd both(n, p + k), small(p + k, p + k), seen(n, p + k);
  both << s.from, s.c;
  seen << s.to, s.b;
  small = s.sum(both.transpose() * seen);
  small.topLeftCorner(p, p).diagonal().array() += a0;
  o.precondition = [&s, lu = core::DenseLu<double>(small), both, seen, n, k, a0](const VectorXd& x) {
    VectorXd z = s.sum(both.transpose() * x.head(n));
    z.tail(k) -= a0 * s.border_of(x);
    z = lu.solve(z);
    return VectorXd(s.joined((x.head(n) - seen * z) / a0, z.tail(k)));
  };
  return o;
}

// The answers for the columns of `rhs`. Collective on `comm`.
void gmres(MPI_Comm comm, const Operator& o, const MatrixXd& rhs, MatrixXd& out) {
  const auto size = static_cast<PetscInt>(rhs.rows());
  core::Gate gate(comm);
  const core::Matrix shell = core::make_shell(comm, size, gate, action_of(o.multiply));
  const core::LinearSolver solver =
      core::make_krylov(shell.get(), gate, {"bordered_", KSPGMRES, 1e-12, 100, 100}, action_of(o.precondition));
  const core::Vector b = core::make_vector(comm, size, PETSC_DETERMINE), x = core::duplicate(b.get());
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
      const double whole = core::norm(b.get());
      core::agree(comm, [&] {
        if (!(left <= 1e-8 * whole))
          throw core::NotConverged("a bordered system of the monodromy matrix does not converge");
      });
    }
    const core::ReadArray a(x.get());
    out.col(j) = Map<const VectorXd>(a.data(), size);
  }
}

MatrixXd iterate(const Matrix& s, const MatrixXd& rhs) {
  MPI_Comm comm = s.problem.comm(), rows = s.problem.rows();
  MatrixXd out(rhs.rows(), rhs.cols());
  if (core::size_of(rows) > 1) {
    gmres(rows, operator_of(s, s.times_m), rhs, out);
    return out;
  }
  // Rank 0 iterates and decides; the others have their share in its products with M only.
  VectorXd moved(s.states());
  core::lead(
      comm, 0,
      [&](const std::function<void()>& together) {
        const auto times_m = [&](const VectorXd& x) {
          moved = x;
          together();
          return moved;
        };
        gmres(PETSC_COMM_SELF, operator_of(s, times_m), rhs, out);
      },
      [&] {
        core::share(comm, moved.data(), static_cast<std::size_t>(moved.size()));
        moved = s.times_m(moved);
      });
  core::share(comm, out.data(), static_cast<std::size_t>(out.size()));
  return out;
}

Product product_of(PeriodicProblem& problem) {
  return [&problem](const VectorXd& x) { return VectorXd(problem.times(x)); };
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
void known_part(PeriodicProblem& problem, const std::vector<double>& polynomial, MatrixXd& basis, MatrixXd& image) {
  MatrixXd power;
  problem.dominant(basis, power);
  MatrixXd inside = basis.transpose() * power;
  MPI_Allreduce(MPI_IN_PLACE, inside.data(), static_cast<int>(inside.size()), MPI_DOUBLE, MPI_SUM, problem.rows());
  image = MatrixXd::Zero(power.rows(), power.cols());
  for (std::size_t e = 1; e < polynomial.size(); ++e) {
    image += polynomial[e] * power;
    if (e + 1 < polynomial.size()) power *= inside;
  }
}

// LU of [A b; c^T 0] where M is at hand. The border in the size of A, so that neither disturbs the pivots of the other.
core::DenseLu<double> bordered_lu(const MatrixXd& a, const MatrixXd& b, const MatrixXd& c, double& size) {
  const Index n = a.rows(), k = b.cols();
  size = std::max(a.norm() / std::sqrt(static_cast<double>(n)), 1e-300);
  MatrixXd whole(n + k, n + k);
  whole << a, size * b, size * c.transpose(), MatrixXd::Zero(k, k);
  return core::DenseLu<double>(whole);
}

void share(const PeriodicProblem& problem, MatrixXd& values) {
  core::share(problem.comm(), values.data(), static_cast<std::size_t>(values.size()));
}

}  // namespace

MatrixXd solve_polynomial(PeriodicProblem& problem, const std::vector<double>& polynomial, const MatrixXd& rhs) {
  if (const auto m = problem.matrix_of_period()) {
    MatrixXd x = core::DenseLu<double>(whole_polynomial(*m, polynomial)).solve(rhs);
    share(problem, x);
    return x;
  }
  MatrixXd basis, image;
  known_part(problem, polynomial, basis, image);
  const MatrixXd none(rhs.rows(), 0);
  return iterate({problem, polynomial, product_of(problem), none, none, basis, image}, rhs);
}

MatrixXd share_of_null_space(PeriodicProblem& problem, const std::vector<double>& polynomial, const MatrixXd& basis,
                             const MatrixXd& rhs) {
  const Index n = rhs.rows(), k = basis.cols();
  MatrixXd g;
  if (const auto m = problem.matrix_of_period()) {
    double size = 1;
    MatrixXd right = MatrixXd::Zero(n + k, rhs.cols());
    right.topRows(n) = rhs;
    g = bordered_lu(whole_polynomial(*m, polynomial), basis, basis, size).solve(right).bottomRows(k);
    g *= size;
    share(problem, g);
    return g;
  }
  MatrixXd known, image;
  known_part(problem, polynomial, known, image);
  const Matrix s{problem, polynomial, product_of(problem), basis, basis, known, image};
  const MatrixXd answer = iterate(s, s.joined(rhs, MatrixXd::Zero(k, rhs.cols())));
  g.resize(k, rhs.cols());
  for (Index j = 0; j < rhs.cols(); ++j) g.col(j) = s.border_of(answer.col(j));
  return g;
}

BorderedMonodromy::BorderedMonodromy(CycleProblem& problem, Index k)
    : problem_(problem), b_(problem.state_scale().size(), k), c_(b_.rows(), k) {
  // Generic vectors, or combinations of the dominant subspace where there is one: film states would leave generic
  // vectors nearly orthogonal to null vectors, which are smooth.
  MatrixXd known, image;
  if (!problem.composition().has_monodromy()) {
    (void)problem.multipliers();  // leaves a dominant subspace
    problem.dominant(known, image);
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
  const Index n = b_.rows(), k = b_.cols();
  if (const auto m = problem_.matrix_of_period()) {
    double size = 1;
    const core::DenseLu<double> lu = bordered_lu(whole_polynomial(*m, polynomial), b_, c_, size);
    MatrixXd unit = MatrixXd::Zero(n + k, k);
    unit.bottomRows(k) = size * MatrixXd::Identity(k, k);
    MatrixXd right = lu.solve(unit), adjoint = lu.solve_transposed(unit);
    for (MatrixXd* part : {&right, &adjoint}) share(problem_, *part);
    v = right.topRows(n);
    g = size * right.bottomRows(k);
    w_ = adjoint.topRows(n);
    return;
  }
  known_part(problem_, polynomial, basis_, image_);
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
  if (!transposed) return iterate({problem_, polynomial_, product_of(problem_), b_, c_, basis_, image_}, unit);
  const Product back = [this](const VectorXd& x) { return VectorXd(problem_.composition().times_transposed(x)); };
  return iterate({problem_, polynomial_, back, c_, b_, image_, basis_}, unit);
}

void BorderedMonodromy::update() {
  b_ = left();
  c_ = v;
  orthonormalise(b_);
  orthonormalise(c_);
}

}  // namespace whirl::solve
