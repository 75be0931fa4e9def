#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "solve/cycle/own_block.hpp"

namespace whirl::solve {

using Eigen::Index;

OwnShape::OwnShape(const problem::OwnStates& film) : count(film.count) {
  const auto around = [&](Index d) { return d > count / 2 ? d - count : d < -(count / 2) ? d + count : d; };
  Index plain = 0, closed = 0;
  for (const auto* places : {&film.states, &film.rates})
    for (const problem::EntryPlace& p : *places) {
      plain = std::max<Index>(plain, std::abs(p.column - p.row));
      closed = std::max<Index>(closed, std::abs(around(p.column - p.row)));
    }
  const bool periodic = closed < plain;
  const auto distance = [&](const problem::EntryPlace& p) {
    return periodic ? around(p.column - p.row) : static_cast<Index>(p.column - p.row);
  };
  for (const auto* places : {&film.states, &film.rates})
    for (const problem::EntryPlace& p : *places) {
      below = std::max(below, -distance(p));
      above = std::max(above, distance(p));
    }
  if (periodic) separators = std::max(below, above);
  for (Index row = 0; row < count; ++row)
    for (Index slot = 0; slot < width(); ++slot) columns.push_back((row + slot - below + count) % count);
  const auto slots = [&](const std::vector<problem::EntryPlace>& places, std::vector<std::size_t>& out) {
    for (const problem::EntryPlace& p : places)
      out.push_back(static_cast<std::size_t>(p.row * width() + distance(p) + below));
  };
  slots(film.states, states);
  slots(film.rates, rates);
}

}  // namespace whirl::solve
