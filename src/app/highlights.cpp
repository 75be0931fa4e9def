#include "highlights.hpp"

namespace whirl::app {

std::string highlights(const io::StudySummary& s, std::span<const io::StudySummary> /*before*/) {
  const Values v(s);
  if (s.kind == "equilibrium_branch") return of_equilibria(s, v);
  if (s.kind == "cycle_branch") return of_cycles(s, v);
  if (s.kind == "run_up") return of_run_up(s, v);
  if (s.kind == "motion") return of_motion(s, v);
  return {};
}

}  // namespace whirl::app
