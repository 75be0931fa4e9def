#pragma once
// The numbers that a study was asked for, in units that a person reads.

#include <span>
#include <string>

#include "cells.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::app {

/// Thresholds, cycles asked for, kinds of motion, with their bars: a few
/// lines or a small table by the kind of the study, from its values. Empty if it has none of these. Lengths in um (mm
/// from 10 mm on), forces in kN, pressures in MPa, margins in percent. `before` are the studies that ended earlier. A
/// sweep takes from them the verdict of the deck as given.
[[nodiscard]] std::string highlights(const io::StudySummary& study, std::span<const io::StudySummary> before);

// By kinds of studies; `v` has the values of the study.
[[nodiscard]] std::string of_equilibria(const io::StudySummary& s, const Values& v);
[[nodiscard]] std::string of_cycles(const io::StudySummary& s, const Values& v);
[[nodiscard]] std::string of_motion(const io::StudySummary& s, const Values& v);
[[nodiscard]] std::string of_run_up(const io::StudySummary& s, const Values& v);

}  // namespace whirl::app
