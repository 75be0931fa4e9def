#include <optional>

#include "solve/cycle/pencil.hpp"
#include "solve/cycle/time_modes.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/solve/cycle/interval.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of W0 = A at df/dw = 0 only the blocks are at hand from the start. Its factors, Y = W0^-1 (I x B) and V Y are made
/// when the first interval of this length is solved, since a Newton step by time modes solves none.
class SparsePart : public ThinPart<Eigen::SparseMatrix<double>> {
public:
  using ThinPart::ThinPart;
  mutable MatrixXd y, vy;

  void prepare() const {
    if (y.size() > 0) return;
    modes_ = interval_modes(scheme, length);
    pencil_.compute(l1, l0, kinematic, modes_.lambda);
    y = MatrixXd::Zero(scheme.degree * n, scheme.degree * r);
    for (Index j = 0; j < scheme.degree; ++j) y.block(j * n, j * r, n, r) = MatrixXd(b);
    solve(y);
    vy = inputs(y);
  }
  /// x := W0^-1 x and W0^-T x [mn x k].
  void solve(MatrixXd& x) const { apply(x, modes_.into, modes_.out, false); }
  void solve_transposed(MatrixXd& x) const { apply(x, modes_.out, modes_.into, true); }

private:
  void apply(MatrixXd& x, const MatrixXd& into, const MatrixXd& out, bool adjoint) const {
    const Index m = scheme.degree, lanes = modes_.lanes, columns = x.cols(), count = lanes * columns;
    MatrixXd all(2 * count, n);
    for (Index q = 0; q < columns; ++q) {
      const MatrixXd hat = into.transpose() * x.col(q).reshaped(n, m).transpose();
      all.middleRows(q * lanes, lanes) = hat.topRows(lanes);
      all.middleRows(count + q * lanes, lanes) = hat.bottomRows(lanes);
    }
    adjoint ? pencil_.solve_adjoint(all, columns) : pencil_.solve(all, columns);
    for (Index q = 0; q < columns; ++q)
      x.col(q).reshaped(n, m) = (out.leftCols(lanes) * all.middleRows(q * lanes, lanes) +
                                 out.rightCols(lanes) * all.middleRows(count + q * lanes, lanes))
                                    .transpose();
  }

  mutable TimeModes modes_;
  mutable Pencil pencil_;
};

namespace {

// A = W0 - (I x B) S V, by A^-1 y = z + Y K^-1 S V z, z = W0^-1 y, K = I - S V Y.
template <class Part>
class ThinInterval final : public Interval {
public:
  ThinInterval(std::shared_ptr<const Part> part, std::vector<MatrixXd> tangents)
      : part_(std::move(part)), s_(std::move(tangents)) {}

  void solve(MatrixXd& y) const override {
    const auto& k = core();
    part_->solve(y);
    y.noalias() += part_->y * k.solve(times_s(part_->inputs(y)));
  }
  void solve_transposed(MatrixXd& y) const override {
    // A^-T y = W0^-T (y + V^T S^T K^-T Y^T y)
    const MatrixXd t = core().solve_transposed(part_->y.transpose() * y);
    y += part_->inputs_transposed(times_s_transposed(t));
    part_->solve_transposed(y);
  }
  void carry(const MatrixXd& rows, MatrixXd& state, MatrixXd& added) const override {
    if constexpr (std::is_same_v<Part, LinearPart>)
      if (state.cols() >= part_->n) {
        MatrixXd adjoint = rows.transpose();
        solve_transposed(adjoint);
        added.noalias() -= start_transposed(adjoint).transpose() * state;
        // Gamma = -E A^-1 A0 [n x n], E the last block row.
        const MatrixXd gamma = part_->free.bottomRows(part_->n) +
                               part_->y.bottomRows(part_->n) * core().solve(times_s(part_->inputs_free));
        state = (gamma * state).eval();
        return;
      }
    Interval::carry(rows, state, added);
  }
  MatrixXd start(const MatrixXd& x) const override {
    MatrixXd out(part_->scheme.degree * part_->n, x.cols());
    const MatrixXd l1 = part_->l1 * x;
    for (int j = 0; j < part_->scheme.degree; ++j) {
      auto rows = out.middleRows(j * part_->n, part_->n);
      rows = slope(j, 0) * l1;
      if (value(j, 0) != 0) rows += value(j, 0) * at_point(j, x);
    }
    return out;
  }
  MatrixXd start_transposed(const MatrixXd& y) const override {
    MatrixXd x = MatrixXd::Zero(part_->n, y.cols());
    for (int j = 0; j < part_->scheme.degree; ++j) {
      const MatrixXd rows = y.middleRows(j * part_->n, part_->n);
      x += slope(j, 0) * (part_->l1.transpose() * rows);
      if (value(j, 0) == 0) continue;
      x += value(j, 0) * (part_->l0.transpose() * rows);
      x -= value(j, 0) *
           (part_->c.transpose() * MatrixXd(tangent(j).transpose() * MatrixXd(part_->b.transpose() * rows)));
    }
    return x;
  }
  VectorXd multiply(const VectorXd& x_start, const VectorXd& x) const override {
    const Index n = part_->n, m = part_->scheme.degree;
    VectorXd y(m * n);
    for (int j = 0; j < m; ++j) {
      VectorXd state = value(j, 0) * x_start, rate = slope(j, 0) * x_start;
      for (int l = 1; l <= m; ++l) {
        if (value(j, l) != 0) state += value(j, l) * x.segment((l - 1) * n, n);
        rate += slope(j, l) * x.segment((l - 1) * n, n);
      }
      y.segment(j * n, n) = at_point(j, state);
      y.segment(j * n, n) += part_->l1 * rate;
    }
    return y;
  }
  MatrixXd block(int j, int l) const override {
    const MatrixXd forces = MatrixXd(part_->b) * tangent(j) * MatrixXd(part_->c);
    return value(j, l) * (MatrixXd(part_->l0) - forces) + slope(j, l) * MatrixXd(part_->l1);
  }

private:
  [[nodiscard]] double value(int j, int l) const { return part_->scheme.value(j, l); }
  [[nodiscard]] double slope(int j, int l) const { return part_->scheme.slope(j, l) / part_->length; }
  [[nodiscard]] const MatrixXd& tangent(int j) const { return s_[static_cast<std::size_t>(j)]; }
  // (L0 - B S_j C) x
  template <class X>
  [[nodiscard]] X at_point(int j, const X& x) const {
    X out = part_->l0 * x;
    out -= part_->b * X(tangent(j) * X(part_->c * x));
    return out;
  }
  [[nodiscard]] const core::DenseLu<double>& core() const {
    part_->prepare();
    const Index size = part_->scheme.degree * part_->r;
    if (k_.size() == 0) k_.compute(MatrixXd::Identity(size, size) - times_s(part_->vy));
    return k_;
  }
  // S v for v [mw x k] and S^T v for v [mr x k], block by block.
  [[nodiscard]] MatrixXd times_s(const MatrixXd& v) const {
    const Index r = part_->r, w = part_->w;
    MatrixXd out(part_->scheme.degree * r, v.cols());
    for (int j = 0; j < part_->scheme.degree; ++j)
      out.middleRows(j * r, r).noalias() = tangent(j) * v.middleRows(j * w, w);
    return out;
  }
  [[nodiscard]] MatrixXd times_s_transposed(const MatrixXd& v) const {
    const Index r = part_->r, w = part_->w;
    MatrixXd out(part_->scheme.degree * w, v.cols());
    for (int j = 0; j < part_->scheme.degree; ++j)
      out.middleRows(j * w, w).noalias() = tangent(j).transpose() * v.middleRows(j * r, r);
    return out;
  }

  std::shared_ptr<const Part> part_;
  std::vector<MatrixXd> s_;
  mutable core::DenseLu<double> k_;
};

}  // namespace

std::unique_ptr<Interval> make_low_rank_interval(std::shared_ptr<const LinearPart> part,
                                                 std::vector<MatrixXd> tangents) {
  return std::make_unique<ThinInterval<LinearPart>>(std::move(part), std::move(tangents));
}

std::shared_ptr<const SparsePart> make_sparse_part(const Scheme& scheme, double length,
                                                   const problem::ThinBlocks& blocks) {
  return std::make_shared<SparsePart>(scheme, length, blocks);
}

std::unique_ptr<Interval> make_sparse_interval(std::shared_ptr<const SparsePart> part, std::vector<MatrixXd> tangents) {
  return std::make_unique<ThinInterval<SparsePart>>(std::move(part), std::move(tangents));
}

}  // namespace whirl::solve
