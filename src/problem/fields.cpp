#include <algorithm>

#include "whirl/problem/system.hpp"

namespace whirl::problem {

std::vector<Field> parts_of(const std::vector<Field>& fields) {
  std::vector<Field> parts;
  for (const Field& f : fields) {
    if (parts.empty() || parts.back().part != f.part) {
      parts.push_back(f);
      parts.back().end = f.last();
      parts.back().stride = 0;
      parts.back().repeats = 1;
    } else {
      const Field& p = parts.back();
      parts.back() = {
          .name = f.name, .begin = std::min(p.begin, f.begin), .end = std::max(p.end, f.last()), .part = f.part};
    }
  }
  return parts;
}

}  // namespace whirl::problem
