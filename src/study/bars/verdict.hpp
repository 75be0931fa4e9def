#pragma once
// What a branch as a whole says about stability: where it is stable, and where that ends.

#include <set>
#include <string>
#include <vector>

#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/solve/branch/continuation.hpp"

namespace whirl::study {

/// Stability of one solution: `undamped` where nothing grows and rounding hides whether something decays.
enum class StabilityClass { stable, undamped, unstable };
[[nodiscard]] const char* name_of(StabilityClass c);
[[nodiscard]] StabilityClass class_of(const solve::Stability& stability);

/// A change of the number of unstable eigenvalues or multipliers between two points of a branch, or a fold.
struct BranchChange {
  int after = 0;               ///< index of the last point before it
  double parameter = 0;        ///< where
  int before = 0, behind = 0;  ///< unstable values on either side, along the branch
  double slope = 0;            ///< its sign is that of the parameter's change along the branch there
  bool fold = false;           ///< the parameter turns
  int bifurcation = -1;        ///< its place among the bifurcations of the summary; -1: not asked for

  /// Unstable values on the side of the smaller, and of the larger parameter. No fold.
  [[nodiscard]] int below() const { return slope > 0 ? before : behind; }
  [[nodiscard]] int above() const { return slope > 0 ? behind : before; }
  void members(auto& archive) { archive(after, parameter, before, behind, slope, fold, bifurcation); }
};
[[nodiscard]] BranchChange change_at(const solve::LocatedEvent& found, int bifurcation);
/// As a table of results. `unit` is that of the parameter.
void put_changes(io::Group& group, const std::vector<BranchChange>& changes, const std::string& unit);

/// Where a branch is stable on one side only.
struct StabilityLimit {
  std::size_t change = 0;     ///< its place among the changes
  bool stable_below = false;  ///< else above
};

/// The points of a branch and what was found between them.
class BranchVerdict {
public:
  /// The points come one after the other; `unstable` values among their eigenvalues or multipliers.
  void add(double parameter, StabilityClass c, int unstable);
  /// Changes in any order.
  void add(const BranchChange& change) { changes_.push_back(change); }
  /// The error of the discretisation leaves open whether this point is stable. It counts where all points are of one
  /// class: beside a located change the next points are doubtful by nature.
  void doubt(int point) { doubts_.insert(point); }
  /// It leaves no doubt at this point: doubt about others does not reach beyond it.
  void settle(int point) { settled_.insert(point); }
  /// The film is not resolved at this point: whatever is stable or changes beside it is undetermined.
  void unresolved(int point) { unresolved_.insert(point); }
  /// Whether a change lies beside such a point, by its place among the bifurcations of the summary.
  [[nodiscard]] bool open_at(int bifurcation) const;

  /// Stretches of one class in the order of the branch, each from change to change; cut at folds. `undetermined`: all
  /// points are of one class, and one is doubtful, from the last settled point before it to the next one, or to the
  /// ends of the branch; or a wave of the mesh grows there. Between two points of different class without a change a
  /// gap is left.
  [[nodiscard]] std::vector<io::StabilityRange> ranges(const std::string& unit) const;
  /// `stable throughout`, `undamped throughout`, `unstable throughout`, `loses stability` (the branch begins stable),
  /// `unstable from its start` (and stable or undamped somewhere), `undamped, then unstable`, `stable or undamped`,
  /// by points and changes together; `undetermined` where one of the first three rests on a doubtful point; empty
  /// without points.
  [[nodiscard]] std::string text() const;
  /// Changes between none and some unstable values, by rising parameter. A fold is one where one half of the branch is
  /// stable: there is no solution nearby on its other side.
  [[nodiscard]] std::vector<StabilityLimit> limits() const;

private:
  struct Point {
    double parameter;
    StabilityClass stability;
    int unstable;
  };
  struct Stretch {
    double from, to;
    StabilityClass stability;
    bool doubtful;
    bool of_mesh = false;  // a wave of the mesh grows, or the film is not resolved
  };
  [[nodiscard]] std::vector<BranchChange> between(std::size_t point) const;
  [[nodiscard]] std::vector<Stretch> stretches() const;
  /// Of each point whether what lies behind it is doubtful; of the last one whether it is itself.
  [[nodiscard]] std::vector<bool> doubtful() const;
  /// The stretches, cut where `doubtful` changes as well.
  [[nodiscard]] std::vector<Stretch> cut(const std::vector<bool>& doubtful) const;
  [[nodiscard]] bool turns_below(const BranchChange& fold) const;
  std::vector<Point> points_;
  std::vector<BranchChange> changes_;
  [[nodiscard]] bool open_at(const BranchChange& change) const;
  std::set<int> doubts_, settled_, unresolved_;
};

/// The limit that is the threshold of a speed: the lowest one below which nothing is unstable. -1 if there is none.
[[nodiscard]] int threshold_among(const std::vector<StabilityLimit>& limits);

}  // namespace whirl::study
