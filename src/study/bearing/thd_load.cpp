#include "study/bearing/thd_load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

using Pair = std::array<double, 2>;
using Matrix = std::array<Pair, 2>;  // [row][column]

constexpr int most_films = 40;
constexpr int most_halvings = 6;

double size(const Pair& a) {
  return std::hypot(a[0], a[1]);
}

// -A^-1 b; not finite where A is singular.
Pair step_of(const Matrix& a, const Pair& b) {
  const double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
  return {-(a[1][1] * b[0] - a[0][1] * b[1]) / det, -(a[0][0] * b[1] - a[1][0] * b[0]) / det};
}

// The part of a step from `at` that leaves half of the smallest gap and goes no further than 0.3 clearances.
double part_of(const Pair& at, const Pair& step) {
  const double length = size(step), far = 0.5 * (1 + size(at));
  double part = length > 0.3 ? 0.3 / length : 1;
  while (size({at[0] + part * step[0], at[1] + part * step[1]}) > far) part *= 0.8;
  return part;
}

// The force that is left at a place, over the load; not a number where there is no film.
class Search {
public:
  virtual ~Search() = default;
  virtual Pair left(const Pair& place) = 0;
  // The derivative at the last place that left() was asked for, whatever it leaves out.
  virtual Matrix slope() = 0;

  // The last call of left() is that of the place returned. Throws core::NotConverged.
  Pair find(Pair place, double enough, double speed) {
    Pair f = left(place);
    if (!std::isfinite(size(f))) give_up(speed, "there is no film where the search begins");
    Matrix a{};
    bool fresh = false;
    for (films_ = 1; size(f) > enough;) {
      if (!fresh && (films_ == 1 || stale_)) {
        a = slope();
        fresh = true;
        stale_ = false;
      }
      Pair step = step_of(a, f);
      if (!std::isfinite(size(step))) give_up(speed, "the film does not resist its journal");
      double part = part_of(place, step);
      Pair next{}, g{};
      for (int k = 0;; ++k, part /= 2) {
        next = {place[0] + part * step[0], place[1] + part * step[1]};
        g = left(next);
        if (++films_ > most_films)
          give_up(speed, fmt::format("{:.2g} of it is left after {} films", size(f), most_films));
        if (size(g) < size(f)) break;
        if (k < most_halvings && fresh) continue;
        // A matrix of updates may be wrong altogether: it is made anew at the place that is kept.
        if (fresh) give_up(speed, fmt::format("{:.2g} of it is left", size(f)));
        stale_ = true;
        break;
      }
      if (stale_) {
        f = left(place);
        ++films_;
        if (!std::isfinite(size(f))) give_up(speed, "the film is lost at a place where there was one");
        continue;
      }
      // Broyden: A += (g - f - A s) s^T/(s^T s).
      const Pair s = {next[0] - place[0], next[1] - place[1]};
      const double square = s[0] * s[0] + s[1] * s[1];
      for (std::size_t r = 0; r < 2; ++r) {
        const double off = g[r] - f[r] - a[r][0] * s[0] - a[r][1] * s[1];
        for (std::size_t c = 0; c < 2; ++c) a[r][c] += off * s[c] / square;
      }
      stale_ = size(g) > 0.5 * size(f);
      fresh = false;
      place = next;
      f = g;
    }
    return place;
  }
  [[nodiscard]] int films() const { return films_; }

private:
  [[noreturn]] static void give_up(double speed, const std::string& why) {
    core::NotConverged error(
        fmt::format("no place of the journal was found that carries the load at {:.6g} rad/s: {}", speed, why));
    error.mark_agreed();
    throw error;
  }
  int films_ = 0;
  bool stale_ = false;
};

ThdOptions at_place(const ThdOptions& options, const Pair& place) {
  ThdOptions out = options;
  out.eccentricity = size(place);
  out.attitude = std::atan2(place[1], place[0]);
  return out;
}

// (F + W)/|W|, the same on all ranks.
Pair left_of(MPI_Comm comm, const Pair& force, const Pair& load) {
  Pair out = {(force[0] + load[0]) / size(load), (force[1] + load[1]) / size(load)};
  core::share(comm, out.data(), out.size());
  return out;
}

// Difference quotients to the side of the wider gap.
Matrix quotients(MPI_Comm comm, ThdAtSpeed& film, double clearance, const Pair& load, std::vector<double> pressure) {
  const Pair& place = film.place();
  const double step = 1e-4 * (clearance - size(place));
  const Pair here = left_of(comm, film.force_beside({0, 0}, pressure), load);
  Matrix out{};
  for (std::size_t c = 0; c < 2; ++c) {
    Pair move{};
    move[c] = place[c] > 0 ? -step : step;
    const Pair there = left_of(comm, film.force_beside(move, pressure), load);
    for (std::size_t r = 0; r < 2; ++r) out[r][c] = (there[r] - here[r]) / (move[c] / clearance);
  }
  return out;
}

// Films of the ambient's temperature, which cost a pressure each.
class OneTemperature final : public Search {
public:
  OneTemperature(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry, double speed,
                 const Pair& load)
      : comm_(comm), options_(options), geometry_(geometry), speed_(speed), load_(load) {}
  Pair left(const Pair& place) override {
    Pair out{std::numeric_limits<double>::quiet_NaN(), 0};
    (void)has_answer([&] {
      film_ = std::make_unique<ThdAtSpeed>(comm_, at_place(options_, place), geometry_, speed_);
      out = left_of(comm_, film_->force_beside({0, 0}, pressure_), load_);
    });
    return out;
  }
  Matrix slope() override { return quotients(comm_, *film_, geometry_.clearance, load_, pressure_); }

private:
  MPI_Comm comm_;
  const ThdOptions& options_;
  const film::Geometry& geometry_;
  double speed_;
  Pair load_;
  std::unique_ptr<ThdAtSpeed> film_;
  std::vector<double> pressure_;
};

// Films with heat, each of which begins with the state of the one before.
class WithHeat final : public Search {
public:
  WithHeat(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry, double speed, const Pair& load,
           std::vector<double> state)
      : comm_(comm), options_(options), geometry_(geometry), speed_(speed), load_(load), state_(std::move(state)) {}
  Pair left(const Pair& place) override {
    Pair out{std::numeric_limits<double>::quiet_NaN(), 0};
    (void)has_answer([&] {
      auto film = std::make_unique<ThdAtSpeed>(comm_, at_place(options_, place), geometry_, speed_);
      if (!state_.empty()) film->thd().start(state_);
      converged_ = film->solve();
      const thermal::FlowReport report = film->thd().flow().report(film->thd().flows());
      out = left_of(comm_, {report.force[0], report.force[1]}, load_);
      state_ = film->thd().state();
      film_ = std::move(film);
    });
    return out;
  }
  Matrix slope() override {
    return quotients(comm_, *film_, geometry_.clearance, load_, film_->thd().flow().pressure());
  }
  SolvedFilm result() { return {std::move(film_), films(), converged_}; }

private:
  MPI_Comm comm_;
  const ThdOptions& options_;
  const film::Geometry& geometry_;
  double speed_;
  Pair load_;
  std::vector<double> state_;
  std::unique_ptr<ThdAtSpeed> film_;
  bool converged_ = false;
};

}  // namespace

std::array<double, 2> load_of(const ThdOptions& options) {
  return options.load.values.size() == 1 ? Pair{0, -options.load.values[0]}
                                         : Pair{options.load.values[0], options.load.values[1]};
}

SolvedFilm solve_film(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry, double speed,
                      const FilmStart& start) {
  if (options.load.values.empty()) {
    SolvedFilm out;
    out.film = std::make_unique<ThdAtSpeed>(comm, options, geometry, speed);
    if (!start.state.empty()) out.film->thd().start(start.state);
    out.converged = out.film->solve();
    return out;
  }
  const Pair load = load_of(options);
  Pair place{};
  if (start.place) {
    place = *start.place;
  } else {
    // The journal of an oil film goes ahead of its load by about an eighth of a turn, that of a gas at rest with it.
    const double ahead = speed > 0 ? std::numbers::pi / 4 : 0, angle = std::atan2(load[1], load[0]) + ahead;
    OneTemperature search(comm, options, geometry, speed, load);
    place = search.find({0.5 * std::cos(angle), 0.5 * std::sin(angle)}, 1e-2, speed);
  }
  WithHeat search(comm, options, geometry, speed, load, start.state);
  (void)search.find(place, load_tolerance, speed);
  return search.result();
}

}  // namespace whirl::study
