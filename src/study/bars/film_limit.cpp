#include "study/bars/film_limit.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "study/state_rows.hpp"

namespace whirl::study {

FilmLimit::FilmLimit(const system::ShownPlaces& places)
    : names_(places.names), limits_(places.least_films), clearances_(places.clearances) {}

double FilmLimit::margin(double thickness, std::size_t place) const {
  const double unit = clearances_[place] > 0 ? clearances_[place] : 1;
  return (thickness - limits_[place]) / unit;
}

double FilmLimit::margin(const std::vector<double>& thickness) const {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < limits_.size() && k < thickness.size(); ++k)
    least = std::min(least, margin(thickness[k], k));
  return least;
}

std::size_t FilmLimit::worst(const std::vector<double>& thickness) const {
  std::size_t out = 0;
  for (std::size_t k = 1; k < limits_.size() && k < thickness.size(); ++k)
    if (margin(thickness[k], k) < margin(thickness[out], out)) out = k;
  return out;
}

std::string FilmLimit::reason(const std::vector<double>& thickness) const {
  const std::size_t at = worst(thickness);
  if (limits_[at] <= 0) return fmt::format("the journal touches bearing {}", names_[at]);
  return fmt::format("film of bearing {} falls below {:.3g} um (minimum_film)", names_[at], limits_[at] * 1e6);
}

std::string FilmLimit::ends(const std::vector<double>& thickness) const {
  return reason(thickness) + (limits_[worst(thickness)] > 0
                                  ? ". With 'minimum_film: 0 um' the motion goes on until the surfaces touch"
                                  : "");
}

std::string FilmLimit::thinnest(const std::vector<double>& thickness) const {
  if (limits_.empty() || thickness.empty()) return "";
  const std::size_t at = worst(thickness);
  if (!std::isfinite(thickness[at])) return "";
  return fmt::format("; the film of bearing {} is {:.3g} um thick", names_[at], thickness[at] * 1e6);
}

void FilmLimit::warn(const std::vector<double>& thickness, const std::string& where, io::StudySummary& summary) const {
  for (std::size_t k = 0; k < limits_.size() && k < thickness.size(); ++k)
    if (thickness[k] < limits_[k] || thickness[k] <= 0)
      summary.warnings.push_back(
          fmt::format("film of bearing {} {}: {:.3g} um, less than the {:.3g} um below which "
                      "the surfaces touch (minimum_film)",
                      names_[k], where, thickness[k] * 1e6, limits_[k] * 1e6));
}

void MarginSlope::add(double parameter, double margin) {
  if (!any_) begin_ = parameter;
  if (any_ && parameter != parameter_) {
    if ((parameter - parameter_) * (parameter_ - begin_) < 0) begin_ = parameter_;
    slope_ = (margin - margin_) / (parameter - parameter_);
    step_ = std::abs(parameter - parameter_);
  }
  parameter_ = parameter;
  margin_ = margin;
  any_ = true;
}

double contact_there(double place, const MarginSlope& here, const std::function<double(double)>& margin) {
  constexpr int most_looks = 60, most_halvings = 6;
  constexpr double close = 1e-2, exact = 1e-6;  // of what the places differ by; of the parameter
  constexpr double farthest = 8;                // times the parameter
  // The last step may have been cut to nothing where the contact was located.
  constexpr double least_step = 1e-2;  // of the parameter
  const double slope = here.value();
  double step = std::max(here.step(), least_step * std::abs(place));
  if (!std::isfinite(slope) || slope == 0 || step == 0) return unknown;
  const double ahead = slope > 0 ? -1 : 1;
  struct Look {
    double at = unknown, margin = unknown;
    [[nodiscard]] bool known() const { return std::isfinite(margin); }
  };
  Look thick, thin;  // the last ones with a film that is thick enough, and with one that is not
  Look last{place, margin(place)};
  const double first_step = step;
  int halvings = 0;
  bool was_lost = true;
  for (int k = 0; k < most_looks; ++k) {
    if (last.known()) {
      (last.margin > 0 ? thick : thin) = last;
      if (last.margin == 0) return last.at;
      halvings = 0;
    }
    double next = unknown;
    if (thick.known() && thin.known()) {
      next = thick.at + (thin.at - thick.at) * thick.margin / (thick.margin - thin.margin);
      if (std::abs(thin.at - thick.at) <= std::max(close * std::abs(next - place), exact * std::abs(place)))
        return next;
      // One end must not stay for ever: a curved margin leaves it far away.
      if (k % 3 == 2) next = (thick.at + thin.at) / 2;
    } else if (thick.known()) {
      if (!last.known() && ++halvings > most_halvings) return unknown;
      // A step that had to be halved is the next one, too.
      if (!last.known())
        step /= 2;
      else if (!was_lost)
        step *= 2;
      next = thick.at + ahead * step;
    } else {
      // Neither a solution nor one with a film that is thick enough: back along the branch, over its beginning by small
      // steps.
      next = last.at - ahead * step;
      step *= 2;
      if ((last.at - here.begin()) * ahead > 0 && (next - here.begin()) * ahead < 0) {
        next = here.begin();
        step = first_step;
      }
    }
    if (std::abs(next - place) > farthest * std::abs(place)) return unknown;
    was_lost = !last.known();
    last = {next, margin(next)};
    if (last.known() && last.margin > 0 && !thick.known()) step = first_step;
    // Behind a bracket that a solution is missing in nothing can be told.
    if (thick.known() && thin.known() && !last.known() && ++halvings > most_halvings) return unknown;
  }
  return unknown;
}

namespace {

// Whether refining moves the place farther each time: of meshes of one direction from the coarsest to the finest.
bool runs_away(double place, std::vector<Sample> there) {
  there.push_back({there.front().axis, 1, place});
  std::sort(there.begin(), there.end(), [](const auto& a, const auto& b) { return a.spacing > b.spacing; });
  for (std::size_t k = 2; k < there.size(); ++k) {
    const double coarse =
                     (there[k - 1].value - there[k - 2].value) / std::log(there[k - 2].spacing / there[k - 1].spacing),
                 fine = (there[k].value - there[k - 1].value) / std::log(there[k - 1].spacing / there[k].spacing);
    if (!(fine * coarse > 0 && std::abs(fine) >= std::abs(coarse))) return false;
  }
  return there.size() > 2;
}

}  // namespace

void put_contact(io::StudySummary& summary, double place, const std::string& unit, double location, const MeshLaw& law,
                 const std::vector<Sample>& there) {
  Bars bars({place}, law);
  bool with_time = false, away = false;
  std::vector<std::string> others;
  for (const Sample& m : there) {
    bars.add(m.axis, m.spacing, {m.value});
    with_time |= m.axis == Axis::time;
    others.push_back(std::isfinite(m.value) ? fmt::format("{:.4g} at {:.3g} times its spacing", m.value, m.spacing)
                                            : fmt::format("not found at {:.3g} times its spacing", m.spacing));
  }
  for (const Axis axis : all_axes) {
    std::vector<Sample> own;
    for (const Sample& m : there)
      if (m.axis == axis && std::isfinite(m.value)) own.push_back(m);
    away = away || (!own.empty() && runs_away(place, own));
  }
  Bar bar = bars[0];
  bar.location = location;
  constexpr double says_nothing = 0.5;  // of the place
  const bool told = bar.total() < says_nothing * std::abs(place);
  // Where refining moves it farther each time there is no limit that a bar could hold.
  away = away && !told;
  if (away) bar.film_mesh = unknown;
  auto more = bar.parts(with_time);
  more["uncertainty"] = bar.total();
  summary.set("contact", place, unit, more);
  if (there.empty() || told) return;
  summary.warnings.push_back(fmt::format(
      "where the film becomes too thin depends on the mesh ({:.4g} {} on this one; {}) and says nothing about the "
      "machine{}",
      place, unit, fmt::join(others, "; "),
      away ? ": with each finer mesh it moves farther, so that it has no limit and no error bar" : ""));
}

std::vector<double> film_column(std::vector<double> thickness, std::size_t places) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  thickness.resize(places, none);
  for (double& h : thickness)
    if (!std::isfinite(h)) h = none;
  return thickness;
}

std::vector<double> least_films(const solve::Cycle& cycle, system::Plant& plant) {
  StateRows states(plant);
  std::vector<std::vector<double>> films;  // [node][place]
  for (Eigen::Index k = 0; k < cycle.x.cols(); ++k) {
    films.push_back(states.film_thickness(cycle.x.col(k)));
    if (films.back().empty()) return {};
  }
  const std::size_t n = films.size();
  std::vector<double> least(films.front().size(), std::numeric_limits<double>::infinity());
  for (std::size_t place = 0; place < least.size(); ++place) {
    std::size_t at = 0;
    for (std::size_t k = 1; k < n; ++k)
      if (films[k][place] < films[at][place]) at = k;
    const double a = films[(at + n - 1) % n][place], b = films[at][place], c = films[(at + 1) % n][place];
    const double curvature = a - 2 * b + c;
    least[place] = curvature > 0 && std::isfinite(curvature) ? b - (a - c) * (a - c) / (8 * curvature) : b;
  }
  return least;
}

}  // namespace whirl::study
