#pragma once
// What studies found at a speed, between speeds, and where a machine becomes stable or ceases to be; and speeds at
// which tables of coefficients have a row.

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"
#include "whirl/system/options.hpp"

namespace whirl::study {

/// Two speeds nearer than this part of them are one.
constexpr double same_speed = 1e-6;

/// A speed at which a machine becomes stable or ceases to be, with its bar [rad/s].
struct SpeedLimit {
  double at, error;
  bool stable_below;
};

/// The bar of what a study located at `speed` [rad/s]; 0 if it located nothing there or has no bar.
[[nodiscard]] double error_at(const io::StudySummary& summary, double speed);

/// Those between the stretches over the speed that a branch or modes found (`StudySummary::ranges`).
[[nodiscard]] std::vector<SpeedLimit> limits_of(const io::StudySummary& summary);

/// A value between the two computed speeds about a place, in a straight line; they are one where that was computed.
struct Interpolated {
  double value, below, above;
};

/// Of values over speeds that at `speed`; nothing outside these speeds, but for `slack` beyond either end: what a
/// revolution of a run-up leaves to the ends of its range. Values that are no numbers are passed over.
[[nodiscard]] std::optional<Interpolated> at_speed(const std::vector<double>& speeds,
                                                   const std::function<double(std::size_t)>& value, double speed,
                                                   double slack);

/// "between A and B UNIT, which were computed"; empty where the speed itself was.
[[nodiscard]] std::string between_words(const Interpolated& at, const std::string& unit);

/// The bar of a quantity as it is stored; nothing of one that is not known.
[[nodiscard]] std::map<std::string, double> bar(double error);
/// A value of a study by its name; null if there is none or it is not finite.
[[nodiscard]] const io::Quantity* find(const io::StudySummary& summary, const std::string& name);

/// Words of stability by rising doubt whether the machine can run; what grows for sure is beyond doubt.
namespace doubt {
inline constexpr std::array words{"stable", "undamped", "undetermined", "unstable"};
inline constexpr std::size_t stable = 0, undetermined = 2, unstable = 3;
/// The place of a word among them: "diverges" is unstable, an unknown one undetermined.
[[nodiscard]] std::size_t rank_of(const std::string& word);
}  // namespace doubt

/// What the modes at one computed speed [rad/s] say together: the worst word, and the least decrement with its bar.
struct ModesAt {
  double speed = 0;
  std::size_t worst = doubt::stable;  ///< among `doubt::words`
  double decrement = io::no_value, error = io::no_value;
};
/// By rising speed.
[[nodiscard]] std::vector<ModesAt> modes_by_speed(const io::StudySummary& summary);

/// What stands between `head` and `tail` in a name, "B3" of "bearing.B3.min_thickness"; nothing if the name is another.
[[nodiscard]] std::optional<std::string> between(const std::string& name, const std::string& head,
                                                 const std::string& tail);

/// Puts a speed between rising ones; not one of them, and none beyond their ends.
void put_between(std::vector<double>& speeds, double at);

/// Speeds [rad/s] strictly between `from` and `to` at which a table of an element or of a bearing's coefficients has a
/// row, rising. Between two rows each coefficient lies between its values there, so that a range of instability that a
/// table makes shows at a row, and may show at no other speed. Of more rows than `asked`, 24, or 100,000 over the
/// `states` of the machine, as many are chosen, evenly; a warning, with speeds in `unit`, says so.
[[nodiscard]] std::vector<double> tabled_speeds(const system::Machine& machine, double from, double to,
                                                std::size_t asked, long states, io::StudySummary& summary,
                                                const std::string& unit);

}  // namespace whirl::study
