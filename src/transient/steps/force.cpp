#include "whirl/transient/steps/force.hpp"

#include <algorithm>
#include <limits>

namespace whirl::transient {

void Forces::add(std::unique_ptr<Signal> signal, std::vector<Entry> column) {
  parts_.push_back({std::move(signal), std::move(column)});
}

double Forces::next_break(double t) const {
  double first = std::numeric_limits<double>::infinity();
  for (const Part& p : parts_) first = std::min(first, p.signal->next_break(t));
  return first;
}

bool Forces::constant(double begin, double end) const {
  return std::all_of(parts_.begin(), parts_.end(), [&](const Part& p) { return p.signal->constant(begin, end); });
}

void Forces::enter(double begin, double end) {
  inside_ = begin + (end - begin) / 2;
  for (const Part& p : parts_) p.signal->prepare(end);
}

double Forces::value(std::size_t k, double t) const {
  return parts_[k].signal->at(t, inside_);
}

void Forces::subtract(double t, PetscInt begin, std::span<const double> factor, std::span<double> rows) const {
  for (const Part& p : parts_) {
    const double value = p.signal->at(t, inside_);
    for (const Entry& e : p.column)
      if (const auto k = static_cast<std::size_t>(e.row - begin); e.row >= begin && k < rows.size())
        rows[k] -= factor[k] * e.weight * value;
  }
}

}  // namespace whirl::transient
