#pragma once
// Where the mass of a film goes and what its motion heats: what the energy equation wants to know of the flow.

#include <vector>

#include "whirl/thermal/rows.hpp"

namespace whirl::thermal {

/// Mass flows through the faces of cells and what heats the cells, of the rows of this rank. Flows are positive towards
/// larger i, j, k. With n = nodes_around(), l = across and r = rows of this rank; the last index runs fastest.
/// Of every cell: around(i) - around(i - 1) + along(j) - along(j - 1) + across(k + 1) - across(k) = inflow, to
/// rounding.
struct Flow {
  std::vector<double> around;  // kg/s [r, n, l], from cell i to i + 1; of a closed film the last one goes to i = 0; of
                               // a pad that of i = n - 1 leaves the film, and `entry` [r, l] comes into i = 0
  std::vector<double> entry;   // kg/s [r, l], into cells i = 0 of a pad; empty of a closed film
  std::vector<double> along;   // kg/s [r + 1, n, l], from row j - 1 to j, for j = begin ... end: the first of the mesh
                               // enters the film there, the last leaves it
  std::vector<double> across;  // kg/s [r, n, l + 1], from layer k - 1 to k; none through the walls
  std::vector<double>
      inflow;  // kg/s [r, n, l], that comes into cells from orifices and grooves: negative where it leaves
  std::vector<double> mixing;  // - [r, n, l + 1]: how much better heat is conducted across than by the resting fluid:
                               // the half layer at the bush, from layer k - 1 to k, the half layer at the journal;
                               // empty of laminar flow
  std::vector<double> heat;  // W [r, n, l], that the motion leaves in each cell: dissipation, of a gas and the work of
                             // pressure with it
};

}  // namespace whirl::thermal
