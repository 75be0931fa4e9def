#include "whirl/film/contract/share.hpp"

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

std::vector<double> seen_of(const Share& share, std::span<const double> states) {
  std::vector<double> out;
  out.reserve(share.seen.size());
  for (const int k : share.seen) out.push_back(states[static_cast<std::size_t>(k)]);
  return out;
}

}  // namespace whirl::film
