#pragma once
// Located bifurcations with their solutions, for whoever goes on from there.

#include <complex>
#include <vector>

#include "study/stored_vector.hpp"
#include "whirl/io/record.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

/// A bifurcation and the cycle there; an equilibrium stands as a cycle of one node.
struct Located {
  solve::Event event = solve::Event::branch_point;
  std::complex<double> critical;  ///< multiplier, or eigenvalue [1/s]
  solve::Cycle cycle;
  /// d(distance from the border of stability)/d(parameter in the unit of the range); of a fold found again on another
  /// film mesh, the second derivative of the parameter over the arclength, else 0
  double sensitivity = 0;
};

/// Whether a study of the deck goes on from the bifurcations of the study `name`, which then keeps them.
[[nodiscard]] bool is_followed(const Context& context, const std::string& name);
/// `like` as of write_cycle().
void write_located(io::Group& group, const std::vector<Located>& all, const SharedRows& like = {});
[[nodiscard]] std::vector<Located> read_located(const io::Group& group, const SharedRows& like = {});

}  // namespace whirl::study
