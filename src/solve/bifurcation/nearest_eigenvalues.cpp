#include "whirl/solve/bifurcation/nearest_eigenvalues.hpp"

#include "solve/cycle/pencil.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using Eigen::ArrayXcd;
using Eigen::Index;
using Eigen::MatrixXd;

// With y = (A + sigma L1)^-1 L1 x and A v = -lambda L1 v, the part along v grows by 1/(sigma - lambda).
ArrayXcd nearest_eigenvalues(problem::System& system, const MatrixXd& tangents, const ArrayXcd& starts) {
  core::require(system.structure() != nullptr, "a machine of blocks");
  problem::BlockStructure& structure = *system.structure();
  core::require(structure.own().empty(), "the films have no own states");
  const Index n = structure.size(), lanes = starts.size();
  Pencil::Matrix held =
      structure.l0() - Pencil::Matrix(structure.b() * Pencil::Matrix(tangents.sparseView()) * structure.c());
  held.makeCompressed();
  // Beside the start, where the matrix is regular even if the start is an eigenvalue.
  const ArrayXcd shift = starts * (1 + 1e-9);
  Pencil pencil;
  pencil.compute(structure.l1(), held, system.kinematic(), shift);
  const Pencil::Matrix rates = structure.l1().transpose();
  MatrixXd x(2 * lanes, n), y;
  for (Index s = 0; s < n; ++s) x.col(s).setConstant(1 + 0.5 * std::sin(0.7 * static_cast<double>(s)));
  ArrayXcd values = starts;
  constexpr int most = 60;
  for (int turn = 0; turn < most; ++turn) {
    y = x * rates;
    pencil.solve(y);
    bool done = true;
    for (Index k = 0; k < lanes; ++k) {
      std::complex<double> product = 0;
      double size = 0, old = 0;
      for (Index s = 0; s < n; ++s) {
        const std::complex<double> before(x(k, s), x(lanes + k, s)), now(y(k, s), y(lanes + k, s));
        product += std::conj(before) * now;
        old += std::norm(before);
        size += std::norm(now);
      }
      const std::complex<double> value = shift(k) - old / product;
      done = done && std::abs(value - values(k)) <= 1e-9 * std::abs(value);
      values(k) = value;
      y.row(k) /= std::sqrt(size);
      y.row(lanes + k) /= std::sqrt(size);
    }
    if (done && turn > 1) return values;
    x.swap(y);
  }
  throw core::NotConverged("inverse iteration for an eigenvalue does not settle");
}

}  // namespace whirl::solve
