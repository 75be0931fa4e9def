#include "whirl/study/bearing/bearing_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "study/bars/film_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bearing/one_bearing.hpp"
#include "study/common.hpp"
#include "study/pieces.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/groups.hpp"

namespace whirl::study {
namespace {

constexpr std::array<const char*, 4> entries = {"xx", "xy", "yx", "yy"};

/// A point of the locus with its coefficients at all frequencies.
struct Point {
  BearingEquilibrium at;
  std::vector<BearingCoefficients> coefficients;
};

/// A point at a load that was asked for.
struct Loaded {
  double sommerfeld = 0;
  Point point;
  BearingProfile profile;
};

void write(io::Group& g, const Point& p) {
  std::vector<double> numbers{p.at.eccentricity, p.at.attitude, p.at.sommerfeld, p.at.speed_limit, p.at.whirl_ratio};
  for (const BearingCoefficients& c : p.coefficients)
    for (const auto* of : {&c.k, &c.b}) numbers.insert(numbers.end(), of->begin(), of->end());
  g.put("numbers", std::move(numbers), "1", "the equilibrium, then stiffness and damping of each frequency");
  g.put("states", p.at.states, "1", "of the film");
}
Point read_point(const io::Group& g) {
  const std::vector<double>& n = g.reals("numbers");
  Point p{{n.at(0), n.at(1), n.at(2), n.at(3), n.at(4), g.reals("states")}, {}};
  for (std::size_t k = 5; k + 8 <= n.size(); k += 8) {
    BearingCoefficients& c = p.coefficients.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      c.k[i] = n[k + i];
      c.b[i] = n[k + 4 + i];
    }
  }
  return p;
}

// What one rank computes, all alike; each point is a piece of the checkpoint, its name begins with `head`. Collective.
class Mapper {
public:
  Mapper(const Context& context, Pieces& pieces, std::string head, const BearingMapOptions& options,
         const system::Support& support)
      : comm_(context.comm), pieces_(pieces), head_(std::move(head)), options_(options) {
    core::agree(comm_, [&] { bearing_.emplace(support, options_.speed.value); });
  }

  // Where no film is found the locus has a gap; some bores carry no vertical load at small eccentricities.
  void follow() {
    BearingEquilibrium last;
    core::agree(comm_, [&] { last = bearing_->centred(); });
    for (int i = 1; i <= options_.points; ++i) {
      const double wanted = options_.max_eccentricity * i / options_.points;
      const auto point = piece(fmt::format("point {}", i), [&]() -> std::optional<Point> {
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

  // The first place on the locus where `margin` changes its sign; the bearing is left there. Not collective.
  std::optional<Point> find(const std::function<double(const BearingEquilibrium&)>& margin) {
    for (std::size_t i = 0; i + 1 < locus.size(); ++i) {
      if (margin(locus[i].at) * margin(locus[i + 1].at) > 0) continue;
      BearingEquilibrium low = locus[i].at, high = locus[i + 1].at;
      for (int k = 0; k < 60; ++k) {
        const auto middle = reach(low, 0.5 * (low.eccentricity + high.eccentricity));
        if (!middle) return std::nullopt;
        (margin(*middle) * margin(low) > 0 ? low : high) = *middle;
      }
      return complete(low);
    }
    return std::nullopt;
  }

  // A load that the map does not reach is refused: whoever asked for it would look for its values in vain.
  void load() {
    for (const double s : options_.sommerfeld) {
      BearingProfile profile;
      const auto point = piece(
          fmt::format("load {:.17g}", s),
          [&] {
            auto there = find([s](const BearingEquilibrium& e) { return e.sommerfeld - s; });
            if (there) profile = bearing_->profile();
            return there;
          },
          &profile);
      if (point)
        loaded.push_back({s, *point, profile});
      else
        refuse(s);
    }
  }

  // A rigid rotor of load F0* turns at Omega* = F0*/(n S); it is stable below the limit of its eccentricity. A soft
  // film or one with own states is another one at every speed: its thresholds belong to branches of equilibria.
  void find_threshold(const std::optional<system::Groups>& groups) {
    if (!groups || !bearing_->rigid()) return;
    const auto found = piece("threshold", [&] {
      return find([&](const BearingEquilibrium& e) {
        return (std::isnan(e.speed_limit) ? 1e3 : e.speed_limit) - groups->load / (groups->bearings * e.sommerfeld);
      });
    });
    if (found) threshold = found->at;
  }

  void squeeze() {
    if (!bearing_->rigid()) return;
    // W grows like powers of 1/(1 - e): its logarithm is all but linear in log(1 - e).
    const int last = options_.grid - 1;
    for (int i = 0; i <= last; ++i)
      radii.push_back(1 - std::pow(1 - options_.max_eccentricity, static_cast<double>(i) / last));
    for (int j = 0; j <= 2 * last; ++j) angles.push_back(std::numbers::pi * j / last);
    for (std::size_t r = 0; r < radii.size(); ++r) {
      const double e = radii[r];
      const std::vector<double> row = pieces_.numbers(fmt::format("{}impedance {}", head_, r), [&] {
        std::vector<double> out;
        core::agree(comm_, [&] {
          for (const double phi : angles) {
            const auto w = bearing_->impedance(e * std::cos(phi), e * std::sin(phi));
            out.insert(out.end(), w.begin(), w.end());
          }
        });
        return out;
      });
      for (std::size_t k = 0; k + 1 < row.size(); k += 2) {
        along.push_back(row[k]);
        across.push_back(row[k + 1]);
      }
    }
  }

  std::vector<Point> locus;
  std::vector<Loaded> loaded;
  std::optional<BearingEquilibrium> threshold;
  std::vector<double> radii, angles, along, across;
  std::vector<double> missing;  // eccentricities without a film that carries a load downwards
  std::string refused;          // loads that the map does not reach, with the reason

  [[nodiscard]] bool ends_early() const {
    return locus.back().at.eccentricity < options_.max_eccentricity * (1 - 1e-12);
  }

private:
  // In as few steps as lead there: from a far one the film of a soft bearing may not be found although it exists. An
  // earlier start may lead past where none is found.
  std::optional<BearingEquilibrium> reach(const BearingEquilibrium& last, double wanted) {
    constexpr int near = 64, far = 4;
    if (bearing_->rigid() || wanted <= last.eccentricity) return bearing_->carrying(wanted, last);
    auto found = reach(last, wanted, near);
    for (auto earlier = locus.rbegin(); !found && earlier != locus.rend(); ++earlier)
      found = reach(earlier->at, wanted, far);
    return found;
  }
  std::optional<BearingEquilibrium> reach(BearingEquilibrium last, double wanted, int most_steps) {
    const double shortest = (wanted - last.eccentricity) / most_steps;
    for (double step = wanted - last.eccentricity; step >= shortest;) {
      const double next = std::min(last.eccentricity + step, wanted);
      if (auto e = bearing_->carrying(next, last)) {
        if (next == wanted) return e;
        last = std::move(*e);
      } else {
        step /= 2;
      }
    }
    return {};
  }
  void refuse(double s) {
    if (locus.empty()) return;
    const auto [low, high] = std::minmax_element(
        locus.begin(), locus.end(), [](const Point& a, const Point& b) { return a.at.sommerfeld < b.at.sommerfeld; });
    const bool small = s < low->at.sommerfeld;
    refused += fmt::format(
        "{}the load {:.6g} of 'sommerfeld' lies beyond the map, which reaches from {:.6g} at eccentricity {:.4g} to "
        "{:.6g} at {:.4g}: {}",
        refused.empty() ? "" : "; ", s, low->at.sommerfeld, low->at.eccentricity, high->at.sommerfeld,
        high->at.eccentricity,
        small          ? "give more 'points', which begin at smaller eccentricities"
        : ends_early() ? "beyond it no film was found"
                       : "raise 'max_eccentricity'");
  }
  Point complete(const BearingEquilibrium& e) {
    Point p{e, {}};
    for (const double ratio : options_.frequencies) p.coefficients.push_back(bearing_->coefficients(ratio));
    return p;
  }
  // What `compute` finds, and the profile that it leaves; none if it finds none.
  std::optional<Point> piece(const std::string& name, const std::function<std::optional<Point>()>& compute,
                             BearingProfile* profile = nullptr) {
    const io::Group& kept = pieces_.get(head_ + name, [&](io::Group& g) {
      std::optional<Point> found;
      core::agree(comm_, [&] { found = compute(); });
      if (!found) return;
      write(g, *found);
      if (!profile) return;
      g.put("theta", profile->theta, "rad", "of the profile");
      g.put("pressure", profile->pressure, "1", "of the profile");
      g.put("thickness", profile->thickness, "1", "of the profile");
    });
    if (!kept.has_dataset("numbers")) return std::nullopt;
    if (profile) *profile = {kept.reals("theta"), kept.reals("pressure"), kept.reals("thickness")};
    return read_point(kept);
  }

  MPI_Comm comm_;
  Pieces& pieces_;
  std::string head_;
  const BearingMapOptions& options_;
  std::optional<OneBearing> bearing_;
};

// One column of the locus.
template <class Value>
std::vector<double> column(const std::vector<Point>& locus, const Value& value) {
  std::vector<double> out;
  for (const Point& p : locus) out.push_back(value(p));
  return out;
}

void put_locus(io::Group& group, const std::vector<Point>& locus, const std::vector<double>& frequencies) {
  using P = Point;
  auto& table = group.child("locus");
  table.put("eccentricity", column(locus, [](const P& p) { return p.at.eccentricity; }), "1", "in clearances");
  table.put("attitude", column(locus, [](const P& p) { return p.at.attitude; }), "rad", "from the load to the journal");
  table.put("sommerfeld", column(locus, [](const P& p) { return p.at.sommerfeld; }), "1",
            "S = (c/R)^2 load/(mu Omega L D)");
  table.put("x", column(locus, [](const P& p) { return p.at.eccentricity * std::sin(p.at.attitude); }), "1",
            "in clearances");
  table.put("y", column(locus, [](const P& p) { return -p.at.eccentricity * std::cos(p.at.attitude); }), "1",
            "in clearances");
  table.put("speed_limit", column(locus, [](const P& p) { return p.at.speed_limit; }), "1",
            "Omega* = Omega sqrt(m c/load) of a rigid rotor at the border of stability; NaN: stable at every speed");
  table.put("whirl_ratio", column(locus, [](const P& p) { return p.at.whirl_ratio; }), "1",
            "whirl frequency there over Omega");
  table.set("frequency_ratio", frequencies.front());
  for (std::size_t i = 0; i < 4; ++i) {
    table.put(fmt::format("k_{}", entries[i]), column(locus, [i](const P& p) { return p.coefficients[0].k[i]; }), "1",
              "stiffness c k/(load/S)");
    table.put(fmt::format("c_{}", entries[i]), column(locus, [i](const P& p) { return p.coefficients[0].b[i]; }), "1",
              "damping c Omega C/(load/S)");
  }
  if (frequencies.size() < 2) return;
  auto& over = group.child("frequencies");
  over.put("ratio", frequencies, "1", "omega/Omega");
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<double> k, b;
    for (const Point& p : locus)
      for (const BearingCoefficients& c : p.coefficients) {
        k.push_back(c.k[i]);
        b.push_back(c.b[i]);
      }
    const io::Shape shape{locus.size(), frequencies.size()};
    over.put(fmt::format("k_{}", entries[i]), shape, k, "1", "stiffness [point of the locus][frequency]");
    over.put(fmt::format("c_{}", entries[i]), shape, b, "1", "damping [point of the locus][frequency]");
  }
  over.label_each({io::labels_of(frequencies)});
}

void put_loaded(io::Group& group, io::StudySummary& summary, const std::vector<Loaded>& loaded) {
  std::vector<double> sommerfeld, pressure, thickness;
  for (const Loaded& l : loaded) {
    const std::string head = fmt::format("sommerfeld.{:.6g}.", l.sommerfeld);
    summary.set(head + "eccentricity", l.point.at.eccentricity, "1");
    summary.set(head + "attitude", l.point.at.attitude, "rad");
    summary.set(head + "speed_limit", l.point.at.speed_limit, "1");
    summary.set(head + "whirl_ratio", l.point.at.whirl_ratio, "1");
    for (std::size_t i = 0; i < 4; ++i) {
      summary.set(fmt::format("{}k.{}", head, entries[i]), l.point.coefficients[0].k[i], "1");
      summary.set(fmt::format("{}c.{}", head, entries[i]), l.point.coefficients[0].b[i], "1");
    }
    if (l.profile.pressure.empty()) continue;
    sommerfeld.push_back(l.sommerfeld);
    pressure.insert(pressure.end(), l.profile.pressure.begin(), l.profile.pressure.end());
    thickness.insert(thickness.end(), l.profile.thickness.begin(), l.profile.thickness.end());
  }
  if (sommerfeld.empty()) return;
  auto& table = group.child("profiles");
  const io::Shape shape{sommerfeld.size(), loaded.back().profile.theta.size()};
  table.put("sommerfeld", sommerfeld, "1", "load S");
  table.put("theta", loaded.back().profile.theta, "rad", "angle from +x");
  table.put("pressure", shape, pressure, "1", "(c/R)^2 p/(6 mu Omega) in the mid-plane [load][theta]");
  table.put("thickness", shape, thickness, "1", "film thickness in clearances [load][theta]");
  table.label_each({io::labels_of(loaded.back().profile.theta)});
}

void put_threshold(io::StudySummary& summary, const Mapper& map, const std::optional<system::Groups>& groups) {
  if (!map.threshold) return;
  const double speed = groups->load / (groups->bearings * map.threshold->sommerfeld);
  summary.set("threshold.nondimensional_speed", speed, "1");
  summary.set("threshold.speed", speed * groups->speed_scale, "rad/s");
  summary.set("threshold.eccentricity", map.threshold->eccentricity, "1");
  summary.set("threshold.whirl_ratio", map.threshold->whirl_ratio, "1");
}

// What the locus says at one eccentricity, in the order of `with_bars`.
constexpr std::array<const char*, 12> with_bars = {"attitude", "sommerfeld", "speed_limit", "whirl_ratio",
                                                   "k_xx",     "k_xy",       "k_yx",        "k_yy",
                                                   "c_xx",     "c_xy",       "c_yx",        "c_yy"};
std::vector<double> numbers_of(const std::vector<Point>& locus, const std::vector<Point>& like) {
  std::vector<double> out;
  for (const Point& wanted : like) {
    const auto at = std::find_if(locus.begin(), locus.end(),
                                 [&](const Point& p) { return p.at.eccentricity == wanted.at.eccentricity; });
    if (at == locus.end()) {
      out.insert(out.end(), with_bars.size(), io::no_value);
      continue;
    }
    out.insert(out.end(), {at->at.attitude, at->at.sommerfeld, at->at.speed_limit, at->at.whirl_ratio});
    const BearingCoefficients& c = at->coefficients.front();
    out.insert(out.end(), c.k.begin(), c.k.end());
    out.insert(out.end(), c.b.begin(), c.b.end());
  }
  return out;
}

// The map on other film meshes: bars of the locus and of all that the summary says of it.
void put_bars(const Context& context, Pieces& pieces, const BearingMapOptions& options, std::size_t which,
              const Mapper& map, const std::optional<system::Groups>& groups) {
  io::StudySummary& summary = context.results.summary();
  Bars bars(numbers_of(map.locus, map.locus), law_of(context.machine, context.layout));
  SummaryBars of_summary(summary, law_of(context.machine, context.layout));
  const std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  int number = 0;
  for (const FilmMesh& mesh : meshes) {
    std::vector<double> numbers;
    io::StudySummary there;
    const std::string head = fmt::format("mesh {} ", ++number);
    const bool answered = has_answer([&] {
      system::Support support;
      core::agree(context.comm,
                  [&] { support = with_film_mesh(system::train_of(context.machine), mesh.factor).supports[which]; });
      Mapper other(context, pieces, head, options, support);
      other.follow();
      other.find_threshold(groups);
      other.load();
      numbers = numbers_of(other.locus, map.locus);
      io::Group unused;
      put_loaded(unused, there, other.loaded);
      put_threshold(there, other, groups);
    });
    if (!answered) numbers.clear();
    bars.add(mesh.axis, mesh.spacing, numbers);
    of_summary.add(mesh.axis, mesh.spacing, there);
  }
  of_summary.write(1e-9);
  if (meshes.empty()) return;
  auto& table = context.results.group().child("locus");
  for (std::size_t k = 0; k < with_bars.size(); ++k) {
    std::vector<double> column;
    for (std::size_t i = 0; i < map.locus.size(); ++i) column.push_back(bars[i * with_bars.size() + k].total());
    // Neighbours on the locus err alike: a difference of meshes that vanishes by chance hides nothing.
    std::vector<double> floored = column;
    for (std::size_t i = 0; i < column.size(); ++i)
      for (const std::size_t j : {i - 1, i + 1})
        if (j < column.size()) floored[i] = std::max(floored[i], column[j] / 2);
    table.put(std::string(with_bars[k]) + "_uncertainty", floored, k == 0 ? "rad" : "1",
              std::string("estimated error of ") + with_bars[k] + " from the film mesh");
  }
}

}  // namespace

StudyResult BearingMap::run(Context& context) {
  const system::Train train = system::train_of(context.machine);
  const std::size_t which = options.bearing.empty() ? 0 : *system::find_bearing(context.machine, options.bearing);
  auto& results = context.results;
  auto& summary = results.summary();
  auto& group = results.group();
  const auto groups = system::groups_of(train);
  put_groups(summary, train);

  Pieces pieces(results, context.resume);
  Mapper map(context, pieces, "", options, train.supports[which]);
  map.follow();
  map.find_threshold(groups);
  map.load();
  map.squeeze();
  if (map.locus.empty()) throw core::NotConverged("no eccentricity carries a vertical load");

  group.set("bearing", context.machine.bearings[which].name);
  group.set("speed", options.speed.value);
  put_locus(group, map.locus, options.frequencies);
  put_loaded(group, summary, map.loaded);
  if (!map.radii.empty()) {
    auto& table = group.child("impedance");
    const io::Shape shape{map.radii.size(), map.angles.size()};
    table.put("eccentricity", map.radii, "1", "distance of the journal from the centre, in clearances");
    table.put("angle", map.angles, "rad", "from the squeeze velocity to the journal, counter-clockwise");
    table.put("W_along", shape, map.along, "1", "impedance [eccentricity][angle], resisting the squeeze");
    table.put("W_across", shape, map.across, "1", "impedance [eccentricity][angle], to the left of the squeeze");
    table.label_each({io::labels_of(map.angles)});
  }
  put_threshold(summary, map, groups);
  put_bars(context, pieces, options, which, map, groups);
  summary.points = static_cast<long>(map.locus.size());
  if (!map.refused.empty()) return results.finish(map.refused, false);
  const double end = map.locus.back().at.eccentricity;
  std::string gaps;
  for (const double e : map.missing)
    if (e > map.locus.front().at.eccentricity && e < end) gaps += fmt::format("{}{:.4g}", gaps.empty() ? "" : ", ", e);
  if (!gaps.empty()) summary.warnings.push_back("no film was found at the eccentricities " + gaps);
  return results.finish(
      map.ends_early() ? fmt::format("ended at eccentricity {:.6g}: beyond it no film was found", end) : "completed",
      true);
}

}  // namespace whirl::study
