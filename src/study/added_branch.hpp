#pragma once
// Branches that a study adds to the results: born at its flips, or begun at solutions beside its first one.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "whirl/study/study.hpp"

namespace whirl::study {

/// Such a branch. It stands in no deck, so that there is nothing to check.
class AddedBranch final : public Study {
public:
  using Run = std::function<StudyResult(Context&)>;
  using Tell = std::function<io::Brief(const StudyResult&)>;
  AddedBranch(std::string_view kind, std::string name, Run run, Tell tell)
      : kind_(kind), name_(std::move(name)), run_(std::move(run)), tell_(std::move(tell)) {}
  [[nodiscard]] std::string_view kind() const override { return kind_; }
  [[nodiscard]] std::string name() const override { return name_; }
  void validate(const system::Machine& /*machine*/, const deck::Report& /*report*/) const override {}
  [[nodiscard]] StudyResult run(Context& context) override { return run_(context); }
  [[nodiscard]] io::Brief brief(const StudyResult& result,
                                std::span<const io::StudySummary> /*before*/) const override {
    return tell_(result);
  }

private:
  std::string_view kind_;
  std::string name_;
  Run run_;
  Tell tell_;
};

/// "NAME flip K", born at the k-th flip (1-based) of the study `name`.
[[nodiscard]] std::string name_of_doubled(const std::string& name, std::size_t k);
/// "NAME solution K", begun at the k-th solution; the first is the branch's own.
[[nodiscard]] std::string name_of_solution(const std::string& name, std::size_t k);
/// K of a text that has another number in the place of the digit at the end of `like`; nothing if it is none.
[[nodiscard]] std::optional<std::size_t> number_in(std::string_view text, std::string_view like);

}  // namespace whirl::study
