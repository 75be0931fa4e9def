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
    const std::string born = name_of_doubled(name(), k + 1);
    if (context.resume && context.results.finished(born)) continue;
    context.results.begin(born, std::string(kind()));
    CycleFollower(context, of_twice_the_period(options), seeds[k]).run();
  }
}

bool CycleBranch::may_add(std::string_view other) const {
  const std::string first = io::plain_name(name_of_doubled(name(), 1));
  const std::string_view stem = std::string_view(first).substr(0, first.size() - 1);
  if (!options.follow_flips || !other.starts_with(stem) || other.size() == stem.size() ||
      other.find_first_not_of("0123456789", stem.size()) != std::string_view::npos)
    return false;
  const auto& chosen = options.flips;
  return chosen.empty() || std::any_of(chosen.begin(), chosen.end(), [&](int k) {
           return other == io::plain_name(name_of_doubled(name(), static_cast<std::size_t>(k)));
         });
}

CycleBranchOptions of_twice_the_period(const CycleBranchOptions& options) {
  CycleBranchOptions twice = options;
  twice.period *= 2;
  const int steps = steps_of(options);
  const bool whole = options.method == CycleBranchOptions::Method::shooting;
  twice.steps = whole ? 2 * steps : steps;
  twice.intervals *= whole ? 1 : 2;
  twice.follow_flips = false;
  return twice;
}

std::string name_of_doubled(const std::string& name, std::size_t k) {
  return fmt::format("{} flip {}", name, k);
}

std::optional<CycleBranchOptions> branch_called(const Study& study, const std::string& name) {
  const auto* branch = dynamic_cast<const CycleBranch*>(&study);
  if (!branch) return std::nullopt;
  if (branch->name() == name) return branch->options;
  const std::string born = name_of_doubled(branch->name(), 1);
  const std::string stem = born.substr(0, born.size() - 1);
  const bool is_born = branch->options.follow_flips && name.starts_with(stem) && name.size() > stem.size() &&
                       name.find_first_not_of("0123456789", stem.size()) == std::string::npos;
  if (!is_born) return std::nullopt;
  const auto& flips = branch->options.flips;
  const auto wanted = [&](int k) { return name == name_of_doubled(branch->name(), static_cast<std::size_t>(k)); };
  if (name[stem.size()] == '0' || (!flips.empty() && std::none_of(flips.begin(), flips.end(), wanted)))
    return std::nullopt;
  return of_twice_the_period(branch->options);
}

}  // namespace whirl::study
