#pragma once
// The eigenvalues of a machine, by whichever way suits its films.

#include <functional>
#include <string>
#include <vector>

#include "whirl/problem/system.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {

struct MachineModes {
  std::vector<spectral::Mode> modes;  ///< as of spectral::modes
  int missed = 0;                     ///< eigenvalues that are there but not among the modes, as far as a count tells
  std::string doubt;                  ///< why that count is not sure; empty if it is, or if nothing was counted
  bool transfer = false;
  // Of a count: its region [rad/s, 1/s] and how many eigenvalues it holds, both of each pair. Zero: nothing was
  // counted.
  double frequency = 0, decay = 0;
  int counted = 0;
  bool gave_up = false;  ///< fewer than Wanted::at_least were found, and a longer search might find more
};

/// What a search is for.
struct Wanted {
  double frequency = 0;  ///< [rad/s] up to which vibration matters; zero: as the speed and `at_least` ask
  int at_least = 1;      ///< pairs that vibrate and count, after which a search without a region may end
  std::function<bool(const spectral::Mode&)> counts;  ///< absent: all do, and one search on the whole pencil will do
};

/// Modes at the equilibrium x. PETSc option -modes_by chooses:
///
/// | whole | spectral::modes on the whole pencil: all of a small one, those nearest to zero of a large one, counted
///           (spectral::count_eigenvalues) where no film has states |
/// | transfer | transfer_modes() in a region |
/// | automatic | the default: `whole` up to 100 000 states, `transfer` above |
///
/// `whole` eliminates the parts of a large machine on their ports (`-modes_st_pc_type lu` factorises it as one).
/// A system without parts or at rest has no other way than `whole`. Regions reach half as far to the
/// left as they are high. Without a frequency the first one reaches to twice the speed, and it grows by half, at most
/// five times, until it holds enough; a search on the whole pencil asks for twice as many, as often, where the caller
/// says which ones count. Collective; throws core::NotConverged, core::InputError on another word.
[[nodiscard]] MachineModes machine_modes(problem::System& system, Vec x, const spectral::EigenOptions& options,
                                         const Wanted& wanted = {});

}  // namespace whirl::solve
