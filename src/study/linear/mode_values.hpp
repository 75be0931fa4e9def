#pragma once
// What modes say of the machine in numbers with names, and in warnings.

#include <string>
#include <vector>

#include "study/linear/mode_bars.hpp"
#include "study/linear/mode_stations.hpp"
#include "study/linear/mode_tables.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/io/table.hpp"

namespace whirl::study {

/// Whether a mode that grows does so for sure: it is no vibration of the elements (unresolved.hpp, which equilibria ask
/// as well), and its real part exceeds its bar. A mode that is listed for its growth alone and has no counterpart on
/// the other meshes is one of the mesh.
[[nodiscard]] bool surely_grows(const ShaftMode& mode, double speed, const ModeBars& bars);
/// "stable", "undamped", "unstable", "undetermined" (the bar of the real part contains zero, or a mode that grows has
/// no counterpart on the other meshes), "diverges" of a real eigenvalue above zero, or `not_resolved` of a vibration of
/// the elements, which decides on no verdict.
[[nodiscard]] const char* stability_of(const ShaftMode& mode, double speed, const ModeBars& bars);

class ModeValues {
public:
  /// `unit` of speeds. All arguments outlive this.
  ModeValues(std::string unit, const ModeTables& tables, const ModeBars& bars)
      : unit_(std::move(unit)), tables_(tables), bars_(bars) {}

  /// Of single speeds, as "at.SPEED.": frequency [rad/s], log_decrement and damping_ratio of the first forward mode
  /// (`first_forward.`, that of lowest frequency) and of the least damped one (`least_damped.`), and how many modes
  /// grow for sure (`unstable`), and how many decide on nothing (`not_resolved`, if any). One warning names the speeds
  /// at which some grow, and these modes at the last of them.
  void put_speeds(io::StudySummary& summary, const std::vector<Station>& stations) const;
  /// Of a range: "unstable.K." with from, to, mode and frequency, and a table; `errors` of the speeds of the crossings
  /// [rad/s]. Ranges of stability and "threshold" are those of a branch over these speeds. A warning names the ranges.
  /// Modes that nowhere grow for sure are left out.
  void put_ranges(io::Group& group, io::StudySummary& summary, const std::vector<Station>& stations,
                  const std::vector<UnstableRange>& ranges, const std::vector<double>& errors) const;
  /// Motions that fall away before they vibrate: a table, and how many there are at the last speed.
  void put_overdamped(io::Group& table, io::StudySummary& summary, const std::vector<Station>& stations) const;

private:
  /// What grows there, in words.
  [[nodiscard]] std::vector<std::string> put_speed(io::StudySummary& summary, const Station& station) const;
  void put_stability(io::StudySummary& summary, const std::vector<Station>& stations,
                     const std::vector<UnstableRange>& sure, const std::vector<double>& errors) const;
  [[nodiscard]] std::string words_of(const ShaftMode& mode, std::complex<double> lambda) const;

  std::string unit_;
  const ModeTables& tables_;
  const ModeBars& bars_;
};

}  // namespace whirl::study
