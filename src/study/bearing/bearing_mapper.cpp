#include "study/bearing/bearing_mapper.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace whirl::study {
Mapper::Mapper(Pieces& pieces, std::string head, const BearingMapOptions& options, const system::Support& support)
    : pieces_(pieces), head_(std::move(head)), options_(options), bearing_(support, options.speed.value) {}

void Mapper::follow() {
  BearingEquilibrium last = bearing_.centred();
  if (!bearing_.rigid()) follow_curve(last);
  for (int i = 1; i <= options_.points; ++i) {
    const double wanted = options_.max_eccentricity * i / options_.points;
    const auto point = piece(fmt::format("point {}", i), [&]() -> std::optional<MapPoint> {
      const auto e = reach(last, wanted);
      if (!e) return std::nullopt;
      return complete(*e);
    });
    if (!point) {
      missing.push_back(wanted);
      continue;
    }
    locus.push_back(*point);
    last = point->at;
  }
}

std::optional<MapPoint> Mapper::find(const std::function<double(const BearingEquilibrium&)>& margin) {
  for (std::size_t i = 0; i + 1 < locus.size(); ++i) {
    if (margin(locus[i].at) * margin(locus[i + 1].at) > 0) continue;
    BearingEquilibrium low = locus[i].at, high = locus[i + 1].at;
    for (int k = 0; k < 60; ++k) {
      const auto middle = reach(low, 0.5 * (low.eccentricity + high.eccentricity));
      if (!middle) return std::nullopt;
      (margin(*middle) * margin(low) > 0 ? low : high) = *middle;
    }
    if (curve_ && std::abs(margin(low)) > 1e-6 * std::abs(margin(locus[i].at) - margin(locus[i + 1].at))) continue;
    return complete(low);
  }
  return std::nullopt;
}

void Mapper::load() {
  for (const double s : options_.sommerfeld) {
    BearingProfile profile;
    const auto point = piece(
        fmt::format("load {:.17g}", s),
        [&] {
          auto there = find([s](const BearingEquilibrium& e) { return e.sommerfeld - s; });
          if (there) profile = bearing_.profile();
          return there;
        },
        &profile);
    if (point)
      loaded.push_back({s, *point, profile});
    else
      refuse(s);
  }
}

void Mapper::find_threshold(const std::optional<system::DimensionlessGroups>& groups) {
  if (!groups || !bearing_.rigid()) return;
  const auto found = piece("threshold", [&] {
    return find([&](const BearingEquilibrium& e) {
      return (std::isnan(e.speed_limit) ? 1e3 : e.speed_limit) - groups->load / (groups->bearings * e.sommerfeld);
    });
  });
  if (found) threshold = found->at;
}

void Mapper::squeeze() {
  if (!bearing_.rigid()) return;
  // W grows like powers of 1/(1 - e): its logarithm is all but linear in log(1 - e).
  const int last = options_.grid - 1;
  for (int i = 0; i <= last; ++i)
    radii.push_back(1 - std::pow(1 - options_.max_eccentricity, static_cast<double>(i) / last));
  for (int j = 0; j <= 2 * last; ++j) angles.push_back(std::numbers::pi * j / last);
  for (std::size_t r = 0; r < radii.size(); ++r) {
    const double e = radii[r];
    const std::vector<double> row = pieces_.numbers(fmt::format("{}impedance {}", head_, r), [&] {
      std::vector<double> out;
      for (const double phi : angles) {
        const auto w = bearing_.impedance(e * std::cos(phi), e * std::sin(phi));
        out.insert(out.end(), w.begin(), w.end());
      }
      return out;
    });
    for (std::size_t k = 0; k + 1 < row.size(); k += 2) {
      along.push_back(row[k]);
      across.push_back(row[k + 1]);
    }
  }
}

void Mapper::follow_curve(const BearingEquilibrium& centred) {
  constexpr int starts = 64;
  curve_.emplace(bearing_.locus());
  const std::vector<double> kept = pieces_.numbers(head_ + "curve", [&] {
    for (int i = 1; i <= starts && curve_->nodes.empty(); ++i)
      if (const auto e = bearing_.carrying(options_.max_eccentricity * i / starts, centred))
        curve_->follow({e->states, {e->eccentricity * std::sin(e->attitude), -e->eccentricity * std::cos(e->attitude)}},
                       options_.max_eccentricity);
    return pack(*curve_);
  });
  unpack(kept, *curve_);
  folds = curve_->folds;
  if (curve_->nodes.empty() || curve_->end == JournalLocus::End::reached) return;
  const bool fold = curve_->end == JournalLocus::End::fold;
  limit = MapLimit{curve_->farthest().eccentricity(), fold, fold ? "" : curve_->why};
}

std::optional<BearingEquilibrium> Mapper::reach(const BearingEquilibrium& near, double wanted) {
  const bool on_curve = curve_ && !curve_->nodes.empty() && wanted >= curve_->nodes.front().eccentricity();
  if (!on_curve) return bearing_.carrying(wanted, near);
  const auto node = curve_->at(wanted);
  return node ? bearing_.carrying(*node) : std::nullopt;
}

void Mapper::refuse(double s) {
  if (locus.empty()) return;
  const auto [low, high] = std::minmax_element(locus.begin(), locus.end(), [](const MapPoint& a, const MapPoint& b) {
    return a.at.sommerfeld < b.at.sommerfeld;
  });
  const bool small = s < low->at.sommerfeld;
  if (!small && s <= high->at.sommerfeld) {
    refused += fmt::format("{}the map jumps over the load {:.6g} of 'sommerfeld'", refused.empty() ? "" : "; ", s);
    return;
  }
  refused += fmt::format(
      "{}the load {:.6g} of 'sommerfeld' lies beyond the map, which reaches from {:.6g} at eccentricity {:.4g} to "
      "{:.6g} at {:.4g}: {}",
      refused.empty() ? "" : "; ", s, low->at.sommerfeld, low->at.eccentricity, high->at.sommerfeld,
      high->at.eccentricity,
      small   ? "give more 'points', which begin at smaller eccentricities"
      : limit ? "there it ends"
              : "raise 'max_eccentricity'");
}

MapPoint Mapper::complete(const BearingEquilibrium& e) {
  MapPoint p{e, bearing_.thinnest(), {}};
  for (const double ratio : options_.frequencies) p.coefficients.push_back(bearing_.coefficients(ratio));
  return p;
}

std::optional<MapPoint> Mapper::piece(const std::string& name, const std::function<std::optional<MapPoint>()>& compute,
                                      BearingProfile* profile) {
  auto [found, left] = pieces_.value(head_ + name, [&] {
    std::pair<std::optional<MapPoint>, BearingProfile> out;
    out.first = compute();
    if (profile && out.first) out.second = *profile;
    return out;
  });
  if (profile && found) *profile = std::move(left);
  return found;
}

}  // namespace whirl::study
