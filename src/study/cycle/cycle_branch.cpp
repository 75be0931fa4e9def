#include "study/cycle/cycle_branch.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "study/cycle/coexisting.hpp"
#include "study/cycle/cycle_brief.hpp"
#include "study/cycle/cycle_follower.hpp"

namespace whirl::study {
namespace {

// The branch born at one flip of another one.
class DoubledBranch final : public Study {
public:
  DoubledBranch(std::string name, CycleBranchOptions options, io::Group flips, std::size_t from)
      : name_(std::move(name)), options_(std::move(options)), flips_(std::move(flips)), from_(from) {}
  [[nodiscard]] std::string_view kind() const override { return CycleBranch::key; }
  [[nodiscard]] std::string name() const override { return name_; }
  void validate(const system::Machine& /*machine*/, const deck::Report& /*report*/) const override {}
  [[nodiscard]] StudyResult run(Context& context) override {
    CycleFollower follower(context, options_);
    follower.leave_from(flips_, from_);
    return follower.run();
  }
  [[nodiscard]] io::Brief brief(const StudyResult& result,
                                std::span<const io::StudySummary> /*before*/) const override {
    return brief_of_cycles(result, options_);
  }

private:
  std::string name_;
  CycleBranchOptions options_;
  io::Group flips_;
  std::size_t from_;  // of them this branch is born
};

// The branch that begins at a forced cycle beside the first one of another branch.
class BesideCycleBranch final : public Study {
public:
  BesideCycleBranch(std::string name, CycleBranchOptions options, io::Group first)
      : name_(std::move(name)), options_(std::move(options)), first_(std::move(first)) {}
  [[nodiscard]] std::string_view kind() const override { return CycleBranch::key; }
  [[nodiscard]] std::string name() const override { return name_; }
  void validate(const system::Machine& /*machine*/, const deck::Report& /*report*/) const override {}
  [[nodiscard]] StudyResult run(Context& context) override {
    CycleFollower follower(context, options_);
    follower.begin_at(first_);
    return follower.run();
  }
  [[nodiscard]] io::Brief brief(const StudyResult& result,
                                std::span<const io::StudySummary> /*before*/) const override {
    return brief_of_cycles(result, options_);
  }

private:
  std::string name_;
  CycleBranchOptions options_;
  io::Group first_;
};

// A flip that was asked for and not found.
class NoFlip final : public Study {
public:
  NoFlip(const std::string& branch, int k, std::size_t found)
      : name_(name_of_doubled(branch, static_cast<std::size_t>(k))),
        reason_(fmt::format("there is no flip {}: the branch '{}' has {}", k, branch, found)) {}
  [[nodiscard]] std::string_view kind() const override { return CycleBranch::key; }
  [[nodiscard]] std::string name() const override { return name_; }
  void validate(const system::Machine& /*machine*/, const deck::Report& /*report*/) const override {}
  [[nodiscard]] StudyResult run(Context& /*context*/) override { throw core::NotConverged(reason_); }

private:
  std::string name_, reason_;
};

}  // namespace

StudyResult CycleBranch::run(Context& context) {
  return CycleFollower(context, options).run();
}

io::Brief CycleBranch::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  return brief_of_cycles(result, options);
}

// A resumed run takes the flips of a finished branch from its results, and so does any other.
std::vector<std::unique_ptr<Study>> CycleBranch::further(const io::Group& result) const {
  std::vector<std::unique_ptr<Study>> born;
  CycleBranchOptions beside = options;
  beside.parameter.deflation.reset();
  beside.follow_flips = false;
  for (std::size_t k = 2; auto& first : solutions_in(result))
    born.push_back(std::make_unique<BesideCycleBranch>(name_of_solution(name(), k++), beside, std::move(first)));
  if (!options.follow_flips) return born;
  const io::Group* flips = result.has_group("flips") ? &result.group("flips") : nullptr;
  const std::size_t count = flips ? count_seeds(*flips) : 0;
  for (std::size_t k = 1; k <= count; ++k) {
    const auto& chosen = options.flips;
    if (!chosen.empty() && std::find(chosen.begin(), chosen.end(), static_cast<int>(k)) == chosen.end()) continue;
    born.push_back(
        std::make_unique<DoubledBranch>(name_of_doubled(name(), k), of_twice_the_period(options), *flips, k - 1));
  }
  for (const int k : options.flips)
    if (static_cast<std::size_t>(k) > count) born.push_back(std::make_unique<NoFlip>(name(), k, count));
  return born;
}

bool CycleBranch::may_add(std::string_view other) const {
  if (options.parameter.deflation && may_be_solution(name(), other)) return true;
  if (!options.follow_flips) return false;
  const std::string first = io::plain_name(name_of_doubled(name(), 1));
  const std::string_view stem = std::string_view(first).substr(0, first.size() - 1);
  if (!other.starts_with(stem) || other.size() == stem.size() ||
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
  if (branch->name() == name) return branch->given();
  const std::string born = name_of_doubled(branch->name(), 1);
  const std::string stem = born.substr(0, born.size() - 1);
  const bool is_born = branch->given().follow_flips && name.starts_with(stem) && name.size() > stem.size() &&
                       name.find_first_not_of("0123456789", stem.size()) == std::string::npos;
  if (!is_born) return std::nullopt;
  const auto& flips = branch->given().flips;
  const auto wanted = [&](int k) { return name == name_of_doubled(branch->name(), static_cast<std::size_t>(k)); };
  if (name[stem.size()] == '0' || (!flips.empty() && std::none_of(flips.begin(), flips.end(), wanted)))
    return std::nullopt;
  return of_twice_the_period(branch->given());
}

}  // namespace whirl::study
