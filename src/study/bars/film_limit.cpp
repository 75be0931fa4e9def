#include "study/bars/film_limit.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

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
  if (any_ && parameter != parameter_) {
    slope_ = (margin - margin_) / (parameter - parameter_);
    step_ = std::abs(parameter - parameter_);
  }
  parameter_ = parameter;
  margin_ = margin;
  any_ = true;
}

double contact_there(double place, const MarginSlope& here, const std::function<double(double)>& margin) {
  constexpr int most_back = 6, most_looks = 20, most_halvings = 5;
  constexpr double close = 1e-2, exact = 1e-6;  // of what the places differ by; of the parameter
  // The last step may have been cut to nothing where the contact was located.
  constexpr double least_step = 1e-2;  // of the parameter
  double p = place, m = margin(p), slope = here.value(), step = std::max(here.step(), least_step * std::abs(place));
  if (!std::isfinite(slope) || slope == 0 || step == 0) return unknown;
  for (int k = 0; k < most_back && !std::isfinite(m); ++k, step *= 2) {
    p += std::copysign(step, slope);  // where the film is thicker
    m = margin(p);
  }
  for (int k = 0; k < most_looks && std::isfinite(m); ++k) {
    if (std::abs(m / slope) <= std::max(close * std::abs(p - place), exact * std::abs(place))) return p - m / slope;
    double q = p - std::clamp(m / slope, -step, step), there = margin(q);
    for (int halvings = 0; halvings < most_halvings && !std::isfinite(there); ++halvings) {
      q = (p + q) / 2;
      there = margin(q);
    }
    const double next = (there - m) / (q - p);
    if (!(next * slope > 0)) return unknown;
    step = 2 * std::abs(q - p);
    p = q, m = there, slope = next;
  }
  return unknown;
}

void put_contact(io::StudySummary& summary, double place, const std::string& unit, double location, const MeshLaw& law,
                 const std::vector<ContactThere>& there) {
  Bars bars({place}, law);
  bool with_time = false;
  for (const ContactThere& m : there) {
    bars.add(m.axis, m.spacing, {m.place});
    with_time |= m.axis == Axis::time;
  }
  Bar bar = bars[0];
  bar.location = location;
  auto more = bar.parts(with_time);
  more["uncertainty"] = bar.total();
  summary.set("contact", place, unit, more);
  constexpr double says_nothing = 0.5;  // of the place
  if (there.empty() || bar.total() < says_nothing * std::abs(place)) return;
  std::vector<std::string> others;
  for (const ContactThere& m : there)
    if (std::isfinite(m.place)) others.push_back(fmt::format("{:.4g}", m.place));
  summary.warnings.push_back(
      fmt::format("where the film becomes too thin hangs on the mesh ({:.4g} {} on this one, {}) and says nothing "
                  "about the machine",
                  place, unit,
                  others.empty() ? "nowhere near it on others" : fmt::format("{} on others", fmt::join(others, ", "))));
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
