#pragma once
// Couplings without tilt stiffness are hinges: what they leave free to move.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Motions of one plane that strain neither shaft nor couplings and leave the displacement at `nodes` and the slope at
/// `slopes` (1-based, any order) at rest: rows are displacement and slope of node 1, of node 2, ..., one column a
/// motion [m, 1/m]. A coupling without tilt stiffness is a hinge half way along its segment, so that a shaft with k of
/// them has k + 2 such motions where nothing is held. Nodes that the shaft does not have count for nothing.
[[nodiscard]] Eigen::MatrixXd free_motions(const Options& options, const std::vector<int>& nodes,
                                           const std::vector<int>& slopes = {});

/// Nodes that are free to move, next to a hinge.
struct Loose {
  std::size_t coupling = 0;  // position among the couplings
  int from = 0, to = 0;      // 1-based nodes
};

/// The first part of the shaft that moves in free_motions(); nothing of a shaft without hinges.
[[nodiscard]] std::optional<Loose> loose_part(const Options& options, const std::vector<int>& nodes,
                                              const std::vector<int>& slopes = {});

/// The same in words, `held` being what holds the shaft, as "by its bearings".
[[nodiscard]] std::string words(const Loose& loose, const Options& options, const std::string& held);

}  // namespace whirl::rotor
