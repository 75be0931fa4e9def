#include <algorithm>

#include "solve/cycle/own_block.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/solve/cycle/interval.hpp"

// With the own states of all films eliminated down to their separators s_S, the forces f at the points are those of a
// film law that is dense in time, and an interval is a low-rank update of the linear part as without own states:
//
//     x = z + Y f                      z = W0^-1 y of the linear part, eta = V z + V Y f: inputs
//     f = S eta + P s_S + phi          S = dF/dw at the points + what the interior makes of eta
//     Sigma s_S + Q eta = y_S          phi, y_S: what the interior makes of its own right-hand side
//
//     =>   [ I - S VY   -P    ] [ f   ]   [ S V z + phi ]
//          [ Q VY       Sigma ] [ s_S ] = [ y_S - Q V z ]      of size m r + m x separators

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class OwnInterval final : public Interval {
public:
  OwnInterval(std::shared_ptr<const LinearPart> part, const std::vector<problem::OwnStates>& films,
              const problem::ScaledPoint& scales, const std::vector<const problem::PointState*>& points);
  void solve(MatrixXd& y) const override;
  void solve_transposed(MatrixXd& y) const override;
  MatrixXd start(const MatrixXd& x) const override;
  MatrixXd start_transposed(const MatrixXd& y) const override;
  VectorXd multiply(const VectorXd& x_start, const VectorXd& x) const override;
  MatrixXd block(int j, int l) const override;
  void carry(const MatrixXd& rows, MatrixXd& state, MatrixXd& added) const override;

private:
  [[nodiscard]] Index degree() const { return part_->scheme.degree; }
  // Row of force d of a film at point j; column of its c-th active input there.
  [[nodiscard]] Index force_row(std::size_t film, Index j, Index d) const {
    return j * part_->r + films_[film].first_force + d;
  }
  [[nodiscard]] Index input_row(std::size_t film, Index j, Index c) const {
    return j * part_->w + films_[film].first_input + blocks_[film]->active()[static_cast<std::size_t>(c)];
  }
  [[nodiscard]] double* own(std::size_t film, std::vector<double>& y, Index columns) const {
    return y.data() + films_[film].first * degree() * columns;
  }
  // From right-hand sides of the own states in `y`, of the forces in `force` and the inputs V z of the linear part:
  // forces [m r x columns], with the own states left in `y`.
  MatrixXd forces(Index columns, std::vector<double>& y, const MatrixXd& force, const MatrixXd& inputs) const;

  std::shared_ptr<const LinearPart> part_;
  const std::vector<problem::OwnStates>& films_;
  std::vector<std::unique_ptr<OwnBlock>> blocks_;
  std::vector<Index> separators_;  // where those of each film begin in the small system
  std::vector<MatrixXd> tangents_;
  Index n_, own_, last_;  // all states, own ones, size of the small system
  MatrixXd by_inputs_;    // [S; -Q]
  core::DenseLu<double> small_;
};

OwnInterval::OwnInterval(std::shared_ptr<const LinearPart> part, const std::vector<problem::OwnStates>& films,
                         const problem::ScaledPoint& scales, const std::vector<const problem::PointState*>& points)
    : part_(std::move(part)), films_(films), n_(scales.size()), own_(scales.own_states()) {
  const LinearPart& p = *part_;
  const Index m = degree();
  last_ = m * p.r;
  for (std::size_t i = 0; i < films_.size(); ++i) {
    blocks_.push_back(make_own_block(p.scheme, films_[i]));
    blocks_[i]->factorise(points, i, scales, p.n + films_[i].first, p.length);
    separators_.push_back(last_);
    last_ += m * blocks_[i]->shape().separators;
  }
  by_inputs_ = MatrixXd::Zero(last_, m * p.w);
  MatrixXd k = MatrixXd::Zero(last_, last_);
  k.topLeftCorner(m * p.r, m * p.r).setIdentity();
  for (Index j = 0; j < m; ++j) {
    tangents_.push_back(points[static_cast<std::size_t>(j)]->films.d_inputs);
    by_inputs_.block(j * p.r, j * p.w, p.r, p.w) = tangents_.back();
  }
  for (std::size_t i = 0; i < films_.size(); ++i) {
    const OwnBlock& b = *blocks_[i];
    const auto active = static_cast<Index>(b.active().size());
    for (Index j = 0; j < m; ++j)
      for (Index c = 0; c < active; ++c) {
        const Index column = input_row(i, j, c);
        for (Index q = 0; q < m; ++q)
          for (Index d = 0; d < films_[i].forces; ++d)
            by_inputs_(force_row(i, q, d), column) += b.f_eta(q * films_[i].forces + d, c * m + j);
        by_inputs_.col(column).segment(separators_[i], b.q.rows()) = -b.q.col(c * m + j);
      }
    for (Index q = 0; q < m; ++q)
      for (Index d = 0; d < films_[i].forces; ++d)
        k.row(force_row(i, q, d)).segment(separators_[i], b.f_own.cols()) = -b.f_own.row(q * films_[i].forces + d);
    k.block(separators_[i], separators_[i], b.sigma.rows(), b.sigma.cols()) = b.sigma;
  }
  k.leftCols(m * p.r).noalias() -= by_inputs_ * p.vy;
  small_.compute(k);
}

MatrixXd OwnInterval::forces(Index columns, std::vector<double>& y, const MatrixXd& force,
                             const MatrixXd& inputs) const {
  const Index m = degree();
  MatrixXd right(last_, columns), interior;
  right.noalias() = by_inputs_ * inputs;
  right.topRows(m * part_->r) += force;
  for (std::size_t i = 0; i < films_.size(); ++i) {
    double* s = own(i, y, columns);
    const OwnShape& shape = blocks_[i]->shape();
    blocks_[i]->eliminate(columns, s, interior);
    for (Index q = 0; q < m; ++q)
      for (Index d = 0; d < films_[i].forces; ++d)
        right.row(force_row(i, q, d)) += interior.row(q * films_[i].forces + d);
    for (Index a = shape.interior(); a < shape.count; ++a)
      right.middleRows(separators_[i] + m * (a - shape.interior()), m) +=
          Map<const MatrixXd>(s + a * m * columns, m, columns);
  }
  const MatrixXd answer = small_.solve(right);
  MatrixXd eta = inputs;
  eta.noalias() += part_->vy * answer.topRows(m * part_->r);
  MatrixXd mine;
  for (std::size_t i = 0; i < films_.size(); ++i) {
    const auto active = static_cast<Index>(blocks_[i]->active().size());
    mine.resize(m * active, columns);
    for (Index c = 0; c < active; ++c)
      for (Index j = 0; j < m; ++j) mine.row(c * m + j) = eta.row(input_row(i, j, c));
    blocks_[i]->substitute(columns, own(i, y, columns), mine,
                           answer.middleRows(separators_[i], m * blocks_[i]->shape().separators));
  }
  return answer.topRows(m * part_->r);
}

void OwnInterval::solve(MatrixXd& y) const {
  const Index m = degree(), n = part_->n;
  std::vector<double> own(static_cast<std::size_t>(m * own_));
  MatrixXd core(m * n, 1);
  const MatrixXd none = MatrixXd::Zero(m * part_->r, 1);
  for (Index c = 0; c < y.cols(); ++c) {
    Map<MatrixXd> nodes(y.col(c).data(), n_, m), s(own.data(), m, own_);
    Map<MatrixXd>(core.data(), n, m) = nodes.topRows(n);
    s = nodes.bottomRows(own_).transpose();
    part_->solve(core);
    core.noalias() += part_->y * forces(1, own, none, part_->inputs(core));
    nodes.topRows(n) = Map<const MatrixXd>(core.data(), n, m);
    nodes.bottomRows(own_) = s.transpose();
  }
}

void OwnInterval::carry(const MatrixXd& rows, MatrixXd& state, MatrixXd& added) const {
  const Index m = degree(), n = part_->n, all = state.cols();
  std::vector<double> y;
  MatrixXd begin, force, from_film;
  for (Index first = 0; first < all;) {
    const Index columns = std::min<Index>(8, all - first);  // as many as stay in the cache together
    y.resize(static_cast<std::size_t>(m * own_ * columns));
    begin = state.block(0, first, n, columns);
    force.setZero(m * part_->r, columns);
    for (std::size_t i = 0; i < films_.size(); ++i) {
      blocks_[i]->start(columns, state.data() + first * n_ + n + films_[i].first, n_, own(i, y, columns), from_film);
      for (Index q = 0; q < m; ++q)
        for (Index d = 0; d < films_[i].forces; ++d)
          force.row(force_row(i, q, d)) += from_film.row(q * films_[i].forces + d);
    }
    const MatrixXd f = forces(columns, y, force, part_->inputs_free * begin);
    MatrixXd core = part_->free * begin;
    core.noalias() += part_->y * f;
    state.block(0, first, n, columns) = core.bottomRows(n);
    for (Index a = 0; a < own_; ++a)
      for (Index c = 0; c < columns; ++c)
        state(n + a, first + c) = y[static_cast<std::size_t>((a * columns + c) * m + m - 1)];
    for (Index b = 0; b < rows.rows(); ++b)
      for (Index l = 0; l < m; ++l)
        added.row(b).segment(first, columns).noalias() += rows.row(b).segment(l * n_, n) * core.middleRows(l * n, n);
    for (Index a = 0; a < own_; ++a)
      for (Index c = 0; c < columns; ++c) {
        const double* s = y.data() + (a * columns + c) * m;
        for (Index b = 0; b < rows.rows(); ++b) {
          double sum = 0;
          for (Index l = 0; l < m; ++l) sum += rows(b, l * n_ + n + a) * s[l];
          added(b, first + c) += sum;
        }
      }
    first += columns;
  }
}

MatrixXd OwnInterval::start(const MatrixXd& x) const {
  const Index m = degree(), n = part_->n;
  MatrixXd out(m * n_, x.cols()), force;
  std::vector<double> y(static_cast<std::size_t>(m * own_));
  for (Index c = 0; c < x.cols(); ++c) {
    const VectorXd core = x.col(c).head(n), inputs = part_->c * core, w = part_->w00 * core;
    VectorXd f = VectorXd::Zero(m * part_->r);
    for (Index j = 0; j < m; ++j)
      f.segment(j * part_->r, part_->r) = part_->scheme.value(j, 0) * (tangents_[static_cast<std::size_t>(j)] * inputs);
    for (std::size_t i = 0; i < films_.size(); ++i) {
      double* s = own(i, y, 1);
      blocks_[i]->start(1, x.col(c).data() + n + films_[i].first, n_, s, force);
      for (Index q = 0; q < m; ++q)
        for (Index d = 0; d < films_[i].forces; ++d) f(force_row(i, q, d)) += force(q * films_[i].forces + d, 0);
      const auto active = static_cast<Index>(blocks_[i]->active().size());
      MatrixXd eta(m, active);
      for (Index e = 0; e < active; ++e) eta.col(e) = part_->scheme.value.col(0) * inputs(input_row(i, 0, e));
      blocks_[i]->add_inputs(-1, eta.data(), s);
    }
    Map<MatrixXd> nodes(out.col(c).data(), n_, m);
    nodes.topRows(n) = Map<const MatrixXd>(w.data(), n, m);
    nodes.topRows(n).noalias() -= part_->b * Map<const MatrixXd>(f.data(), part_->r, m);
    nodes.bottomRows(own_) = -Map<const MatrixXd>(y.data(), m, own_).transpose();
  }
  return out;
}

VectorXd OwnInterval::multiply(const VectorXd& x_start, const VectorXd& x) const {
  const LinearPart& p = *part_;
  const Index m = degree(), n = p.n;
  const Map<const MatrixXd> nodes(x.data(), n_, m);
  MatrixXd value = nodes.topRows(n) * p.scheme.value.rightCols(m).transpose(),
           slope = nodes.topRows(n) * p.scheme.slope.rightCols(m).transpose();
  value += x_start.head(n) * p.scheme.value.col(0).transpose();
  slope += x_start.head(n) * p.scheme.slope.col(0).transpose();
  const MatrixXd inputs = p.c * value, s = nodes.bottomRows(own_).transpose();
  MatrixXd force(p.r, m), rows(m, own_);
  for (Index j = 0; j < m; ++j) force.col(j) = tangents_[static_cast<std::size_t>(j)] * inputs.col(j);
  VectorXd mine;
  for (std::size_t i = 0; i < films_.size(); ++i) {
    const problem::OwnStates& film = films_[i];
    blocks_[i]->multiply(x_start.data() + n + film.first, s.data() + film.first * m, rows.data() + film.first * m,
                         mine);
    force.middleRows(film.first_force, film.forces) += Map<const MatrixXd>(mine.data(), film.forces, m);
    const auto active = static_cast<Index>(blocks_[i]->active().size());
    MatrixXd eta(m, active);
    for (Index e = 0; e < active; ++e) eta.col(e) = inputs.row(input_row(i, 0, e)).transpose();
    blocks_[i]->add_inputs(1, eta.data(), rows.data() + film.first * m);
  }
  VectorXd y(m * n_);
  Map<MatrixXd> out(y.data(), n_, m);
  out.topRows(n) = p.l0 * value + p.l1 * (slope / p.length) - p.b * force;
  out.bottomRows(own_) = rows.transpose();
  return y;
}

// The steps of the solution backwards, each transposed.
void OwnInterval::solve_transposed(MatrixXd& y) const {
  const LinearPart& p = *part_;
  const Index m = degree(), n = p.n;
  MatrixXd s(m, own_), core(m * n, 1), eta(m * p.w, 1);
  VectorXd answer(last_), border, force;
  for (Index c = 0; c < y.cols(); ++c) {
    Map<MatrixXd> nodes(y.col(c).data(), n_, m);
    s = nodes.bottomRows(own_).transpose();
    Map<MatrixXd>(core.data(), n, m) = nodes.topRows(n);
    // x = z + Y f, s_I = ... - Z (eta, s_S), eta = V z + V Y f
    answer.setZero();
    eta.setZero();
    for (std::size_t i = 0; i < films_.size(); ++i) {
      const OwnBlock& b = *blocks_[i];
      const auto active = static_cast<Index>(b.active().size());
      b.substitute_transposed(s.data() + films_[i].first * m, border);
      for (Index e = 0; e < active; ++e)
        for (Index j = 0; j < m; ++j) eta(input_row(i, j, e), 0) += border(e * m + j);
      answer.segment(separators_[i], m * b.shape().separators) = border.tail(m * b.shape().separators);
    }
    answer.head(m * p.r).noalias() += p.y.transpose() * core.col(0) + p.vy.transpose() * eta.col(0);
    answer = small_.solve_transposed(answer);
    eta.noalias() += by_inputs_.transpose() * answer;
    core += p.inputs_transposed(eta);
    p.solve_transposed(core);
    for (std::size_t i = 0; i < films_.size(); ++i) {
      const OwnShape& shape = blocks_[i]->shape();
      double* own = s.data() + films_[i].first * m;
      Map<VectorXd>(own + m * shape.interior(), m * shape.separators) =
          answer.segment(separators_[i], m * shape.separators);
      force.resize(m * films_[i].forces);
      for (Index j = 0; j < m; ++j)
        for (Index d = 0; d < films_[i].forces; ++d) force(j * films_[i].forces + d) = answer(force_row(i, j, d));
      blocks_[i]->eliminate_transposed(own, force.data());
    }
    nodes.topRows(n) = Map<const MatrixXd>(core.data(), n, m);
    nodes.bottomRows(own_) = s.transpose();
  }
}

MatrixXd OwnInterval::start_transposed(const MatrixXd& y) const {
  const LinearPart& p = *part_;
  const Index m = degree(), n = p.n;
  MatrixXd out = MatrixXd::Zero(n_, y.cols());
  for (Index c = 0; c < y.cols(); ++c) {
    const Map<const MatrixXd> nodes(y.col(c).data(), n_, m);
    const MatrixXd core = nodes.topRows(n), s = nodes.bottomRows(own_).transpose(), phi = p.b.transpose() * core;
    VectorXd inputs = VectorXd::Zero(p.w), mine;
    for (Index j = 0; j < m; ++j)
      inputs -= p.scheme.value(j, 0) * (tangents_[static_cast<std::size_t>(j)].transpose() * phi.col(j));
    for (std::size_t i = 0; i < films_.size(); ++i) {
      const problem::OwnStates& film = films_[i];
      const double* own = s.data() + film.first * m;
      const auto active = static_cast<Index>(blocks_[i]->active().size());
      mine.resize(m * active);
      blocks_[i]->inputs_transposed(own, mine.data());
      for (Index e = 0; e < active; ++e)
        for (Index j = 0; j < m; ++j) inputs(input_row(i, 0, e)) += p.scheme.value(j, 0) * mine(e * m + j);
      const MatrixXd force = phi.middleRows(film.first_force, film.forces);
      blocks_[i]->start_transposed(own, force.data(), out.col(c).data() + n + film.first);
    }
    out.col(c).head(n) = p.w00.transpose() * Map<const VectorXd>(core.data(), m * n) + p.c.transpose() * inputs;
  }
  return out;
}

MatrixXd OwnInterval::block(int j, int l) const {
  const LinearPart& p = *part_;
  const Index n = p.n;
  MatrixXd out = MatrixXd::Zero(n_, n_);
  const MatrixXd& s = tangents_[static_cast<std::size_t>(j)];
  out.topLeftCorner(n, n) = p.scheme.value(j, l) * (p.l0 - p.b * s * p.c) + (p.scheme.slope(j, l) / p.length) * p.l1;
  for (std::size_t i = 0; i < films_.size(); ++i) {
    const problem::OwnStates& film = films_[i];
    for (Index a = 0; a < film.count; ++a) {
      const MatrixXd g = blocks_[i]->inputs_of(a);
      for (Index e = 0; e < g.cols(); ++e)
        out.row(n + film.first + a).head(n) += p.scheme.value(j, l) * g(j, e) * p.c.row(input_row(i, 0, e));
      out.col(n + film.first + a).head(n) -=
          p.b.middleCols(film.first_force, film.forces) * blocks_[i]->forces_of(a, j, l);
      for (Index slot = 0; slot < blocks_[i]->shape().width(); ++slot)
        out(n + film.first + a, n + film.first + blocks_[i]->shape().column(a, slot)) +=
            blocks_[i]->entry(a, slot, j, l);
    }
  }
  return out;
}

}  // namespace

std::unique_ptr<Interval> make_own_interval(std::shared_ptr<const LinearPart> part,
                                            const std::vector<problem::OwnStates>& films,
                                            const problem::ScaledPoint& scales,
                                            const std::vector<const problem::PointState*>& points) {
  return std::make_unique<OwnInterval>(std::move(part), films, scales, points);
}

}  // namespace whirl::solve
