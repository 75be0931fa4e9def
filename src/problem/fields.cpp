#include <algorithm>

#include "whirl/problem/system.hpp"

namespace whirl::problem {

// A part has no quantity twice: one that comes again begins the next part, whatever that is called.
std::vector<Field> parts_of(const std::vector<Field>& fields) {
  std::vector<Field> parts;
  std::vector<std::string> quantities;
  for (const Field& f : fields) {
    const bool again = std::find(quantities.begin(), quantities.end(), f.quantity) != quantities.end();
    if (parts.empty() || parts.back().name != f.name || again) {
      parts.push_back(f);
      quantities.clear();
    } else {
      parts.back() = {f.name, parts.back().begin, f.end};
    }
    quantities.push_back(f.quantity);
  }
  return parts;
}

}  // namespace whirl::problem
