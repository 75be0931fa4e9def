#include "study/bearing/thd_load.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "study/bearing/held_film.hpp"
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
  Search(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry, double speed, const Pair& load)
      : comm_(comm), options_(options), geometry_(geometry), speed_(speed), load_(load) {}
  virtual ~Search() = default;

  // The last film is that of the place returned. Throws core::NotConverged.
  Pair find(Pair place, double enough) {
    Pair f = left(place);
    if (!std::isfinite(size(f))) give_up("there is no film where the search begins");
    Matrix a{};
    bool fresh = false;
    for (films_ = 1; size(f) > enough;) {
      if (!fresh && (films_ == 1 || stale_)) {
        a = slope();
        fresh = true;
        stale_ = false;
      }
      Pair step = step_of(a, f);
      if (!std::isfinite(size(step))) give_up("the film does not resist its journal");
      double part = part_of(place, step);
      Pair next{}, g{};
      for (int k = 0;; ++k, part /= 2) {
        next = {place[0] + part * step[0], place[1] + part * step[1]};
        g = left(next);
        if (++films_ > most_films) give_up(fmt::format("{:.2g} of it is left after {} films", size(f), most_films));
        if (size(g) < size(f)) break;
        if (k < most_halvings && fresh) continue;
        // A matrix of updates may be wrong altogether: it is made anew at the place that is kept.
        if (fresh) give_up(fmt::format("{:.2g} of it is left", size(f)));
        stale_ = true;
        break;
      }
      if (stale_) {
        f = left(place);
        ++films_;
        if (!std::isfinite(size(f))) give_up("the film is lost at a place where there was one");
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

protected:
  std::unique_ptr<ThdAtSpeed> film_;  // the last one

private:
  // Solves the film at a place, and keeps it; its force [N].
  virtual Pair force_at(std::unique_ptr<ThdAtSpeed> film) = 0;
  // Of the last film, from which the next one starts.
  [[nodiscard]] virtual std::vector<double> pressure() const = 0;

  Pair left(const Pair& place) {
    Pair out{std::numeric_limits<double>::quiet_NaN(), 0};
    (void)has_answer([&] {
      ThdOptions there = options_;
      there.eccentricity = size(place);
      there.attitude = std::atan2(place[1], place[0]);
      out = over_load(force_at(std::make_unique<ThdAtSpeed>(comm_, there, geometry_, speed_)));
    });
    return out;
  }
  // (F + W)/|W|, the same on all ranks.
  [[nodiscard]] Pair over_load(const Pair& force) const {
    Pair out = {(force[0] + load_[0]) / size(load_), (force[1] + load_[1]) / size(load_)};
    core::share(comm_, out.data(), out.size());
    return out;
  }
  // The derivative at the last place, by difference quotients to the side of the wider gap, whatever they leave out.
  [[nodiscard]] Matrix slope() const {
    const Pair& place = film_->place();
    const double clearance = geometry_.clearance, step = 1e-4 * (clearance - size(place));
    std::vector<double> from = pressure();
    const Pair here = over_load(film_->force_beside({0, 0}, from));
    Matrix out{};
    for (std::size_t c = 0; c < 2; ++c) {
      Pair move{};
      move[c] = place[c] > 0 ? -step : step;
      const Pair there = over_load(film_->force_beside(move, from));
      for (std::size_t r = 0; r < 2; ++r) out[r][c] = (there[r] - here[r]) / (move[c] / clearance);
    }
    return out;
  }
  [[noreturn]] void give_up(const std::string& why) const {
    core::NotConverged error(
        fmt::format("no place of the journal was found that carries the load at {:.6g} rad/s: {}", speed_, why));
    error.mark_agreed();
    throw error;
  }

  MPI_Comm comm_;
  const ThdOptions& options_;
  const film::Geometry& geometry_;
  double speed_;
  Pair load_;
  int films_ = 0;
  bool stale_ = false;
};

// Films of the ambient's temperature, which cost a pressure each.
class OneTemperature final : public Search {
public:
  using Search::Search;

private:
  Pair force_at(std::unique_ptr<ThdAtSpeed> film) override {
    film_ = std::move(film);
    return film_->force_beside({0, 0}, pressure_);
  }
  [[nodiscard]] std::vector<double> pressure() const override { return pressure_; }

  std::vector<double> pressure_;
};

// Films with heat, each of which begins with the state of the one before.
class WithHeat final : public Search {
public:
  using Search::Search;
  void start(std::vector<double> state) { state_ = std::move(state); }
  SolvedFilm result() { return {std::move(film_), films(), converged_}; }

private:
  Pair force_at(std::unique_ptr<ThdAtSpeed> film) override {
    if (!state_.empty()) film->thd().start(state_);
    converged_ = film->solve();
    const thermal::FlowReport report = film->thd().flow().report(film->thd().flows());
    const Pair force = {report.force[0], report.force[1]};
    state_ = film->thd().state();
    film_ = std::move(film);
    return force;
  }
  [[nodiscard]] std::vector<double> pressure() const override { return film_->thd().flow().pressure(); }

  std::vector<double> state_;
  bool converged_ = false;
};

}  // namespace

SolvedFilm solve_film(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry, double speed,
                      const FilmStart& start) {
  if (options.load.values.empty()) {
    SolvedFilm out;
    out.film = std::make_unique<ThdAtSpeed>(comm, options, geometry, speed);
    if (!start.state.empty()) out.film->thd().start(start.state);
    out.converged = out.film->solve();
    return out;
  }
  const Pair load = load_along(options.load);
  Pair place{};
  if (start.place) {
    place = *start.place;
  } else {
    // The journal of an oil film goes ahead of its load by about an eighth of a turn, that of a gas at rest with it.
    const double ahead = speed > 0 ? std::numbers::pi / 4 : 0, angle = std::atan2(load[1], load[0]) + ahead;
    OneTemperature search(comm, options, geometry, speed, load);
    place = search.find({0.5 * std::cos(angle), 0.5 * std::sin(angle)}, 1e-2);
  }
  WithHeat search(comm, options, geometry, speed, load);
  search.start(start.state);
  (void)search.find(place, load_tolerance);
  return search.result();
}

}  // namespace whirl::study
