#include "whirl/problem/scaled_point.hpp"

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/matrix_rows.hpp"

namespace whirl::problem {
namespace {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd to_eigen(Vec v) {
  const core::ReadArray a(v);
  return Map<const VectorXd>(a.data(), a.size());
}

// out = diag(rows) block diag(columns)
void scale(const SparseBlock& block, const VectorXd& rows, const VectorXd& columns, MatrixXd& out) {
  out.setZero(block.rows(), block.cols());
  for (Index j = 0; j < block.cols(); ++j)
    for (SparseBlock::InnerIterator it(block, j); it; ++it) out(it.row(), j) = rows(it.row()) * it.value() * columns(j);
}

void scale(const SparseBlock& block, const VectorXd& rows, const VectorXd& columns, SparseBlock& out) {
  out = block;
  for (Index j = 0; j < out.cols(); ++j)
    for (SparseBlock::InnerIterator it(out, j); it; ++it) it.valueRef() *= rows(it.row()) * columns(j);
}

}  // namespace

ScaledPoint::ScaledPoint(System& system, BlockStructure* structure, bool sparse)
    : system_(system), structure_(structure), sparse_(sparse && structure) {
  core::require(core::size_of(system.comm()) == 1, "a scaled point needs the whole system on one rank");
  x_ = core::make_vector(system.comm(), system.size(), PETSC_DETERMINE);
  xdot_ = core::duplicate(x_.get());
  f_ = core::duplicate(x_.get());
  system.scales(x_.get(), f_.get());
  state_scale_ = to_eigen(x_.get());
  residual_scale_ = to_eigen(f_.get());
  if (structure_) {
    refresh();
  } else {
    matrix_ = system.make_jacobian();
  }
}

void ScaledPoint::refresh() {
  if (!structure_) return;
  const Index n = structure_->size();
  const VectorXd rows = residual_scale_.head(n).cwiseInverse(), columns = state_scale_.head(n);
  const VectorXd forces = VectorXd::Ones(structure_->n_forces()), inputs = VectorXd::Ones(structure_->n_inputs());
  const auto all = [&](auto& blocks) {
    scale(structure_->l0(), rows, columns, blocks.l0);
    scale(structure_->l1(), rows, columns, blocks.l1);
    scale(structure_->b(), rows, forces, blocks.b);
    scale(structure_->c(), inputs, columns, blocks.c);
    blocks.kinematic = system_.kinematic();
  };
  if (sparse_)
    all(thin_);
  else
    all(dense_);
}

void ScaledPoint::refresh_speed() {
  if (!structure_) return;
  const Index n = structure_->size();
  const VectorXd rows = residual_scale_.head(n).cwiseInverse();
  const VectorXd columns = state_scale_.head(n);
  const auto scaled = [&](auto& blocks) {
    scale(structure_->l0(), rows, columns, blocks.l0);
    scale(structure_->l1(), rows, columns, blocks.l1);
  };
  if (sparse_)
    scaled(thin_);
  else
    scaled(dense_);
}

void ScaledPoint::put(const VectorXd& x, const VectorXd& xdot) {
  const core::WriteArray xa(x_.get()), da(xdot_.get());
  Map<VectorXd>(xa.data(), size()) = x.cwiseProduct(state_scale_);
  Map<VectorXd>(da.data(), size()) = xdot.cwiseProduct(state_scale_);
}

void ScaledPoint::structured(double angle, const VectorXd& x, const VectorXd& xdot, bool tangents,
                             Eigen::Ref<VectorXd> out, PointState& at) {
  const Index n = structure_->size(), k = own_states();
  at.value = x.cwiseProduct(state_scale_);
  at.rate = xdot.cwiseProduct(state_scale_);
  with_blocks([&](const auto& blocks) { inputs_.noalias() = blocks.c * x.head(n); });
  structure_->films(inputs_, at.value.data() + n, at.rate.data() + n, tangents, at.films);
  structure_->load(angle, load_);
  auto core = out.head(n);
  with_blocks([&](const auto& blocks) {
    core.noalias() = blocks.l0 * x.head(n);
    core.noalias() += blocks.l1 * xdot.head(n);
    core -= load_.cwiseQuotient(residual_scale_.head(n));
    core.noalias() -= blocks.b * at.films.forces;
  });
  if (k > 0) out.tail(k) = at.films.residual.cwiseQuotient(residual_scale_.tail(k));
}

void ScaledPoint::residual(double angle, const VectorXd& x, const VectorXd& xdot, Eigen::Ref<VectorXd> out,
                           PointState& keep) {
  structured(angle, x, xdot, true, out, keep);
}

void ScaledPoint::residual(double angle, const VectorXd& x, const VectorXd& xdot, Eigen::Ref<VectorXd> out) {
  if (structure_) return structured(angle, x, xdot, false, out, point_);
  put(x, xdot);
  system_.residual(angle, x_.get(), xdot_.get(), f_.get());
  out = to_eigen(f_.get()).cwiseQuotient(residual_scale_);
}

void ScaledPoint::parameter_derivative(double angle, const PointState& at, Eigen::Ref<VectorXd> out) {
  structure_->parameter_derivative(angle, at.value, at.rate, at.films, d_parameter_);
  out = d_parameter_.cwiseQuotient(residual_scale_);
}

void ScaledPoint::times_rates(const PointState& at, const VectorXd& v, Eigen::Ref<VectorXd> out) const {
  const Index n = structure_->size();
  with_blocks([&](const auto& blocks) { out.head(n).noalias() = blocks.l1 * v.head(n); });
  out.tail(own_states()).setZero();
  for (std::size_t i = 0; i < structure_->own().size(); ++i) {
    const OwnStates& film = structure_->own()[i];
    const core::ThinRows& forces = at.films.own[i].force_rates;
    const Index first = n + film.first;
    if (forces.rows() > 0)
      with_blocks([&](const auto& blocks) {
        out.head(n) -= blocks.b.middleCols(film.first_force, film.forces) *
                       (forces * v.segment(first, film.count).cwiseProduct(state_scale_.segment(first, film.count)));
      });
    const std::vector<double>& values = at.films.own[i].d_rates;
    for (std::size_t e = 0; e < values.size(); ++e) {
      const Index row = first + film.rates[e].row, column = first + film.rates[e].column;
      out(row) += values[e] * v(column) * state_scale_(column) / residual_scale_(row);
    }
  }
}

void ScaledPoint::times(const PointState& at, const VectorXd& a, const VectorXd& b, Eigen::Ref<VectorXd> out) const {
  const Index n = structure_->size();
  times_rates(at, b, out);
  VectorXd inputs;
  with_blocks([&](const auto& blocks) {
    inputs = blocks.c * a.head(n);
    out.head(n).noalias() += blocks.l0 * a.head(n);
  });
  VectorXd forces = at.films.d_inputs * inputs;
  for (std::size_t i = 0; i < structure_->own().size(); ++i) {
    const OwnStates& film = structure_->own()[i];
    const core::PartResponse& t = at.films.own[i];
    const Index first = n + film.first;
    const VectorXd s = a.segment(first, film.count).cwiseProduct(state_scale_.segment(first, film.count));
    forces.segment(film.first_force, film.forces) += t.forces * s;
    VectorXd rows = t.inputs.transpose() * inputs.segment(film.first_input, film.inputs);
    for (std::size_t e = 0; e < t.d_states.size(); ++e)
      rows(film.states[e].row) += t.d_states[e] * s(film.states[e].column);
    out.segment(first, film.count) += rows.cwiseQuotient(residual_scale_.segment(first, film.count));
  }
  with_blocks([&](const auto& blocks) { out.head(n).noalias() -= blocks.b * forces; });
}

void ScaledPoint::times_transposed(const PointState& at, const Eigen::Ref<const VectorXd>& y, VectorXd& by_state,
                                   VectorXd& by_rate) const {
  const Index n = structure_->size();
  by_state = by_rate = VectorXd::Zero(size());
  VectorXd forces;
  with_blocks([&](const auto& blocks) {
    by_rate.head(n) = blocks.l1.transpose() * y.head(n);
    forces = -(blocks.b.transpose() * y.head(n));
  });
  VectorXd inputs = at.films.d_inputs.transpose() * forces;
  for (std::size_t i = 0; i < structure_->own().size(); ++i) {
    const OwnStates& film = structure_->own()[i];
    const core::PartResponse& t = at.films.own[i];
    const Index first = n + film.first;
    const VectorXd rows = y.segment(first, film.count).cwiseQuotient(residual_scale_.segment(first, film.count));
    inputs.segment(film.first_input, film.inputs) += t.inputs * rows;
    const auto own = forces.segment(film.first_force, film.forces);
    VectorXd s = t.forces.transpose() * own, r = VectorXd::Zero(film.count);
    if (t.force_rates.rows() > 0) r = t.force_rates.transpose() * own;
    for (std::size_t e = 0; e < t.d_states.size(); ++e)
      s(film.states[e].column) += t.d_states[e] * rows(film.states[e].row);
    for (std::size_t e = 0; e < t.d_rates.size(); ++e)
      r(film.rates[e].column) += t.d_rates[e] * rows(film.rates[e].row);
    by_state.segment(first, film.count) = s.cwiseProduct(state_scale_.segment(first, film.count));
    by_rate.segment(first, film.count) = r.cwiseProduct(state_scale_.segment(first, film.count));
  }
  with_blocks([&](const auto& blocks) {
    by_state.head(n) = blocks.l0.transpose() * y.head(n);
    by_state.head(n) += blocks.c.transpose() * inputs;
  });
}

void ScaledPoint::matrices(const PointState& at, MatrixXd& jx, MatrixXd& jxdot) const {
  const Index n = structure_->size();
  jx.setZero(size(), size());
  jxdot.setZero(size(), size());
  DenseBlocks made;
  if (sparse_) made = {MatrixXd(thin_.l1), MatrixXd(thin_.l0), MatrixXd(thin_.b), MatrixXd(thin_.c), {}};
  const DenseBlocks& all = sparse_ ? made : dense_;
  jx.topLeftCorner(n, n) = all.l0;
  jx.topLeftCorner(n, n).noalias() -= all.b * (at.films.d_inputs * all.c);
  jxdot.topLeftCorner(n, n) = all.l1;
  for (std::size_t i = 0; i < structure_->own().size(); ++i) {
    const OwnStates& film = structure_->own()[i];
    const core::PartResponse& t = at.films.own[i];
    const Index first = n + film.first;
    const auto rows = residual_scale_.segment(first, film.count).cwiseInverse().asDiagonal();
    jx.block(first, 0, film.count, n).noalias() =
        rows * (t.inputs.transpose() * all.c.middleRows(film.first_input, film.inputs));
    jx.block(0, first, n, film.count).noalias() = -all.b.middleCols(film.first_force, film.forces) * t.forces *
                                                  state_scale_.segment(first, film.count).asDiagonal();
    if (t.force_rates.rows() > 0)
      jxdot.block(0, first, n, film.count).noalias() = -all.b.middleCols(film.first_force, film.forces) *
                                                       t.force_rates *
                                                       state_scale_.segment(first, film.count).asDiagonal();
    const auto add = [&](const std::vector<EntryPlace>& places, const std::vector<double>& values, MatrixXd& out) {
      for (std::size_t e = 0; e < places.size(); ++e) {
        const Index row = first + places[e].row, column = first + places[e].column;
        out(row, column) += values[e] * state_scale_(column) / residual_scale_(row);
      }
    };
    add(film.states, t.d_states, jx);
    add(film.rates, t.d_rates, jxdot);
  }
}

void ScaledPoint::linearise(double angle, const VectorXd& x, const VectorXd& xdot, MatrixXd& jx, MatrixXd& jxdot,
                            VectorXd* d_parameter) {
  if (structure_) {
    VectorXd f(size());
    structured(angle, x, xdot, true, f, point_);
    matrices(point_, jx, jxdot);
    if (!d_parameter) return;
    d_parameter->resize(size());
    parameter_derivative(angle, point_, *d_parameter);
    return;
  }
  put(x, xdot);
  const auto scaled = [&]() -> MatrixXd {
    return residual_scale_.cwiseInverse().asDiagonal() * core::dense(matrix_.get()) * state_scale_.asDiagonal();
  };
  system_.jacobian(angle, x_.get(), xdot_.get(), 1, 0, matrix_.get());
  jx = scaled();
  system_.jacobian(angle, x_.get(), xdot_.get(), 0, 1, matrix_.get());
  jxdot = scaled();
  if (!d_parameter) return;
  system_.parameter_derivative(angle, x_.get(), xdot_.get(), f_.get());
  *d_parameter = to_eigen(f_.get()).cwiseQuotient(residual_scale_);
}

VectorXd ScaledPoint::rate(double angle, const VectorXd& x) {
  VectorXd f(size()), rate = VectorXd::Zero(size());
  MatrixXd jx, jxdot;
  // The first pass finds the rates of own states, the second one the forces that are cut off at these.
  for (int pass = 0; pass < 2; ++pass) {
    residual(angle, x, rate, f);
    linearise(angle, x, rate, jx, jxdot, nullptr);
    rate -= core::DenseLu<double>(jxdot).solve(f);
  }
  return rate;
}

}  // namespace whirl::problem
