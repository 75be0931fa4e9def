#pragma once
// Which inner freedoms the segments of a shaft have, and which of them are one.

#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Inner freedoms of one plane, numbered from 0 along the shaft.
struct Inner {
  int count = 0;
  std::vector<std::vector<int>> of_segment;  // [segment][inner freedom of the element]; empty if there are none
  [[nodiscard]] std::vector<int> of(std::size_t segment) const {
    return of_segment.empty() ? std::vector<int>() : of_segment[segment];
  }
};

/// Those of a shaft. Neighbours of timoshenko_hermitian share shear angle and curvature at a node where both sections
/// are the same and nothing acts: elsewhere shear force and bending moment may jump, and a shared freedom would leave
/// an error of first order.
[[nodiscard]] Inner inner_freedoms(const Options& options);

}  // namespace whirl::rotor
