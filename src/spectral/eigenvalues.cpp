#include "whirl/spectral/eigenvalues.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "spectral/left_vectors.hpp"
#include "spectral/pencil_search.hpp"
#include "spectral/rounding.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/from_options.hpp"
#include "whirl/spectral/dense.hpp"

namespace whirl::spectral {
namespace {

using core::check;

// Of a search: what it leaves in equal eigenvalues, relative. Measured on shafts of 101 to 201 nodes between isotropic
// springs of 1e3 to 1e12 N/m, with and without damping: at most 7e-10.
constexpr double most_parted = 1e-8;

Eigen::MatrixXd entries(Mat dense) {
  PetscInt n = 0;
  check(MatGetSize(dense, &n, nullptr));
  const PetscScalar* a = nullptr;
  check(MatDenseGetArrayRead(dense, &a));
  Eigen::MatrixXd out = Eigen::Map<const Eigen::MatrixXd>(a, n, n);
  check(MatDenseRestoreArrayRead(dense, &a));
  return out;
}

// Size beyond which an eigenvalue of a u = lambda b u is infinite: b is singular where a row holds at every moment, and
// LAPACK takes a diagonal entry of its triangle below eps |b| as zero, for which SLEPc answers the largest double.
double infinite_from(Mat a, Mat b) {
  double left = 0, right = 0;
  check(MatNorm(a, NORM_FROBENIUS, &left));
  check(MatNorm(b, NORM_FROBENIUS, &right));
  return left / (std::numeric_limits<double>::epsilon() * right);
}

// Rows of b that are zero.
PetscInt zero_rows(const Eigen::MatrixXd& b) {
  return static_cast<PetscInt>((b.cwiseAbs().rowwise().maxCoeff().array() == 0).count());
}

// The size that infinite eigenvalues have at least: there are as many as b has zero rows, and rounding makes some of
// them finite, smaller than infinite_from() where rows differ in size.
double least_infinite(const EigenSolver& eps, PetscInt count, double infinite) {
  PetscInt converged = 0;
  check(EPSGetConverged(eps.get(), &converged));
  std::vector<double> size;
  for (PetscInt i = 0; i < converged; ++i)
    size.push_back(std::abs(pair_of(eps.get(), i, nullptr, nullptr, false).value));
  if (count == 0 || count > converged) return infinite;
  std::nth_element(size.begin(), size.begin() + (count - 1), size.end(), std::greater<>());
  return std::min(infinite, size[static_cast<std::size_t>(count - 1)]);
}

// Left rows y* of the scaled pencil, y* B x = 1, as the vector that belongs to a shape of SI which is x over `largest`.
std::vector<Complex> in_si(const std::vector<Complex>& row, const std::vector<double>& row_scale, Complex largest) {
  std::vector<Complex> out(row.size());
  for (std::size_t k = 0; k < row.size(); ++k) out[k] = std::conj(row[k] * largest) / row_scale[k];
  return out;
}

// Whether rounding may decide the sign of a real part, or part equal eigenvalues, so that its size must be estimated.
bool doubtful(const EigenSolver& eps, double infinite) {
  PetscInt converged = 0;
  check(EPSGetConverged(eps.get(), &converged));
  double largest = 0, least = std::numeric_limits<double>::infinity();
  std::vector<Complex> values;
  for (PetscInt i = 0; i < converged; ++i) {
    const Complex value = pair_of(eps.get(), i, nullptr, nullptr, false).value;
    if (!(std::abs(value) < infinite)) continue;
    largest = std::max(largest, std::abs(value));
    least = std::min(least, std::abs(value.real()));
    values.push_back(value);
  }
  if (least <= DensePencil::asked_below * largest) return true;
  const std::vector<bool> near = DensePencil::near_another(values);
  return std::ranges::find(near, true) != near.end();
}

// What a solver has found, at least `wanted` of them, below `infinite`; `scales` make the vectors SI. `iterated`: what
// a search leaves counts as rounding.
std::vector<Mode> modes_of(const EigenSolver& eps, Mat a, const ScaledPencil& scales, PetscInt wanted,
                           const EigenOptions& options, DensePencil* pencil, LeftVectors* search, double infinite,
                           bool iterated) {
  const std::vector<double>& scale = scales.states;
  const bool vectors = options.shapes || options.left;
  PetscInt converged = 0;
  check(EPSGetConverged(eps.get(), &converged));
  if (converged == 0 || (converged < wanted && !iterated))
    throw core::NotConverged(fmt::format("only {} of {} eigenvalues converged", converged, options.count));
  core::Vector re, im;
  check(MatCreateVecs(a, re.put(), im.put()));
  std::vector<Mode> out;
  std::vector<PetscInt> place;
  std::vector<Complex> sizes;
  for (PetscInt i = 0; i < converged; ++i) {
    const Pair p = pair_of(eps.get(), i, re.get(), im.get(), vectors || pencil);
    const bool finite = std::abs(p.value) < infinite;
    if (pencil) pencil->add(finite ? p.value : std::numeric_limits<double>::infinity(), p.real, p.imaginary);
    if (p.value.imag() < 0 || !finite) continue;
    Mode m;
    m.lambda = p.value;
    if (options.rounding && iterated) {
      m.rounding = search_tolerance * std::abs(p.value);
      m.blur = most_parted * std::abs(p.value);
    }
    sizes.emplace_back(1);
    if (vectors) {
      m.shape.resize(p.real.size());
      Complex largest = 0;
      for (std::size_t k = 0; k < p.real.size(); ++k) {
        const Complex value(p.real[k], p.value.imag() != 0 ? p.imaginary[k] : 0.0);
        if (std::abs(value) > std::abs(largest)) largest = value;
        m.shape[k] = value * scale[k];
      }
      for (Complex& v : m.shape) v /= largest;
      sizes.back() = largest;
    }
    place.push_back(i);
    out.push_back(std::move(m));
  }
  if (pencil) {
    const DensePencil::Doubt doubt = options.rounding ? pencil->doubt() : DensePencil::Doubt{};
    for (std::size_t k = 0; k < out.size() && options.rounding; ++k) {
      out[k].rounding = doubt.rounding[static_cast<std::size_t>(place[k])];
      out[k].blur = doubt.blur[static_cast<std::size_t>(place[k])];
    }
  }
  if (pencil && options.left) {
    const DensePencil::Conditioning of = pencil->conditioning();
    for (std::size_t k = 0; k < out.size(); ++k) {
      const auto i = static_cast<std::size_t>(place[k]);
      out[k].condition = of.condition[i];
      out[k].multiplicity = of.multiplicity[i];
      out[k].vectors = of.vectors[i];
      if (of.left.size() == 0) continue;
      const Eigen::RowVectorXcd row = of.left.row(place[k]);
      out[k].left = in_si({row.begin(), row.end()}, scales.rows, sizes[k]);
    }
  }
  if (search)
    for (std::size_t k = 0; k < out.size(); ++k) {
      const LeftVectors::Vector of = search->of(eps.get(), place[k]);
      out[k].condition = of.condition;
      if (!of.row.empty()) out[k].left = in_si(of.row, scales.rows, sizes[k]);
    }
  std::sort(out.begin(), out.end(), [](const Mode& m, const Mode& n) {
    return std::pair(m.lambda.imag(), m.lambda.real()) < std::pair(n.lambda.imag(), n.lambda.real());
  });
  return out;
}

Eigenpairs solve_small(const Eigen::MatrixXd& matrix, bool vectors) {
  if (!matrix.allFinite()) throw core::NotConverged("eigenvalues of a matrix that is not finite");
  Eigenpairs out = real_eigenpairs(matrix, vectors);
  if (!out.values.allFinite()) throw core::NotConverged("the eigenvalues did not converge");
  return out;
}

}  // namespace

std::vector<Mode> modes(problem::System& system, Vec x, const EigenOptions& options) {
  ScaledPencil scale = scaled_pencil(system, x);
  core::Matrix a = std::move(scale.a), b = std::move(scale.b);
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
    if (options.inverse) shell.emplace(InverseShell{*options.inverse, core::Gate(comm)});
    search_near(eps.get(), a.get(), options.target, std::min<PetscInt>(options.count, system.size() - 2),
                shell ? &*shell : nullptr);
  }
  core::set_from_options(eps.get());
  std::vector<Mode> out;
  if (!dense) {
    // A shift on an eigenvalue makes a singular matrix, and LAPACK may refuse to sort the projected one.
    try {
      if (shell)
        shell->gate.rethrow(EPSSolve(eps.get()));
      else
        check(EPSSolve(eps.get()));
    } catch (const core::LibraryError& error) {
      throw core::NotConverged(fmt::format("the search for eigenvalues failed: {}", error.what()));
    }
    std::optional<LeftVectors> left;
    if (options.left && !shell) left.emplace(a.get(), b.get(), options);
    return modes_of(eps, a.get(), scale, std::min<PetscInt>(options.count, system.size() - 2), options, nullptr,
                    left ? &*left : nullptr, std::numeric_limits<double>::infinity(), true);
  }
  // One rank's answer for all: how many modes there are, and which of them are unstable, decides what comes next.
  core::agree(system.comm(), [&] {
    if (core::rank_of(system.comm()) != 0) return;
    std::optional<DensePencil> pencil;
    if (options.rounding || options.left) pencil.emplace(entries(a.get()), entries(b.get()));
    const double infinite = infinite_from(a.get(), b.get());
    const PetscInt at_least = zero_rows(entries(b.get()));
    solve_dense(eps, a.get(), b.get());
    const double finite_below = least_infinite(eps, at_least, infinite);
    if (!options.left && pencil && !doubtful(eps, finite_below)) pencil.reset();
    out = modes_of(eps, a.get(), scale, std::min<PetscInt>(options.count, system.size() - 2), options,
                   pencil ? &*pencil : nullptr, nullptr, finite_below, false);
  });
  if (core::size_of(system.comm()) == 1) return out;
  std::vector<Complex> values;
  std::vector<Complex> rounding, multiple, blur;
  for (const Mode& m : out) {
    values.push_back(m.lambda);
    rounding.emplace_back(m.rounding, m.condition);
    multiple.emplace_back(m.multiplicity, m.vectors);
    blur.emplace_back(m.blur);
  }
  share(system.comm(), values);
  share(system.comm(), rounding);
  share(system.comm(), multiple);
  share(system.comm(), blur);
  out.resize(values.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].lambda = values[k];
    out[k].rounding = rounding[k].real();
    out[k].condition = rounding[k].imag();
    out[k].blur = blur[k].real();
    out[k].multiplicity = static_cast<int>(multiple[k].real());
    out[k].vectors = static_cast<int>(multiple[k].imag());
    share(system.comm(), out[k].shape);
    if (options.left) share(system.comm(), out[k].left);
  }
  return out;
}

Eigen::VectorXcd Eigenpairs::nearest(Complex value) const {
  Eigen::Index column = 0;
  (values.array() - value).abs().minCoeff(&column);
  return vectors.col(column);
}

Eigenpairs eigenpairs(const Eigen::MatrixXd& matrix) {
  return solve_small(matrix, true);
}

std::vector<Complex> eigenvalues(const Eigen::MatrixXd& matrix) {
  const auto by_modulus = [](Complex a, Complex b) { return std::abs(a) > std::abs(b); };
  // A few states: setting up an EPS costs more than all the rest of a cycle.
  if (matrix.rows() <= 16) {
    const Eigen::VectorXcd values = solve_small(matrix, false).values;
    std::vector<Complex> out(values.begin(), values.end());
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
  core::set_from_options(eps.get());
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
