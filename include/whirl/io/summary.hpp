#pragma once
// summary.json: the contract with scripts and users' own tools.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "whirl/io/brief.hpp"
#include "whirl/io/quantity.hpp"

namespace whirl::io {

enum class BifurcationType { fold, hopf, cyclic_fold, flip, neimark_sacker, branch_point };
[[nodiscard]] const char* name_of(BifurcationType type);

/// A located bifurcation: `value` and `uncertainty` in `unit` of `parameter`.
struct Bifurcation {
  BifurcationType type = BifurcationType::fold;
  std::string parameter = {};
  double value = no_value;
  std::string unit = {};
  double period_s = no_value;               ///< of the cycle, or 2 pi/omega of a Hopf point
  double uncertainty = no_value;            ///< estimated absolute error of `value`
  std::string criticality = {};             ///< "supercritical", "subcritical", or empty if not computed
  std::string criticality_by = {};          ///< how it was obtained, or why it was not
  std::string stable_side = {};             ///< "above", "below", "neither"; empty where it is not known
  std::string born = {};                    ///< what begins here: "whirl", "half-frequency whirl", ...; or empty
  std::string sentence = {};                ///< what that means for the machine, in words; or empty
  std::map<std::string, double> more = {};  ///< further numbers, e.g. "whirl_frequency_rad_s", "angle_rad"
};

/// A stretch of a branch with one kind of stability, in the order of the branch: `from` may be above `to`.
struct StabilityRange {
  double from = no_value, to = no_value;
  std::string unit = {};
  std::string stability = {};  ///< stable, undamped, unstable, undetermined
};

/// A point of codimension two on a curve of bifurcations, in both parameters.
struct CodimensionTwo {
  std::string type = {};  ///< resonance_1_2, meeting, cusp, ...
  std::string parameter = {}, second_parameter = {};
  Quantity value = {}, second_value = {};
  double uncertainty = no_value;            ///< estimated absolute error of `second_value`
  std::map<std::string, double> more = {};  ///< as of bifurcations; "uncertainty_parameter" is that of `value`
};

/// A stretch of a branch on which events may lie that could not be resolved.
struct Suspicion {
  double from = no_value, to = no_value;
  std::string unit = {}, reason = {};
};

/// One eigenvalue real + i imag (rad/s) at a speed (in `speed_unit`, that of the study's range).
struct ModeEntry {
  double speed = no_value, real = no_value, imag = no_value, log_decrement = no_value;
  std::string whirl = {};  ///< forward, backward, mixed, planar, either (equal modes)
  std::string speed_unit = "rad/s";
  std::map<std::string, double> more = {};  ///< "real_uncertainty", ...
  /// "stable", "unstable", "undamped" (its real part is rounding), "undetermined" (its bar contains zero), "not
  /// resolved" (a vibration of single elements of the shaft, which decides on nothing); empty where nobody looked.
  std::string stability = {};
  std::string whirl_rule = {};  ///< as `whirl`, by the nodes' sense alone; or empty
};

/// A column of numbers over the points of a curve.
struct Column {
  std::string name = {}, unit = {};
  std::vector<double> values = {};
};

struct StudySummary;

/// One variant of a sweep.
struct VariantSummary {
  std::string name = {};
  std::vector<std::pair<std::string, std::string>> changes = {};  ///< path and value, as text with unit
  std::vector<StudySummary> studies;                              ///< what was asked of it
};

/// One value of all variants of a sweep, in their order; NaN where a variant has none.
struct SweepColumn {
  std::string name = {}, unit = {};
  std::vector<double> values = {}, uncertainties = {};
};

/// How a value changes along one quantity of a sweep.
struct Trend {
  std::string column = {}, quantity = {}, unit = {};
  std::string beside = {};                 ///< the other quantities of a grid, which are constant; else empty
  std::string sign = {};                   ///< "+", "-", "0", "mixed", "undetermined" (the bar contains zero), "no bar"
  std::vector<std::string> variants = {};  ///< by rising quantity
  std::vector<double> at = {};             ///< the quantity of each
  std::vector<double> difference = {};     ///< of the value from each to the next
  std::vector<double> uncertainty = {};    ///< of that
};

/// A peak of a linear response at one place.
struct PeakEntry {
  std::string place = {};  ///< "node 4"; "B1, journal" of a motion in a bearing
  Quantity speed = {}, semi_major = {}, amplification_factor = {};
  Quantity separation_margin = {}, required_margin = {};  ///< without unit where no operating speed is known
  std::string stability = {};                             ///< of the equilibrium there; empty if it was not looked at
  std::string verdict = {};  ///< whether it keeps its distance from the operating speeds; empty if that is not known
  std::vector<std::string> notes = {};  ///< why a number is missing, and what the peak must not be taken for
};

/// One thing that is known of a machine at its service speed.
struct ServiceFact {
  std::string what = {}, place = {};
  Quantity value = {};     ///< not a number where the fact is a word, or where no study gives it
  std::string mark = {};   ///< a verdict, or what has to be known with the value
  std::string study = {};  ///< that it is taken from; empty: no study gives it
};

/// What is known of a machine at its service speed, from the studies that ran.
struct Service {
  Quantity speed = {};
  std::vector<ServiceFact> facts = {};
};

/// What one study delivered.
struct StudySummary {
  std::string name = {}, kind = {};
  std::string status = "completed";  ///< or why it ended early
  double wall_seconds = 0;
  std::string ways = {};    ///< how equations were solved where there was a choice, one line
  std::string layout = {};  ///< how several ranks shared the work; in the file only if there were several
  std::vector<std::pair<std::string, Quantity>> values = {};  ///< dotted names, in the order they were set
  std::vector<Bifurcation> bifurcations = {};
  std::vector<CodimensionTwo> codimension_two = {};  ///< in the file only if there are any
  std::vector<Suspicion> suspected = {};             ///< likewise
  std::string stability = {};                        ///< verdict on the whole branch; likewise
  std::vector<StabilityRange> ranges = {};           ///< of a branch, in its order; likewise
  std::vector<std::string> warnings = {};            ///< what its numbers must not be taken for; likewise
  std::vector<PeakEntry> peaks = {};                 ///< of a response, by place and falling height; likewise
  std::vector<Column> curve = {};                    ///< a curve, column by column of equal length; likewise
  std::vector<ModeEntry> modes = {};
  std::vector<VariantSummary> variants = {};  ///< of a sweep; in the file only if there are any, like what follows
  std::vector<SweepColumn> columns = {};
  std::vector<Trend> trends = {};
  Brief brief = {};  ///< what a reader wants to know first; in the file only if there is any
  long points = 0;

  /// Sets values[key], replacing an earlier one.
  void set(const std::string& key, double value, const std::string& unit, std::map<std::string, double> more = {});
};

/// An option of a library that was in force, and where it came from (empty if that cannot be told).
struct LibraryOption {
  std::string name = {}, value = {}, source = {};
};

/// The whole file; write it again after each study.
struct Summary {
  std::string title = {}, version = {};
  int ranks = 1;
  double wall_seconds = 0;
  std::vector<LibraryOption> options = {};  ///< of PETSc and SLEPc, from whatever source
  std::vector<std::string> warnings = {};   ///< what is unusual about the deck; in the file only if there are any
  Service service = {};                     ///< in the file only if the machine has a service speed
  std::vector<StudySummary> studies = {};

  /// Replaces the study of the same name or appends it.
  void set(StudySummary study);
  [[nodiscard]] std::string to_json() const;
  /// What to_json() made; core::Error if the text is not that.
  [[nodiscard]] static Summary from_json(const std::string& text);
  /// Atomic: temporary name, sync, rename. Call on one rank.
  void write(const std::filesystem::path& path) const;
  /// Reads what `write` wrote; core::Error with the place if the file is missing or not ours.
  [[nodiscard]] static Summary read(const std::filesystem::path& path);
};

}  // namespace whirl::io
