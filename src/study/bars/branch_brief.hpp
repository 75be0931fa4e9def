#pragma once
// The answer of a branch of equilibria or cycles: where it is stable, what happens where that changes, what is open.

#include <string>
#include <vector>

#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Neighbouring stretches of one stability as one, in the order of the branch.
struct JoinedStretch {
  double from = io::no_value, to = io::no_value;
  std::string stability = {};
  std::vector<double> turns = {};  ///< where the parameter turns between its ends
};
[[nodiscard]] std::vector<JoinedStretch> joined(const std::vector<io::StabilityRange>& ranges);

/// "Hopf point", "limit point of cycles (fold)", ...
[[nodiscard]] const char* words_of(io::BifurcationType type);
/// The same without what stands in brackets, within a sentence.
[[nodiscard]] std::string short_words_of(io::BifurcationType type);
/// "from 20 to 25 um", "at 20 um" where both are read alike.
[[nodiscard]] std::string from_to(double from, double to, const std::string& unit);
/// The first letter in upper case, a full stop at the end.
[[nodiscard]] std::string as_sentence(std::string words);

/// A row for each bifurcation: place, frequency of what is born, criticality, what it means for the machine.
[[nodiscard]] io::BriefTable table_of_bifurcations(const io::StudySummary& s);
/// A row for each stretch on which bifurcations may lie that could not be resolved.
[[nodiscard]] io::BriefTable table_of_suspicions(const io::StudySummary& s);

/// Where the journals, or the places that another system shows, are at both ends of a branch of equilibria; nothing if
/// all stay at the origin.
[[nodiscard]] io::BriefTable table_of_ends(const io::Group& group);

/// Sentences on stability, threshold and end of a branch of `what` ("equilibrium", "forced vibration", "limit cycle"),
/// and the tables of its bifurcations, its stretches and, last, what is not resolved.
[[nodiscard]] io::Brief brief_of_branch(const io::StudySummary& s, const std::string& what);

}  // namespace whirl::study
