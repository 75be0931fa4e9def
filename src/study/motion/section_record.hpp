#pragma once
// Where a motion crossed its section, and how it comes back there.

#include <string>
#include <vector>

#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// Times and what is shown of crossings, the same on all ranks; of states the entries of this rank.
class SectionRecord {
public:
  /// Of the revolution that is under way.
  void add(double time, const std::vector<system::PlaceState>& shown, std::vector<double> scaled);
  /// That revolution counts from now on.
  void close();
  [[nodiscard]] std::size_t count() const { return times_.size(); }
  /// Scaled states [crossing][entries of this rank].
  [[nodiscard]] const std::vector<std::vector<double>>& states() const { return states_; }
  /// x and y of a place [crossing].
  [[nodiscard]] std::vector<std::array<double, 2>> points(std::size_t place, std::size_t places) const;
  /// Mean time from each crossing to the k-th after it, and half of how far these times lie apart [s].
  [[nodiscard]] std::array<double, 2> interval(int k) const;

  void write(io::Group& group, const system::ShownPlaces& places, const std::string& text) const;
  /// Where all ranks share one machine they share the states; `like` has their layout. Collective.
  void save(io::Group& group, bool shared, Vec like) const;
  void load(const io::Group& group, Vec like);

private:
  struct Crossing {
    double time;
    std::vector<double> shown, state;
  };
  std::vector<Crossing> open_;
  std::vector<double> times_, shown_;  // shown: [crossing][place][x, y, vx, vy]
  std::vector<std::vector<double>> states_;
};

}  // namespace whirl::study
