#include <fmt/core.h>

#include "common.hpp"
#include "whirl/study/cycle_branch.hpp"
#include "whirl/study/mesh_convergence.hpp"

namespace whirl::study {

void describe(deck::Description<MeshConvergenceOptions>& d) {
  using O = MeshConvergenceOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("of", &O::of,
        "name of an earlier cycle_branch, or 'NAME flip K' for the branch born at its K-th flip, whose bifurcations are "
        "located anew on finer films")
      .required();
  d.add("bifurcations", &O::bifurcations, deck::positive,
        "which ones: 1 is the first that the summary of the branch lists; all if not given");
  d.add("doublings", &O::doublings, deck::in(1, 6), "how many times the cells of all films are doubled, both ways");
}

void MeshConvergence::validate(const system::Machine& machine, const deck::Report& report) const {
  if (!has_film_mesh(system::train_of(machine, {})))
    report.fail("", "no film of this machine is computed on a mesh: there is nothing to refine");
}

void MeshConvergence::validate_among(std::span<const std::unique_ptr<Study>> before, const deck::Report& report) const {
  std::vector<std::string> names;
  for (const auto& s : before) {
    const auto* branch = dynamic_cast<const CycleBranch*>(s.get());
    if (!branch) continue;
    names.push_back(s->name());
    if (options.of == s->name()) return;
    if (!options.of.starts_with(s->name() + " flip ")) continue;
    if (!branch->options.follow_flips)
      report.fail("of", fmt::format("'{}' does not follow the branches born at its flips (follow_flips)", s->name()));
    return;
  }
  report.fail("of", fmt::format("there is no cycle_branch '{}' before this study{}", options.of,
                                deck::did_you_mean(options.of, names)));
}

}  // namespace whirl::study
