#include <fmt/core.h>

#include <algorithm>

#include "study/common.hpp"
#include "study/convergence/mesh_convergence.hpp"
#include "study/cycle/cycle_branch.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "whirl/film/contract/options.hpp"

namespace whirl::study {

void describe(deck::Description<MeshConvergenceOptions>& d) {
  using O = MeshConvergenceOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("of", &O::of,
        "name of an earlier equilibrium_branch or cycle_branch, or 'NAME flip K' for the branch born at its K-th flip, "
        "whose bifurcations are located anew on finer films")
      .required();
  d.add("bifurcations", &O::bifurcations, deck::positive,
        "which ones: 1 is the first that the summary of the branch lists; all if not given");
  d.add("doublings", &O::doublings, deck::in(1, 6),
        "how many times the cells of all films are doubled, both ways; edges of grooves lie on nodes, and should "
        "do so on the deck's own mesh");
}

void MeshConvergence::validate(const system::Machine& machine, const deck::Report& report) const {
  const bool meshed = std::any_of(machine.bearings.begin(), machine.bearings.end(),
                                  [](const auto& b) { return film::facts(b.film).cells[0] > 0; });
  if (!meshed) report.fail("", "no film of this machine is computed on a mesh: there is nothing to refine");
}

void MeshConvergence::validate_among(std::span<const std::unique_ptr<Study>> before, const deck::Report& report) const {
  std::vector<std::string> names;
  for (const auto& s : before) {
    if (dynamic_cast<const EquilibriumBranch*>(s.get())) {
      names.push_back(s->name());
      if (s->name() == options.of) return;
    }
    if (!dynamic_cast<const CycleBranch*>(s.get())) continue;
    names.push_back(s->name());
    if (branch_called(*s, options.of)) return;
  }
  report.fail("of", fmt::format("there is no equilibrium_branch or cycle_branch '{}' before this study{}", options.of,
                                deck::did_you_mean(options.of, names)));
}

}  // namespace whirl::study
