#include "study/linear/mode_loss.hpp"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/least_squares.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/core/pivoted_lu.hpp"
#include "whirl/spectral/dense.hpp"

namespace whirl::study {
namespace {

using core::check;
using Complex = std::complex<double>;
using ComplexSparse = Eigen::SparseMatrix<Complex>;

// In the scales of the system: dF/dx without loss, dF/d(dx/dt), and the rotor's K and K x [[0, 1], [-1, 0]] on its
// displacements.
struct Pencil {
  ComplexSparse at_rest, rates, stiffness, turning;
  Eigen::VectorXcd scale;  // of the states
};

Pencil pencil_of(system::RotorSystem& system, Vec x) {
  core::Vector rest = core::duplicate(x), states = core::duplicate(x), rows = core::duplicate(x);
  check(VecSet(rest.get(), 0));
  system.scales(states.get(), rows.get());
  check(VecReciprocal(rows.get()));
  core::Matrix j = system.make_jacobian();
  const auto jacobian = [&](double at_rest, double rates, const system::RotorSystem::Loss& loss) {
    const system::RotorSystem::WithLoss with(system, loss);
    system.jacobian(0, x, rest.get(), at_rest, rates, j.get());
    check(MatDiagonalScale(j.get(), rows.get(), states.get()));
    return ComplexSparse(whole_matrix(j.get()).cast<Complex>());
  };
  Pencil p;
  const std::vector<double> scale = core::gather(states.get());
  p.scale = Eigen::Map<const Eigen::VectorXd>(scale.data(), static_cast<Eigen::Index>(scale.size())).cast<Complex>();
  p.at_rest = jacobian(1, 0, {});
  p.turning = jacobian(1, 0, {0, 1}) - p.at_rest;
  // K stands on velocities there, each behind its displacement.
  const ComplexSparse on_velocities = jacobian(1, 0, {1, 0}) - p.at_rest;
  std::vector<Eigen::Triplet<Complex>> entries;
  for (Eigen::Index c = 1; c < on_velocities.cols(); ++c)
    for (ComplexSparse::InnerIterator e(on_velocities, c); e; ++e)
      if (e.value() != 0.0) entries.emplace_back(e.row(), c - 1, e.value() * p.scale(c - 1) / p.scale(c));
  p.stiffness.resize(p.at_rest.rows(), p.at_rest.cols());
  p.stiffness.setFromTriplets(entries.begin(), entries.end());
  p.rates = jacobian(0, 1, {});
  return p;
}

// dF/dx with the loss of one sense of whirl.
ComplexSparse with_loss(const Pencil& p, double eta, int sense) {
  return p.at_rest + Complex(0, eta * (1 + sense) / 2) * p.stiffness + Complex(eta * (1 - sense) / 2) * p.turning;
}

// A mode in scaled states, of length one.
struct Vibration {
  Complex lambda;
  Eigen::VectorXcd shape;
};

// Newton's method of (a + lambda b) u = 0 is inverse iteration whose shift is the last eigenvalue. Frequencies below a
// thousandth of the `fastest` are measured against that: stiff shafts leave their rounding to slow motions on soft
// springs.
void refine(const ComplexSparse& a, const ComplexSparse& b, double fastest, Vibration& v) {
  core::PivotedLu<Complex> lu;
  constexpr int most = 30;
  double change = 1, before = 2;
  for (int k = 0; k < most; ++k) {
    const ComplexSparse t = a + v.lambda * b;
    if (k == 0) lu.analyse(t);
    if (!lu.factorise(t)) return;  // the eigenvalue to the last digit
    const Eigen::VectorXcd w = lu.solve(b * v.shape);
    const Complex move = 1.0 / v.shape.dot(w);  // u* u = 1
    v.lambda -= move;
    v.shape = w.normalized();
    before = std::exchange(change, std::abs(move) / std::max(std::abs(v.lambda), 1e-3 * fastest));
    if (change < 1e-12 || (change < 1e-7 && change >= before)) return;  // rounding moves it from here on
  }
  throw core::NotConverged("a mode with loss did not converge");
}

// Modes that are one frequency without loss may be mixed in any way: planar motion is forward and backward whirl, which
// a loss parts. One step of inverse iteration beside them, in their own span, finds what becomes modes.
void part(const ComplexSparse& a, const ComplexSparse& b, double eta, std::span<Vibration> together) {
  const auto n = static_cast<Eigen::Index>(together.size());
  Eigen::MatrixXcd u(together[0].shape.size(), n);
  for (Eigen::Index k = 0; k < n; ++k) u.col(k) = together[static_cast<std::size_t>(k)].shape;
  const Complex beside = together[0].lambda + eta * std::abs(together[0].lambda) * Complex(0.31, 0.17);
  const core::PivotedLu<Complex> lu(a + beside * b);
  if (!lu.regular()) throw core::NotConverged("modes with loss: the matrix beside them is singular");
  const Eigen::MatrixXcd w = lu.solve(b * u);
  const spectral::Eigenpairs small = spectral::complex_eigenpairs(core::least_squares(u, w));
  for (Eigen::Index k = 0; k < n; ++k) {
    Vibration& v = together[static_cast<std::size_t>(k)];
    v.lambda = beside - 1.0 / small.values(k);
    v.shape = (u * small.vectors.col(k)).normalized();
  }
}

// Of modes without loss, by rising frequency.
void add_loss(const Pencil& p, const system::RotorSystem& system, double eta, std::vector<Vibration>& modes) {
  const int steps = static_cast<int>(std::ceil(eta / 0.05));
  for (std::size_t first = 0, end = 0; first < modes.size(); first = end) {
    const int sense = system.loss_sense(modes[first].lambda.imag());
    for (end = first + 1; end < modes.size(); ++end)
      if (std::abs(modes[end].lambda - modes[end - 1].lambda) > eta * std::abs(modes[end].lambda) ||
          system.loss_sense(modes[end].lambda.imag()) != sense)
        break;
    const std::span<Vibration> together(modes.data() + first, end - first);
    for (int step = 1; step <= steps; ++step) {
      const ComplexSparse a = with_loss(p, eta * step / steps, sense);
      if (step == 1 && together.size() > 1) part(a, p.rates, eta / steps, together);
      for (Vibration& v : together) refine(a, p.rates, std::abs(modes.back().lambda), v);
    }
  }
}

}  // namespace

Eigen::SparseMatrix<double> whole_matrix(Mat shared) {
  PetscInt n = 0;
  check(MatGetSize(shared, &n, nullptr));
  std::vector<double> mine;
  const PetscInt first = core::first_row(shared);
  core::for_rows(shared, [&](PetscInt row, const PetscInt* columns, const PetscScalar* values, PetscInt count) {
    for (PetscInt k = 0; k < count; ++k)
      mine.insert(mine.end(), {static_cast<double>(first + row), static_cast<double>(columns[k]), values[k]});
  });
  return core::gather_entries(PetscObjectComm(reinterpret_cast<PetscObject>(shared)), n, mine);
}

std::vector<spectral::Mode> with_loss(system::RotorSystem& system, Vec x, std::vector<spectral::Mode> modes) {
  constexpr PetscInt most_states = 20000;
  if (system.size() > most_states)
    core::agree(system.comm(), [] {
      throw core::InputError("modes with a loss factor take machines up to 20,000 states: films with fewer cells");
    });
  const Pencil pencil = pencil_of(system, x);
  const double eta = system.train().rotor.loss_factor;
  std::vector<Vibration> moving;
  for (const spectral::Mode& m : modes) {
    const auto n = static_cast<Eigen::Index>(m.shape.size());
    moving.push_back({m.lambda, Eigen::Map<const Eigen::VectorXcd>(m.shape.data(), n).cwiseQuotient(pencil.scale)});
    moving.back().shape.normalize();
  }
  core::agree(system.comm(), [&] { add_loss(pencil, system, eta, moving); });
  for (std::size_t k = 0; k < moving.size(); ++k) {
    spectral::Mode& m = modes[k];
    m.lambda = moving[k].lambda;
    m.rounding = 1e-9 * std::abs(m.lambda);  // Newton's method has solved it
    m.blur = 10 * m.rounding;
    // Condition and multiplicity belong to the machine without loss.
    m.condition = std::numeric_limits<double>::quiet_NaN();
    m.multiplicity = m.vectors = 1;
    m.left.clear();
    Eigen::Index largest = 0;
    moving[k].shape.cwiseAbs().maxCoeff(&largest);
    const Eigen::VectorXcd shape = (moving[k].shape / moving[k].shape(largest)).cwiseProduct(pencil.scale);
    m.shape.assign(shape.begin(), shape.end());
  }
  std::stable_sort(modes.begin(), modes.end(),
                   [](const spectral::Mode& a, const spectral::Mode& b) { return a.lambda.imag() < b.lambda.imag(); });
  return modes;
}

}  // namespace whirl::study
