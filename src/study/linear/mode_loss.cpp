#include "study/linear/mode_loss.hpp"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

using core::check;
using Complex = std::complex<double>;
using Sparse = Eigen::SparseMatrix<Complex>;

Sparse whole(Mat distributed) {
  core::Matrix all;
  check(MatCreateRedundantMatrix(distributed,
                                 core::size_of(PetscObjectComm(reinterpret_cast<PetscObject>(distributed))),
                                 PETSC_COMM_SELF, MAT_INITIAL_MATRIX, all.put()));
  PetscInt n = 0;
  check(MatGetSize(all.get(), &n, nullptr));
  std::vector<Eigen::Triplet<Complex>> entries;
  for (PetscInt r = 0; r < n; ++r) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(all.get(), r, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k) entries.emplace_back(r, columns[k], values[k]);
    check(MatRestoreRow(all.get(), r, &count, &columns, &values));
  }
  Sparse out(n, n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// In the scales of the system: dF/dx without loss, dF/d(dx/dt), and what unit losses add to dF/dx.
struct Pencil {
  Sparse at_rest, rates, damping, turning;
  Eigen::VectorXd scale;  // of the states
};

Pencil pencil_of(system::RotorSystem& system, Vec x) {
  core::Vector rest = core::duplicate(x), states = core::duplicate(x), rows = core::duplicate(x);
  check(VecSet(rest.get(), 0));
  system.scales(states.get(), rows.get());
  check(VecReciprocal(rows.get()));
  core::Matrix j = system.make_jacobian();
  const auto jacobian = [&](double at_rest, double rates, const system::RotorSystem::Loss& loss) {
    system.set_loss(loss);
    system.jacobian(0, x, rest.get(), at_rest, rates, j.get());
    check(MatDiagonalScale(j.get(), rows.get(), states.get()));
    return whole(j.get());
  };
  Pencil p;
  p.at_rest = jacobian(1, 0, {});
  p.damping = jacobian(1, 0, {1, 0}) - p.at_rest;
  p.turning = jacobian(1, 0, {0, 1}) - p.at_rest;
  p.rates = jacobian(0, 1, {});
  const std::vector<double> scale = core::gather(states.get());
  p.scale = Eigen::Map<const Eigen::VectorXd>(scale.data(), static_cast<Eigen::Index>(scale.size()));
  return p;
}

// On velocities v = lambda q stand i eta (1 + s)/(2 lambda) K, so that K q has the factor i eta (1 + s)/2 exactly.
void correct(const Pencil& p, double eta, int sense, spectral::Mode& mode) {
  const auto n = static_cast<Eigen::Index>(mode.shape.size());
  Eigen::VectorXcd u = Eigen::Map<const Eigen::VectorXcd>(mode.shape.data(), n).cwiseQuotient(p.scale.cast<Complex>());
  u.normalize();
  Complex lambda = mode.lambda;
  Eigen::SparseLU<Sparse> lu;
  constexpr int most = 30;
  const int steps = static_cast<int>(std::ceil(eta / 0.05));
  for (int step = 1; step <= steps; ++step) {
    const double here = eta * step / steps;
    double change = 0;
    int k = 0;
    for (; k < most; ++k) {
      const Complex c = Complex(0, here * (1 + sense) / 2) / lambda;
      const Sparse t = p.at_rest + lambda * p.rates + c * p.damping + Complex(here * (1 - sense) / 2) * p.turning;
      const Sparse slope = p.rates - (c / lambda) * p.damping;
      if (k == 0 && step == 1) lu.analyzePattern(t);
      lu.factorize(t);
      if (lu.info() != Eigen::Success) {
        if (k > 0) break;  // the eigenvalue to the last digit
        throw core::NotConverged("a mode with loss: the first matrix is singular");
      }
      const Eigen::VectorXcd w = lu.solve(slope * u);
      const Complex move = 1.0 / u.dot(w);  // u* u = 1
      lambda -= move;
      u = w.normalized();
      change = std::abs(move) / std::abs(lambda);
      if (change < 1e-12) break;
    }
    if (k == most && !(change < 1e-9)) throw core::NotConverged("a mode with loss did not converge");
  }
  mode.lambda = lambda;
  mode.rounding = std::max(mode.rounding, 1e-12 * std::abs(lambda));
  u = u.cwiseProduct(p.scale.cast<Complex>());
  Eigen::Index largest = 0;
  u.cwiseQuotient(p.scale.cast<Complex>()).cwiseAbs().maxCoeff(&largest);
  u /= u(largest) / p.scale(largest);
  mode.shape.assign(u.begin(), u.end());
}

}  // namespace

std::vector<spectral::Mode> with_loss(system::RotorSystem& system, Vec x, const std::vector<spectral::Mode>& modes,
                                      int most) {
  constexpr PetscInt largest = 20000;
  if (system.size() > largest)
    core::agree(system.comm(), [] {
      throw core::InputError("modes with a loss factor take machines up to 20,000 states: films with fewer cells");
    });
  const Pencil pencil = pencil_of(system, x);
  const double eta = system.train().rotor.loss_factor;
  std::vector<spectral::Mode> out;
  int vibrating = 0;
  core::agree(system.comm(), [&] {
    for (const spectral::Mode& m : modes) {
      const bool vibrates = m.lambda.imag() > 1e-7 * std::abs(m.lambda);
      if (vibrates && ++vibrating > most) return;
      out.push_back(m);
      if (vibrates) correct(pencil, eta, system.loss_sense(m.lambda.imag()), out.back());
    }
  });
  std::stable_sort(out.begin(), out.end(),
                   [](const spectral::Mode& a, const spectral::Mode& b) { return a.lambda.imag() < b.lambda.imag(); });
  return out;
}

}  // namespace whirl::study
