#pragma once
// What a bifurcation means for the machine, in words: the one place that says so, for screen, report and pictures.

#include <string>

#include "study/bars/verdict.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// What a branch is of.
struct BranchKind {
  bool cycles = false;        ///< else equilibria
  bool self_excited = false;  ///< cycles without unbalance
  int turns = 1;              ///< revolutions in a period of forced cycles
  bool shaft = true;          ///< something turns: whirl, else oscillations
  bool linear = false;        ///< no force depends on the motion but in proportion: nothing limits what grows
};

/// "speed", "supply": the last word of a path that is no number.
[[nodiscard]] std::string parameter_word(std::string path);

/// What begins at a bifurcation: "whirl", "half-frequency whirl", "second whirl", "oscillation", ...; empty for folds
/// and branch points.
[[nodiscard]] std::string born_at(io::BifurcationType type, const BranchKind& kind);

/// "whirl" as it is; "an oscillation", "a second whirl".
[[nodiscard]] std::string with_article(const std::string& born);

/// Puts the numbers of unstable values into `b.more`: others_unstable, and unstable_below and unstable_above the
/// parameter there, of a fold unstable_before and unstable_after it along the branch.
void put_counts(io::Bifurcation& b, const BranchChange& change);

/// Puts `stable_side`, `born` and `sentence` into `b`, by its type, counts and criticality.
///
/// With nothing else unstable: where stability is lost with rising parameter, whether what is born grows from nothing
/// (supercritical) or is jumped to (subcritical), on which side; where it is gained, that, and what is left of the
/// motion that ends. `again`: the branch is stable somewhere below as well. Where something is unstable on both sides
/// no more than that another pair becomes unstable, or ceases to be.
void tell(io::Bifurcation& b, const BranchKind& kind, bool again);

/// Verdict, ranges and sentences of a branch that is followed to its end, into its summary.
void conclude(io::StudySummary& summary, const BranchVerdict& verdict, const BranchKind& kind, const std::string& unit);

}  // namespace whirl::study
