#include "whirl/spectral/eigenvalues.hpp"

#include <fmt/core.h>
#include <slepceps.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "spectral/rounding.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/gate.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::spectral {
namespace {

using core::check;
using EigenSolver = core::Handle<EPS, EPSDestroy>;

// The whole of a small distributed matrix, dense on this rank.
core::Matrix redundant_dense(Mat m) {
  core::Matrix whole, dense;
  const int size = core::size_of(PetscObjectComm(reinterpret_cast<PetscObject>(m)));
  if (size == 1) {
    check(MatConvert(m, MATSEQDENSE, MAT_INITIAL_MATRIX, dense.put()));
    return dense;
  }
  check(MatCreateRedundantMatrix(m, size, MPI_COMM_NULL, MAT_INITIAL_MATRIX, whole.put()));
  check(MatConvert(whole.get(), MATSEQDENSE, MAT_INITIAL_MATRIX, dense.put()));
  return dense;
}

// Real SLEPc keeps a complex pair as two entries and its vector as real and imaginary part: hidden here once.
struct Pair {
  Complex value;
  std::vector<double> real, imaginary;
};

Pair pair_of(EPS eps, PetscInt i, Vec re, Vec im, bool vectors) {
  PetscScalar a = 0, b = 0;
  Pair p;
  if (vectors) {
    check(EPSGetEigenpair(eps, i, &a, &b, re, im));
    p.real = core::gather(re);
    p.imaginary = core::gather(im);
  } else {
    check(EPSGetEigenvalue(eps, i, &a, &b));
  }
  p.value = {a, b};
  return p;
}

// Rank 0's list for all ranks.
void share(MPI_Comm comm, std::vector<Complex>& values) {
  auto count = static_cast<unsigned long>(values.size());
  MPI_Bcast(&count, 1, MPI_UNSIGNED_LONG, 0, comm);
  values.resize(count);
  core::share(comm, reinterpret_cast<double*>(values.data()), 2 * values.size());
}

// The generalised Schur form of strongly non-normal pencils (thin films swept along by the journal) may refuse to be
// sorted: LAPACK's dtgexc calls neighbours too close. Their standard form b^-1 a sorts.
void solve_dense(EigenSolver& eps, Mat a, Mat b) {
  try {
    check(EPSSolve(eps.get()));
    return;
  } catch (const core::LibraryError&) {
    check(MatLUFactor(b, nullptr, nullptr, nullptr));
  }
  core::Matrix standard;
  check(MatDuplicate(a, MAT_DO_NOT_COPY_VALUES, standard.put()));
  check(MatMatSolve(b, a, standard.get()));
  eps.reset();
  check(EPSCreate(PETSC_COMM_SELF, eps.put()));
  check(EPSSetOptionsPrefix(eps.get(), "modes_"));
  check(EPSSetOperators(eps.get(), standard.get(), nullptr));
  check(EPSSetProblemType(eps.get(), EPS_NHEP));
  check(EPSSetType(eps.get(), EPSLAPACK));
  check(EPSSetFromOptions(eps.get()));
  check(EPSSolve(eps.get()));
}

constexpr double search_tolerance = 1e-10;

// A ShiftInverse as the preconditioner of a KSP.
struct InverseShell {
  ShiftInverse& inverse;
  core::Gate gate;

  static PetscErrorCode set_up(PC pc) {
    void* raw = nullptr;
    Mat a = nullptr;
    PetscCall(PCShellGetContext(pc, &raw));
    PetscCall(PCGetOperators(pc, &a, nullptr));
    auto& self = *static_cast<InverseShell*>(raw);
    return self.gate.run([&] { self.inverse.factorise(a); });
  }
  static PetscErrorCode apply(PC pc, Vec rhs, Vec x) {
    void* raw = nullptr;
    PetscCall(PCShellGetContext(pc, &raw));
    auto& self = *static_cast<InverseShell*>(raw);
    return self.gate.run([&] { self.inverse.solve(rhs, x); });
  }
  void serve(KSP ksp) {
    PC pc = nullptr;
    check(KSPSetType(ksp, KSPPREONLY));
    check(KSPGetPC(ksp, &pc));
    check(PCSetType(pc, PCSHELL));
    check(PCShellSetContext(pc, this));
    check(PCShellSetSetUp(pc, set_up));
    check(PCShellSetApply(pc, apply));
  }
};

// The `wanted` eigenvalues nearest to a real target, by Krylov-Schur with shift and invert.
void search_near(EPS eps, Mat a, double target, PetscInt wanted, InverseShell* shell) {
  PetscInt n = 0;
  check(MatGetSize(a, &n, nullptr));
  check(EPSSetType(eps, EPSKRYLOVSCHUR));
  check(EPSSetDimensions(eps, wanted, std::min<PetscInt>(n, 2 * wanted + 20), PETSC_DEFAULT));
  check(EPSSetTolerances(eps, search_tolerance, 200));
  check(EPSSetTarget(eps, target));
  check(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
  ST st = nullptr;
  KSP ksp = nullptr;
  check(EPSGetST(eps, &st));
  check(STSetType(st, STSINVERT));
  check(STGetKSP(st, &ksp));
  if (shell)
    shell->serve(ksp);
  else
    core::make_direct(ksp);
  // The same start vector on any number of ranks.
  core::Vector start;
  check(MatCreateVecs(a, start.put(), nullptr));
  PetscInt begin = 0;
  check(VecGetOwnershipRange(start.get(), &begin, nullptr));
  {
    const core::WriteArray s(start.get());
    for (PetscInt i = 0; i < s.size(); ++i) s[i] = 1 + std::sin(0.7 * static_cast<double>(begin + i));
  }
  Vec first = start.get();
  check(EPSSetInitialSpace(eps, 1, &first));
}

Eigen::MatrixXd entries(Mat dense) {
  PetscInt n = 0;
  check(MatGetSize(dense, &n, nullptr));
  const PetscScalar* a = nullptr;
  check(MatDenseGetArrayRead(dense, &a));
  Eigen::MatrixXd out = Eigen::Map<const Eigen::MatrixXd>(a, n, n);
  check(MatDenseRestoreArrayRead(dense, &a));
  return out;
}

// What a solver has found, at least `wanted` of them; `scale` makes the shapes SI.
std::vector<Mode> modes_of(const EigenSolver& eps, Mat a, const std::vector<double>& scale, PetscInt wanted,
                           const EigenOptions& options, DensePencil* pencil) {
  PetscInt converged = 0;
  check(EPSGetConverged(eps.get(), &converged));
  if (converged < wanted)
    throw core::NotConverged(fmt::format("only {} of {} eigenvalues converged", converged, options.count));
  core::Vector re, im;
  check(MatCreateVecs(a, re.put(), im.put()));
  std::vector<Mode> out;
  std::vector<PetscInt> place;
  for (PetscInt i = 0; i < converged; ++i) {
    const Pair p = pair_of(eps.get(), i, re.get(), im.get(), options.shapes || pencil);
    if (pencil) pencil->add(p.value, p.real, p.imaginary);
    if (p.value.imag() < 0 || !std::isfinite(p.value.real())) continue;
    Mode m{p.value, {}};
    // What a search by iteration leaves.
    if (options.rounding && !pencil) m.rounding = search_tolerance * std::abs(p.value);
    if (options.shapes) {
      m.shape.resize(p.real.size());
      Complex largest = 0;
      for (std::size_t k = 0; k < p.real.size(); ++k) {
        const Complex value(p.real[k], p.value.imag() != 0 ? p.imaginary[k] : 0.0);
        if (std::abs(value) > std::abs(largest)) largest = value;
        m.shape[k] = value * scale[k];
      }
      for (Complex& v : m.shape) v /= largest;
    }
    if (pencil) place.push_back(i);
    out.push_back(std::move(m));
  }
  if (pencil) {
    const std::vector<double> rounding = pencil->rounding();
    for (std::size_t k = 0; k < out.size(); ++k) out[k].rounding = rounding[static_cast<std::size_t>(place[k])];
  }
  std::sort(out.begin(), out.end(), [](const Mode& m, const Mode& n) {
    return std::pair(m.lambda.imag(), m.lambda.real()) < std::pair(n.lambda.imag(), n.lambda.real());
  });
  return out;
}

// Of a dense matrix, by Eigen.
Eigen::EigenSolver<Eigen::MatrixXd> solve_small(const Eigen::MatrixXd& matrix, bool vectors) {
  if (!matrix.allFinite()) throw core::NotConverged("eigenvalues of a matrix that is not finite");
  Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix, vectors);
  if (solver.info() != Eigen::Success) throw core::NotConverged("the eigenvalues did not converge");
  return solver;
}

}  // namespace

std::vector<Mode> modes(problem::System& system, Vec x, const EigenOptions& options) {
  core::Vector rest = core::duplicate(x), xs = core::duplicate(x), fs = core::duplicate(x);
  check(VecSet(rest.get(), 0.0));
  system.scales(xs.get(), fs.get());
  const std::vector<double> scale = core::gather(xs.get());
  check(VecReciprocal(fs.get()));
  core::Matrix a = system.make_jacobian(), b = system.make_jacobian();
  system.jacobian(0, x, rest.get(), 1, 0, a.get());
  system.jacobian(0, x, rest.get(), 0, -1, b.get());  // dF/dx u = lambda (-dF/dxdot) u
  check(MatDiagonalScale(a.get(), fs.get(), xs.get()));
  check(MatDiagonalScale(b.get(), fs.get(), xs.get()));

  const bool dense = system.size() <= std::max(options.dense_below, 3);  // Krylov wants n - 2 > 0
  MPI_Comm comm = dense ? PETSC_COMM_SELF : system.comm();
  if (dense) {
    a = redundant_dense(a.get());
    b = redundant_dense(b.get());
  }
  std::optional<InverseShell> shell;
  EigenSolver eps;
  check(EPSCreate(comm, eps.put()));
  check(EPSSetOptionsPrefix(eps.get(), "modes_"));
  check(EPSSetOperators(eps.get(), a.get(), b.get()));
  check(EPSSetProblemType(eps.get(), EPS_GNHEP));
  if (dense) {
    check(EPSSetType(eps.get(), EPSLAPACK));
  } else {
    if (options.inverse) shell.emplace(*options.inverse, core::Gate(comm));
    search_near(eps.get(), a.get(), options.target, std::min<PetscInt>(options.count, system.size() - 2),
                shell ? &*shell : nullptr);
  }
  check(EPSSetFromOptions(eps.get()));
  std::vector<Mode> out;
  if (!dense) {
    if (shell)
      shell->gate.rethrow(EPSSolve(eps.get()));
    else
      check(EPSSolve(eps.get()));
    return modes_of(eps, a.get(), scale, std::min<PetscInt>(options.count, system.size() - 2), options, nullptr);
  }
  // One rank's answer for all: how many modes there are, and which of them are unstable, decides what comes next.
  core::agree(system.comm(), [&] {
    if (core::rank_of(system.comm()) != 0) return;
    std::optional<DensePencil> pencil;
    if (options.rounding) pencil.emplace(entries(a.get()), entries(b.get()));
    solve_dense(eps, a.get(), b.get());
    out = modes_of(eps, a.get(), scale, std::min<PetscInt>(options.count, system.size() - 2), options,
                   pencil ? &*pencil : nullptr);
  });
  if (core::size_of(system.comm()) == 1) return out;
  std::vector<Complex> values;
  std::vector<Complex> rounding;
  for (const Mode& m : out) {
    values.push_back(m.lambda);
    rounding.emplace_back(m.rounding);
  }
  share(system.comm(), values);
  share(system.comm(), rounding);
  out.resize(values.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].lambda = values[k];
    out[k].rounding = rounding[k].real();
    share(system.comm(), out[k].shape);
  }
  return out;
}

std::vector<LocalMode> modes_within(Mat a, Mat b, double target, double radius) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(a));
  PetscInt n = 0, begin = 0, end = 0;
  check(MatGetSize(a, &n, nullptr));
  check(MatGetOwnershipRange(a, &begin, &end));
  const auto make = [](EigenSolver& eps, MPI_Comm where, Mat left, Mat right) {
    check(EPSCreate(where, eps.put()));
    check(EPSSetOptionsPrefix(eps.get(), "parts_"));
    check(EPSSetOperators(eps.get(), left, right));
    check(EPSSetProblemType(eps.get(), EPS_GNHEP));
  };
  std::vector<LocalMode> out;
  const auto take = [&](const Pair& p, std::size_t from, std::size_t count) {
    LocalMode m{p.value, {}};
    for (std::size_t k = from; k < from + count; ++k)
      m.shape.emplace_back(p.real[k], p.value.imag() != 0 ? p.imaginary[k] : 0.0);
    out.push_back(std::move(m));
  };
  core::Matrix minus;
  if (n <= std::max(EigenOptions{}.dense_below, 3)) {
    const core::Matrix left = redundant_dense(a);
    minus = redundant_dense(b);
    check(MatScale(minus.get(), -1));
    std::vector<std::vector<Complex>> whole;
    std::vector<Complex> values;
    core::agree(comm, [&] {
      if (core::rank_of(comm) != 0) return;
      EigenSolver eps;
      make(eps, PETSC_COMM_SELF, left.get(), minus.get());
      check(EPSSetType(eps.get(), EPSLAPACK));
      solve_dense(eps, left.get(), minus.get());
      PetscInt found = 0;
      check(EPSGetConverged(eps.get(), &found));
      core::Vector re, im;
      check(MatCreateVecs(left.get(), re.put(), im.put()));
      for (PetscInt i = 0; i < found; ++i) {
        const Pair p = pair_of(eps.get(), i, re.get(), im.get(), true);
        if (std::isfinite(std::abs(p.value)) && std::abs(p.value - target) <= radius)
          take(p, 0, static_cast<std::size_t>(n));
      }
      for (const LocalMode& m : out) {
        values.push_back(m.lambda);
        whole.push_back(m.shape);
      }
    });
    share(comm, values);
    whole.resize(values.size());
    out.clear();
    for (std::size_t k = 0; k < values.size(); ++k) {
      share(comm, whole[k]);
      out.push_back({values[k], {whole[k].begin() + begin, whole[k].begin() + end}});
    }
  } else {
    check(MatDuplicate(b, MAT_COPY_VALUES, minus.put()));
    check(MatScale(minus.get(), -1));
    constexpr PetscInt most = 400;
    for (PetscInt wanted = 10;; wanted *= 2) {
      EigenSolver eps;
      make(eps, comm, a, minus.get());
      wanted = std::min({wanted, most, n - 2});
      search_near(eps.get(), a, target, wanted, nullptr);
      check(EPSSetFromOptions(eps.get()));
      check(EPSSolve(eps.get()));
      PetscInt found = 0;
      check(EPSGetConverged(eps.get(), &found));
      if (found < wanted) throw core::NotConverged("the eigenvalues of a film by itself did not converge");
      // Those that converged beside the wanted ones need not be the nearest.
      std::vector<double> distances;
      for (PetscInt i = 0; i < found; ++i) {
        const double distance = std::abs(pair_of(eps.get(), i, nullptr, nullptr, false).value - target);
        distances.push_back(std::isfinite(distance) ? distance : std::numeric_limits<double>::infinity());
      }
      std::sort(distances.begin(), distances.end());
      if (distances[static_cast<std::size_t>(wanted) - 1] <= radius && wanted < n - 2) {
        if (wanted == most) throw core::NotConverged("a film by itself has too many eigenvalues in the region");
        continue;
      }
      core::Vector re, im;
      check(MatCreateVecs(a, re.put(), im.put()));
      for (PetscInt i = 0; i < found; ++i) {
        PetscScalar x = 0, y = 0;
        check(EPSGetEigenpair(eps.get(), i, &x, &y, re.get(), im.get()));
        if (std::abs(Complex(x, y) - target) > radius) continue;
        const core::ReadArray u(re.get()), v(im.get());
        Pair p{{x, y}, {u.data(), u.data() + u.size()}, {v.data(), v.data() + v.size()}};
        take(p, 0, static_cast<std::size_t>(end - begin));
      }
      break;
    }
  }
  for (LocalMode& m : out) {
    double size = 0;
    for (const Complex& v : m.shape) size += std::norm(v);
    MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_SUM, comm);
    for (Complex& v : m.shape) v /= std::sqrt(size);
  }
  std::stable_sort(out.begin(), out.end(), [&](const LocalMode& m, const LocalMode& k) {
    return std::abs(m.lambda - target) < std::abs(k.lambda - target);
  });
  return out;
}

Eigen::VectorXcd Eigenpairs::nearest(Complex value) const {
  Eigen::Index column = 0;
  (values.array() - value).abs().minCoeff(&column);
  return vectors.col(column);
}

Eigenpairs eigenpairs(const Eigen::MatrixXd& matrix) {
  const auto solver = solve_small(matrix, true);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

std::vector<Complex> eigenvalues(const Eigen::MatrixXd& matrix) {
  const auto by_modulus = [](Complex a, Complex b) { return std::abs(a) > std::abs(b); };
  // A few states: setting up an EPS costs more than all the rest of a cycle.
  if (matrix.rows() <= 16) {
    const auto solver = solve_small(matrix, false);
    std::vector<Complex> out(solver.eigenvalues().begin(), solver.eigenvalues().end());
    std::stable_sort(out.begin(), out.end(), by_modulus);
    return out;
  }
  Eigen::MatrixXd copy = matrix;
  const auto n = static_cast<PetscInt>(matrix.rows());
  core::Matrix m;
  check(MatCreateSeqDense(PETSC_COMM_SELF, n, n, copy.data(), m.put()));
  check(MatAssemblyBegin(m.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(m.get(), MAT_FINAL_ASSEMBLY));
  EigenSolver eps;
  check(EPSCreate(PETSC_COMM_SELF, eps.put()));
  check(EPSSetOptionsPrefix(eps.get(), "floquet_"));
  check(EPSSetOperators(eps.get(), m.get(), nullptr));
  check(EPSSetProblemType(eps.get(), EPS_NHEP));
  check(EPSSetType(eps.get(), EPSLAPACK));
  check(EPSSetFromOptions(eps.get()));
  check(EPSSolve(eps.get()));
  PetscInt converged = 0;
  check(EPSGetConverged(eps.get(), &converged));
  std::vector<Complex> out;
  for (PetscInt i = 0; i < converged; ++i) out.push_back(pair_of(eps.get(), i, nullptr, nullptr, false).value);
  std::stable_sort(out.begin(), out.end(), by_modulus);
  return out;
}

std::vector<Complex> eigenvalues(MPI_Comm comm, const Eigen::MatrixXd& matrix) {
  std::vector<Complex> out;
  core::agree(comm, [&] {
    if (core::rank_of(comm) == 0) out = eigenvalues(matrix);
  });
  share(comm, out);
  return out;
}

}  // namespace whirl::spectral
