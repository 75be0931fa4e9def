#pragma once
// Axial grooves on the mesh of a whole circle.

#include <numbers>
#include <vector>

#include "whirl/film/contract/bore.hpp"

namespace whirl::film {

/// True for the nodes k = 0 .. n - 1 at start + k 2 pi/n that lie in a groove, whose edges are moved to the nearest
/// nodes. Throws core::InputError if they leave nothing.
[[nodiscard]] std::vector<bool> grooved(int n, const std::vector<Groove>& grooves,
                                        double start = 0.5 * std::numbers::pi);

/// Pressure [Pa] held at these nodes, zero outside the grooves; of grooves that share a node the last one counts.
[[nodiscard]] std::vector<double> pressures_in_grooves(int n, const std::vector<Groove>& grooves,
                                                       double start = 0.5 * std::numbers::pi);

}  // namespace whirl::film
