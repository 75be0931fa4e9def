#pragma once
// What a film on rigid pads says of itself, from the pressure and fill at the nodes of its pads.

#include <optional>
#include <vector>

#include "film/fluid/mobility.hpp"
#include "film/sheet/pad.hpp"

namespace whirl::film {

/// Of one pad: pressure [Pa] and fill (empty if unknown) at the nodes [n_theta + 1][n_z + 1], and flows if known.
struct PadReport {
  std::vector<double> pressure, fill;
  std::optional<Flows> flows;
};

/// Report quantities of all pads at `motion`, as these see it.
[[nodiscard]] FilmReport summarise(const std::vector<Pad>& pads, const Reynolds& options, const Lubricant& lubricant,
                                   const JournalMotion& motion, const std::vector<PadReport>& reports);

/// Fields of all pads; `turn` [rad] is that of their frame against the bearing.
[[nodiscard]] std::vector<NodalField> fields_of(const std::vector<Pad>& pads, const Reynolds& options,
                                                const JournalMotion& motion, double turn,
                                                std::vector<PadReport> reports);

}  // namespace whirl::film
