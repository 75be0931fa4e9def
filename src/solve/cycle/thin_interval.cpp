#include <algorithm>
#include <span>

#include "solve/cycle/linear_part.hpp"
#include "solve/cycle/own_block.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/solve/cycle/interval.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A = W0 - (I x B) df/dw V. With the own states of films eliminated down to their separators s_S, the forces f at the
// points are those of a film law that is dense in time:
//
//     x = z + Y f                      z = W0^-1 y of the linear part, eta = V z + V Y f: inputs
//     f = S eta + P s_S + phi          S = df/dw at the points + what the interior makes of eta
//     Sigma s_S + Q eta = y_S          phi, y_S: what the interior makes of its own right-hand side
//
//     =>   [ I - S VY   -P    ] [ f   ]   [ S V z + phi ]
//          [ Q VY       Sigma ] [ s_S ] = [ y_S - Q V z ]      of size m r + m x separators
//
// Without own states the first row is left, and S is block diagonal.
template <class Part>
class ThinInterval final : public Interval {
public:
  // Of films without own states.
  ThinInterval(std::shared_ptr<const Part> part, std::vector<MatrixXd> tangents)
      : part_(std::move(part)), tangents_(std::move(tangents)), n_(part_->n), last_(degree() * part_->r) {}
  ThinInterval(std::shared_ptr<const Part> part, std::span<const problem::OwnStates> films,
               const problem::ScaledPoint& scales, const std::vector<const problem::PointState*>& points)
      : part_(std::move(part)),
        films_(films),
        n_(scales.size()),
        own_(scales.own_states()),
        last_(degree() * part_->r) {
    for (const problem::PointState* at : points) tangents_.push_back(at->films.d_inputs);
    for (std::size_t i = 0; i < films_.size(); ++i) {
      blocks_.push_back(make_own_block(part_->scheme, films_[i]));
      blocks_[i]->factorise(points, i, scales, part_->n + films_[i].first, part_->length, true);
      separators_.push_back(last_);
      last_ += degree() * blocks_[i]->shape().separators;
    }
    const Index m = degree(), r = part_->r, w = part_->w;
    law_ = MatrixXd::Zero(last_, m * w);
    for (Index j = 0; j < m; ++j) law_.block(j * r, j * w, r, w) = tangent(j);
    for (std::size_t i = 0; i < films_.size(); ++i)
      for (Index j = 0; j < m; ++j)
        for (Index c = 0; c < active(i); ++c) {
          MatrixXd column = MatrixXd::Zero(last_, 1);
          add_forces(i, blocks_[i]->f_eta.col(c * m + j), column);
          column.middleRows(separators_[i], blocks_[i]->q.rows()) = -blocks_[i]->q.col(c * m + j);
          law_.col(input_row(i, j, c)) += column;
        }
  }

  void solve(MatrixXd& y) const override {
    part_->prepare();
    in_parts(y.cols(), [&](Index first, MatrixXd& core, std::vector<double>& own) {
      for (Index c = 0; c < core.cols(); ++c) {
        const auto nodes = y.col(first + c).reshaped(n_, degree());
        core.col(c).reshaped(part_->n, degree()) = nodes.topRows(part_->n);
        states(own, c, core.cols()) = nodes.bottomRows(own_).transpose();
      }
      part_->solve(core);
      respond(part_->inputs(core), MatrixXd(), core, own);
      for (Index c = 0; c < core.cols(); ++c) {
        auto nodes = y.col(first + c).reshaped(n_, degree());
        nodes.topRows(part_->n) = core.col(c).reshaped(part_->n, degree());
        nodes.bottomRows(own_) = states(own, c, core.cols()).transpose();
      }
    });
  }
  // The steps of solve() backwards, each transposed.
  void solve_transposed(MatrixXd& y) const override {
    const Part& p = *part_;
    p.prepare();
    const Index m = degree(), n = p.n;
    MatrixXd s(m, own_), core(m * n, 1), eta;
    VectorXd answer(last_), border, force;
    for (Index c = 0; c < y.cols(); ++c) {
      auto nodes = y.col(c).reshaped(n_, m);
      s = nodes.bottomRows(own_).transpose();
      core.reshaped(n, m) = nodes.topRows(n);
      // x = z + Y f, s_I = ... - Z (eta, s_S), eta = V z + V Y f
      answer.setZero();
      answer.head(m * p.r).noalias() = p.y.transpose() * core.col(0);
      eta.setZero(m * p.w, 1);
      for (std::size_t i = 0; i < films_.size(); ++i) {
        blocks_[i]->substitute_transposed(s.data() + films_[i].first * m, border);
        for (Index e = 0; e < active(i); ++e)
          for (Index j = 0; j < m; ++j) eta(input_row(i, j, e), 0) += border(e * m + j);
        answer.segment(separators_[i], separators(i)) = border.tail(separators(i));
      }
      if (!films_.empty()) answer.head(m * p.r).noalias() += p.vy.transpose() * eta.col(0);
      answer = small().solve_transposed(answer);
      add_law_transposed(answer, eta);
      core += p.inputs_transposed(eta);
      p.solve_transposed(core);
      for (std::size_t i = 0; i < films_.size(); ++i) {
        double* own = s.data() + films_[i].first * m;
        Map<VectorXd>(own + m * blocks_[i]->shape().interior(), separators(i)) =
            answer.segment(separators_[i], separators(i));
        force = answer.head(m * p.r).reshaped(p.r, m).middleRows(films_[i].first_force, films_[i].forces).reshaped();
        blocks_[i]->eliminate_transposed(own, force.data());
      }
      nodes.topRows(n) = core.reshaped(n, m);
      nodes.bottomRows(own_) = s.transpose();
    }
  }
  void carry(const MatrixXd& rows, MatrixXd& state, MatrixXd& added) const override {
    const Index n = part_->n, m = degree();
    if (part_->free.size() == 0) return Interval::carry(rows, state, added);
    if (films_.empty() && state.cols() >= n) {
      MatrixXd adjoint = rows.transpose();
      solve_transposed(adjoint);
      added.noalias() -= start_transposed(adjoint).transpose() * state;
      // Gamma = -E A^-1 A0 [n x n], E the last block row.
      const MatrixXd gamma =
          part_->free.bottomRows(n) + part_->y.bottomRows(n) * small().solve(law(part_->inputs_free));
      state = (gamma * state).eval();
      return;
    }
    MatrixXd force, from_film;
    in_parts(state.cols(), [&](Index first, MatrixXd& core, std::vector<double>& own) {
      const Index columns = core.cols();
      const MatrixXd begin = state.block(0, first, n, columns);
      force.setZero(m * part_->r, columns);
      for (std::size_t i = 0; i < films_.size(); ++i) {
        blocks_[i]->start(columns, state.col(first).data() + n + films_[i].first, n_, film(i, own, columns), from_film);
        add_forces(i, from_film, force);
      }
      core.noalias() = part_->free * begin;
      respond(part_->inputs_free * begin, force, core, own);
      state.block(0, first, n, columns) = core.bottomRows(n);
      for (Index l = 0; l < m; ++l)
        added.middleCols(first, columns).noalias() += rows.middleCols(l * n_, n) * core.middleRows(l * n, n);
      const double* s = own.data();
      for (Index a = n; a < n_; ++a)
        for (Index c = first; c < first + columns; ++c, s += m) {
          state(a, c) = s[m - 1];
          for (Index b = 0; b < rows.rows(); ++b) {
            double sum = 0;
            for (Index l = 0; l < m; ++l) sum += rows(b, l * n_ + a) * s[l];
            added(b, c) += sum;
          }
        }
    });
  }
  MatrixXd start(const MatrixXd& x) const override {
    const Part& p = *part_;
    const Index m = degree(), n = p.n;
    const VectorXd value = p.scheme.value.col(0), slope = p.scheme.slope.col(0) / p.length;
    const bool by_value = (value.array() != 0).any();  // not at Radau points
    MatrixXd out(m * n_, x.cols()), from_film;
    std::vector<double> own(static_cast<std::size_t>(m * own_));
    for (Index c = 0; c < x.cols(); ++c) {
      const VectorXd begin = x.col(c).head(n);
      MatrixXd core = VectorXd(p.l1 * begin) * slope.transpose(), force = MatrixXd::Zero(m * p.r, 1);
      VectorXd inputs = VectorXd::Zero(p.w);
      if (by_value) {
        core += VectorXd(p.l0 * begin) * value.transpose();
        inputs = p.c * begin;
        for (Index j = 0; j < m; ++j) force.middleRows(j * p.r, p.r) = value(j) * (tangent(j) * inputs);
      }
      for (std::size_t i = 0; i < films_.size(); ++i) {
        blocks_[i]->start(1, x.col(c).data() + n + films_[i].first, n_, film(i, own, 1), from_film);
        add_forces(i, from_film, force);
        MatrixXd eta(m, active(i));
        for (Index e = 0; e < eta.cols(); ++e) eta.col(e) = value * inputs(input_row(i, 0, e));
        blocks_[i]->add_inputs(-1, eta.data(), film(i, own, 1));
      }
      if (by_value || own_ > 0) core -= p.b * MatrixXd(force.reshaped(p.r, m));
      auto nodes = out.col(c).reshaped(n_, m);
      nodes.topRows(n) = core;
      nodes.bottomRows(own_) = -states(own, 0, 1).transpose();
    }
    return out;
  }
  MatrixXd start_transposed(const MatrixXd& y) const override {
    const Part& p = *part_;
    const Index m = degree(), n = p.n;
    const VectorXd value = p.scheme.value.col(0), slope = p.scheme.slope.col(0) / p.length;
    MatrixXd out = MatrixXd::Zero(n_, y.cols());
    for (Index c = 0; c < y.cols(); ++c) {
      const auto nodes = y.col(c).reshaped(n_, m);
      const MatrixXd core = nodes.topRows(n), s = nodes.bottomRows(own_).transpose(), phi = p.b.transpose() * core;
      VectorXd inputs = VectorXd::Zero(p.w), mine, begin = p.l1.transpose() * VectorXd(core * slope);
      for (Index j = 0; j < m; ++j) inputs -= value(j) * (tangent(j).transpose() * phi.col(j));
      for (std::size_t i = 0; i < films_.size(); ++i) {
        const double* own = s.data() + films_[i].first * m;
        mine.resize(m * active(i));
        blocks_[i]->inputs_transposed(own, mine.data());
        for (Index e = 0; e < active(i); ++e) inputs(input_row(i, 0, e)) += value.dot(mine.segment(e * m, m));
        const MatrixXd force = phi.middleRows(films_[i].first_force, films_[i].forces);
        blocks_[i]->start_transposed(own, force.data(), out.col(c).data() + n + films_[i].first);
      }
      if ((value.array() != 0).any()) begin += p.l0.transpose() * VectorXd(core * value);
      begin += p.c.transpose() * inputs;
      out.col(c).head(n) = begin;
    }
    return out;
  }
  VectorXd multiply(const VectorXd& x_start, const VectorXd& x) const override {
    const Part& p = *part_;
    const Index m = degree(), n = p.n;
    const auto nodes = x.reshaped(n_, m);
    MatrixXd value = nodes.topRows(n) * p.scheme.value.rightCols(m).transpose(),
             slope = nodes.topRows(n) * p.scheme.slope.rightCols(m).transpose();
    value += x_start.head(n) * p.scheme.value.col(0).transpose();
    slope += x_start.head(n) * p.scheme.slope.col(0).transpose();
    slope /= p.length;
    const MatrixXd inputs = p.c * value, s = nodes.bottomRows(own_).transpose();
    MatrixXd force(p.r, m), rows(m, own_), core(n, m);
    for (Index j = 0; j < m; ++j) {
      core.col(j).noalias() = p.l0 * value.col(j);
      core.col(j).noalias() += p.l1 * slope.col(j);
      force.col(j).noalias() = tangent(j) * inputs.col(j);
    }
    VectorXd mine;
    for (std::size_t i = 0; i < films_.size(); ++i) {
      const Index first = films_[i].first;
      blocks_[i]->multiply(x_start.data() + n + first, s.data() + first * m, rows.data() + first * m, mine);
      force.middleRows(films_[i].first_force, films_[i].forces) += mine.reshaped(films_[i].forces, m);
      MatrixXd eta(m, active(i));
      for (Index e = 0; e < eta.cols(); ++e) eta.col(e) = inputs.row(input_row(i, 0, e)).transpose();
      blocks_[i]->add_inputs(1, eta.data(), rows.data() + first * m);
    }
    core -= p.b * force;
    VectorXd y(m * n_);
    y.reshaped(n_, m) << core, rows.transpose();
    return y;
  }
  MatrixXd block(int j, int l) const override {
    MatrixXd out(n_, n_);
    VectorXd begin = VectorXd::Zero(n_), x = VectorXd::Zero(degree() * n_);
    for (Index k = 0; k < n_; ++k) {
      double& one = l == 0 ? begin(k) : x((l - 1) * n_ + k);
      one = 1;
      out.col(k) = multiply(begin, x).segment(j * n_, n_);
      one = 0;
    }
    return out;
  }

private:
  [[nodiscard]] Index degree() const { return part_->scheme.degree; }
  [[nodiscard]] const MatrixXd& tangent(Index j) const { return tangents_[static_cast<std::size_t>(j)]; }
  [[nodiscard]] Index active(std::size_t i) const { return static_cast<Index>(blocks_[i]->active().size()); }
  [[nodiscard]] Index separators(std::size_t i) const { return degree() * blocks_[i]->shape().separators; }
  // Row of the c-th active input of a film at point j.
  [[nodiscard]] Index input_row(std::size_t i, Index j, Index c) const {
    return j * part_->w + films_[i].first_input + blocks_[i]->active()[static_cast<std::size_t>(c)];
  }
  // to [m r, ... x columns] += the forces of one film [m forces x columns].
  void add_forces(std::size_t i, const MatrixXd& from, MatrixXd& to) const {
    for (Index j = 0; j < degree(); ++j)
      to.middleRows(j * part_->r + films_[i].first_force, films_[i].forces) +=
          from.middleRows(j * films_[i].forces, films_[i].forces);
  }
  // Own states are ordered by state, then column, then node: those of a film, and of all in one column [m x own].
  [[nodiscard]] double* film(std::size_t i, std::vector<double>& own, Index columns) const {
    return own.data() + films_[i].first * degree() * columns;
  }
  [[nodiscard]] auto states(std::vector<double>& own, Index c, Index columns) const {
    return Map<MatrixXd, 0, Eigen::OuterStride<>>(own.data() + c * degree(), degree(), own_,
                                                  Eigen::OuterStride<>(degree() * columns));
  }
  // work(first column, core, own) with room for the columns that pass together.
  template <class Work>
  void in_parts(Index all, const Work& work) const {
    constexpr Index in_cache = 8;  // columns of own states
    MatrixXd core;
    std::vector<double> own;
    for (Index first = 0; first < all; first += core.cols()) {
      core.resize(degree() * part_->n, films_.empty() ? all : std::min(in_cache, all - first));
      own.resize(static_cast<std::size_t>(degree() * own_ * core.cols()));
      work(first, core, own);
    }
  }
  // [S; -Q] v for v [m w x k], and eta [m w x k] += its transpose times v.
  [[nodiscard]] MatrixXd law(const MatrixXd& v) const {
    if (!films_.empty()) return law_ * v;
    MatrixXd out(last_, v.cols());
    for (Index j = 0; j < degree(); ++j)
      out.middleRows(j * part_->r, part_->r).noalias() = tangent(j) * v.middleRows(j * part_->w, part_->w);
    return out;
  }
  void add_law_transposed(const VectorXd& v, MatrixXd& eta) const {
    if (!films_.empty()) eta.noalias() += law_.transpose() * v;
    for (Index j = 0; films_.empty() && j < degree(); ++j)
      eta.middleRows(j * part_->w, part_->w).noalias() += tangent(j).transpose() * v.segment(j * part_->r, part_->r);
  }
  // Made when it is first wanted.
  [[nodiscard]] const core::DenseLu<double>& small() const {
    if (small_.size() > 0) return small_;
    MatrixXd k = MatrixXd::Identity(last_, last_), column;
    for (std::size_t i = 0; i < films_.size(); ++i)
      for (Index c = 0; c < separators(i); ++c) {
        column = MatrixXd::Zero(last_, 1);
        add_forces(i, -blocks_[i]->f_own.col(c), column);
        column.middleRows(separators_[i], separators(i)) = blocks_[i]->sigma.col(c);
        k.col(separators_[i] + c) = column;
      }
    k.leftCols(degree() * part_->r) -= law(part_->vy);
    small_.compute(k);
    return small_;
  }
  // core = z [mn x columns] becomes x, and right-hand sides of own states become states; `inputs` are V z, and `force`
  // [m r x columns] is added to the forces where it is not empty.
  void respond(const MatrixXd& inputs, const MatrixXd& force, MatrixXd& core, std::vector<double>& own) const {
    const Index m = degree(), columns = core.cols(), forces = m * part_->r;
    MatrixXd right = law(inputs), from_film;
    if (force.size() > 0) right.topRows(forces) += force;
    for (std::size_t i = 0; i < films_.size(); ++i) {
      double* s = film(i, own, columns);
      const OwnShape& shape = blocks_[i]->shape();
      blocks_[i]->eliminate(columns, s, from_film);
      add_forces(i, from_film, right);
      for (Index a = shape.interior(); a < shape.count; ++a)
        right.middleRows(separators_[i] + m * (a - shape.interior()), m) +=
            Map<const MatrixXd>(s + a * m * columns, m, columns);
    }
    const MatrixXd answer = small().solve(right);
    core.noalias() += part_->y * answer.topRows(forces);
    if (films_.empty()) return;
    MatrixXd eta = inputs, mine;
    eta.noalias() += part_->vy * answer.topRows(forces);
    for (std::size_t i = 0; i < films_.size(); ++i) {
      mine.resize(m * active(i), columns);
      for (Index c = 0; c < active(i); ++c)
        for (Index j = 0; j < m; ++j) mine.row(c * m + j) = eta.row(input_row(i, j, c));
      blocks_[i]->substitute(columns, film(i, own, columns), mine, answer.middleRows(separators_[i], separators(i)));
    }
  }

  std::shared_ptr<const Part> part_;
  std::vector<MatrixXd> tangents_;             // df/dw at the points
  std::span<const problem::OwnStates> films_;  // with own states
  std::vector<std::unique_ptr<OwnBlock>> blocks_;
  std::vector<Index> separators_;  // where those of each film begin in the small system
  Index n_, own_ = 0, last_;       // all states, own ones, size of the small system
  MatrixXd law_;                   // [S; -Q] with own states
  mutable core::DenseLu<double> small_;
};

}  // namespace

std::unique_ptr<Interval> make_low_rank_interval(std::shared_ptr<const LinearPart> part,
                                                 std::vector<MatrixXd> tangents) {
  return std::make_unique<ThinInterval<LinearPart>>(std::move(part), std::move(tangents));
}

std::unique_ptr<Interval> make_own_interval(std::shared_ptr<const LinearPart> part,
                                            const std::vector<problem::OwnStates>& films,
                                            const problem::ScaledPoint& scales,
                                            const std::vector<const problem::PointState*>& points) {
  return std::make_unique<ThinInterval<LinearPart>>(std::move(part), films, scales, points);
}

std::shared_ptr<const SparsePart> make_sparse_part(const Scheme& scheme, double length,
                                                   const problem::ThinBlocks& blocks) {
  return std::make_shared<SparsePart>(scheme, length, blocks);
}

std::unique_ptr<Interval> make_sparse_interval(std::shared_ptr<const SparsePart> part, std::vector<MatrixXd> tangents) {
  return std::make_unique<ThinInterval<SparsePart>>(std::move(part), std::move(tangents));
}

}  // namespace whirl::solve
