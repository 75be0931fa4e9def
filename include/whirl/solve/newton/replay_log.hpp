#pragma once
// What a computation that may be interrupted has found, so that its repetition goes on where it was.

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "whirl/core/petsc.hpp"

namespace whirl::solve {

/// Answers to costly questions, in the order in which a computation asks them.
///
/// The repetition of an interrupted computation asks the same questions again, up to rounding, and is given the answers
/// that were found. The first question that is another one ends that: the rest of what was found is forgotten. A
/// question may ask others on its way, whose answers are of no use any more once it is answered itself. NotConverged
/// and DomainError are answers too. Every rank asks alike and holds the same, but for its rows of distributed vectors.
/// Nothing here communicates but keep(), give(), `due` and `changed`.
class ReplayLog {
public:
  /// A distributed vector: the whole of it on every rank, or of each rank some rows.
  struct Rows {
    bool whole = true;                 ///< the same on all ranks
    std::size_t begin = 0, total = 0;  ///< place of the first one here, and their number on all ranks
    std::vector<double> values;
  };
  struct Answer {
    std::vector<double> numbers;
    std::string text;
    std::vector<Rows> vectors{};
  };
  enum class State { under_way, answered, not_converged, outside };
  struct Entry {
    std::string kind;
    std::vector<double> question;  ///< tells it from other ones of its kind: norms, parameters
    Answer answer;                 ///< the text of the error if there was one
    State state = State::under_way;
  };

  /// The answer known, or what `work` finds; `so_far` is what an interrupted `work` had noted last, else empty.
  Answer ask(const std::string& kind, const std::vector<double>& question,
             const std::function<Answer(const Answer& so_far)>& work);
  /// The same where there may be no replay log: then `work` finds it.
  static Answer ask(ReplayLog* replay_log, const std::string& kind, const std::vector<double>& question,
                    const std::function<Answer(const Answer& so_far)>& work) {
    return replay_log ? replay_log->ask(kind, question, work) : work({});
  }
  /// What the question under way has come to, if anybody wants to know now (see `due`).
  void note(const std::function<Answer()>& so_far);

  /// What an answer keeps of v: this rank's entries if the ranks of a study share them (by_rows) or nothing is saved
  /// (`replay_log` is null), else all of them. Collective on v.
  [[nodiscard]] static Rows keep(const ReplayLog* replay_log, Vec v);
  /// The other way, into a vector in whatever layout. core::Error if it is of another size. Collective on v.
  static void give(const Rows& rows, Vec v);

  /// Where the next question stands, and forgetting what was asked from there on.
  [[nodiscard]] std::size_t place() const { return next_; }
  /// Whether answers of an interrupted computation wait for their questions.
  [[nodiscard]] bool repeats() const { return next_ < entries_.size(); }
  void forget_from(std::size_t place);

  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// Begins anew with the entries of an interrupted computation.
  void begin(std::vector<Entry> entries = {});

  int by_rows = 0;                ///< answers keep vectors of so many ranks by rows; 0: none
  std::function<bool()> due;      ///< whether it is time to save; collective
  std::function<void()> changed;  ///< called after each answer and note; collective

private:
  struct UnderWay;
  void close(std::size_t place, State state, Answer answer);

  std::vector<Entry> entries_;
  std::size_t next_ = 0;
  std::vector<std::size_t> under_way_;  // the question asked last is the last one
};

}  // namespace whirl::solve
