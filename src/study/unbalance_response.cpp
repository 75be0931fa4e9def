#include "whirl/study/unbalance_response.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "common.hpp"
#include "film_limit.hpp"
#include "film_mesh.hpp"
#include "groups.hpp"
#include "pieces.hpp"
#include "response_bars.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/film/state_model.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/solve/frequency_response.hpp"
#include "whirl/study/separation.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

// x = Re(z exp(i angle)) of one place.
struct Motion {
  Complex x, y;

  // z = x + i y is the sum of a forward circle |f| and a backward circle |g|.
  [[nodiscard]] double forward() const { return std::abs(x + Complex(0, 1) * y) / 2; }
  [[nodiscard]] double backward() const { return std::abs(x - Complex(0, 1) * y) / 2; }
  [[nodiscard]] double semi_major() const { return forward() + backward(); }
  [[nodiscard]] double semi_minor() const { return forward() - backward(); }  // negative: backward orbit
};

struct Response {
  double speed = 0;
  std::vector<Motion> nodes, bearings;
  std::vector<double> films;  // smallest thickness that the linear motion leaves each bearing [m]
};

std::vector<double> pack(const Response& r) {
  std::vector<double> flat{r.speed};
  for (const auto* place : {&r.nodes, &r.bearings})
    for (const Motion& m : *place) flat.insert(flat.end(), {m.x.real(), m.x.imag(), m.y.real(), m.y.imag()});
  flat.insert(flat.end(), r.films.begin(), r.films.end());
  return flat;
}

Response unpack(const std::vector<double>& flat, std::size_t n_nodes, std::size_t n_bearings) {
  Response r;
  r.speed = flat[0];
  for (std::size_t k = 0; k < n_nodes + n_bearings; ++k) {
    const double* v = flat.data() + 1 + 4 * k;
    (k < n_nodes ? r.nodes : r.bearings).push_back({{v[0], v[1]}, {v[2], v[3]}});
  }
  r.films.assign(flat.end() - static_cast<std::ptrdiff_t>(n_bearings), flat.end());
  return r;
}

// The journal goes round `at` as the linear response says, whatever stands in its way. The bore of an elastic liner
// gives way; there the motion counts against the clearance.
double film_left(const system::Support& s, const std::array<double, 2>& at, const Motion& m) {
  if (s.film.kind == film::Options::Kind::linear) return std::numeric_limits<double>::infinity();
  if (film::has_states(s.film.kind)) return s.geometry.clearance - m.semi_major();
  double least = std::numeric_limits<double>::infinity();
  constexpr int samples = 90;
  for (int k = 0; k < samples; ++k) {
    const Complex turn = std::exp(Complex(0, 2 * std::numbers::pi * k / samples));
    least = std::min(
        least, film::minimum_thickness(s.geometry, {at[0] + (m.x * turn).real(), at[1] + (m.y * turn).real(), 0, 0}));
  }
  return least;
}

class Machine {
public:
  /// `cells`: of the films over those of the deck.
  Machine(const Context& context, const Groups& groups, const UnbalanceResponseOptions& options, std::vector<int> nodes,
          const std::array<double, 2>& cells = {1, 1})
      : system_(groups.space, with_film_mesh(system::train_of(context.machine, options.unbalance), cells),
                options.range.from),
        walker_(system_),
        solver_(system_),
        nodes_(std::move(nodes)) {}

  Response at(double speed) {
    Vec x = walker_.at(speed);
    PetscInt begin = 0, end = 0;
    core::check(VecGetOwnershipRange(x, &begin, &end));
    // F holds minus the forcing Omega^2 (u_c cos + u_s sin) = Re(Omega^2 (u_c - i u_s) exp(i angle)) on its momentum
    // rows; own states of films, behind all pairs of coordinate and rate, are not forced.
    std::vector<double> right(static_cast<std::size_t>(2 * (end - begin)), 0.0), amplitude;
    for (PetscInt row = begin; row < std::min(end, 2 * system_.coordinates()); row += 2) {
      const auto q = static_cast<std::size_t>(row / 2), at = static_cast<std::size_t>(2 * (row - begin));
      right[at] = speed * speed * system_.unbalance_cosine()[q];
      right[at + 1] = -speed * speed * system_.unbalance_sine()[q];
    }
    solver_.solve(x, speed, right, amplitude);
    std::vector<double> state[2], shaft[2];
    for (std::size_t part = 0; part < 2; ++part) {
      core::Vector v = core::duplicate(x);
      {
        const core::WriteArray a(v.get());
        for (PetscInt i = 0; i < a.size(); ++i) a[i] = amplitude[static_cast<std::size_t>(2 * i) + part];
      }
      state[part] = system_.gather(v.get());
      shaft[part] = system_.shaft(state[part].data(), 0, false);
    }
    Response r;
    r.speed = speed;
    for (const int node : nodes_) {
      const auto k = static_cast<std::size_t>(4 * (node - 1));
      r.nodes.push_back({{shaft[0][k], shaft[1][k]}, {shaft[0][k + 1], shaft[1][k + 1]}});
    }
    for (int b = 0; b < system_.n_bearings(); ++b) {
      Complex z[2];
      for (int d = 0; d < 2; ++d) {
        const PetscInt j = 2 * system_.journal(b, d), p = 2 * system_.pedestal(b, d);
        const auto value = [&](PetscInt i) {
          return Complex(state[0][static_cast<std::size_t>(i)], state[1][static_cast<std::size_t>(i)]);
        };
        z[d] = value(j) - (p >= 0 ? value(p) : 0.0);
      }
      r.bearings.push_back({z[0], z[1]});
    }
    const auto rest = system_.journals(system_.gather(x).data());
    for (std::size_t b = 0; b < rest.size(); ++b)
      r.films.push_back(film_left(system_.train().supports[b], rest[b].position, r.bearings[b]));
    return r;
  }

  [[nodiscard]] system::Places places() const { return system_.places(); }
  [[nodiscard]] Trail trail() { return walker_.trail(); }

private:
  system::RotorSystem system_;
  Walker walker_;
  solve::FrequencyResponse solver_;
  std::vector<int> nodes_;
};

struct Peak {
  int node = 0;
  double speed = 0, amplitude = 0, amplification = 0;
  PeakErrors errors;
};

// Where the parabola of 1/f^2 through the speeds about a top has its foot: exactly the top of a single resonance. Not a
// number if that lies beyond its neighbours. Speeds closer to the top than a few tolerances, which other nodes may have
// asked for, say nothing of its curvature.
double foot_of(const std::vector<Response>& curve, std::size_t node, std::size_t top) {
  const double s1 = curve[top].speed, apart = 4 * peak_tolerance * s1;
  std::size_t low = top - 1, high = top + 1;
  while (low > 0 && s1 - curve[low].speed < apart) --low;
  while (high + 1 < curve.size() && curve[high].speed - s1 < apart) ++high;
  const auto g = [&](std::size_t k) { return 1 / std::pow(curve[k].nodes[node].semi_major(), 2); };
  const double s0 = curve[low].speed, s2 = curve[high].speed, g0 = g(low), g1 = g(top), g2 = g(high);
  const double u = (s1 - s0) * (s1 - s0) * (g1 - g2), v = (s1 - s2) * (s1 - s2) * (g1 - g0),
               w = (s1 - s0) * (g1 - g2) - (s1 - s2) * (g1 - g0);
  const double foot = w != 0 ? s1 - 0.5 * (u - v) / w : s1;
  return foot > s0 && foot < s2 ? foot : std::numeric_limits<double>::quiet_NaN();
}

// Where the curve falls to 0.707 of a peak's height on either side of it (API 684): between two speeds of the curve.
// There 1/f^2 is a straight line over (N - N_top)^2, as it is of a single resonance f = f_top/sqrt(1 + (2 Q (N/N_top -
// 1))^2). Nothing where the curve ends first.
struct Side {
  double inner = 0, outer = 0, crossing = 0;
};
std::array<std::optional<Side>, 2> sides_of(const std::vector<Response>& curve, std::size_t node, std::size_t top) {
  const auto value = [&](std::size_t k) { return curve[k].nodes[node].semi_major(); };
  const double level = value(top) / std::sqrt(2.0), middle = curve[top].speed;
  std::array<std::optional<Side>, 2> sides;
  for (std::size_t s = 0; s < 2; ++s) {
    std::size_t outer = top;
    while ((s == 0 ? outer > 0 : outer + 1 < curve.size()) && value(outer) > level) s == 0 ? --outer : ++outer;
    if (value(outer) > level) continue;
    const std::size_t inner = s == 0 ? outer + 1 : outer - 1;
    const auto g = [](double f) { return 1 / (f * f); };
    const auto apart = [&](std::size_t k) { return (curve[k].speed - middle) * (curve[k].speed - middle); };
    const double w = (g(level) - g(value(inner))) / (g(value(outer)) - g(value(inner)));
    const double distance = std::sqrt(apart(inner) + w * (apart(outer) - apart(inner)));
    sides[s] = {curve[inner].speed, curve[outer].speed, middle + (s == 0 ? -distance : distance)};
  }
  return sides;
}

// N/(N2 - N1)
double amplification(const std::vector<Response>& curve, std::size_t node, std::size_t top) {
  const auto sides = sides_of(curve, node, top);
  if (!sides[0] || !sides[1]) return std::numeric_limits<double>::quiet_NaN();
  return curve[top].speed / (sides[1]->crossing - sides[0]->crossing);
}

// What is left of a width: its crossings may be off by their distance from the nearer one of their neighbours, relative
// to the width; nothing if one of them is missing.
std::array<double, 2> left_of_width(const std::array<std::optional<Side>, 2>& sides) {
  const double width = sides[1]->crossing - sides[0]->crossing;
  std::array<double, 2> left{};
  for (std::size_t k = 0; k < 2; ++k)
    left[k] = std::min(std::abs(sides[k]->crossing - sides[k]->inner), std::abs(sides[k]->crossing - sides[k]->outer)) /
              width;
  return left;
}

// Speeds that settle the width of a peak.
void unsettled_width(const std::vector<Response>& curve, std::size_t node, std::size_t top,
                     std::vector<double>& speeds) {
  const auto sides = sides_of(curve, node, top);
  if (!sides[0] || !sides[1]) return;
  const auto left = left_of_width(sides);
  for (std::size_t k = 0; k < 2; ++k)
    if (left[k] > width_tolerance) speeds.push_back(sides[k]->crossing);
}

// A top that is off by a part d of its speed is too low by (2 Q d)^2/2 of its height. Where a resonance is narrower
// than that it has no height that could be told: an undamped one.
constexpr double narrow = 0.5;

Peak peak_at(const std::vector<Response>& curve, std::size_t node, std::size_t top, int name) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  Peak p{name, curve[top].speed, curve[top].nodes[node].semi_major(), amplification(curve, node, top), {}};
  const double off = std::abs(foot_of(curve, node, top) - p.speed) / p.speed;
  p.errors.speed = off <= peak_tolerance ? peak_tolerance : unknown;
  const double share = 2 * p.amplification * peak_tolerance;
  if (share > narrow) {
    p.amplitude = p.amplification = unknown;
    return p;
  }
  p.errors.height = p.errors.speed + (std::isfinite(share) ? share * share / 2 : 0);
  if (!std::isfinite(p.amplification)) return p;
  const auto left = left_of_width(sides_of(curve, node, top));
  p.errors.factor = std::max(left[0], left[1]) <= width_tolerance ? width_tolerance + p.errors.height : unknown;
  return p;
}

void put_operating(const Context& context, const std::vector<int>& nodes, const Response& r,
                   io::StudySummary& summary) {
  const auto names = names_of_bearings(context.machine);
  for (std::size_t b = 0; b < names.size(); ++b) {
    summary.set("operating.bearing." + names[b] + ".x", std::abs(r.bearings[b].x), "m");
    summary.set("operating.bearing." + names[b] + ".y", std::abs(r.bearings[b].y), "m");
  }
  for (std::size_t k = 0; k < nodes.size(); ++k)
    summary.set(fmt::format("operating.node.{}.semi_major", nodes[k]), r.nodes[k].semi_major(), "m");
}

void put_motion(io::Group& g, const std::vector<Response>& curve, std::vector<Motion> Response::*place,
                const std::string& text) {
  const io::Shape shape{curve.size(), (curve.front().*place).size()};
  std::map<std::string, std::vector<double>> column;
  for (const Response& r : curve)
    for (const Motion& m : r.*place) {
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

// Linear motions know no bore: where they leave less film than the surfaces bear they are none.
void put_films(io::Group& group, io::StudySummary& summary, const system::Places& places,
               const std::vector<Response>& curve, const std::string& unit) {
  std::vector<double> all;
  for (const Response& r : curve) {
    const auto films = film_column(r.films, places.names.size());
    all.insert(all.end(), films.begin(), films.end());
  }
  group.child("bearings")
      .put("film_min", {curve.size(), places.names.size()}, all, "m",
           "smallest film thickness at mid-plane that the linear motion leaves, not a number without a film");
  for (std::size_t b = 0; b < places.names.size(); ++b) {
    const Response *worst = nullptr, *first = nullptr, *last = nullptr;
    for (const Response& r : curve) {
      if (!std::isfinite(r.films[b])) continue;
      if (!worst || r.films[b] < worst->films[b]) worst = &r;
      if (r.films[b] > 0 && r.films[b] >= places.least_films[b]) continue;
      if (!first) first = &r;
      last = &r;
    }
    if (!worst) continue;
    summary.set("bearing." + places.names[b] + ".film_min", worst->films[b], "m");
    if (first)
      summary.warnings.push_back(fmt::format(
          "the linear motion leaves bearing {} {:.3g} um of film at {:.6g} {}, less than the {:.3g} um below which the "
          "surfaces touch (minimum_film): no answer between {:.6g} and {:.6g} {}",
          places.names[b], worst->films[b] * 1e6, deck::from_si(worst->speed, unit), unit, places.least_films[b] * 1e6,
          deck::from_si(first->speed, unit), deck::from_si(last->speed, unit), unit));
  }
}

}  // namespace

StudyResult UnbalanceResponse::run(Context& context) {
  std::set<int> wanted(options.nodes.begin(), options.nodes.end());
  std::vector<int> nodes = options.nodes;
  if (nodes.empty()) {
    for (const auto& b : context.machine.bearings) wanted.insert(b.node);
    for (const auto& name : options.unbalance)
      for (const auto& plane : context.machine.unbalance[*system::find_unbalance(context.machine, name)].planes)
        wanted.insert(plane.node);
    nodes.assign(wanted.begin(), wanted.end());
  }
  const std::string unit = options.range.unit;
  const Groups groups = Groups::split(context.comm, context.machine);
  Machine machine(context, groups, options, nodes);
  auto& results = context.results;
  auto& summary = results.summary();
  const std::size_t n_bearings = context.machine.bearings.size();
  // Responses at several speeds, shared between the groups of ranks.
  std::size_t ready = 0, calls = 0;
  Pieces pieces(results, context.resume);
  const auto solve_at = [&](Machine& which, const std::vector<double>& speeds, const std::string& piece) {
    const auto compute = [&](std::size_t i) {
      auto packed = pack(which.at(speeds[i]));
      results.progress(fmt::format("{}: {} speeds on this rank, {:.1f} {}, {:.1f} s", summary.name, ++ready,
                                   deck::from_si(speeds[i], unit), unit, results.seconds()));
      return packed;
    };
    std::vector<Response> out;
    for (const auto& flat : distribute(groups, speeds.size(), compute, pieces, piece, which.trail()))
      out.push_back(unpack(flat, nodes.size(), n_bearings));
    return out;
  };
  const auto at_speeds = [&](const std::vector<double>& speeds) {
    return solve_at(machine, speeds, fmt::format("{} speed", ++calls));
  };
  std::vector<double> grid;
  for (int k = 0; k < options.points; ++k)
    grid.push_back(options.range.from + (options.range.to - options.range.from) * k / std::max(1, options.points - 1));
  std::vector<Response> curve = at_speeds(grid);

  // Speeds added around the peaks of each node until the parabola of 1/f^2 settles the speed to 1e-5.
  const auto by_speed = [](const Response& a, const Response& b) { return a.speed < b.speed; };
  std::sort(curve.begin(), curve.end(), by_speed);
  const auto tops = [&](std::size_t node) {
    std::vector<std::size_t> found;
    for (std::size_t k = 1; k + 1 < curve.size(); ++k) {
      const double a = curve[k - 1].nodes[node].semi_major(), b = curve[k].nodes[node].semi_major(),
                   c = curve[k + 1].nodes[node].semi_major();
      if (!(b > a && b >= c)) continue;
      // Nearer than the tolerance two tops are one.
      if (!found.empty() && curve[k].speed - curve[found.back()].speed < 2 * peak_tolerance * curve[k].speed) {
        if (b > curve[found.back()].nodes[node].semi_major()) found.back() = k;
        continue;
      }
      found.push_back(k);
    }
    return found;
  };
  const auto add = [&](const std::vector<double>& speeds) {
    for (Response& r : at_speeds(speeds)) curve.push_back(std::move(r));
    std::sort(curve.begin(), curve.end(), by_speed);
  };
  // Until no top of any node asks for more.
  const auto settle = [&](int passes, const auto& ask) {
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<double> speeds;
      for (std::size_t node = 0; node < nodes.size(); ++node)
        for (const std::size_t k : tops(node)) ask(pass, node, k, speeds);
      if (speeds.empty()) return;
      add(speeds);
    }
  };
  const auto ask_for_top = [&](int pass, std::size_t node, std::size_t k, std::vector<double>& speeds) {
    const double foot = foot_of(curve, node, k), off = std::abs(foot - curve[k].speed);
    if (off <= peak_tolerance * curve[k].speed) return;
    if (std::isnan(foot)) {  // no parabola with a foot between them: halves
      speeds.push_back((curve[k - 1].speed + curve[k].speed) / 2);
      speeds.push_back((curve[k].speed + curve[k + 1].speed) / 2);
      return;
    }
    speeds.push_back(foot);
    // A neighbour that stays far away spoils the parabola: nearer ones on either side, which shrink with the move.
    if (pass < 2) return;
    for (const double beside : {foot - 5 * off, foot + 5 * off})
      if (beside > curve[k - 1].speed && beside < curve[k + 1].speed) speeds.push_back(beside);
  };
  // Then speeds around the two places where each peak has fallen to 0.707 of its height; these may show a higher top.
  for (int round = 0; round < 3 && options.refine; ++round) {
    settle(10, ask_for_top);
    settle(10, [&](int, std::size_t node, std::size_t k, std::vector<double>& speeds) {
      unsettled_width(curve, node, k, speeds);
    });
  }

  const auto put_peak = [&](io::StudySummary& to, const std::string& head, double speed, double height, double factor) {
    to.set(head + "speed", deck::from_si(speed, unit), unit);
    to.set(head + "semi_major", height, "m");
    to.set(head + "amplification_factor", factor, "1");
    if (!options.operating && !options.operating_speed) return;
    const double lowest = options.operating ? options.operating->from : options.operating_speed->value,
                 highest = options.operating ? options.operating->to : lowest;
    const Separation margin = separation(speed, factor, lowest, highest);
    to.set(head + "separation_margin", margin.actual, "1");
    to.set(head + "required_margin", margin.required, "1");
  };
  std::vector<Peak> peaks;
  std::vector<NamedPeak> named;
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    std::vector<Peak> own;
    for (const std::size_t k : tops(node)) own.push_back(peak_at(curve, node, k, nodes[node]));
    // Those without a height are the highest.
    const auto height = [](const Peak& p) {
      return std::isfinite(p.amplitude) ? p.amplitude : std::numeric_limits<double>::infinity();
    };
    std::stable_sort(own.begin(), own.end(), [&](const Peak& a, const Peak& b) { return height(a) > height(b); });
    for (std::size_t k = 0; k < own.size(); ++k) {
      const std::string head = fmt::format("node.{}.peak.{}.", nodes[node], k + 1);
      put_peak(summary, head, own[k].speed, own[k].amplitude, own[k].amplification);
      if (!std::isfinite(own[k].amplitude))
        summary.warnings.push_back(
            fmt::format("node {}: the peak near {:.6g} {} has no height: it grows as the speed comes nearer, as an "
                        "undamped resonance does",
                        nodes[node], deck::from_si(own[k].speed, unit), unit));
      named.push_back({head, node, own[k].speed, own[k].amplitude, own[k].amplification, own[k].errors});
      if (node == 0) {
        named.push_back(named.back());
        named.back().head = fmt::format("peak.{}.", k + 1);
      }
    }
    if (node == 0) peaks = own;
  }
  // The first node named in the deck is the one the report speaks of; its highest peak comes first.
  for (std::size_t k = 0; k < peaks.size(); ++k) {
    const std::string head = fmt::format("peak.{}.", k + 1);
    summary.set(head + "node", peaks[k].node, "1");
    put_peak(summary, head, peaks[k].speed, peaks[k].amplitude, peaks[k].amplification);
  }
  if (options.operating_speed) {
    put_operating(context, nodes, at_speeds({options.operating_speed->value}).front(), summary);
  }
  put_response_bars(summary, film_meshes(context.machine), law_of(context.machine), named, put_peak,
                    [&](const std::array<double, 2>& cells, std::vector<double> at, const std::string& piece) {
                      std::optional<Machine> other;
                      if (cells != std::array<double, 2>{1, 1}) other.emplace(context, groups, options, nodes, cells);
                      if (options.operating_speed) at.push_back(options.operating_speed->value);
                      std::vector<Response> all = solve_at(other ? *other : machine, at, piece);
                      MeshResponse out;
                      if (options.operating_speed) {
                        put_operating(context, nodes, all.back(), out.operating);
                        all.pop_back();
                      }
                      for (const Response& r : all) {
                        out.height.emplace_back();
                        for (const Motion& m : r.nodes) out.height.back().push_back(m.semi_major());
                      }
                      return out;
                    });

  auto& group = results.group();
  put_films(group, summary, machine.places(), curve, unit);
  auto& response = group.child("response");
  std::vector<double> speeds;
  for (const Response& r : curve) speeds.push_back(r.speed);
  response.put("speed", speeds, "rad/s", "shaft speed");
  response.put("node", std::vector<std::int64_t>(nodes.begin(), nodes.end()), "shaft nodes, 1-based");
  put_motion(response, curve, &Response::nodes, "absolute motion of the shaft");
  put_bearings(group, context.machine);
  put_motion(group.child("bearings"), curve, &Response::bearings, "journal relative to its pedestal");
  group.set("speed_unit", unit);
  group.set("unbalance", fmt::format("{}", fmt::join(options.unbalance, ", ")));
  summary.points = static_cast<long>(curve.size());
  return results.finish("completed", true);
}

}  // namespace whirl::study
