#include "solve/bordered_monodromy.hpp"

#include <petscksp.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "whirl/core/error.hpp"
#include "whirl/core/gate.hpp"
#include "whirl/core/petsc.hpp"

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

// A square system that is known by what it and its preconditioner do to a vector.
struct Operator {
  std::function<VectorXd(const VectorXd&)> multiply, precondition;
  core::Gate gate{PETSC_COMM_SELF};
};

PetscErrorCode run(Operator& o, const std::function<VectorXd(const VectorXd&)>& work, Vec x, Vec y) {
  return o.gate.run([&] {
    const core::ReadArray in(x);
    const core::WriteArray out(y);
    Map<VectorXd>(out.data(), out.size()) = work(Map<const VectorXd>(in.data(), in.size()));
  });
}

PetscErrorCode multiply(Mat m, Vec x, Vec y) {
  void* raw = nullptr;
  PetscCall(MatShellGetContext(m, &raw));
  auto& o = *static_cast<Operator*>(raw);
  return run(o, o.multiply, x, y);
}

PetscErrorCode precondition(PC pc, Vec x, Vec y) {
  void* raw = nullptr;
  PetscCall(PCShellGetContext(pc, &raw));
  auto& o = *static_cast<Operator*>(raw);
  return run(o, o.precondition, x, y);
}

// The answers for right-hand sides (0; I). Every rank solves the same system: only the products are shared.
MatrixXd gmres(Operator& o, Index n, Index k) {
  const auto size = static_cast<PetscInt>(n + k);
  core::Matrix shell;
  core::LinearSolver solver;
  check(MatCreateShell(PETSC_COMM_SELF, size, size, size, size, &o, shell.put()));
  check(MatShellSetOperation(shell.get(), MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
  check(KSPCreate(PETSC_COMM_SELF, solver.put()));
  check(KSPSetOptionsPrefix(solver.get(), "bordered_"));
  check(KSPSetOperators(solver.get(), shell.get(), shell.get()));
  check(KSPSetType(solver.get(), KSPGMRES));
  check(KSPSetPCSide(solver.get(), PC_RIGHT));
  check(KSPGMRESSetRestart(solver.get(), 100));
  check(KSPSetTolerances(solver.get(), 1e-12, 1e-300, PETSC_DEFAULT, 300));
  PC pc = nullptr;
  check(KSPGetPC(solver.get(), &pc));
  check(PCSetType(pc, PCSHELL));
  check(PCShellSetContext(pc, &o));
  check(PCShellSetApply(pc, precondition));
  check(KSPSetFromOptions(solver.get()));
  const core::Vector rhs = core::make_vector(PETSC_COMM_SELF, size, size), x = core::duplicate(rhs.get());
  MatrixXd out(n + k, k);
  for (Index j = 0; j < k; ++j) {
    check(VecSet(rhs.get(), 0.0));
    check(VecSetValue(rhs.get(), static_cast<PetscInt>(n + j), 1, INSERT_VALUES));
    check(VecAssemblyBegin(rhs.get()));
    check(VecAssemblyEnd(rhs.get()));
    o.gate.rethrow(KSPSolve(solver.get(), rhs.get(), x.get()));
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    check(KSPGetConvergedReason(solver.get(), &reason));
    if (reason < 0) throw core::NotConverged("a bordered system of the monodromy matrix does not converge");
    const core::ReadArray a(x.get());
    out.col(j) = Map<const VectorXd>(a.data(), n + k);
  }
  return out;
}

}  // namespace

BorderedMonodromy::BorderedMonodromy(CycleProblem& problem, Index k)
    : problem_(problem), b_(problem.state_scale().size(), k), c_(b_.rows(), k) {
  const Index n = b_.rows();
  for (Index j = 0; j < k; ++j)
    for (Index i = 0; i < n; ++i) {
      b_(i, j) = std::sin(1.0 + static_cast<double>(i + n * j));
      c_(i, j) = std::cos(2.0 + static_cast<double>(i) + static_cast<double>(n * j) / 3);
    }
  orthonormalise(b_);
  orthonormalise(c_);
  if (!problem.composition().has_monodromy()) (void)problem.multipliers();  // leaves a dominant subspace
}

void BorderedMonodromy::solve(const std::vector<double>& polynomial) {
  polynomial_ = polynomial;
  w_.resize(0, 0);
  Composition& joined = problem_.composition();
  const Index n = b_.rows(), k = b_.cols();
  if (joined.has_monodromy()) {
    const MatrixXd m = joined.monodromy();
    MatrixXd a = polynomial[0] * MatrixXd::Identity(n, n), power = m;
    for (std::size_t e = 1; e < polynomial.size(); ++e) {
      a += polynomial[e] * power;
      if (e + 1 < polynomial.size()) power *= m;
    }
    // The border in the size of A, so that neither disturbs the pivots of the other.
    const double size = std::max(a.norm() / std::sqrt(static_cast<double>(n)), 1e-300);
    MatrixXd whole(n + k, n + k), unit = MatrixXd::Zero(n + k, k);
    whole << a, size * b_, size * c_.transpose(), MatrixXd::Zero(k, k);
    unit.bottomRows(k) = size * MatrixXd::Identity(k, k);
    const Eigen::PartialPivLU<MatrixXd> lu(whole);
    const MatrixXd right = lu.solve(unit);
    v = right.topRows(n);
    g = size * right.bottomRows(k);
    const MatrixXd adjoint = lu.transpose().solve(unit);
    w_ = adjoint.topRows(n);
    return;
  }
  MatrixXd image;
  joined.dominant(basis_, image);
  const MatrixXd inside = basis_.transpose() * image;
  image_ = MatrixXd::Zero(n, image.cols());
  for (std::size_t e = 1; e < polynomial.size(); ++e) {
    image_ += polynomial[e] * image;
    if (e + 1 < polynomial.size()) image *= inside;
  }
  const MatrixXd right = iterate(false);
  v = right.topRows(n);
  g = right.bottomRows(k);
}

const MatrixXd& BorderedMonodromy::left() {
  if (w_.size() == 0) w_ = iterate(true).topRows(b_.rows());
  return w_;
}

// Transposed, U and V, b and c change places.
MatrixXd BorderedMonodromy::iterate(bool transposed) const {
  const MatrixXd &b = transposed ? c_ : b_, &c = transposed ? b_ : c_, &from = transposed ? image_ : basis_,
                 &to = transposed ? basis_ : image_;
  const Index n = b.rows(), k = b.cols(), p = to.cols();
  Composition& joined = problem_.composition();
  const auto times_m = [&](const VectorXd& x) {
    return VectorXd(transposed ? joined.times_transposed(x) : joined.times(x));
  };
  const double a0 = polynomial_[0];
  MatrixXd small(p + k, p + k);
  small << a0 * MatrixXd::Identity(p, p) + from.transpose() * to, from.transpose() * b, c.transpose() * to,
      c.transpose() * b;
  const Eigen::PartialPivLU<MatrixXd> lu(small);
  Operator o;
  o.multiply = [&](const VectorXd& x) {
    VectorXd y(n + k), power = x.head(n);
    y.head(n) = a0 * power + b * x.tail(k);
    for (std::size_t e = 1; e < polynomial_.size(); ++e) {
      power = times_m(power);
      y.head(n) += polynomial_[e] * power;
    }
    y.tail(k) = c.transpose() * x.head(n);
    return y;
  };
  o.precondition = [&](const VectorXd& x) {
    VectorXd z(p + k), y(n + k);
    z << from.transpose() * x.head(n), c.transpose() * x.head(n) - a0 * x.tail(k);
    z = lu.solve(z).eval();
    y << (x.head(n) - to * z.head(p) - b * z.tail(k)) / a0, z.tail(k);
    return y;
  };
  return gmres(o, n, k);
}

void BorderedMonodromy::update() {
  b_ = left();
  c_ = v;
  orthonormalise(b_);
  orthonormalise(c_);
}

}  // namespace whirl::solve
