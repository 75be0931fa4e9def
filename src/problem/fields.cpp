#include "whirl/problem/system.hpp"

namespace whirl::problem {

std::vector<Field> parts_of(const std::vector<Field>& fields) {
  std::vector<Field> parts;
  for (const Field& f : fields) {
    if (f.continues)
      parts.back() = {f.name, parts.back().begin, f.end};
    else
      parts.push_back(f);
  }
  return parts;
}

}  // namespace whirl::problem
