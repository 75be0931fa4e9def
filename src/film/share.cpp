#include "whirl/film/share.hpp"

#include <algorithm>

namespace whirl::film {

void Places::add(Diagonal piece) {
  size_ += static_cast<std::size_t>(piece.count);
  if (!pieces_.empty()) {
    Diagonal& last = pieces_.back();
    if (last.row + last.count == piece.row && last.column + last.count == piece.column) {
      last.count += piece.count;
      return;
    }
  }
  pieces_.push_back(piece);
}

// In blocks of rows short enough for x and y to stay in the nearest cache while they add up, unless pieces are cut into
// loops so short that starting them costs more.
void multiply_add(const Places& places, std::span<const double> values, const double* x, std::span<double> y) {
  constexpr int block = 512, shortest_loop = 16;
  const int rows = static_cast<int>(y.size());
  const std::size_t loops = places.pieces().size() * static_cast<std::size_t>(rows / block + 1);
  const int height = places.size() < shortest_loop * loops ? rows : block;
  for (int begin = 0; begin < rows; begin += height) {
    const double* value = values.data();
    for (const Diagonal& d : places.pieces()) {
      const int first = std::max(begin - d.row, 0), last = std::min(begin + height - d.row, d.count);
      const double* from = x + d.column;
      double* __restrict to = y.data() + d.row;
      for (int i = first; i < last; ++i) to[i] += value[i] * from[i];
      value += d.count;
    }
  }
}

std::vector<double> seen_of(const Share& share, std::span<const double> states) {
  std::vector<double> out;
  out.reserve(share.seen.size());
  for (const int k : share.seen) out.push_back(states[static_cast<std::size_t>(k)]);
  return out;
}

}  // namespace whirl::film
