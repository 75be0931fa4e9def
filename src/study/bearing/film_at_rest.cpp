#include "study/bearing/film_at_rest.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/io/brief.hpp"

namespace whirl::study {

using Pair = FilmAtRest::Pair;

JournalPlace rest_at(film::Film& film, const film::JournalMotion& motion, std::vector<double> states) {
  JournalPlace out{motion, std::move(states), {}};
  if (out.states.size() != film.states()) {
    out.states.assign(film.states(), 0.0);
    film.unloaded(motion, out.states);
  }
  film::relax(film, motion, out.states);
  film::StateResponse response;
  const std::vector<double> rest(out.states.size(), 0.0);
  film.evaluate(motion, out.states, rest, film::Need::force, response);
  out.force = {response.journal.force[0], response.journal.force[1]};
  return out;
}

std::string in_words(const Capacity& most) {
  return fmt::format(
      "Where it pushes to no side the film carries at most {:.6g} N, at an eccentricity of {:.3g} clearances{}",
      most.load, most.eccentricity, most.rises ? ", and more closer to the wall" : "");
}

void put_capacity(io::StudySummary& summary, const Capacity& most) {
  summary.set("capacity.load", most.load, "N");
  summary.set("capacity.eccentricity", most.eccentricity, "1");
}

std::string capacity_words(const Values& v) {
  if (!v.get("capacity.load")) return {};
  return fmt::format("the film carries at most {}, at eccentricity {}", io::reading(v["capacity.load"]),
                     io::reading(v["capacity.eccentricity"]));
}

std::optional<NoPlace> agreed_place(MPI_Comm comm, const std::function<void()>& compute) {
  std::optional<NoPlace> none;
  core::agree(comm, [&] {
    try {
      compute();
    } catch (const NoPlace& error) {
      none = error;
    }
  });
  int rank = 0, size = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &size);
  int mine = none ? rank : size, source = size;
  MPI_Allreduce(&mine, &source, 1, MPI_INT, MPI_MIN, comm);
  if (source == size) return std::nullopt;
  std::string text = none ? none->what() : "";
  std::array<double, 4> facts{};
  if (none) facts = {none->speed, none->most.load, none->most.eccentricity, none->most.rises ? 1.0 : 0.0};
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, source, comm);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, source, comm);
  MPI_Bcast(facts.data(), static_cast<int>(facts.size()), MPI_DOUBLE, source, comm);
  return NoPlace(text, facts[0], {facts[1], facts[2], facts[3] != 0});
}

WithoutFilm agreed_film(MPI_Comm comm, const std::function<void()>& compute) {
  WithoutFilm out;
  const auto none = agreed_place(comm, [&] {
    std::optional<NoPlace> no_place;
    (void)has_answer(
        [&] {
          try {
            compute();
          } catch (const NoPlace& error) {
            no_place = error;
            throw;
          }
        },
        &out.reason);
    if (no_place) throw *no_place;
  });
  if (none) out = {none->what(), none->most};
  return out;
}

FilmAtRest::FilmAtRest(const system::Support& support, double speed)
    : clearance_(support.geometry.clearance),
      film_(film::condense(film::make_film(support.geometry, support.film, support.lubricant))) {
  motion_.speed = speed;
}

void FilmAtRest::hold(const Pair& place) {
  film::JournalMotion there = motion_;
  there.position = {place[0], place[1], 0, 0};
  film::Response answer;
  film_->evaluate(there, film::Need::tangents, answer);
  motion_ = there;
  answer_ = answer;
}

// Newton's method with the film's own stiffness, in steps of at most a quarter of the clearance, which are halved where
// there is no film or the force that is left does not fall.
bool FilmAtRest::try_to_carry(const Pair& load) {
  constexpr int most_steps = 60, most_halvings = 12;
  // Closer to the wall the wedge of any film carries any load, on paper.
  constexpr double thinnest = 0.005;
  const Eigen::Vector2d wanted(load[0], load[1]);
  const auto left = [&] { return Eigen::Vector2d(Eigen::Vector2d(answer_.force[0], answer_.force[1]) + wanted); };
  for (int step = 0; step < most_steps; ++step) {
    const Eigen::Vector2d before = left();
    if (before.norm() <= place_tolerance * wanted.norm()) return answer_.min_thickness >= thinnest * clearance_;
    Eigen::Matrix2d slope;
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        slope(i, j) = answer_.d_position[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    Eigen::Vector2d move = -slope.partialPivLu().solve(before);
    if (!move.allFinite()) return false;
    move *= std::min(1.0, 0.25 * clearance_ / move.norm());
    const Pair from = place();
    bool closer = false;
    for (int k = 0; k < most_halvings && !closer; ++k, move *= 0.5) {
      closer = has_answer([&] { hold({from[0] + move(0), from[1] + move(1)}); }) && left().norm() < before.norm();
    }
    if (closer) continue;
    hold(from);
    return before.norm() <= 100 * place_tolerance * wanted.norm() && answer_.min_thickness >= thinnest * clearance_;
  }
  return false;
}

void FilmAtRest::carry(const Pair& load) {
  const double size = std::hypot(load[0], load[1]);
  // From the last place, or else from ones on the way of the load: at the centre some films have no stiffness.
  for (const double part : {0.0, 0.1, 0.4, 0.7}) {
    bool carried = false;
    (void)has_answer([&] {
      if (part > 0 || !(answer_.force[0] != 0 || answer_.force[1] != 0))
        hold({part * clearance_ * load[0] / size, part * clearance_ * load[1] / size});
      carried = try_to_carry(load);
    });
    if (carried) return;
  }
  const Capacity most = capacity(load);
  throw NoPlace(fmt::format("no equilibrium: no place of the journal was found where the film carries {:.6g} N at "
                            "{:.6g} rad/s. {}",
                            size, motion_.speed, in_words(most)),
                motion_.speed, most);
}

double FilmAtRest::lifted(const Pair& load, double eccentricity, double& from) {
  const double size = std::hypot(load[0], load[1]);
  const Pair along = {load[0] / size, load[1] / size}, aside = {-along[1], along[0]};
  double up = 0;
  const auto miss = [&](double angle) {
    const double u = eccentricity * clearance_ * std::cos(angle), v = eccentricity * clearance_ * std::sin(angle);
    hold({u * along[0] + v * aside[0], u * along[1] + v * aside[1]});
    up = -(answer_.force[0] * along[0] + answer_.force[1] * along[1]);
    return std::atan2(-(answer_.force[0] * aside[0] + answer_.force[1] * aside[1]), up);
  };
  constexpr double none = std::numeric_limits<double>::quiet_NaN(), straight = 1e-6;
  try {
    double before = from, d_before = miss(before), angle = before + std::clamp(-d_before, -0.3, 0.3);
    for (int k = 0; k < 40; ++k) {
      const double d = miss(angle);
      if (std::abs(d) < straight) {
        from = angle;
        return up;
      }
      if (angle == before) return none;
      const double slope = (d - d_before) / (angle - before);
      const double step = slope != 0 ? std::clamp(-d / slope, -0.3, 0.3) : -d;
      before = angle;
      d_before = d;
      angle += step;
    }
  } catch (const core::DomainError&) {
  } catch (const core::NotConverged&) {
  }
  return none;
}

Capacity FilmAtRest::capacity(const Pair& load) {
  constexpr double first = 0.05, last = 0.95, step = 0.05;
  Capacity out;
  double angle = 0;
  bool largest_last = false;  // of the places with an answer
  for (double e = first; e < last + 0.5 * step; e += step) {
    const double up = lifted(load, e, angle);
    // Beyond a place without an answer nothing is known: the load may go on rising.
    if (!std::isfinite(up) && largest_last) out.rises = true;
    largest_last = up > out.load;
    if (largest_last) out = {up, e, e > last - 0.5 * step};
  }
  if (out.rises || !(out.load > 0)) return out;
  // Golden section about the largest.
  constexpr double golden = 0.3819660112501051, narrow = 1e-4;
  double low = out.eccentricity - step, high = out.eccentricity + step;
  double a = low + golden * (high - low), b = high - golden * (high - low);
  double at_a = lifted(load, a, angle), at_b = lifted(load, b, angle);
  while (high - low > narrow) {
    if (at_a > at_b || !std::isfinite(at_b)) {
      high = std::exchange(b, a);
      at_b = at_a;
      a = low + golden * (high - low);
      at_a = lifted(load, a, angle);
    } else {
      low = std::exchange(a, b);
      at_a = at_b;
      b = high - golden * (high - low);
      at_b = lifted(load, b, angle);
    }
  }
  for (const auto& [e, up] : {std::pair{a, at_a}, {b, at_b}})
    if (up > out.load) out = {up, e, false};
  return out;
}

}  // namespace whirl::study
