#pragma once
// At which speeds of a linear study the equilibrium is stable.

#include <functional>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"

namespace whirl::study {

/// At most 13 of rising speeds, evenly spread with both ends; a count at each costs an eigenvalue problem.
[[nodiscard]] std::vector<double> few_speeds(const std::vector<double>& speeds);

/// Numbers of eigenvalues that grow about the equilibria over rising speeds. They are counted at some of the speeds,
/// and between two of these that differ by halves. Other speeds take the number of the counted ones beside them: a
/// stretch with another number between two of these is not seen.
class StableSpeeds {
public:
  static constexpr int unknown = -1;  ///< eigenvalues may be missing, or could not be computed
  /// The numbers at some of the speeds.
  using Count = std::function<std::vector<int>(const std::vector<double>& speeds)>;

  StableSpeeds() = default;
  /// Of rising speeds. Those in `first` are counted first; they are among the speeds, in any order, with both ends.
  /// Calls `count` a few times.
  StableSpeeds(std::vector<double> speeds, const std::vector<double>& first, const Count& count);

  [[nodiscard]] bool known() const { return !speeds_.empty(); }
  /// At how many speeds.
  [[nodiscard]] std::size_t counted() const { return counted_; }
  /// At one of the speeds.
  [[nodiscard]] int at(double speed) const;
  /// "stable", "unstable", "undetermined" of a number.
  [[nodiscard]] static const char* word(int number);

  /// Neighbouring speeds with one word.
  struct Stretch {
    double from = 0, to = 0;
    std::string stability;
  };
  [[nodiscard]] std::vector<Stretch> stretches() const;

private:
  std::vector<double> speeds_;
  std::vector<int> numbers_;
  std::size_t counted_ = 0;
};

/// Puts the verdict over the speeds, shown in `unit`: "stable at the N speeds counted" if these are. And a warning that
/// names where the equilibrium is unstable, with the `consequence` for the study, or not known.
void put_verdict(io::StudySummary& summary, const StableSpeeds& stable, const std::string& unit,
                 const std::string& consequence);

}  // namespace whirl::study
