#include "whirl/solve/newton/frequency_resolvent.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "solve/newton/frequency_hub.hpp"
#include "solve/newton/frequency_inverse.hpp"
#include "solve/newton/frequency_part.hpp"
#include "solve/newton/part_factors.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::solve {

using core::check;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;

MatrixXcd FrequencyResolvent::motions(const Coupled& p) const {
  const auto ports = static_cast<Index>(p.seen.size());
  MatrixXcd out(p.count, ports + border());
  out.leftCols(ports) = p.g(*at_rest_) + lambda_ * p.g(*rates_);
  if (border() > 0) out.col(ports) = b_.segment(begin_ + p.first, p.count);
  return out;
}

MatrixXcd FrequencyResolvent::forces(const Coupled& p) const {
  const auto ports = static_cast<Index>(p.of.size());
  MatrixXcd out(p.count, ports + border());
  out.leftCols(ports) = (p.f(*at_rest_) + lambda_ * p.f(*rates_)).conjugate();
  if (border() > 0) out.col(ports) = c_.segment(begin_ + p.first, p.count);
  return out;
}

template <class F>
MatrixXcd FrequencyResolvent::together(F&& columns) const {
  Index most = 0;
  std::vector<MatrixXcd> each;
  for (const auto& p : parts_) {
    each.push_back(columns(*p));
    most = std::max(most, each.back().cols());
  }
  MatrixXcd all = MatrixXcd::Zero(at_rest_->layout()->parts(), most);
  for (std::size_t i = 0; i < each.size(); ++i) all.block(parts_[i]->row, 0, each[i].rows(), each[i].cols()) = each[i];
  return all;
}

MatrixXcd FrequencyResolvent::rates_of_parts(const MatrixXcd& columns) const {
  Eigen::VectorXd in, out(columns.rows());
  MatrixXcd product(columns.rows(), columns.cols());
  for (Index k = 0; k < columns.cols(); ++k) {
    in = columns.col(k).real();
    rates_->multiply_parts(in.data(), out.data());
    product.col(k).real() = out;
    in = columns.col(k).imag();
    rates_->multiply_parts(in.data(), out.data());
    product.col(k).imag() = out;
  }
  return product;
}

MatrixXcd FrequencyResolvent::solve_parts(const MatrixXcd& right, bool adjoint) {
  if (adjoint || !eliminates_by_inverse()) {
    if (iterated_ && size() > core::plan::whole_states()) throw core::NotConverged(core::plan::too_large(size()));
    if (!factors_) factors_ = std::make_unique<PartFactors<Complex>>(at_rest_->layout());
    if (!factorised_) factors_->set(*at_rest_, rates_.get(), lambda_);
    factorised_ = true;
    return factors_->solve(right, adjoint);
  }
  MatrixXcd x(right.rows(), right.cols());
  if (iterated_)
    iterated_->apply_at(right.data(), x.data(), right.rows(), static_cast<int>(right.cols()));
  else
    inverse_->exact()->apply_at(core::span_of(right), core::span_of(x));
  return x;
}

FrequencyResolvent::Transfers FrequencyResolvent::evaluate(Complex lambda, bool slopes) {
  b_.resize(0);
  c_.resize(0);
  return eliminate(lambda, slopes);
}

// X = A^-1 G, X' = A^-1 (G' - A' X).
void FrequencyResolvent::eliminate_together(bool slopes) {
  const problem::Point here{0, x_.get(), rest_.get()};
  if (iterated_)
    iterated_->set_at(*at_rest_, *rates_, here, lambda_);
  else if (inverse_)
    inverse_->exact()->set_at(here, lambda_);
  const auto split = [&](const MatrixXcd& all, MatrixXcd Coupled::*to) {
    for (const auto& p : parts_)
      (*p).*to = all.block(p->row, 0, p->count, static_cast<Index>(p->seen.size()) + border());
  };
  split(solve_parts(together([this](const Coupled& p) { return motions(p); }), false), &Coupled::x);
  if (!slopes) return;
  const MatrixXcd right = together([this](const Coupled& p) -> MatrixXcd { return p.g(*rates_).cast<Complex>(); });
  split(solve_parts(right - rates_of_parts(together([](const Coupled& p) -> MatrixXcd { return p.x; })), false),
        &Coupled::dx);
}

// H = F X, H' = F' X + F X'.
FrequencyResolvent::Transfers FrequencyResolvent::eliminate(Complex lambda, bool slopes) {
  lambda_ = lambda;
  Transfers out;
  if (parts_.empty()) return out;
  factorised_ = false;
  try {
    eliminate_together(slopes);
  } catch (const core::NotConverged&) {
    if (!iterated_ || size() > core::plan::whole_states()) throw;
    iterated_.reset();
    eliminate_together(slopes);
  }
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Coupled& p = *parts_[i];
    const MatrixXcd f = forces(p).adjoint();
    Block block{f * p.x, {}};
    if (slopes)
      block.slope = p.f(*rates_).transpose().cast<Complex>() * p.x + f * p.dx;
    else
      p.dx.resize(0, 0);
    for (MatrixXcd* m : {&block.value, &block.slope})
      if (m->size() > 0)
        MPI_Allreduce(MPI_IN_PLACE, m->data(), static_cast<int>(m->size()), MPI_C_DOUBLE_COMPLEX, MPI_SUM, comm());
    if (!block.value.allFinite()) throw core::NotConverged("the equations of a film are singular at this frequency");
    out.push_back(std::move(block));
  }
  return out;
}

void FrequencyResolvent::factorise(Complex lambda, const ComplexVector& b, const ComplexVector& c) {
  b_ = b;
  c_ = c;
  const auto n = static_cast<int>(hub());
  std::vector<FrequencyHub::Block> blocks;
  const auto places = [&](const std::vector<PetscInt>& of) {
    std::vector<int> out(of.begin(), of.end());
    if (border() > 0) out.push_back(n);
    return out;
  };
  Transfers parts = eliminate(lambda, false);
  for (std::size_t i = 0; i < parts.size(); ++i)
    blocks.push_back({places(ports_[i].forces), places(ports_[i].seen), -parts[i].value});
  if (border() > 0) {
    std::vector<int> all(hub_numbers_.size());
    std::iota(all.begin(), all.end(), 0);
    blocks.push_back({all, {n}, b(hub_numbers_)});
    blocks.push_back({{n}, std::move(all), c(hub_numbers_).adjoint()});
  }
  bool regular = hub_->factorise(lambda, std::move(blocks), border());
  MPI_Allreduce(MPI_IN_PLACE, &regular, 1, MPI_CXX_BOOL, MPI_LAND, comm());
  if (!regular) throw core::NotConverged(singular_at_frequency);
}

// With y = A_i^-1 r_i: T z = r_h - sum F_i y_i, x_i = y_i - X_i z. Conjugate and transposed, with X_i = A_i^-1 G_i:
// T^* z = r_h - sum X_i^* r_i, x_i = A_i^-* (r_i - F_i^* z).
ComplexVector FrequencyResolvent::solve_here(const ComplexVector& r, Complex& corner, bool adjoint) {
  const PortLayout& layout = *at_rest_->layout();
  ComplexVector at_hub = ComplexVector::Zero(hub() + border()), x(r.size());
  MatrixXcd y(layout.parts(), 1);
  const auto picked = [&](const std::vector<PetscInt>& places) {
    ComplexVector out(static_cast<Index>(places.size()) + border());
    out.head(static_cast<Index>(places.size())) = at_hub(places);
    if (border() > 0) out(out.size() - 1) = at_hub(hub());
    return out;
  };
  layout.take(r.data(), y.data(), at_hub.data() + layout.first_of_hub());
  bool loaded = (y.array() != 0.0).any();
  if (!parts_.empty()) MPI_Allreduce(MPI_IN_PLACE, &loaded, 1, MPI_CXX_BOOL, MPI_LOR, comm());
  if (loaded) {
    if (!adjoint) y = solve_parts(y, false);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Coupled& p = *parts_[i];
      const ComplexVector moved = (adjoint ? p.x : forces(p)).adjoint() * y.middleRows(p.row, p.count);
      const std::vector<PetscInt>& places = adjoint ? ports_[i].seen : ports_[i].forces;
      for (std::size_t k = 0; k < places.size(); ++k) at_hub(places[k]) -= moved(static_cast<Index>(k));
      if (border() > 0) at_hub(hub()) -= moved(moved.size() - 1);
    }
  }
  if (core::size_of(comm()) > 1)
    MPI_Allreduce(MPI_IN_PLACE, at_hub.data(), static_cast<int>(at_hub.size()), MPI_C_DOUBLE_COMPLEX, MPI_SUM, comm());
  if (border() > 0) at_hub(hub()) += corner;
  at_hub = adjoint ? hub_->solve_adjoint(at_hub) : hub_->solve(at_hub);
  if (border() > 0) corner = at_hub(hub());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Coupled& p = *parts_[i];
    y.middleRows(p.row, p.count) -= adjoint ? forces(p) * picked(ports_[i].forces) : p.x * picked(ports_[i].seen);
  }
  if (adjoint && !parts_.empty()) y = solve_parts(y, true);
  layout.give(y.data(), at_hub.data() + layout.first_of_hub(), x.data());
  return x;
}

ComplexVector FrequencyResolvent::solve_whole(const ComplexVector& r, bool adjoint) {
  Complex corner = border() > 0 ? r(size()) : 0;
  ComplexVector out(r.size());
  out.head(size()) = whole(solve_here(r.segment(begin_, system_.local_size()), corner, adjoint));
  if (border() > 0) out(size()) = corner;
  return out;
}

std::vector<Complex> FrequencyResolvent::respond(const std::vector<Complex>& r) {
  const core::ReadArray states(state_scale_.get()), rows(row_scale_.get());
  const auto real = [](const core::ReadArray& a) { return Eigen::Map<const Eigen::ArrayXd>(a.data(), a.size()); };
  Complex unused = 0;
  const ComplexVector scaled = Eigen::Map<const ComplexVector>(r.data(), states.size()).array() * real(rows);
  std::vector<Complex> z(r.size());
  Eigen::Map<ComplexVector>(z.data(), states.size()) = solve_here(scaled, unused, false).array() * real(states);
  return z;
}

ComplexVector FrequencyResolvent::rates_times(const ComplexVector& v) const {
  const PetscInt n = system_.local_size();
  ComplexVector out(n);
  Eigen::VectorXd in = v.real().segment(begin_, n), product(n);
  rates_->multiply(in.data(), product.data());
  out.real() = product;
  in = v.imag().segment(begin_, n);
  rates_->multiply(in.data(), product.data());
  out.imag() = product;
  return whole(out);
}

ComplexVector FrequencyResolvent::whole(const ComplexVector& local) const {
  ComplexVector out(size());
  const core::Vector v = core::duplicate(rest_.get());
  for (const bool real : {true, false}) {
    {
      const core::WriteArray a(v.get());
      for (PetscInt i = 0; i < a.size(); ++i) a[i] = real ? local(i).real() : local(i).imag();
    }
    const std::vector<double> all = core::gather(v.get());
    const auto part = Eigen::Map<const Eigen::VectorXd>(all.data(), out.size());
    if (real)
      out.real() = part;
    else
      out.imag() = part;
  }
  return out;
}

}  // namespace whirl::solve
