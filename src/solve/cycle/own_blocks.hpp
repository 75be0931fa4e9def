#pragma once
// The band of one film in one interval, for degree M of the polynomials, or any for M = 0.

#include <vector>

#include "solve/cycle/own_block.hpp"

namespace whirl::solve {

template <int M>
class OwnBand final : public OwnBlock {
public:
  using Index = Eigen::Index;
  using MatrixXd = Eigen::MatrixXd;
  using VectorXd = Eigen::VectorXd;
  OwnBand(const Scheme& scheme, const problem::OwnStates& film)
      : OwnBlock(OwnShape(film)), scheme_(scheme), degree_(scheme.degree), forces_(film.forces), inputs_(film.inputs) {
    value_ = scheme.value.rightCols(degree_);
    const auto entries = static_cast<std::size_t>(shape_.count * shape_.width() * degree_);
    by_state_.resize(entries);
    by_rate_.resize(entries);
    at_start_.resize(entries);
    force_.resize(static_cast<std::size_t>(shape_.count * degree_ * forces_));
    input_.resize(static_cast<std::size_t>(shape_.count * degree_ * inputs_));
    factor_.resize(static_cast<std::size_t>(shape_.interior() * shape_.width() * degree_ * degree_));
  }
  void factorise(const std::vector<const problem::PointState*>& points, std::size_t index,
                 const problem::ScaledPoint& scales, Index first, double length, bool whole) override;
  void eliminate(Index columns, double* y, MatrixXd& force) const override;
  void substitute(Index columns, double* y, const MatrixXd& eta, const MatrixXd& separators) const override;
  void start(Index columns, const double* s, Index stride, double* y, MatrixXd& force) const override;
  void add_inputs(double factor, const double* eta, double* y) const override;
  void multiply(const double* start, const double* s, double* rows, VectorXd& force) const override;
  void substitute_transposed(const double* y, VectorXd& border) const override;
  void eliminate_transposed(double* y, const double* force) const override;
  void inputs_transposed(const double* y, double* eta) const override;
  void start_transposed(const double* y, const double* force, double* s) const override;

private:
  [[nodiscard]] Index m() const { return M > 0 ? M : degree_; }
  [[nodiscard]] const double* band(const std::vector<double>& of, Index row, Index slot) const {
    return of.data() + (row * shape_.width() + slot) * m();
  }
  [[nodiscard]] const double* input(Index state, Index c) const { return input_.data() + (state * inputs_ + c) * m(); }
  [[nodiscard]] const double* force_of(Index state) const { return force_.data() + state * forces_ * m(); }
  [[nodiscard]] const double* force_rate_of(Index state) const { return force_rate_.data() + state * forces_ * m(); }
  [[nodiscard]] bool rated() const { return !force_rate_.empty(); }
  // The blocks of L left of the diagonal, the inverse of the diagonal one, those of the unit U right of it.
  [[nodiscard]] double* factor(Index row, Index slot) {
    return factor_.data() + (row * shape_.width() + slot) * m() * m();
  }
  [[nodiscard]] const double* factor(Index row, Index slot) const {
    return factor_.data() + (row * shape_.width() + slot) * m() * m();
  }
  // Z of one state [m x (m active + m separators)].
  [[nodiscard]] double* z(Index row) { return z_.data() + row * m() * border_; }
  [[nodiscard]] const double* z(Index row) const { return z_.data() + row * m() * border_; }
  // out = T(row, column at slot) [m x m].
  void block(Index row, Index slot, double* out) const {
    const double *s = band(by_state_, row, slot), *r = band(by_rate_, row, slot);
    for (Index l = 0; l < m(); ++l)
      for (Index j = 0; j < m(); ++j) out[l * m() + j] = value_(j, l) * s[j] + slope_(j, l) * r[j];
  }
  void read(const std::vector<const problem::PointState*>& points, std::size_t index,
            const problem::ScaledPoint& scales, Index first);
  void factorise_band();
  void find_border();
  // force += (F value + F' slope) v for v [m x columns] of one state.
  void add_force(Index state, const double* v, Index columns, double* force) const {
    add_force(value_, force_of(state), v, columns, force);
    if (rated()) add_force(slope_, force_rate_of(state), v, columns, force);
  }
  void add_force(const MatrixXd& by, const double* of, const double* v, Index columns, double* force) const {
    for (Index c = 0; c < columns; ++c)
      for (Index j = 0; j < m(); ++j) {
        double at_point = 0;
        for (Index l = 0; l < m(); ++l) at_point += by(j, l) * v[c * m() + l];
        for (Index d = 0; d < forces_; ++d) force[(c * m() + j) * forces_ + d] += of[d * m() + j] * at_point;
      }
  }
  // What force d at point j makes of the value at the start of the interval.
  [[nodiscard]] double force_at_start(Index state, Index d, Index j) const {
    const double by_value = scheme_.value(j, 0) * force_of(state)[d * m() + j];
    return rated() ? by_value + scheme_.slope(j, 0) / length_ * force_rate_of(state)[d * m() + j] : by_value;
  }

  const Scheme& scheme_;
  Index degree_, forces_, inputs_, border_ = 0;
  double length_ = 0;
  MatrixXd value_, slope_;                             // V and D/H
  std::vector<double> by_state_, by_rate_, at_start_;  // dg/ds, dg/ds' and minus A0 by row, slot, point
  std::vector<double> force_, input_;                  // df/ds by state, force, point; dg/dw by state, input, point
  std::vector<double> force_rate_;                     // df/ds', or empty
  std::vector<double> factor_, z_;
};

}  // namespace whirl::solve
