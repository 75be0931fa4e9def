#include "study/linear/response_record.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "study/bars/film_limit.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {

ResponseAtSpeed ResponseAtSpeed::without_answer(double speed, std::size_t n_nodes, std::size_t n_bearings) {
  constexpr NodeMotion none{{io::no_value, io::no_value}, {io::no_value, io::no_value}};
  return {speed, io::no_value, std::vector(n_nodes, none), std::vector(n_bearings, none),
          std::vector(n_bearings, io::no_value)};
}

ResponseCurve curve_at(const std::vector<ResponseAtSpeed>& curve, Places places, std::size_t at) {
  ResponseCurve of;
  for (const ResponseAtSpeed& r : curve) {
    of.speed.push_back(r.speed);
    const double height = (r.*places)[at].semi_major();
    of.height.push_back(height > motion_rounding * r.largest ? height : 0);
  }
  return of;
}

void put_operating(const std::vector<std::string>& names, const std::vector<int>& nodes, const ResponseAtSpeed& r,
                   io::StudySummary& summary) {
  for (std::size_t b = 0; b < names.size(); ++b) {
    summary.set("operating.bearing." + names[b] + ".x", std::abs(r.bearings[b].x), "m");
    summary.set("operating.bearing." + names[b] + ".y", std::abs(r.bearings[b].y), "m");
  }
  for (std::size_t k = 0; k < nodes.size(); ++k)
    summary.set(fmt::format("operating.node.{}.semi_major", nodes[k]), r.nodes[k].semi_major(), "m");
}

void put_motion(io::Group& g, const std::vector<ResponseAtSpeed>& curve, Places place, const std::string& text) {
  const io::Shape shape{curve.size(), (curve.front().*place).size()};
  std::map<std::string, std::vector<double>> column;
  for (const ResponseAtSpeed& r : curve)
    for (const NodeMotion& m : r.*place) {
      column["x_amplitude"].push_back(std::abs(m.x));
      column["x_phase"].push_back(std::arg(m.x));
      column["y_amplitude"].push_back(std::abs(m.y));
      column["y_phase"].push_back(std::arg(m.y));
      column["semi_major"].push_back(m.semi_major());
      column["semi_minor"].push_back(m.semi_minor());
    }
  for (auto& [name, values] : column) {
    const bool phase = name.ends_with("phase");
    g.put(name, shape, std::move(values), phase ? "rad" : "m",
          text + (phase ? ", phase ahead of the shaft angle" : ", 0-peak"));
  }
}

namespace {

bool too_thin(double film, double least) {
  return std::isfinite(film) && (film <= 0 || film < least);
}

}  // namespace

std::string touched(const ResponseAtSpeed& r, const system::ShownPlaces& places) {
  for (std::size_t b = 0; b < r.films.size(); ++b)
    if (too_thin(r.films[b], places.least_films[b])) return places.names[b];
  return {};
}

void put_films(io::Group& group, io::StudySummary& summary, const system::ShownPlaces& places,
               const std::vector<ResponseAtSpeed>& curve, const std::string& unit) {
  std::vector<double> all;
  std::vector<std::int64_t> answers;
  for (const ResponseAtSpeed& r : curve) {
    const auto films = film_column(r.films, places.names.size());
    all.insert(all.end(), films.begin(), films.end());
    answers.push_back(std::isfinite(r.largest) && touched(r, places).empty() ? 1 : 0);
  }
  group.child("response")
      .put("answer", answers,
           "1 where the linear motion leaves every bearing its film; 0: it is no answer, or there is none");
  group.child("bearings")
      .put("film_min", {curve.size(), places.names.size()}, all, "m",
           "smallest film thickness that the linear motion leaves, at mid-plane of films that do not tilt, not a "
           "number without a film");
  for (std::size_t b = 0; b < places.names.size(); ++b) {
    const ResponseAtSpeed *worst = nullptr, *first = nullptr, *last = nullptr;
    for (const ResponseAtSpeed& r : curve) {
      if (!std::isfinite(r.films[b])) continue;
      if (!worst || r.films[b] < worst->films[b]) worst = &r;
      if (!too_thin(r.films[b], places.least_films[b])) continue;
      if (!first) first = &r;
      last = &r;
    }
    if (!worst) continue;
    summary.set("bearing." + places.names[b] + ".film_min", worst->films[b], "m");
    if (first)
      summary.warnings.push_back(
          fmt::format("the linear motion {} bearing {} at {:.6g} {}, where surfaces touch below {:.3g} um "
                      "(minimum_film): no answer "
                      "between {:.6g} and {:.6g} {}",
                      worst->films[b] < 0 ? fmt::format("is {:.3g} um larger than the film of", -worst->films[b] * 1e6)
                                          : fmt::format("leaves {:.3g} um of film in", worst->films[b] * 1e6),
                      places.names[b], deck::from_si(worst->speed, unit), unit, places.least_films[b] * 1e6,
                      deck::from_si(first->speed, unit), deck::from_si(last->speed, unit), unit));
  }
}

namespace {

// Places show one resonance at speeds that differ by parts of this: one of them is counted.
constexpr double one_resonance = 1e-3;

}  // namespace

std::vector<ResponsePlace> places_of(const std::vector<int>& nodes, const std::vector<std::string>& bearings) {
  std::vector<ResponsePlace> out;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    out.push_back({fmt::format("node {}", nodes[k]), fmt::format("node.{}", nodes[k]), &ResponseAtSpeed::nodes, k});
  for (std::size_t b = 0; b < bearings.size(); ++b)
    out.push_back({bearings[b] + ", journal", "bearing." + bearings[b], &ResponseAtSpeed::bearings, b});
  return out;
}

std::vector<std::size_t> tops_of(const ResponseCurve& curve) {
  std::vector<std::size_t> tops = curve.tops();
  std::ranges::stable_sort(tops, std::greater{}, [&](std::size_t k) { return peak_at(curve, k).height; });
  return tops;
}

void add_tops(std::vector<double>& speeds, const std::vector<ResponseAtSpeed>& curve,
              const std::vector<ResponsePlace>& places, bool settled) {
  for (const ResponsePlace& place : places) {
    const ResponseCurve of = curve_at(curve, place.of, place.at);
    for (const std::size_t k : of.tops()) {
      const double top = of.speed[k];
      if (settled && !std::isfinite(peak_at(of, k).errors.speed)) continue;
      if (std::ranges::none_of(speeds, [&](double s) { return std::abs(s - top) < one_resonance * top; }))
        speeds.push_back(top);
    }
  }
}

std::string unsettled(const ResponseCurve& curve, std::size_t top, const Peak& peak, bool refined,
                      const std::string& unit) {
  const bool place = std::isnan(peak.errors.speed),
             width = std::isfinite(peak.amplification) && std::isnan(peak.errors.factor);
  if (!std::isfinite(peak.height) || (!place && !width)) return {};
  return fmt::format("{} not settled: the speeds computed beside it are {:.6g} and {:.6g} {}{}",
                     place ? "its speed is" : "its width is", deck::from_si(curve.speed[top - 1], unit),
                     deck::from_si(curve.speed[top + 1], unit), unit, refined ? "" : " (refine: false)");
}

std::vector<std::string> shown_by(std::vector<ResponseAtSpeed> curve, const std::vector<ResponseAtSpeed>& more,
                                  const std::vector<Resonance>& hidden, const std::vector<ResponsePlace>& places,
                                  const std::string& unit) {
  curve.insert(curve.end(), more.begin(), more.end());
  std::ranges::sort(curve, {}, &ResponseAtSpeed::speed);
  const auto is_more = [&](double speed) {
    return std::ranges::find(more, speed, &ResponseAtSpeed::speed) != more.end();
  };
  std::vector<std::string> words;
  for (const Resonance& r : hidden) {
    double height = 0;
    std::string where;
    for (const ResponsePlace& place : places) {
      const ResponseCurve of = curve_at(curve, place.of, place.at);
      for (const std::size_t k : of.tops())
        if (std::abs(of.speed[k] - r.speed) < 2 * r.width && is_more(of.speed[k]) && of.height[k] > height)
          height = of.height[k], where = place.label;
    }
    if (height > 0)
      words.push_back(fmt::format(
          "{:.6g} {} ({}, {})", deck::from_si(r.speed, unit), unit,
          r.undamped ? std::string("undamped: it has no height") : fmt::format("{:.4g} um at least", 1e6 * height),
          where));
  }
  return words;
}

}  // namespace whirl::study
