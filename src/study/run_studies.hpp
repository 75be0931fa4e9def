#pragma once
// The studies of a deck, one after another.

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "whirl/study/deck.hpp"

namespace whirl::study {

using Say = std::function<void(const std::string& line, bool transient)>;

/// Where the results of studies go, one after another. Every rank holds the same.
class Store {
public:
  Store() = default;
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;
  virtual ~Store() = default;
  /// True if an earlier run finished this study and it delivered something; its results are kept.
  [[nodiscard]] virtual bool finished(const std::string& name) const = 0;
  /// Where that study keeps its checkpoint. Collective.
  [[nodiscard]] virtual std::filesystem::path checkpoint_path(const std::string& study) = 0;
  /// Takes the result of a study; its checkpoint goes. Collective.
  virtual void add(StudyResult result) = 0;
  /// Results of the studies that are finished: a group for each, under io::safe_name of its name.
  [[nodiscard]] virtual const io::Group& studies() const = 0;
  [[nodiscard]] virtual std::span<const io::StudySummary> summaries() const = 0;
};

/// Runs all studies of `deck` in turn, and those that their results call for; what is finished already is skipped if
/// `resume`. Collective.
void run_studies(MPI_Comm comm, const Deck& deck, const Say& say, bool resume, Store& store);

}  // namespace whirl::study
