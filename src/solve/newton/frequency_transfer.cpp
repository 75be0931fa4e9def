// Films with states as transfer functions between the motions of the hub and the forces on it.

#include <algorithm>
#include <cmath>

#include "solve/newton/frequency_hub.hpp"
#include "solve/newton/frequency_part.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::VectorXcd;

FrequencyResolvent::Sparse FrequencyResolvent::matrix(Complex lambda, const Transfers& parts, bool slope) const {
  std::vector<Eigen::Triplet<Complex>> entries;
  const auto add = [&](const Eigen::SparseMatrix<double>& m, Complex factor) {
    for (int c = 0; c < m.outerSize(); ++c)
      for (Eigen::SparseMatrix<double>::InnerIterator e(m, c); e; ++e)
        entries.emplace_back(static_cast<int>(e.row()), c, factor * e.value());
  };
  // Both in either case, so that the pattern is always the same.
  add(hub_->a, slope ? 0.0 : 1.0);
  add(hub_->b, slope ? 1.0 : lambda);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const MatrixXcd& h = slope ? parts[i].slope : parts[i].value;
    for (Index c = 0; c < h.cols(); ++c)
      for (Index r = 0; r < h.rows(); ++r)
        entries.emplace_back(static_cast<int>(ports_[i].forces[static_cast<std::size_t>(r)]),
                             static_cast<int>(ports_[i].seen[static_cast<std::size_t>(c)]), -h(r, c));
  }
  Sparse out(hub(), hub());
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

double FrequencyResolvent::magnitude(Complex lambda, const Transfers& parts) const {
  double h = 0;
  for (const Block& b : parts) h += b.value.squaredNorm();
  return hub_->a.norm() + std::abs(lambda) * hub_->b.norm() + std::sqrt(h);
}

// The part adds -H to the hub's derivatives.
MatrixXcd FrequencyResolvent::from_motion(std::size_t i, const Block& part, Complex lambda,
                                          const std::vector<PetscInt>& positions, const std::vector<PetscInt>& rates,
                                          const std::vector<PetscInt>& forces) const {
  const auto at = [](const std::vector<PetscInt>& all, PetscInt one) {
    const auto place = std::lower_bound(all.begin(), all.end(), one);
    return place != all.end() && *place == one ? place - all.begin() : -1;
  };
  MatrixXcd out = MatrixXcd::Zero(static_cast<Index>(forces.size()), static_cast<Index>(positions.size()));
  for (std::size_t r = 0; r < forces.size(); ++r)
    for (std::size_t c = 0; c < positions.size(); ++c)
      for (const bool rate : {false, true}) {
        const PetscInt state = rate ? rates[c] : positions[c];
        const Index row = at(ports_[i].forces, forces[r]), column = at(ports_[i].seen, state);
        if (row < 0 || column < 0) continue;
        const double si =
            hub_row_scale_[static_cast<std::size_t>(forces[r])] / hub_scale_[static_cast<std::size_t>(state)];
        out(static_cast<Index>(r), static_cast<Index>(c)) -=
            part.value(row, column) * si * (rate ? lambda : Complex(1));
      }
  return out;
}

std::vector<Complex> FrequencyResolvent::state(const VectorXcd& z, Complex ahead) const {
  const PortLayout& layout = *at_rest_->layout();
  VectorXcd mine(layout.local()), own(layout.parts());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Coupled& p = *parts_[i];
    const VectorXcd seen = z(ports_[i].seen);
    own.segment(p.row, p.count) = -p.x * seen;
    if (p.dx.size() > 0) own.segment(p.row, p.count) -= ahead * (p.dx * seen);
  }
  layout.give(own.data(), z.data() + layout.first_of_hub(), mine.data());
  const VectorXcd all = whole(mine);
  return {all.begin(), all.end()};
}

std::vector<Complex> FrequencyResolvent::state(std::size_t i, const std::vector<Complex>& shape) const {
  VectorXcd mine = VectorXcd::Zero(system_.local_size());
  std::copy(shape.begin(), shape.end(), mine.begin() + parts_[i]->first);
  const VectorXcd all = whole(mine);
  return {all.begin(), all.end()};
}

std::vector<FrequencyResolvent::Pole> FrequencyResolvent::poles(std::size_t i, double target, double radius) const {
  assemble();
  const Coupled& p = *parts_[i];
  std::vector<Pole> out;
  for (const spectral::LocalMode& m : spectral::modes_within(p.a.get(), p.b.get(), target, radius)) {
    const Eigen::Map<const VectorXcd> v(m.shape.data(), static_cast<Index>(m.shape.size()));
    const MatrixXcd f = p.f(*at_rest_) + m.lambda * p.f(*rates_);
    VectorXcd force = f.transpose() * v;
    std::vector<double> sizes{f.squaredNorm(), v.squaredNorm()};
    MPI_Allreduce(MPI_IN_PLACE, force.data(), static_cast<int>(force.size()), MPI_C_DOUBLE_COMPLEX, MPI_SUM, comm());
    MPI_Allreduce(MPI_IN_PLACE, sizes.data(), 2, MPI_DOUBLE, MPI_SUM, comm());
    Pole pole{m.lambda, force.norm() <= 1e-12 * std::sqrt(sizes[0] * sizes[1]), {}};
    if (pole.silent) pole.shape = m.shape;
    out.push_back(std::move(pole));
  }
  return out;
}

}  // namespace whirl::solve
