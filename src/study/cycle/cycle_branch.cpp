#include "study/cycle/cycle_branch.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <functional>

#include "study/added_branch.hpp"
#include "study/cycle/coexisting.hpp"
#include "study/cycle/cycle_brief.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
StudyResult CycleBranch::run(Context& context) {
  return CycleFollower(context, options).run();
}

io::Brief CycleBranch::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  return brief_of_cycles(result, options);
}

// A resumed run takes the flips of a finished branch from its results, and so does any other.
std::vector<std::unique_ptr<Study>> CycleBranch::further(const io::Group& result) const {
  std::vector<std::unique_ptr<Study>> added;
  const auto add = [&](const std::string& called, const CycleBranchOptions& own,
                       std::function<void(CycleFollower&)> begin) {
    added.push_back(std::make_unique<AddedBranch>(
        key, called,
        [own, begin = std::move(begin)](Context& context) {
          CycleFollower follower(context, own);
          begin(follower);
          return follower.run();
        },
        [own](const StudyResult& found) { return brief_of_cycles(found, own); }));
  };
  CycleBranchOptions beside = options;
  beside.parameter.deflation.reset();
  beside.follow_flips = false;
  for (std::size_t k = 2; const auto& first : solutions_in(result))
    add(name_of_solution(name(), k++), beside, [first](CycleFollower& follower) { follower.begin_at(first); });
  if (!options.follow_flips) return added;
  const io::Group flips = result.has_group("flips") ? result.group("flips") : io::Group();
  const std::size_t count = result.has_group("flips") ? count_seeds(flips) : 0;
  for (std::size_t k = 1; k <= count; ++k)
    if (follows(k))
      add(name_of_doubled(name(), k), of_twice_the_period(options),
          [flips, k](CycleFollower& follower) { follower.leave_from(flips, k - 1); });
  for (const int k : options.flips)
    if (static_cast<std::size_t>(k) > count)
      added.push_back(std::make_unique<AddedBranch>(
          key, name_of_doubled(name(), static_cast<std::size_t>(k)),
          [=, name = name()](Context&) -> StudyResult {
            throw core::NotConverged(fmt::format("there is no flip {}: the branch '{}' has {}", k, name, count));
          },
          [](const StudyResult&) { return io::Brief(); }));
  return added;
}

bool CycleBranch::follows(std::size_t flip) const {
  const auto& chosen = options.flips;
  return options.follow_flips && (chosen.empty() || std::ranges::find(chosen, static_cast<int>(flip)) != chosen.end());
}

bool CycleBranch::may_add(std::string_view other) const {
  if (options.parameter.deflation && number_in(other, io::plain_name(name_of_solution(name(), 2)))) return true;
  const auto flip = number_in(other, io::plain_name(name_of_doubled(name(), 1)));
  return flip && follows(*flip);
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

std::optional<CycleBranchOptions> branch_called(const Study& study, const std::string& name) {
  const auto* branch = dynamic_cast<const CycleBranch*>(&study);
  if (!branch) return std::nullopt;
  if (branch->name() == name) return branch->given();
  const auto flip = number_in(name, name_of_doubled(branch->name(), 1));
  if (!flip || !branch->follows(*flip)) return std::nullopt;
  return of_twice_the_period(branch->given());
}

}  // namespace whirl::study
