#include <Eigen/LU>
#include <optional>

#include "solve/cycle/pencil.hpp"
#include "solve/cycle/time_modes.hpp"
#include "whirl/solve/cycle/interval.hpp"

namespace whirl::solve {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of W0 = A at df/dw = 0 only what products need is at hand from the start. Its factors, Y = W0^-1 (I x B) and V Y are
/// made when the first interval of this length is solved, since a Newton step by time modes solves none.
class SparsePart {
public:
  SparsePart(const Scheme& sc, double len, const ThinBlocks& all) : scheme(sc), length(len), blocks(all) {}

  const Scheme& scheme;
  const double length;
  const ThinBlocks& blocks;
  [[nodiscard]] Index n() const { return blocks.l1.rows(); }
  [[nodiscard]] Index r() const { return blocks.b.cols(); }
  [[nodiscard]] Index w() const { return blocks.c.rows(); }

  /// x := W0^-1 x and W0^-T x [mn x k].
  void solve(MatrixXd& x) const { apply(x, modes().into, modes().out, false); }
  void solve_transposed(MatrixXd& x) const { apply(x, modes().out, modes().into, true); }
  /// V x [mw x k], and V^T s [mn x k].
  [[nodiscard]] MatrixXd inputs(const MatrixXd& x) const {
    MatrixXd out = MatrixXd::Zero(scheme.degree * w(), x.cols());
    for (Index l = 0; l < scheme.degree; ++l) {
      const MatrixXd cx = blocks.c * x.middleRows(l * n(), n());
      for (Index j = 0; j < scheme.degree; ++j)
        if (scheme.value(j, l + 1) != 0) out.middleRows(j * w(), w()) += scheme.value(j, l + 1) * cx;
    }
    return out;
  }
  [[nodiscard]] MatrixXd inputs_transposed(const MatrixXd& s) const {
    MatrixXd out = MatrixXd::Zero(scheme.degree * n(), s.cols());
    for (Index j = 0; j < scheme.degree; ++j) {
      const MatrixXd cs = blocks.c.transpose() * s.middleRows(j * w(), w());
      for (Index l = 0; l < scheme.degree; ++l)
        if (scheme.value(j, l + 1) != 0) out.middleRows(l * n(), n()) += scheme.value(j, l + 1) * cs;
    }
    return out;
  }
  [[nodiscard]] const MatrixXd& y() const {
    if (y_.size() == 0) {
      y_ = MatrixXd::Zero(scheme.degree * n(), scheme.degree * r());
      for (Index j = 0; j < scheme.degree; ++j) y_.block(j * n(), j * r(), n(), r()) = MatrixXd(blocks.b);
      solve(y_);
      vy_ = inputs(y_);
    }
    return y_;
  }
  [[nodiscard]] const MatrixXd& vy() const {
    (void)y();
    return vy_;
  }

private:
  [[nodiscard]] const TimeModes& modes() const {
    if (!modes_) {
      modes_ = interval_modes(scheme, length);
      pencil_.compute(blocks.l1, blocks.l0, modes_->lambda);
    }
    return *modes_;
  }
  void apply(MatrixXd& x, const MatrixXd& into, const MatrixXd& out, bool adjoint) const {
    const Index m = scheme.degree, lanes = modes_->lanes, columns = x.cols(), count = lanes * columns;
    MatrixXd all(2 * count, n());
    for (Index q = 0; q < columns; ++q) {
      const MatrixXd hat = into.transpose() * x.col(q).reshaped(n(), m).transpose();
      all.middleRows(q * lanes, lanes) = hat.topRows(lanes);
      all.middleRows(count + q * lanes, lanes) = hat.bottomRows(lanes);
    }
    adjoint ? pencil_.solve_adjoint(all, columns) : pencil_.solve(all, columns);
    for (Index q = 0; q < columns; ++q)
      x.col(q).reshaped(n(), m) = (out.leftCols(lanes) * all.middleRows(q * lanes, lanes) +
                                   out.rightCols(lanes) * all.middleRows(count + q * lanes, lanes))
                                      .transpose();
  }

  mutable std::optional<TimeModes> modes_;
  mutable Pencil pencil_;
  mutable MatrixXd y_, vy_;
};

namespace {

class SparseInterval final : public Interval {
public:
  SparseInterval(std::shared_ptr<const SparsePart> part, std::vector<MatrixXd> tangents)
      : part_(std::move(part)), s_(std::move(tangents)) {}

  void solve(MatrixXd& y) const override {
    part_->solve(y);
    y.noalias() += part_->y() * core().solve(times_s(part_->inputs(y)));
  }
  void solve_transposed(MatrixXd& y) const override {
    // A^-T y = W0^-T (y + V^T S^T K^-T Y^T y)
    const MatrixXd t = core().transpose().solve(part_->y().transpose() * y);
    y += part_->inputs_transposed(times_s_transposed(t));
    part_->solve_transposed(y);
  }
  MatrixXd start(const MatrixXd& x) const override {
    MatrixXd out(part_->scheme.degree * part_->n(), x.cols());
    const MatrixXd l1 = part_->blocks.l1 * x;
    for (int j = 0; j < part_->scheme.degree; ++j) {
      auto rows = out.middleRows(j * part_->n(), part_->n());
      rows = (slope(j, 0) * l1).eval();
      if (value(j, 0) != 0) rows += value(j, 0) * at_point(j, x);
    }
    return out;
  }
  MatrixXd start_transposed(const MatrixXd& y) const override {
    MatrixXd x = MatrixXd::Zero(part_->n(), y.cols());
    for (int j = 0; j < part_->scheme.degree; ++j) {
      const MatrixXd rows = y.middleRows(j * part_->n(), part_->n());
      x += slope(j, 0) * (part_->blocks.l1.transpose() * rows);
      if (value(j, 0) == 0) continue;
      x += value(j, 0) * (part_->blocks.l0.transpose() * rows);
      x -= value(j, 0) *
           (part_->blocks.c.transpose() * (tangent(j).transpose() * MatrixXd(part_->blocks.b.transpose() * rows)));
    }
    return x;
  }
  VectorXd multiply(const VectorXd& x_start, const VectorXd& x) const override {
    const Index n = part_->n(), m = part_->scheme.degree;
    VectorXd y(m * n);
    for (int j = 0; j < m; ++j) {
      VectorXd state = value(j, 0) * x_start, rate = slope(j, 0) * x_start;
      for (int l = 1; l <= m; ++l) {
        if (value(j, l) != 0) state += value(j, l) * x.segment((l - 1) * n, n);
        rate += slope(j, l) * x.segment((l - 1) * n, n);
      }
      y.segment(j * n, n) = at_point(j, state) + part_->blocks.l1 * rate;
    }
    return y;
  }
  MatrixXd block(int j, int l) const override {
    return value(j, l) * at_point(j, MatrixXd::Identity(part_->n(), part_->n())) +
           slope(j, l) * MatrixXd(part_->blocks.l1);
  }

private:
  [[nodiscard]] double value(int j, int l) const { return part_->scheme.value(j, l); }
  [[nodiscard]] double slope(int j, int l) const { return part_->scheme.slope(j, l) / part_->length; }
  [[nodiscard]] const MatrixXd& tangent(int j) const { return s_[static_cast<std::size_t>(j)]; }
  // (L0 - B S_j C) x
  [[nodiscard]] MatrixXd at_point(int j, const MatrixXd& x) const {
    const ThinBlocks& p = part_->blocks;
    MatrixXd out = p.l0 * x;
    out -= p.b * (tangent(j) * MatrixXd(p.c * x));
    return out;
  }
  // K = I - S V Y
  [[nodiscard]] const Eigen::PartialPivLU<MatrixXd>& core() const {
    const Index size = part_->scheme.degree * part_->r();
    if (k_.rows() == 0) k_.compute(MatrixXd::Identity(size, size) - times_s(part_->vy()));
    return k_;
  }
  [[nodiscard]] MatrixXd times_s(const MatrixXd& v) const {
    const Index r = part_->r(), w = part_->w();
    MatrixXd out(part_->scheme.degree * r, v.cols());
    for (int j = 0; j < part_->scheme.degree; ++j)
      out.middleRows(j * r, r).noalias() = tangent(j) * v.middleRows(j * w, w);
    return out;
  }
  [[nodiscard]] MatrixXd times_s_transposed(const MatrixXd& v) const {
    const Index r = part_->r(), w = part_->w();
    MatrixXd out(part_->scheme.degree * w, v.cols());
    for (int j = 0; j < part_->scheme.degree; ++j)
      out.middleRows(j * w, w).noalias() = tangent(j).transpose() * v.middleRows(j * r, r);
    return out;
  }

  std::shared_ptr<const SparsePart> part_;
  std::vector<MatrixXd> s_;
  mutable Eigen::PartialPivLU<MatrixXd> k_;
};

}  // namespace

std::shared_ptr<const SparsePart> make_sparse_part(const Scheme& scheme, double length, const ThinBlocks& blocks) {
  return std::make_shared<SparsePart>(scheme, length, blocks);
}

std::unique_ptr<Interval> make_sparse_interval(std::shared_ptr<const SparsePart> part, std::vector<MatrixXd> tangents) {
  return std::make_unique<SparseInterval>(std::move(part), std::move(tangents));
}

}  // namespace whirl::solve
