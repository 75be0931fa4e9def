#pragma once
// Sections of motions: planes in the states that cut them, where they crossed, and how they come back there.

#include <string>
#include <vector>

#include "study/motion/assessment.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// A coordinate that decks name: x, y, vx, vy of a place, or a state by its number.
struct StateAt {
  int place = -1;  ///< of ShownPlaces; -1: a state
  int which = 0;   ///< 0 to 3 for x, y, vx, vy; of a state its number from 0
};
/// Throws core::InputError (without a place) with the nearest name if there is none. `states` 0: none can be named.
[[nodiscard]] StateAt state_at(std::string_view name, const std::vector<std::string>& places, PetscInt states);

/// sum factor x coordinate - value, whose sign changes where the plane is crossed.
class SectionPlane {
public:
  struct Term {
    StateAt of;
    double factor = 1;
  };
  SectionPlane(std::vector<Term> terms, double value) : terms_(std::move(terms)), value_(value) {}
  /// Of a state in SI. Collective, the same on all ranks.
  [[nodiscard]] double height(system::Plant& system, Vec x) const;
  /// "B1.y = 1.2e-05 m".
  [[nodiscard]] std::string text(const system::ShownPlaces& places) const;

private:
  std::vector<Term> terms_;
  double value_;
};
[[nodiscard]] SectionPlane plane_of(const SectionOptions& options, const system::ShownPlaces& places, PetscInt states);

/// Watches where a motion is, to choose a plane that it crosses: the mean of the coordinate x or y that travels most,
/// per clearance.
class Watch {
public:
  void see(const std::vector<system::PlaceState>& shown);
  [[nodiscard]] bool seen() const { return count_ > 0; }
  [[nodiscard]] SectionPlane choose(const system::ShownPlaces& places) const;
  void members(auto& archive) { archive(sum_, low_, high_, count_); }

private:
  std::vector<double> sum_, low_, high_;  // [place][x, y]
  double count_ = 0;
};

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
