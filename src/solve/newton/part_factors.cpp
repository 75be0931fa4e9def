#include "solve/newton/part_factors.hpp"

#include <complex>
#include <type_traits>

#include "whirl/core/inverse.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::solve {

template <class Scalar>
PartFactors<Scalar>::PartFactors(std::shared_ptr<const PortLayout> layout) : layout_(std::move(layout)) {
  for (std::size_t p = 0; p < layout_->n_parts(); ++p) {
    parts_.emplace_back().rows = layout_->part(p);
    parts_.back().large = !std::is_same_v<Scalar, double> && parts_.back().rows.states > core::plan::kept_states();
  }
}

template <class Scalar>
void PartFactors<Scalar>::set(const PortMatrix& a, const PortMatrix* b, Scalar sigma) {
  a_ = &a;
  b_ = b;
  sigma_ = sigma;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    parts_[p].made = false;
    if (!parts_[p].large) factorise(p);
  }
}

template <class Scalar>
void PartFactors<Scalar>::factorise(std::size_t p) {
  Part& part = parts_[p];
  part.made = true;
  if (part.rows.alone && part.rows.count == 0) return;
  if (!part.lu) {
    std::vector<typename Lu::Place> places;
    part.values.clear();
    for (const auto& [row, column, value] : layout_->entries_of(p)) {
      places.push_back({row, column});
      part.values.push_back(value);
    }
    auto of_b = b_ ? places : std::vector<typename Lu::Place>();
    part.lu = std::make_unique<Lu>(part.rows.alone ? PETSC_COMM_SELF : layout_->comm(), part.rows.count,
                                   std::move(places), std::move(of_b), "parts_");
  }
  const auto values = [&](const PortMatrix* m) {
    std::vector<double> out;
    for (std::size_t k = 0; m && k < part.values.size(); ++k) out.push_back(m->of_parts()[part.values[k]]);
    return out;
  };
  part.lu->set(values(a_), values(b_), 1, sigma_);
}

template <class Scalar>
typename PartFactors<Scalar>::Columns PartFactors<Scalar>::solve(const Columns& right, bool adjoint) {
  Columns out(right.rows(), right.cols());
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Part& part = parts_[p];
    if (!part.made) {
      for (Part& other : parts_)
        if (other.large && &other != &part) {
          other.lu.reset();
          other.made = false;
        }
      factorise(p);
    }
    const Columns of = right.middleRows(part.rows.first, part.rows.count);
    Columns found(of.rows(), of.cols());
    if (part.lu) part.lu->solve(adjoint, core::span_of(of), core::span_of(found));
    out.middleRows(part.rows.first, part.rows.count) = found;
  }
  return out;
}

std::unique_ptr<problem::PartInverse> own_inverse(problem::System& system) {
  return core::plan::parts() == core::plan::PartsWay::own ? system.make_part_inverse() : nullptr;
}

template class PartFactors<double>;
template class PartFactors<std::complex<double>>;

}  // namespace whirl::solve
