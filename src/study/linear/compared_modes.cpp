#include "study/linear/compared_modes.hpp"

#include <fmt/core.h>

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/core/pivoted_lu.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Sparse = Eigen::SparseMatrix<double>;

// A = dF/dx with the films as `films` says.
Sparse linearised(problem::BlockStructure& machine, const MatrixXd& films) {
  return machine.l0() - Sparse(machine.b() * Sparse(films.sparseView()) * machine.c());
}

// Overdamped ones would stand among the lowest.
bool compared(Complex s) {
  return s.imag() > 0 && spectral::vibrates(s) && spectral::damping_ratio(s) <= spectral::overdamped_above;
}

}  // namespace

MatrixXd whole_states(const system::RotorSystem& reduced) {
  const rotor::Rotor& rotor = reduced.rotor();
  const Index kept = 2 * rotor.size(), others = 2 * reduced.coordinates() - kept;
  MatrixXd q, v;
  if (const auto& states = rotor.states()) {
    q = core::dense(states->displacement.get());
    v = core::dense(states->velocity.get());
  } else if (!rotor.matrices().basis) {
    return MatrixXd::Identity(2 * reduced.coordinates(), 2 * reduced.coordinates());
  } else {
    const MatrixXd t = core::dense(rotor.matrices().basis.get());
    q = v = MatrixXd::Zero(t.rows(), kept);
    for (Index j = 0; j < t.cols(); ++j) {
      q.col(2 * j) = t.col(j);
      v.col(2 * j + 1) = t.col(j);
    }
  }
  MatrixXd out = MatrixXd::Zero(2 * q.rows() + others, kept + others);
  for (Index i = 0; i < q.rows(); ++i) {
    out.row(2 * i).head(kept) = q.row(i);
    out.row(2 * i + 1).head(kept) = v.row(i);
  }
  out.bottomRightCorner(others, others).setIdentity();
  return out;
}

Orbit orbit_from_rest(system::RotorSystem& system, const MatrixXd& films, int node, double step, Index count) {
  problem::BlockStructure& machine = *system.structure();
  const MatrixXd a = linearised(machine, films), rates = machine.l1();
  const Index n = machine.size();
  const double omega = system.speed();
  VectorXcd force(n);
  for (Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    force(i) = omega * omega * Complex(system.forcing_cosine()[row], -system.forcing_sine()[row]);
  }
  const VectorXcd forced = core::DenseLu<Complex>(a.cast<Complex>() + Complex(0, omega) * rates).solve(force);
  // theta = 1/s, and the free motion that makes the state at the beginning zero. A mode of infinite s ends at once.
  const spectral::Eigenpairs pairs = spectral::eigenpairs(-core::DenseLu<double>(a).solve(rates));
  const VectorXcd start = core::DenseLu<Complex>(pairs.vectors).solve(-forced.real().cast<Complex>());
  const MatrixXd shown = whole_states(system);
  const Index first = 2 * rotor::full_coordinate(node, rotor::Freedom::x);
  const double largest = pairs.values.cwiseAbs().maxCoeff();
  Orbit out(2, count);
  for (Index d = 0; d < 2; ++d) {
    const Eigen::RowVectorXcd place = shown.row(first + 2 * d).cast<Complex>();
    const Complex along = place * forced;
    const VectorXcd weight = (place * pairs.vectors).transpose().cwiseProduct(start);
    for (Index k = 0; k < count; ++k) {
      const double t = step * static_cast<double>(k);
      double value = (along * std::polar(1.0, omega * t)).real();
      for (Index m = 0; m < weight.size(); ++m)
        if (std::abs(pairs.values(m)) > 1e-15 * largest) value += (weight(m) * std::exp(t / pairs.values(m))).real();
      out(d, k) = value;
    }
  }
  return out;
}

WholeModes::WholeModes(system::RotorSystem& system, Vec x, int count) {
  problem::BlockStructure& machine = *system.structure();
  const Index n = machine.size();
  const std::vector<double> state = system.gather(x);
  problem::Films films;
  machine.films(machine.c() * Eigen::Map<const Eigen::VectorXd>(state.data(), n), nullptr, nullptr, true, films);
  films_ = films.d_inputs;
  rates_ = machine.l1();
  const Sparse a = linearised(machine, films_);

  std::vector<Eigen::Triplet<double>> entries;
  const auto of = [&](const Sparse& m, Index column_parity, double factor) {
    for (Index j = column_parity; j < n; j += 2)
      for (Sparse::InnerIterator it(m, j); it; ++it)
        if (it.row() % 2 == 0) {
          const auto r = static_cast<int>(it.row() + column_parity), c = static_cast<int>(j);
          entries.emplace_back(r, c, factor * it.value());
          entries.emplace_back(c, r, factor * it.value());
        }
  };
  of(a, 0, 0.5);
  of(rates_, 1, 0.5);
  energy_.resize(n, n);
  energy_.setFromTriplets(entries.begin(), entries.end());
  if (Eigen::SimplicialLLT<Sparse>(energy_).info() != Eigen::Success)
    throw core::NotConverged("the stiffness of the machine is not positive definite: its modes have no energy norm");

  std::vector<spectral::Mode> modes = spectral::modes(system, x, {.count = 2 * count + 40});
  std::erase_if(modes, [](const spectral::Mode& m) { return !compared(m.lambda); });
  if (static_cast<int>(modes.size()) < count)
    throw core::NotConverged(fmt::format("the machine has {} modes that vibrate, not {}", modes.size(), count));
  frequencies_.resize(count);
  right_.resize(n, count);
  left_.resize(n, count);
  const Eigen::SparseMatrix<Complex> rates = rates_.cast<Complex>(), held = a.cast<Complex>();
  for (int k = 0; k < count; ++k) {
    const spectral::Mode& mode = modes[static_cast<std::size_t>(k)];
    // Beside the eigenvalue, where the matrix is regular.
    const Complex shift = mode.lambda * (1 + 1e-9);
    Eigen::SparseMatrix<Complex> shifted = held + shift * rates;
    shifted.makeCompressed();
    const core::PivotedLu<Complex> lu(shifted);
    if (!lu.regular()) throw core::NotConverged("an eigenvector of the whole shaft could not be computed");
    VectorXcd v = Eigen::Map<const VectorXcd>(mode.shape.data(), n), w = (rates * v).conjugate();
    for (int turn = 0; turn < 3; ++turn) {
      v = lu.solve(rates * v);
      w = lu.solve_transposed(rates.transpose() * w);
      v /= v.norm();
      w /= w.norm();
    }
    v /= std::sqrt(std::abs(energy(v, v)));
    const Complex product = w.transpose() * (rates * v);
    w /= product;
    const Complex s = -Complex(w.transpose() * (held * v));
    frequencies_(k) = s.imag();
    right_.col(k) = v;
    left_.col(k) = w;
  }
}

Complex WholeModes::energy(const VectorXcd& a, const VectorXcd& b) const {
  return a.dot((energy_.cast<Complex>() * b).eval());
}

// Eigenvalues of -A^-1 L1 are 1/s: the slowest ones are the largest, and keep their digits.
WholeModes::Errors WholeModes::errors(system::RotorSystem& reduced) const {
  problem::BlockStructure& machine = *reduced.structure();
  const MatrixXd a = linearised(machine, films_), rates = machine.l1();
  const spectral::Eigenpairs pairs = spectral::eigenpairs(-core::DenseLu<double>(a).solve(rates));
  std::vector<std::pair<double, Index>> order;
  for (Index k = 0; k < pairs.values.size(); ++k) {
    const Complex s = 1.0 / pairs.values(k);
    if (compared(s)) order.emplace_back(s.imag(), k);
  }
  std::sort(order.begin(), order.end());
  const Index count = frequencies_.size();
  if (static_cast<Index>(order.size()) < count)
    throw core::NotConverged(fmt::format("the reduced machine has {} modes that vibrate, not {}", order.size(), count));
  const MatrixXd to_whole = whole_states(reduced);
  const Eigen::SparseMatrix<Complex> whole_rates = rates_.cast<Complex>();
  Errors out{Eigen::VectorXd(count), Eigen::VectorXd(count), Eigen::MatrixXcd::Identity(count, count)};
  for (Index k = 0; k < count; ++k) {
    const auto [frequency, at] = order[static_cast<std::size_t>(k)];
    out.frequency(k) = std::abs(frequency / frequencies_(k) - 1);
    VectorXcd v = to_whole.cast<Complex>() * pairs.vectors.col(at);
    v /= std::sqrt(std::abs(energy(v, v)));
    const Complex along = energy(right_.col(k), v);
    const VectorXcd beside = v - along * right_.col(k);
    out.vector(k) = std::sqrt(std::abs(energy(beside, beside)));
    const Complex product = left_.col(k).transpose() * (whole_rates * v);
    if (product != 0.0) v *= std::conj(product) / std::abs(product);
    out.r.col(k) -= left_.transpose() * (whole_rates * v);
  }
  return out;
}

}  // namespace whirl::study
