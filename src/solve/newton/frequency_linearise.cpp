// The linearisation that a resolvent at complex frequencies is made of.

#include <algorithm>
#include <utility>

#include "solve/newton/frequency_hub.hpp"
#include "solve/newton/frequency_inverse.hpp"
#include "solve/newton/frequency_part.hpp"
#include "solve/newton/part_factors.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;

FrequencyResolvent::FrequencyResolvent(problem::System& system)
    : system_(system), hub_(std::make_unique<FrequencyHub>()) {
  rest_ = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  for (core::Vector* v : {&x_, &state_scale_, &row_scale_}) *v = core::duplicate(rest_.get());
  check(VecGetOwnershipRange(rest_.get(), &begin_, nullptr));
  hub_numbers_ = problem::hub_numbers(system);
  const std::vector<problem::Field> fields = problem::parts_of(system.fields());
  PetscInt largest = 0, row = 0;
  for (std::size_t f = 1; f < fields.size(); ++f) {
    auto part = std::make_unique<Coupled>();
    part->first = fields[f].begin;
    part->count = fields[f].end - fields[f].begin;
    part->row = row;
    row += part->count;
    PetscInt states = 0;
    MPI_Allreduce(&part->count, &states, 1, MPIU_INT, MPI_SUM, comm());
    largest = std::max(largest, states);
    parts_.push_back(std::move(part));
    ports_.push_back({fields[f].name, {}, {}});
  }
  auto inverse = own_inverse(system);
  if (inverse && inverse->exact() != nullptr)
    inverse_ = std::move(inverse);
  else if (inverse && largest > core::plan::kept_states())
    iterated_ = std::make_unique<FrequencyInverse>(comm(), std::move(inverse));
}

FrequencyResolvent::~FrequencyResolvent() = default;

void FrequencyResolvent::linearise(Vec x) {
  check(VecCopy(x, x_.get()));
  system_.scales(state_scale_.get(), row_scale_.get());
  const auto at_hub = [&](Vec v) {
    std::vector<double> out(hub_numbers_.size(), 0);
    const core::ReadArray a(v);
    for (std::size_t k = 0; k < out.size(); ++k)
      if (const PetscInt i = hub_numbers_[k] - begin_; i >= 0 && i < a.size()) out[k] = a[i];
    MPI_Allreduce(MPI_IN_PLACE, out.data(), static_cast<int>(out.size()), MPI_DOUBLE, MPI_SUM, comm());
    return out;
  };
  hub_scale_ = at_hub(state_scale_.get());
  hub_row_scale_ = at_hub(row_scale_.get());
  check(VecReciprocal(row_scale_.get()));
  for (const auto& p : parts_) {
    p->a.reset();
    p->b.reset();
    p->x.resize(0, 0);
    p->dx.resize(0, 0);
  }
  for (const bool rates : {false, true}) {
    problem::list_entries(system_, {0, x_.get(), rest_.get()}, rates ? 0 : 1, rates ? 1 : 0, jacobian_, entries_);
    if (!at_rest_) find_ports();
    PortMatrix& m = rates ? *rates_ : *at_rest_;
    m.take(entries_.values());
    m.scale(row_scale_.get(), state_scale_.get());
  }
  gather_hub();
  std::vector<problem::KinematicRow> kinematic = system_.kinematic();
  const auto in_hub = [&](int& k) {
    k = static_cast<int>(std::ranges::lower_bound(hub_numbers_, k) - hub_numbers_.begin());
  };
  for (auto& [row, state, rate] : kinematic) in_hub(row), in_hub(state), in_hub(rate);
  hub_->linearise(kinematic);
}

void FrequencyResolvent::find_ports() {
  const auto layout =
      std::make_shared<const PortLayout>(comm(), system_.local_size(), system_.fields(), entries_.places());
  at_rest_ = std::make_unique<PortMatrix>(layout);
  rates_ = std::make_unique<PortMatrix>(layout);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    for (const bool forces : {false, true}) {
      const PortLayout::Coloured& all = forces ? layout->coupled() : layout->ports();
      std::vector<std::pair<PetscInt, Index>> found;  // in the hub, and its colour
      for (std::size_t colour = 0; colour < all.at[i].size(); ++colour)
        if (const int k = all.at[i][colour]; k >= 0)
          found.emplace_back(all.numbers[static_cast<std::size_t>(k)], static_cast<Index>(colour));
      std::ranges::sort(found);
      for (const auto& [number, colour] : found) {
        (forces ? ports_[i].forces : ports_[i].seen).push_back(number);
        (forces ? parts_[i]->of : parts_[i]->seen).push_back(colour);
      }
    }
  std::vector<double> mine;
  at_rest_->for_hub([&](PetscInt row, PetscInt column, double) {
    mine.insert(mine.end(), {static_cast<double>(row), static_cast<double>(column), 0.0});
  });
  hub_->a = hub_->b = core::gather_entries(comm(), static_cast<Index>(hub()), mine);
  at_rest_->for_hub([&](PetscInt row, PetscInt column, double) {
    const int* const first = hub_->a.innerIndexPtr();
    const int* const at = hub_->a.outerIndexPtr() + column;
    hub_places_.push_back(
        static_cast<std::size_t>(std::lower_bound(first + at[0], first + at[1], static_cast<int>(row)) - first));
  });
}

void FrequencyResolvent::gather_hub() {
  for (const bool rates : {false, true}) {
    FrequencyHub::Sparse& to = rates ? hub_->b : hub_->a;
    std::fill_n(to.valuePtr(), to.nonZeros(), 0.0);
    std::size_t k = 0;
    (rates ? rates_ : at_rest_)->for_hub([&](PetscInt, PetscInt, double value) {
      to.valuePtr()[hub_places_[k++]] += value;
    });
    if (core::size_of(comm()) > 1)
      MPI_Allreduce(MPI_IN_PLACE, to.valuePtr(), static_cast<int>(to.nonZeros()), MPI_DOUBLE, MPI_SUM, comm());
  }
}

void FrequencyResolvent::assemble() const {
  if (parts_.empty() || parts_.front()->a) return;
  const core::Matrix j = system_.make_jacobian();
  for (const bool rates : {false, true}) {
    system_.jacobian(0, x_.get(), rest_.get(), rates ? 0 : 1, rates ? 1 : 0, j.get());
    check(MatDiagonalScale(j.get(), row_scale_.get(), state_scale_.get()));
    for (const auto& p : parts_) {
      core::IndexSet rows;
      check(ISCreateStride(comm(), p->count, begin_ + p->first, 1, rows.put()));
      check(MatCreateSubMatrix(j.get(), rows.get(), rows.get(), MAT_INITIAL_MATRIX, (rates ? p->b : p->a).put()));
    }
  }
}

}  // namespace whirl::solve
