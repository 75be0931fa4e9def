#pragma once
// What is kept of a branch of cycles, and how it goes into results and checkpoints.

#include <algorithm>
#include <string>
#include <vector>

#include "study/bars/verdict.hpp"
#include "study/state_rows.hpp"
#include "study/stored_vector.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/io/table.hpp"
#include "whirl/solve/branch/continuation.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// Rows of a branch of cycles: extremes of what is shown (journals in their bearings), multipliers, orbits. Replicated
/// on all ranks.
class CycleRecord {
public:
  CycleRecord(system::ShownPlaces places, std::string unit, int multipliers);

  /// Adds a point; `scale` is the SI value of one unit of the parameter.
  void append(const solve::BranchPoint& point, const CycleOrbit& orbit, double scale);
  /// Keeps the cycle that the branch leaves from, of no amplitude at a Hopf point or run through twice at a flip: it
  /// belongs to the branch, but is no point of it.
  void begin(const CycleOrbit& orbit, double scale);
  /// Keeps the cycle that the branch runs into, likewise: the simple one at a flip.
  void close(const CycleOrbit& orbit, double scale);
  /// Removes the last point.
  void drop_last();
  /// What pictures show of a cycle, by their axes: [place and direction][largest, smallest].
  [[nodiscard]] std::vector<std::vector<double>> drawn(const CycleOrbit& orbit) const;
  /// Largest eccentricity per clearance of any journal on a cycle.
  [[nodiscard]] double eccentricity(const CycleOrbit& orbit) const;
  /// Whether all points so far are stable, or all unstable.
  [[nodiscard]] bool one_sided() const;
  /// How often the branch passes a value of the parameter, in the unit of the table.
  [[nodiscard]] int passes(double parameter) const;
  /// Says where waves of a film's mesh grow, which are left out, if any do.
  void warn_of_waves(io::StudySummary& summary) const;
  /// Says at how many points the search for multipliers did not converge, if at any.
  void warn_of_unknown(io::StudySummary& summary) const;
  /// The points so far, by their stability.
  [[nodiscard]] BranchVerdict verdict() const;
  /// Puts peak to peak, extremes and the largest multiplier of a cycle asked for into the summary under `at.<key>.`.
  void report(const std::string& key, const CycleOrbit& orbit, const solve::Stability& stability,
              io::StudySummary& summary);
  [[nodiscard]] bool reported(const std::string& key) const {
    return std::ranges::find(reported_, key) != reported_.end();
  }

  /// Parameter of the last point, in the unit of the branch.
  [[nodiscard]] double last_parameter() const { return table_.column("parameter").back(); }
  /// Of the leading multiplier of a point; not a number if none is known.
  [[nodiscard]] double modulus(int point) const;
  [[nodiscard]] std::size_t points() const { return table_.rows(); }

  /// Calls back with place, x and y of every sample of every point, and its parameter.
  template <class See>
  void for_samples(const See& see) const {
    const std::size_t n = places_.names.size();
    for (std::size_t i = 0; i < orbits_.size(); ++i)
      for (std::size_t k = 0; k < orbits_[i].size(); k += 2)
        see(k / 2 % n, orbits_[i][k], orbits_[i][k + 1], table_.column("parameter")[i]);
  }
  /// Tables `branch` and, if it left from a bifurcation or ran into one, `birth` and `closing` into `group`; with
  /// `everything`, also what a restart needs.
  void write(io::Group& group, bool everything) const;
  void read(const io::Group& group);
  /// `count` orbits spread evenly over the points.
  void write_orbits(io::Group& group, int count) const;

private:
  void keep(io::Table& end, const CycleOrbit& orbit, double scale) const;
  [[nodiscard]] std::vector<double> per_clearance(const std::vector<double>& radius) const;
  system::ShownPlaces places_;
  std::string unit_;
  int multipliers_;
  io::Table table_, birth_, closing_;
  std::vector<std::vector<double>> orbits_;  // per point: [time][place][x, y]
  std::vector<std::string> reported_;
};

/// `like`: null where every rank has the whole cycle, else a state of which it has these rows (see put_columns()).
/// Collective.
void write_cycle(io::Group& group, const solve::Cycle& cycle, const SharedRows& like = {});
[[nodiscard]] solve::Cycle read_cycle(const io::Group& group, const SharedRows& like = {});
void write_summary(io::Group& group, const io::StudySummary& summary);
void read_summary(const io::Group& group, io::StudySummary& summary);

}  // namespace whirl::study
