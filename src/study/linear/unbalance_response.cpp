#include "whirl/study/linear/unbalance_response.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "study/bars/film_limit.hpp"
#include "study/bars/film_mesh.hpp"
#include "study/common.hpp"
#include "study/layout.hpp"
#include "study/linear/response_bars.hpp"
#include "study/linear/response_peaks.hpp"
#include "study/pieces.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/film/thickness.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/solve/newton/frequency_response.hpp"
#include "whirl/study/linear/separation.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

// x = Re(z exp(i angle)) of one place.
struct NodeMotion {
  Complex x, y;

  // z = x + i y is the sum of a forward circle |f| and a backward circle |g|.
  [[nodiscard]] double forward() const { return std::abs(x + Complex(0, 1) * y) / 2; }
  [[nodiscard]] double backward() const { return std::abs(x - Complex(0, 1) * y) / 2; }
  [[nodiscard]] double semi_major() const { return forward() + backward(); }
  [[nodiscard]] double semi_minor() const { return forward() - backward(); }  // negative: backward orbit
};

struct Response {
  double speed = 0;
  std::vector<NodeMotion> nodes, bearings;
  std::vector<double> films;  // smallest thickness that the linear motion leaves each bearing [m]
};

std::vector<double> pack(const Response& r) {
  std::vector<double> flat{r.speed};
  for (const auto* place : {&r.nodes, &r.bearings})
    for (const NodeMotion& m : *place) flat.insert(flat.end(), {m.x.real(), m.x.imag(), m.y.real(), m.y.imag()});
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
double film_left(const system::Support& s, const system::JournalState& at, const NodeMotion& m,
                 const std::array<Complex, 2>& tilt) {
  const film::Facts film = film::facts(s.film);
  if (film.coefficients) return std::numeric_limits<double>::infinity();
  if (film.gives_way) return s.geometry.clearance - m.semi_major();
  double least = std::numeric_limits<double>::infinity();
  constexpr int samples = 90;
  for (int k = 0; k < samples; ++k) {
    const Complex turn = std::exp(Complex(0, 2 * std::numbers::pi * k / samples));
    least =
        std::min(least, film::minimum_thickness(
                            s.geometry, {at.position[0] + (m.x * turn).real(), at.position[1] + (m.y * turn).real(),
                                         at.tilt[0] + (tilt[0] * turn).real(), at.tilt[1] + (tilt[1] * turn).real()}));
  }
  return least;
}

class Responder {
public:
  /// `cells`: of the films over those of the deck.
  Responder(const Context& context, const Layout& layout, const UnbalanceResponseOptions& options,
            std::vector<int> nodes, const std::array<double, 2>& cells = {1, 1})
      : system_(layout.space, with_film_mesh(system::train_of(context.machine, options.unbalance), cells),
                options.range.from),
        walker_(system_),
        solver_(system_),
        nodes_(std::move(nodes)) {}

  Response at(double speed) {
    Vec x = walker_.at(speed);
    PetscInt begin = 0, end = 0;
    core::check(VecGetOwnershipRange(x, &begin, &end));
    // F holds minus the forcing Omega^2 (u_c cos + u_s sin) = Re(Omega^2 (u_c - i u_s) exp(i angle)) on the
    // rotor's rows; own states of films, behind all pairs of coordinate and rate, are not forced.
    std::vector<double> right(static_cast<std::size_t>(2 * (end - begin)), 0.0), amplitude;
    for (PetscInt row = begin; row < std::min(end, 2 * system_.coordinates()); ++row) {
      const auto of = static_cast<std::size_t>(row), at = static_cast<std::size_t>(2 * (row - begin));
      right[at] = speed * speed * system_.forcing_cosine()[of];
      right[at + 1] = -speed * speed * system_.forcing_sine()[of];
    }
    {
      std::optional<system::RotorSystem::WithLoss> loss;  // equilibria know of none
      if (system_.train().rotor.loss_factor > 0) loss.emplace(system_, system_.loss_at(speed));
      solver_.solve(x, speed, right, amplitude);
    }
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
    const auto rest = system_.journals(system_.gather(x).data());
    for (int b = 0; b < system_.n_bearings(); ++b) {
      const auto value = [&](PetscInt coordinate) {
        const auto i = static_cast<std::size_t>(2 * coordinate);
        return Complex(state[0][i], state[1][i]);
      };
      Complex z[2];
      std::array<Complex, 2> tilt{};
      for (int d = 0; d < 2; ++d) {
        const PetscInt p = system_.pedestal(b, d);
        z[d] = value(system_.journal(b, d)) - (p >= 0 ? value(p) : 0.0);
        if (system_.ports(b) > 2) tilt[static_cast<std::size_t>(d)] = value(system_.journal(b, 2 + d));
      }
      r.bearings.push_back({z[0], z[1]});
      const auto k = static_cast<std::size_t>(b);
      r.films.push_back(film_left(system_.train().supports[k], rest[k], r.bearings[k], tilt));
    }
    return r;
  }

  [[nodiscard]] system::ShownPlaces places() const { return system_.places(); }
  [[nodiscard]] Trail trail() { return walker_.trail(); }

private:
  system::RotorSystem system_;
  Walker walker_;
  solve::FrequencyResponse solver_;
  std::vector<int> nodes_;
};

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

void put_motion(io::Group& g, const std::vector<Response>& curve, std::vector<NodeMotion> Response::*place,
                const std::string& text) {
  const io::Shape shape{curve.size(), (curve.front().*place).size()};
  std::map<std::string, std::vector<double>> column;
  for (const Response& r : curve)
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

// Linear motions know no bore: where they leave less film than the surfaces bear they are none.
void put_films(io::Group& group, io::StudySummary& summary, const system::ShownPlaces& places,
               const std::vector<Response>& curve, const std::string& unit) {
  std::vector<double> all;
  for (const Response& r : curve) {
    const auto films = film_column(r.films, places.names.size());
    all.insert(all.end(), films.begin(), films.end());
  }
  group.child("bearings")
      .put("film_min", {curve.size(), places.names.size()}, all, "m",
           "smallest film thickness that the linear motion leaves, at mid-plane of films that do not tilt, not a "
           "number without a film");
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
      for (const int node : system::unbalance_nodes(context.machine, name)) wanted.insert(node);
    nodes.assign(wanted.begin(), wanted.end());
  }
  const std::string unit = options.range.unit;
  const Layout layout = plan(context, Sharing::speeds);
  Responder machine(context, layout, options, nodes);
  auto& results = context.results;
  auto& summary = results.summary();
  const std::size_t n_bearings = context.machine.bearings.size();
  // Responses at several speeds, shared between the groups of ranks.
  std::size_t ready = 0, calls = 0;
  Pieces pieces(results, context.resume);
  const auto solve_at = [&](Responder& which, const std::vector<double>& speeds, const std::string& piece) {
    const auto compute = [&](std::size_t i) {
      auto packed = pack(which.at(speeds[i]));
      results.progress(fmt::format("{}: {} speeds on this rank, {:.1f} {}, {:.1f} s", summary.name, ++ready,
                                   deck::from_si(speeds[i], unit), unit, results.seconds()));
      return packed;
    };
    std::vector<Response> out;
    for (const auto& flat : distribute(layout, speeds.size(), compute, pieces, piece, which.trail()))
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
  const auto curve_of = [&](std::size_t node) {
    ResponseCurve of;
    for (const Response& r : curve) {
      of.speed.push_back(r.speed);
      of.height.push_back(r.nodes[node].semi_major());
    }
    return of;
  };
  const auto add = [&](const std::vector<double>& speeds) {
    for (Response& r : at_speeds(speeds)) curve.push_back(std::move(r));
    std::sort(curve.begin(), curve.end(), by_speed);
  };
  // Until no top of any node asks for more.
  const auto settle = [&](int passes, const auto& ask) {
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<double> speeds;
      for (std::size_t node = 0; node < nodes.size(); ++node) {
        const ResponseCurve of = curve_of(node);
        for (const std::size_t k : of.tops()) ask(of, k, pass, speeds);
      }
      if (speeds.empty()) return;
      add(speeds);
    }
  };
  // Then speeds around the two places where each peak has fallen to 0.707 of its height; these may show a higher top.
  for (int round = 0; round < 3 && options.refine; ++round) {
    settle(10, ask_for_top);
    settle(10, [](const ResponseCurve& of, std::size_t k, int, std::vector<double>& speeds) {
      ask_for_width(of, k, speeds);
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
    const ResponseCurve of = curve_of(node);
    for (const std::size_t k : of.tops()) own.push_back(peak_at(of, k));
    // Those without a height are the highest.
    const auto height = [](const Peak& p) {
      return std::isfinite(p.height) ? p.height : std::numeric_limits<double>::infinity();
    };
    std::stable_sort(own.begin(), own.end(), [&](const Peak& a, const Peak& b) { return height(a) > height(b); });
    for (std::size_t k = 0; k < own.size(); ++k) {
      const std::string head = fmt::format("node.{}.peak.{}.", nodes[node], k + 1);
      put_peak(summary, head, own[k].speed, own[k].height, own[k].amplification);
      if (!std::isfinite(own[k].height))
        summary.warnings.push_back(
            fmt::format("node {}: the peak near {:.6g} {} has no height: it grows as the speed comes nearer, as an "
                        "undamped resonance does",
                        nodes[node], deck::from_si(own[k].speed, unit), unit));
      named.push_back({head, node, own[k].speed, own[k].height, own[k].amplification, own[k].errors});
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
    summary.set(head + "node", nodes.front(), "1");
    put_peak(summary, head, peaks[k].speed, peaks[k].height, peaks[k].amplification);
  }
  if (options.operating_speed) {
    put_operating(context, nodes, at_speeds({options.operating_speed->value}).front(), summary);
  }
  put_response_bars(summary, film_meshes(context.machine, context.layout), law_of(context.machine), named, put_peak,
                    [&](const std::array<double, 2>& cells, std::vector<double> at, const std::string& piece) {
                      std::optional<Responder> other;
                      if (cells != std::array<double, 2>{1, 1}) other.emplace(context, layout, options, nodes, cells);
                      if (options.operating_speed) at.push_back(options.operating_speed->value);
                      std::vector<Response> all = solve_at(other ? *other : machine, at, piece);
                      MeshResponse out;
                      if (options.operating_speed) {
                        put_operating(context, nodes, all.back(), out.operating);
                        all.pop_back();
                      }
                      for (const Response& r : all) {
                        out.height.emplace_back();
                        for (const NodeMotion& m : r.nodes) out.height.back().push_back(m.semi_major());
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
  response.label_each({io::node_labels(nodes)});
  put_bearings(group, context.machine);
  put_motion(group.child("bearings"), curve, &Response::bearings, "journal relative to its pedestal");
  group.child("bearings").label_each({names_of_bearings(context.machine)});
  group.set("speed_unit", unit);
  group.set("unbalance", fmt::format("{}", fmt::join(options.unbalance, ", ")));
  summary.points = static_cast<long>(curve.size());
  return results.finish("completed", true);
}

}  // namespace whirl::study
