#include "whirl/solve/newton/frequency_resolvent.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "solve/newton/frequency_hub.hpp"
#include "solve/newton/frequency_inverse.hpp"
#include "solve/newton/frequency_part.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::solve {

using core::check;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;

MatrixXcd FrequencyResolvent::motions(const Coupled& p) const {
  const Index ports = p.g0.cols();
  MatrixXcd out(p.count, ports + border());
  out.leftCols(ports) = p.g0 + lambda_ * p.g1;
  if (border() > 0) out.col(ports) = b_.segment(begin_ + p.first, p.count);
  return out;
}

MatrixXcd FrequencyResolvent::forces(const Coupled& p) const {
  const Index ports = p.f0.cols();
  MatrixXcd out(p.count, ports + border());
  out.leftCols(ports) = (p.f0 + lambda_ * p.f1).conjugate();
  if (border() > 0) out.col(ports) = c_.segment(begin_ + p.first, p.count);
  return out;
}

template <class F>
MatrixXcd FrequencyResolvent::together(F&& columns) const {
  Index rows = 0, most = 0;
  std::vector<MatrixXcd> each;
  for (const auto& p : parts_) {
    each.push_back(columns(*p));
    rows += each.back().rows();
    most = std::max(most, each.back().cols());
  }
  MatrixXcd all = MatrixXcd::Zero(rows, most);
  Index row = 0;
  for (const MatrixXcd& m : each) {
    all.block(row, 0, m.rows(), m.cols()) = m;
    row += m.rows();
  }
  return all;
}

MatrixXcd FrequencyResolvent::solve_part(Coupled& p, const MatrixXcd& right, bool adjoint) {
  if (!p.factorised) {
    for (const auto& other : parts_)
      if (other.get() != &p && other->states > core::plan::kept_states()) {
        other->factors.reset();
        other->factorised = false;
      }
    if (!p.factors && (!p.alone || p.count > 0))
      p.factors =
          std::make_unique<Coupled::Factors>(p.alone ? PETSC_COMM_SELF : comm(), p.count, p.places, p.places, "parts_");
    if (p.factors) p.factors->set(p.at_rest, p.rates, 1, lambda_);
    p.factorised = true;
  }
  // A_i = D_r (a + lambda b) D_c of which the factors have no D_c.
  MatrixXcd r = right, x(right.rows(), right.cols());
  const core::ReadArray scale(state_scale_.get());
  const auto states = Eigen::Map<const Eigen::ArrayXd>(scale.data() + p.first, p.count).cast<Complex>();
  if (adjoint) r.array().colwise() /= states;
  if (p.factors) p.factors->solve(adjoint, core::span_of(std::as_const(r)), core::span_of(x));
  if (!adjoint) x.array().colwise() /= states;
  return x;
}

MatrixXcd FrequencyResolvent::solve_parts(const MatrixXcd& right, bool adjoint) {
  MatrixXcd x(right.rows(), right.cols());
  if (adjoint || !eliminates_by_inverse()) {
    if (iterated_ && size() > core::plan::whole_states()) throw core::NotConverged(core::plan::too_large(size()));
    if (!own_taken_) take_entries(true);
    Index row = 0;
    for (const auto& p : parts_) {
      x.middleRows(row, p->count) = solve_part(*p, right.middleRows(row, p->count), adjoint);
      row += p->count;
    }
    return x;
  }
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
void FrequencyResolvent::eliminate_by_inverse(bool slopes) {
  if (iterated_)
    iterated_->set_at(x_.get(), rest_.get(), lambda_);
  else
    inverse_->exact()->set_at({0, x_.get(), rest_.get()}, lambda_);
  const auto split = [&](const MatrixXcd& all, MatrixXcd Coupled::*to) {
    Index row = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      Coupled& p = *parts_[i];
      p.*to = all.block(row, 0, p.count, static_cast<Index>(ports_[i].seen.size()) + border());
      row += p.count;
    }
  };
  split(solve_parts(together([this](const Coupled& p) { return motions(p); }), false), &Coupled::x);
  if (!slopes) return;
  MatrixXcd right = together([](const Coupled& p) -> MatrixXcd { return p.g1.cast<Complex>(); });
  if (iterated_) {
    right -= iterated_->rates_times(together([](const Coupled& p) -> MatrixXcd { return p.x; }));
  } else {
    assemble();  // whose rates these take
    right -= together([](const Coupled& p) -> MatrixXcd { return p.rates_times(p.x); });
  }
  split(solve_parts(right, false), &Coupled::dx);
}

// H = F X, H' = F' X + F X'.
FrequencyResolvent::Transfers FrequencyResolvent::eliminate(Complex lambda, bool slopes) {
  lambda_ = lambda;
  Transfers out;
  if (parts_.empty()) return out;
  for (const auto& p : parts_) p->factorised = false;
  try {
    if (eliminates_by_inverse()) eliminate_by_inverse(slopes);
  } catch (const core::NotConverged&) {
    if (!iterated_ || size() > core::plan::whole_states()) throw;
    iterated_.reset();
    take_entries(true);
  }
  if (slopes && !iterated_) assemble();
  for (const auto& p : parts_)
    if (!eliminates_by_inverse()) {
      p->x = solve_part(*p, motions(*p), false);
      if (slopes) p->dx = solve_part(*p, p->g1 - p->rates_times(p->x), false);
    }
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Coupled& p = *parts_[i];
    const MatrixXcd f = forces(p).adjoint();
    Block block{f * p.x, {}};
    if (slopes)
      block.slope = p.f1.transpose().cast<Complex>() * p.x + f * p.dx;
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
  ComplexVector at_hub = ComplexVector::Zero(hub() + border()), x(r.size());
  const auto each_here = [&](auto&& use) {
    for (std::size_t k = 0; k < hub_numbers_.size(); ++k)
      if (const PetscInt i = hub_numbers_[k] - begin_; i >= 0 && i < r.size()) use(static_cast<Index>(k), i);
  };
  const auto picked = [&](const std::vector<PetscInt>& places) {
    ComplexVector out(static_cast<Index>(places.size()) + border());
    for (std::size_t k = 0; k < places.size(); ++k) out(static_cast<Index>(k)) = at_hub(places[k]);
    if (border() > 0) out(out.size() - 1) = at_hub(hub());
    return out;
  };
  each_here([&](Index k, PetscInt i) { at_hub(k) = r(i); });
  MatrixXcd y = together([&](const Coupled& p) -> MatrixXcd { return r.segment(p.first, p.count); });
  bool loaded = (y.array() != 0.0).any();
  if (!parts_.empty()) MPI_Allreduce(MPI_IN_PLACE, &loaded, 1, MPI_CXX_BOOL, MPI_LOR, comm());
  if (loaded) {
    if (!adjoint) y = solve_parts(y, false);
    Index row = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Coupled& p = *parts_[i];
      const ComplexVector moved = (adjoint ? p.x : forces(p)).adjoint() * y.middleRows(row, p.count);
      const std::vector<PetscInt>& places = adjoint ? ports_[i].seen : ports_[i].forces;
      for (std::size_t k = 0; k < places.size(); ++k) at_hub(places[k]) -= moved(static_cast<Index>(k));
      if (border() > 0) at_hub(hub()) -= moved(moved.size() - 1);
      row += p.count;
    }
  }
  if (core::size_of(comm()) > 1)
    MPI_Allreduce(MPI_IN_PLACE, at_hub.data(), static_cast<int>(at_hub.size()), MPI_C_DOUBLE_COMPLEX, MPI_SUM, comm());
  if (border() > 0) at_hub(hub()) += corner;
  at_hub = adjoint ? hub_->solve_adjoint(at_hub) : hub_->solve(at_hub);
  if (border() > 0) corner = at_hub(hub());
  Index row = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Coupled& p = *parts_[i];
    y.middleRows(row, p.count) -= adjoint ? forces(p) * picked(ports_[i].forces) : p.x * picked(ports_[i].seen);
    row += p.count;
  }
  if (adjoint && !parts_.empty()) y = solve_parts(y, true);
  row = 0;
  for (const auto& p : parts_) {
    x.segment(p->first, p->count) = y.middleRows(row, p->count);
    row += p->count;
  }
  each_here([&](Index k, PetscInt i) { x(i) = at_hub(k); });
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
  assemble();
  const PetscInt n = system_.local_size();
  const ComplexVector at_hub = hub_->b * v(hub_numbers_);
  ComplexVector forces = ComplexVector::Zero(hub()), out(n);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Coupled& p = *parts_[i];
    const ComplexVector own = v.segment(begin_ + p.first, p.count);
    out.segment(p.first, p.count) = p.rates_times(own) + p.g1 * v(hub_numbers_)(ports_[i].seen);
    forces(ports_[i].forces) += p.f1.transpose() * own;
  }
  MPI_Allreduce(MPI_IN_PLACE, forces.data(), static_cast<int>(forces.size()), MPI_C_DOUBLE_COMPLEX, MPI_SUM, comm());
  for (std::size_t k = 0; k < hub_numbers_.size(); ++k)
    if (const PetscInt i = hub_numbers_[k] - begin_; i >= 0 && i < n) {
      const auto at = static_cast<Index>(k);
      out(i) = at_hub(at) + forces(at);
    }
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
