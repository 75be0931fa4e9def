#include "solve/cycle/own_block.hpp"

#include <algorithm>

#include "solve/cycle/own_blocks.hpp"
#include "solve/cycle/small_blocks.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

template <int M>
void OwnBand<M>::read(const std::vector<const problem::PointState*>& points, std::size_t index,
                      const problem::ScaledPoint& scales, Index first) {
  const Index width = shape_.width();
  std::fill(by_state_.begin(), by_state_.end(), 0.0);
  std::fill(by_rate_.begin(), by_rate_.end(), 0.0);
  const double *column = scales.state_scale().data() + first, *row = scales.residual_scale().data() + first;
  std::vector<bool> seen(static_cast<std::size_t>(inputs_), false);
  for (Index j = 0; j < m(); ++j) {
    const core::PartResponse& t = points[static_cast<std::size_t>(j)]->films.own[index];
    const auto put = [&](const std::vector<std::size_t>& places, const std::vector<double>& values,
                         std::vector<double>& to) {
      for (std::size_t e = 0; e < places.size(); ++e)
        to[places[e] * static_cast<std::size_t>(m()) + static_cast<std::size_t>(j)] += values[e];
    };
    put(shape_.states, t.d_states, by_state_);
    put(shape_.rates, t.d_rates, by_rate_);
    force_rate_.resize(t.force_rates.rows() > 0 ? force_.size() : 0);
    for (Index a = 0; a < shape_.count; ++a) {
      for (Index f = 0; f < t.force_rates.rows(); ++f)
        force_rate_[static_cast<std::size_t>((a * forces_ + f) * m() + j)] = t.force_rates(f, a) * column[a];
      for (Index f = 0; f < forces_; ++f)
        force_[static_cast<std::size_t>((a * forces_ + f) * m() + j)] = t.forces(f, a) * column[a];
      for (Index c = 0; c < inputs_; ++c) {
        const double value = t.inputs(c, a) / row[a];
        input_[static_cast<std::size_t>((a * inputs_ + c) * m() + j)] = value;
        if (value != 0) seen[static_cast<std::size_t>(c)] = true;
      }
    }
  }
  for (Index a = 0; a < shape_.count; ++a)
    for (Index slot = 0; slot < width; ++slot) {
      const double scale = column[shape_.column(a, slot)] / row[a];
      for (Index j = 0; j < m(); ++j) {
        const auto at = static_cast<std::size_t>((a * width + slot) * m() + j);
        by_state_[at] *= scale;
        by_rate_[at] *= scale;
        at_start_[at] = -scheme_.value(j, 0) * by_state_[at] - scheme_.slope(j, 0) / length_ * by_rate_[at];
      }
    }
  active_.clear();
  for (Index c = 0; c < inputs_; ++c)
    if (seen[static_cast<std::size_t>(c)]) active_.push_back(c);
}

// Crout's order: L carries the diagonal, U has a unit one.
template <int M>
void OwnBand<M>::factorise_band() {
  const Index n = shape_.interior(), below = shape_.below, above = shape_.above;
  std::vector<double> work(static_cast<std::size_t>(m() * m()));
  for (Index a = 0; a < n; ++a)
    for (Index c = std::max<Index>(0, a - below); c <= std::min(n - 1, a + above); ++c) {
      const Index end = std::min(a, c);
      double* l = c < a ? factor(a, c - a + below) : work.data();
      block(a, c - a + below, l);
      for (Index e = std::max({Index(0), a - below, c - above}); e < end; ++e)
        subtract<M>(m(), factor(a, e - a + below), factor(e, c - e + below), m(), l);
      if (c == a) invert<M>(m(), l, factor(a, below));
      if (c > a) multiply_by<M>(m(), factor(a, below), l, m(), factor(a, c - a + below));
    }
}

// Z, and with it what is left for the separators and the forces.
template <int M>
void OwnBand<M>::find_border() {
  const Index n = shape_.interior(), below = shape_.below, above = shape_.above, width = shape_.width();
  const auto active = static_cast<Index>(active_.size());
  border_ = m() * (active + shape_.separators);
  z_.resize(static_cast<std::size_t>(n * m() * border_));
  std::vector<double> row(static_cast<std::size_t>(m() * border_)), square(static_cast<std::size_t>(m() * m()));
  const auto put_inputs = [&](Index a, double* out, Index stride) {
    for (Index c = 0; c < active; ++c)
      for (Index j = 0; j < m(); ++j)
        out[(c * m() + j) * stride + j] = input(a, active_[static_cast<std::size_t>(c)])[j];
  };
  for (Index a = 0; a < n; ++a) {
    std::fill(row.begin(), row.end(), 0.0);
    put_inputs(a, row.data(), m());
    for (Index slot = 0; slot < width; ++slot) {
      const Index to = shape_.column(a, slot);
      if (to < n) continue;
      block(a, slot, square.data());
      double* out = row.data() + m() * m() * (active + to - n);
      for (Index e = 0; e < m() * m(); ++e) out[e] += square[static_cast<std::size_t>(e)];
    }
    for (Index c = std::max<Index>(0, a - below); c < a; ++c)
      subtract<M>(m(), factor(a, c - a + below), z(c), border_, row.data());
    multiply_by<M>(m(), factor(a, below), row.data(), border_, z(a));
  }
  for (Index a = n - 1; a >= 0; --a)
    for (Index c = a + 1; c <= std::min(n - 1, a + above); ++c)
      subtract<M>(m(), factor(a, c - a + below), z(c), border_, z(a));

  const Index s = m() * shape_.separators;
  MatrixXd both = MatrixXd::Zero(s, border_), force = MatrixXd::Zero(m() * forces_, border_);
  for (Index a = 0; a < n; ++a) add_force(a, z(a), border_, force.data());
  force *= -1;
  const MatrixXd one = MatrixXd::Identity(m(), m());
  for (Index a = n; a < shape_.count; ++a) {
    const Index at = m() * (a - n);
    add_force(a, one.data(), m(), force.col(m() * active + at).data());
    put_inputs(a, both.data() + at, s);
    for (Index slot = 0; slot < width; ++slot) {
      const Index to = shape_.column(a, slot);
      block(a, slot, square.data());
      const Map<const MatrixXd> t(square.data(), m(), m());
      if (to >= n)
        both.block(at, m() * (active + to - n), m(), m()) += t;
      else
        both.middleRows(at, m()) -= t.lazyProduct(Map<const MatrixXd>(z(to), m(), border_));
    }
  }
  q = both.leftCols(m() * active);
  sigma = both.rightCols(s);
  f_eta = force.leftCols(m() * active);
  f_own = force.rightCols(s);
}

template <int M>
void OwnBand<M>::factorise(const std::vector<const problem::PointState*>& points, std::size_t index,
                           const problem::ScaledPoint& scales, Index first, double length, bool whole) {
  length_ = length;
  slope_ = scheme_.slope.rightCols(m()) / length;
  read(points, index, scales, first);
  factorise_band();
  if (whole) find_border();
}

template <int M>
void OwnBand<M>::eliminate(Index columns, double* y, MatrixXd& force) const {
  const Index n = shape_.interior(), below = shape_.below, above = shape_.above, size = m() * columns;
  std::vector<double> row(static_cast<std::size_t>(size)), square(static_cast<std::size_t>(m() * m()));
  for (Index a = 0; a < n; ++a) {
    std::copy(y + a * size, y + (a + 1) * size, row.begin());
    for (Index c = std::max<Index>(0, a - below); c < a; ++c)
      subtract<M>(m(), factor(a, c - a + below), y + c * size, columns, row.data());
    multiply_by<M>(m(), factor(a, below), row.data(), columns, y + a * size);
  }
  force.setZero(m() * forces_, columns);
  for (Index a = n - 1; a >= 0; --a) {
    for (Index c = a + 1; c <= std::min(n - 1, a + above); ++c)
      subtract<M>(m(), factor(a, c - a + below), y + c * size, columns, y + a * size);
    add_force(a, y + a * size, columns, force.data());
  }
  for (Index a = n; a < shape_.count; ++a)
    for (Index slot = 0; slot < shape_.width(); ++slot) {
      const Index to = shape_.column(a, slot);
      if (to >= n) continue;
      block(a, slot, square.data());
      subtract<M>(m(), square.data(), y + to * size, columns, y + a * size);
    }
}

template <int M>
void OwnBand<M>::substitute(Index columns, double* y, const MatrixXd& eta, const MatrixXd& separators) const {
  const Index n = shape_.interior(), size = m() * columns;
  MatrixXd border(border_, columns);
  border.topRows(eta.rows()) = -eta;
  border.bottomRows(separators.rows()) = -separators;
  for (Index a = 0; a < n; ++a)
    for (Index c = 0; c < columns; ++c)
      accumulate_column<M>(m(), z(a), border.col(c).data(), border_, y + a * size + c * m());
  for (Index a = n; a < shape_.count; ++a)
    for (Index c = 0; c < columns; ++c)
      for (Index l = 0; l < m(); ++l) y[a * size + c * m() + l] = separators(m() * (a - n) + l, c);
}

template <int M>
void OwnBand<M>::start(Index columns, const double* s, Index stride, double* y, MatrixXd& force) const {
  const Index size = m() * columns, width = shape_.width();
  force.setZero(m() * forces_, columns);
  const bool forces_at_start = rated() || scheme_.value.col(0).cwiseAbs().maxCoeff() > 0;
  std::vector<double> seen(static_cast<std::size_t>(width));
  for (Index a = 0; a < shape_.count; ++a)
    for (Index c = 0; c < columns; ++c) {
      double* out = y + a * size + c * m();
      std::fill(out, out + m(), 0.0);
      for (Index slot = 0; slot < width; ++slot)
        seen[static_cast<std::size_t>(slot)] = s[c * stride + shape_.column(a, slot)];
      accumulate_column<M>(m(), band(at_start_, a, 0), seen.data(), width, out);
    }
  if (!forces_at_start) return;
  for (Index c = 0; c < columns; ++c) {
    double* sum = force.col(c).data();
    for (Index a = 0; a < shape_.count; ++a)
      for (Index d = 0; d < forces_; ++d)
        for (Index j = 0; j < m(); ++j) sum[j * forces_ + d] += force_at_start(a, d, j) * s[c * stride + a];
  }
}

template <int M>
void OwnBand<M>::add_inputs(double factor, const double* eta, double* y) const {
  for (Index a = 0; a < shape_.count; ++a)
    for (std::size_t c = 0; c < active_.size(); ++c) {
      const double *g = input(a, active_[c]), *at = eta + static_cast<Index>(c) * m();
      for (Index j = 0; j < m(); ++j) y[a * m() + j] += factor * g[j] * at[j];
    }
}

template <int M>
void OwnBand<M>::multiply(const double* start, const double* s, double* rows, VectorXd& force) const {
  force.setZero(m() * forces_);
  std::vector<double> values(static_cast<std::size_t>(shape_.count * m())), slopes = values;
  for (Index a = 0; a < shape_.count; ++a)
    for (Index j = 0; j < m(); ++j) {
      double value = scheme_.value(j, 0) * start[a], slope = scheme_.slope(j, 0) * start[a] / length_;
      for (Index l = 0; l < m(); ++l) {
        value += value_(j, l) * s[a * m() + l];
        slope += slope_(j, l) * s[a * m() + l];
      }
      values[static_cast<std::size_t>(a * m() + j)] = value;
      slopes[static_cast<std::size_t>(a * m() + j)] = slope;
      for (Index d = 0; d < forces_; ++d) {
        force(j * forces_ + d) += force_of(a)[d * m() + j] * value;
        if (rated()) force(j * forces_ + d) += force_rate_of(a)[d * m() + j] * slope;
      }
    }
  for (Index a = 0; a < shape_.count; ++a)
    for (Index j = 0; j < m(); ++j) {
      double sum = 0;
      for (Index slot = 0; slot < shape_.width(); ++slot) {
        const auto to = static_cast<std::size_t>(shape_.column(a, slot) * m() + j);
        sum += band(by_state_, a, slot)[j] * values[to] + band(by_rate_, a, slot)[j] * slopes[to];
      }
      rows[a * m() + j] = sum;
    }
}

template <int M>
void OwnBand<M>::substitute_transposed(const double* y, VectorXd& border) const {
  const Index n = shape_.interior(), separators = m() * shape_.separators;
  border = VectorXd::Zero(border_);
  border.tail(separators) = Map<const VectorXd>(y + n * m(), separators);
  for (Index a = 0; a < n; ++a)
    border.noalias() -= Map<const MatrixXd>(z(a), m(), border_).transpose() * Map<const VectorXd>(y + a * m(), m());
}

// T_II^T = U^T L^T.
template <int M>
void OwnBand<M>::eliminate_transposed(double* y, const double* force) const {
  const Index n = shape_.interior(), below = shape_.below, above = shape_.above, size = m();
  std::vector<double> square(static_cast<std::size_t>(size * size)), row(static_cast<std::size_t>(size));
  for (Index a = n; a < shape_.count; ++a)
    for (Index slot = 0; slot < shape_.width(); ++slot) {
      const Index to = shape_.column(a, slot);
      if (to >= n) continue;
      block(a, slot, square.data());
      subtract_transposed<M>(size, square.data(), y + a * size, y + to * size);
    }
  for (Index a = 0; a < n; ++a) {
    for (Index d = 0; d < forces_; ++d)
      for (Index j = 0; j < size; ++j) {
        const double v = force_of(a)[d * size + j] * force[j * forces_ + d];
        for (Index l = 0; l < size; ++l) y[a * size + l] += value_(j, l) * v;
        if (!rated()) continue;
        const double w = force_rate_of(a)[d * size + j] * force[j * forces_ + d];
        for (Index l = 0; l < size; ++l) y[a * size + l] += slope_(j, l) * w;
      }
    for (Index c = std::max<Index>(0, a - above); c < a; ++c)
      subtract_transposed<M>(size, factor(c, a - c + below), y + c * size, y + a * size);
  }
  for (Index a = n - 1; a >= 0; --a) {
    for (Index c = a + 1; c <= std::min(n - 1, a + below); ++c)
      subtract_transposed<M>(size, factor(c, a - c + below), y + c * size, y + a * size);
    std::fill(row.begin(), row.end(), 0.0);
    subtract_transposed<M>(size, factor(a, below), y + a * size, row.data());
    for (Index l = 0; l < size; ++l) y[a * size + l] = -row[static_cast<std::size_t>(l)];
  }
}

template <int M>
void OwnBand<M>::inputs_transposed(const double* y, double* eta) const {
  for (std::size_t c = 0; c < active_.size(); ++c)
    for (Index j = 0; j < m(); ++j) {
      double sum = 0;
      for (Index a = 0; a < shape_.count; ++a) sum += input(a, active_[c])[j] * y[a * m() + j];
      eta[static_cast<Index>(c) * m() + j] = sum;
    }
}

template <int M>
void OwnBand<M>::start_transposed(const double* y, const double* force, double* s) const {
  for (Index a = 0; a < shape_.count; ++a)
    for (Index j = 0; j < m(); ++j) {
      for (Index slot = 0; slot < shape_.width(); ++slot)
        s[shape_.column(a, slot)] -= band(at_start_, a, slot)[j] * y[a * m() + j];
      for (Index d = 0; d < forces_; ++d) s[a] -= force_at_start(a, d, j) * force[j * forces_ + d];
    }
}

std::unique_ptr<OwnBlock> make_own_block(const Scheme& scheme, const problem::OwnStates& film) {
  switch (scheme.degree) {
    case 3:
      return std::make_unique<OwnBand<3>>(scheme, film);
    case 4:
      return std::make_unique<OwnBand<4>>(scheme, film);
    default:
      return std::make_unique<OwnBand<0>>(scheme, film);
  }
}

}  // namespace whirl::solve
