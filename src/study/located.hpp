#pragma once
// Located bifurcations with their solutions, for whoever goes on from there.

#include <complex>
#include <vector>

#include "whirl/io/record.hpp"
#include "whirl/solve/continuation.hpp"
#include "whirl/solve/cycle.hpp"

namespace whirl::study {

/// A bifurcation and the cycle there; an equilibrium stands as a cycle of one node.
struct Located {
  solve::Event event = solve::Event::branch_point;
  std::complex<double> critical;  ///< multiplier, or eigenvalue [1/s]
  solve::Cycle cycle;
};
void write_located(io::Group& group, const std::vector<Located>& all);
[[nodiscard]] std::vector<Located> read_located(const io::Group& group);

}  // namespace whirl::study
