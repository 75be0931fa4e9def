#pragma once
// The same film on a coarser mesh, whose solution is where that of a finer one starts.

#include <optional>
#include <vector>

#include "whirl/thermal/thd_solver.hpp"

namespace whirl::thermal {

/// Half of the intervals in every direction. None where that is too coarse for the ranks, or two orifices would share a
/// node, or a groove's nodes would be none.
[[nodiscard]] std::optional<Mesh> coarser(const Mesh& mesh, const FilmFlowOptions& flow, int ranks);
/// What is given on `fine`, given on `coarse`. Its solution is a start alone, found to 1e-5 of the ambient's
/// temperature. Collective.
[[nodiscard]] ThdSetup coarser(const ThdSetup& setup, const Rows& fine, const Rows& coarse);
/// Values [r, n, width] at the nodes of one mesh at those of another, linear between nodes. Collective.
[[nodiscard]] std::vector<double> interpolate(const Rows& from, const Rows& to, const std::vector<double>& values,
                                              int width);
/// ThdSolver::state() of one mesh for another: linear between the centres of layers too. Collective.
[[nodiscard]] std::vector<double> interpolate_state(const Rows& from, const Rows& to, const std::vector<double>& state);

/// ThdSolver::state() from the solution on a coarser mesh, itself begun from a coarser one. None where there is no
/// coarser mesh, `setup.coarse_start` does not want one, or nothing is found there. Collective.
[[nodiscard]] std::optional<std::vector<double>> coarse_start(const Rows& rows, const ThdSetup& setup,
                                                              const std::vector<double>& thickness);

}  // namespace whirl::thermal
