#pragma once
// The film of one bearing with its journal at rest: held at a place, or where it carries a load.

#include <mpi.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "study/brief.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/system/train.hpp"

namespace whirl::study {

/// Of the load, the force that may be left where the journal is.
inline constexpr double place_tolerance = 1e-9;

/// The most that a film carries in one direction where it pushes to no side, up to 0.95 clearances.
struct Capacity {
  double load = 0;          ///< N
  double eccentricity = 0;  ///< there, in clearances
  bool rises = false;       ///< it still grows with the eccentricity where the search ended
  void members(auto& archive) { archive(load, eccentricity, rises); }
};
[[nodiscard]] std::string in_words(const Capacity& most);
void put_capacity(io::StudySummary& summary, const Capacity& most);
/// What a brief says of it; empty where the film carries its load.
[[nodiscard]] std::string capacity_words(const Values& v);

/// No place of the journal was found where the film carries the load; the text tells what it carries at most.
class NoPlace : public core::NotConverged {
public:
  NoPlace(const std::string& what, double at_speed, const Capacity& capacity)
      : NotConverged(what), speed(at_speed), most(capacity) {}
  double speed;  ///< rad/s
  Capacity most;
};

/// Runs `compute` (which must not communicate) on every rank of `comm`. Where it threw NoPlace on any of them, all
/// ranks get that of the lowest one: all compute the same, but at the most that a film carries the last digit decides,
/// and ranks that part there would wait for each other. Throws as core::agree(). Collective.
[[nodiscard]] std::optional<NoPlace> agreed_place(MPI_Comm comm, const std::function<void()>& compute);

/// Why there is no film; nothing where there is one.
struct WithoutFilm {
  std::string reason = {};
  std::optional<Capacity> most = {};  ///< of a film that does not carry its load
};
/// Runs `compute` as agreed_place() does; also other films that are not there have a reason, see has_answer().
[[nodiscard]] WithoutFilm agreed_film(MPI_Comm comm, const std::function<void()>& compute);

/// A journal at rest and the film that has come to rest with it.
struct JournalPlace {
  film::JournalMotion motion;
  std::vector<double> states;     ///< of the film, if it has any
  std::array<double, 2> force{};  ///< of the film on the journal [N]
};
/// The film at rest at the place and speed of `motion`, from `states`, or where these are none from those of a film
/// that carries nothing. Throws core::DomainError or core::NotConverged.
[[nodiscard]] JournalPlace rest_at(film::Film& film, const film::JournalMotion& motion, std::vector<double> states);

/// At one speed. Not collective; not thread-safe.
class FilmAtRest {
public:
  using Pair = std::array<double, 2>;

  /// @param speed shaft speed [rad/s]
  FilmAtRest(const system::Support& support, double speed);
  /// The journal at `place` (x, y) [m] from the centre of the bearing, without tilt. Throws core::DomainError where the
  /// surfaces touch, core::NotConverged where the film is not found.
  void hold(const Pair& place);
  /// The journal where the film balances `load` [N] on it, to place_tolerance of it, sought from the last place. Throws
  /// NoPlace if there is none; one with a film thinner than 0.005 clearances is none.
  void carry(const Pair& load);
  /// In the direction of `load`.
  [[nodiscard]] Capacity capacity(const Pair& load);

  [[nodiscard]] const film::JournalMotion& motion() const { return motion_; }
  [[nodiscard]] Pair place() const { return {motion_.position[0], motion_.position[1]}; }
  /// Of the film on the journal [N].
  [[nodiscard]] Pair force() const { return {answer_.force[0], answer_.force[1]}; }
  [[nodiscard]] const film::Response& answer() const { return answer_; }

private:
  [[nodiscard]] bool try_to_carry(const Pair& load);
  // The share of the load's direction in the film's force against it at `eccentricity` in clearances, where the film
  // pushes to no side, sought from the angle `from`, which it changes. Not a number where there is no film.
  [[nodiscard]] double lifted(const Pair& load, double eccentricity, double& from);

  double clearance_;
  std::unique_ptr<film::Film> film_;  // its states are condensed
  film::JournalMotion motion_;
  film::Response answer_;
};

}  // namespace whirl::study
