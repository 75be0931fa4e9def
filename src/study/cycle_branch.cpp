#include "whirl/study/cycle_branch.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "cycle_follower.hpp"

namespace whirl::study {

// The branch asked for, and the branches of twice the period that are born at its flips, each a study of its own in the
// results. A resumed run takes the flips of a finished branch from its results.
void CycleBranch::run(Context& context) {
  std::vector<FlipSeed> seeds;
  if (context.resume && context.results.finished(name())) {
    if (options.follow_flips) seeds = read_seeds(context.results.group_of(name()).group("flips"));
  } else {
    CycleFollower follower(context, options);
    follower.run();
    seeds = follower.seeds();
  }
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    const auto& chosen = options.flips;
    if (!chosen.empty() && std::find(chosen.begin(), chosen.end(), static_cast<int>(k) + 1) == chosen.end()) continue;
    const std::string born = fmt::format("{} flip {}", name(), k + 1);
    if (context.resume && context.results.finished(born)) continue;
    context.results.begin(born, std::string(kind()));
    CycleFollower(context, twice_the_period(options), seeds[k]).run();
  }
}

}  // namespace whirl::study
