#pragma once
// Calls of LAPACK.

#include <algorithm>
#include <complex>
#include <vector>

namespace whirl::core {

/// Calls a routine of LAPACK, call(work, size, info), with the workspace that it asks for in a first call; its `info`.
template <class Number, class Call>
[[nodiscard]] int with_workspace(const Call& call) {
  Number wanted{};
  int size = -1, info = 0;
  call(&wanted, &size, &info);
  std::vector<Number> work(static_cast<std::size_t>(std::max(1.0, std::real(wanted))));
  size = static_cast<int>(work.size());
  if (info == 0) call(work.data(), &size, &info);
  return info;
}

}  // namespace whirl::core
