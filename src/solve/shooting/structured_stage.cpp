#include "solve/shooting/structured_stage.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void StructuredStage::factorise(const StructuredRate& rate, const RateMatrix& a, double own) {
  rate_ = &rate;
  const Index n = rate.coordinates();
  Index size = n;
  for (const RateFilm& film : rate.films()) size += film.reach;
  MatrixXd v = MatrixXd::Identity(size, size);
  v.topLeftCorner(n, n) -= own * Map<const MatrixXd>(a.data(), n, n);
  parts_.resize(rate.films().size());
  Index end = n;  // of this film's last states in X
  for (std::size_t f = 0; f < parts_.size(); ++f) {
    const RateFilm& film = rate.films()[f];
    Part& part = parts_[f];
    const Index count = film.at.count, reach = film.reach, inner = count - reach;
    Index seen = 0;
    part.inputs.resize(film.at.inputs, n);
    part.response.setZero(inner, film.at.inputs + reach);
    const auto input = [&](Index e) { return -own * a.segment(film.inputs + e * film.stride, count); };
    for (Index e = 0; e < film.at.inputs; ++e) {
      if (a(film.seen + e) == 0) continue;
      part.inputs.row(seen) = rate.inputs().row(film.at.first_input + e);
      part.response.col(seen) = input(e).head(inner);
      v.block(end, 0, reach, n) += input(e).tail(reach) * part.inputs.row(seen);
      ++seen;
    }
    part.inputs.conservativeResize(seen, n);
    part.response.conservativeResize(inner, seen + reach);
    part.ends.setZero(inner, reach);
    part.band.resize(inner, reach);
    for (Index k = 0; k < inner; ++k) part.band.at(k, k) = 1;
    for (std::size_t d = 0; d < film.shifts.size(); ++d)
      for (Index k = 0; k < count; ++k) {
        const double value = -own * a(film.diagonals + static_cast<Index>(d) * film.stride + k);
        const Index j = (k + film.shifts[d] + count) % count;
        if (k < inner && j < inner)
          part.band.at(k, j) += value;
        else if (k < inner)
          part.response(k, seen + j - inner) += value;
        else if (j < inner)
          part.ends(j, k - inner) -= value;
        else
          v(end + k - inner, end + j - inner) += value;
      }
    part.band.factorise();
    for (Index c = 0; c < part.response.cols(); ++c) part.band.solve(part.response.col(c).data());
    part.forces.resize(inner, film.at.forces);
    for (Index e = 0; e < film.at.forces; ++e) {
      const auto force = own * a.segment(film.forces + e * film.stride, count);
      part.forces.col(e) = force.head(inner);
      v.block(0, end, n, reach) -= rate.lead().col(film.at.first_force + e) * force.tail(reach).transpose();
    }
    // V - W B^-1 U, with -W = own (Q P, D) of the interior.
    const MatrixXd forces = rate.lead().middleCols(film.at.first_force, film.at.forces) *
                            (part.forces.transpose() * part.response),
                   ends = part.ends.transpose() * part.response;
    v.topLeftCorner(n, n) += forces.leftCols(seen) * part.inputs;
    v.block(0, end, n, reach) += forces.rightCols(reach);
    v.block(end, 0, reach, n) += ends.leftCols(seen) * part.inputs;
    v.block(end, end, reach, reach) += ends.rightCols(reach);
    end += reach;
  }
  border_.compute(v);
  x_.resize(size);
}

void StructuredStage::solve(double* r) const {
  const Index n = rate_->coordinates();
  x_.head(n) = Map<const VectorXd>(r, n);
  Index end = n;
  for (std::size_t f = 0; f < parts_.size(); ++f) {
    const RateFilm& film = rate_->films()[f];
    const Part& part = parts_[f];
    double* s = r + n + film.at.first;
    const Index inner = film.at.count - film.reach;
    part.band.solve(s);
    const Map<const VectorXd> interior(s, inner);
    x_.head(n) += rate_->lead().middleCols(film.at.first_force, film.at.forces) * (part.forces.transpose() * interior);
    x_.segment(end, film.reach) = Map<const VectorXd>(s + inner, film.reach) + part.ends.transpose() * interior;
    end += film.reach;
  }
  x_ = border_.solve(x_);
  Map<VectorXd>(r, n) = x_.head(n);
  end = n;
  for (std::size_t f = 0; f < parts_.size(); ++f) {
    const RateFilm& film = rate_->films()[f];
    const Part& part = parts_[f];
    const Index inner = film.at.count - film.reach, seen = part.inputs.rows();
    Map<VectorXd> s(r + n + film.at.first, film.at.count);
    s.head(inner).noalias() -= part.response.leftCols(seen) * (part.inputs * x_.head(n));
    s.head(inner).noalias() -= part.response.rightCols(film.reach) * x_.segment(end, film.reach);
    s.tail(film.reach) = x_.segment(end, film.reach);
    end += film.reach;
  }
}

}  // namespace whirl::solve
