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

#include "study/bars/film_mesh.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/common.hpp"
#include "study/growth.hpp"
#include "study/layout.hpp"
#include "study/linear/peak_list.hpp"
#include "study/linear/response_bars.hpp"
#include "study/linear/response_record.hpp"
#include "study/linear/stable_speeds.hpp"
#include "study/pieces.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/film/thickness.hpp"
#include "whirl/rotor/divide.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/solve/newton/frequency_response.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

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
  /// `nodes` of the deck's shaft, of whatever mesh.
  Responder(const Context& context, const Layout& layout, const UnbalanceResponseOptions& options,
            std::vector<int> nodes, const FilmMesh& mesh = {})
      : system_(layout.space,
                with_cut_shaft(with_film_mesh(system::train_of(context.machine, options.unbalance), mesh.factor),
                               parts_of(mesh)),
                options.range.from),
        walker_(system_),
        solver_(system_),
        nodes_(std::move(nodes)) {
    for (int& node : nodes_) node = rotor::node_after(context.machine.rotor, node, parts_of(mesh));
  }

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

  // Eigenvalues that grow about the equilibrium at a speed, StableSpeeds::unknown where some may be missing.
  int growing(double speed) {
    std::optional<Growth> growth;
    (void)has_answer([&] { growth = growth_at(system_, walker_.at(speed)); });
    return growth ? growth->known_count() : StableSpeeds::unknown;
  }

  [[nodiscard]] system::ShownPlaces places() const { return system_.places(); }
  [[nodiscard]] Trail trail() { return walker_.trail(); }

private:
  system::RotorSystem system_;
  Walker walker_;
  solve::FrequencyResponse solver_;
  std::vector<int> nodes_;
};

std::vector<double> speeds_of(const std::vector<Response>& curve) {
  std::vector<double> speeds;
  for (const Response& r : curve) speeds.push_back(r.speed);
  return speeds;
}

const Response& nearest(const std::vector<Response>& curve, double speed) {
  return *std::ranges::min_element(curve, {}, [&](const Response& r) { return std::abs(r.speed - speed); });
}

// A place of the response: shaft nodes, then journals in their bearings.
struct Place {
  std::string label, head;  // in the list of peaks, and of its values
  Places of;
  std::size_t at;
};

std::vector<Place> places_of(const std::vector<int>& nodes, const std::vector<std::string>& bearings) {
  std::vector<Place> out;
  for (std::size_t k = 0; k < nodes.size(); ++k)
    out.push_back({fmt::format("node {}", nodes[k]), fmt::format("node.{}", nodes[k]), &Response::nodes, k});
  for (std::size_t b = 0; b < bearings.size(); ++b)
    out.push_back({bearings[b] + ", journal", "bearing." + bearings[b], &Response::bearings, b});
  return out;
}

// A peak of the list with the numbers that its bars stand on.
struct Listed {
  io::PeakEntry entry;
  NamedPeak named;
};

// The peaks of a curve by falling height; those without a height are the highest.
std::vector<std::size_t> tops_of(const ResponseCurve& curve) {
  std::vector<std::size_t> tops = curve.tops();
  std::ranges::stable_sort(tops, std::greater{}, [&](std::size_t k) {
    const double height = peak_at(curve, k).height;
    return std::isfinite(height) ? height : std::numeric_limits<double>::infinity();
  });
  return tops;
}

// Whether there is a peak at all; where that is open its margin decides nothing.
void judge(const io::StudySummary& summary, Listed& peak) {
  io::PeakEntry& entry = peak.entry;
  entry.verdict = margin_verdict(entry.amplification_factor, entry.separation_margin, entry.required_margin);
  std::string doubt;
  if (peak.named.vanishes) doubt = "on another mesh the response has no peak there";
  for (const auto& [name, q] : summary.values) {
    if (name != peak.named.head + prominence || !q.more.contains("uncertainty")) continue;
    const double bar = q.more.at("uncertainty");
    if (doubt.empty() && !(q.value > bar))
      doubt = fmt::format("it stands {:.2g} um above the response beside it, with a bar of {}", 1e6 * q.value,
                          std::isfinite(bar) ? fmt::format("{:.2g} um", 1e6 * bar) : "unknown size");
  }
  if (doubt.empty()) return;
  entry.notes.push_back("undetermined: " + doubt);
  entry.verdict = "undetermined";
}

// Places show one resonance at speeds that differ by parts of this: one of them is counted.
constexpr double one_resonance = 1e-3;

// At the operating speed and at all resonances in any case. Equilibria know of no loss factor: of such shafts nothing
// is asked.
StableSpeeds stability(const Context& context, const std::vector<Response>& curve, const std::vector<Place>& places,
                       const std::optional<deck::Quantity>& operating, const StableSpeeds::Count& count) {
  if (context.machine.rotor.loss_factor > 0) return {};
  std::vector<double> speeds = speeds_of(curve), always;
  if (operating) {
    speeds.push_back(operating->value);
    always.push_back(operating->value);
  }
  for (const Place& place : places) {
    const ResponseCurve of = curve_at(curve, place.of, place.at);
    for (const std::size_t k : of.tops()) {
      const double top = of.speed[k];
      if (std::ranges::none_of(always, [&](double s) { return std::abs(s - top) < one_resonance * top; }))
        always.push_back(top);
    }
  }
  std::ranges::sort(speeds);
  speeds.erase(std::unique(speeds.begin(), speeds.end()), speeds.end());
  return {std::move(speeds), always, count};
}

// What the summary has of a peak with its bars.
void take_bars(const io::StudySummary& summary, const std::string& head, io::PeakEntry& entry) {
  for (const auto& [name, q] : summary.values)
    for (const PeakValue& v : peak_values())
      if (name == head + v.name) entry.*v.member = q;
}

// Marks the speeds at which the equilibrium is unstable: there nothing settles into the linear motion.
void put_stability(io::Group& group, io::StudySummary& summary, const std::vector<Response>& curve,
                   const StableSpeeds& stable, const std::optional<deck::Quantity>& operating,
                   const std::string& unit) {
  if (!stable.known()) return;
  std::vector<std::int64_t> numbers;
  for (const Response& r : curve) numbers.push_back(stable.at(r.speed));
  group.child("response")
      .put("unstable_count", numbers,
           "eigenvalues that grow about the equilibrium, between the speeds counted as beside them; -1: some may be "
           "missing");
  put_verdict(summary, stable, unit);
  if (operating) summary.set("operating_speed.unstable_count", stable.at(operating->value), "1");
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
  const auto names = names_of_bearings(context.machine);
  const std::vector<Place> places = places_of(nodes, names);
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
      out.push_back(unpack(flat, nodes.size(), names.size()));
    return out;
  };
  const auto at_speeds = [&](const std::vector<double>& speeds) {
    return solve_at(machine, speeds, fmt::format("{} speed", ++calls));
  };
  std::vector<double> grid;
  for (int k = 0; k < options.points; ++k)
    grid.push_back(options.range.from + (options.range.to - options.range.from) * k / std::max(1, options.points - 1));
  std::vector<Response> curve = at_speeds(grid);

  // Speeds added around the peaks of each place until the parabola of 1/f^2 settles the speed to 1e-5.
  const auto by_speed = [](const Response& a, const Response& b) { return a.speed < b.speed; };
  std::sort(curve.begin(), curve.end(), by_speed);
  const auto add = [&](std::vector<double> speeds) {
    speeds = worth_asking(std::move(speeds), speeds_of(curve));
    for (Response& r : at_speeds(speeds)) curve.push_back(std::move(r));
    std::sort(curve.begin(), curve.end(), by_speed);
    return !speeds.empty();
  };
  // Until no top of any place asks for more.
  const auto settle = [&](int passes, const auto& ask) {
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<double> speeds;
      for (const Place& place : places) {
        const ResponseCurve of = curve_at(curve, place.of, place.at);
        for (const std::size_t k : of.tops()) ask(of, k, pass, speeds);
      }
      if (speeds.empty() || !add(std::move(speeds))) return;
    }
  };
  // Then speeds around the two places where each peak has fallen to 0.707 of its height; these may show a higher top.
  for (int round = 0; round < 3 && options.refine; ++round) {
    settle(10, ask_for_top);
    settle(10, [](const ResponseCurve& of, std::size_t k, int, std::vector<double>& speeds) {
      ask_for_width(of, k, speeds);
    });
  }

  const auto operating = operating_range(options.operating, options.operating_speed, context.machine.service_speed);
  const auto& operating_speed = options.operating_speed ? options.operating_speed : context.machine.service_speed;
  const StableSpeeds stable =
      stability(context, curve, places, operating_speed, [&](const std::vector<double>& speeds) {
        const auto compute = [&](std::size_t i) {
          return std::vector<double>{static_cast<double>(machine.growing(speeds[i]))};
        };
        std::vector<int> out;
        for (const auto& one :
             distribute(layout, speeds.size(), compute, pieces, fmt::format("{} stability", ++calls), machine.trail()))
          out.push_back(static_cast<int>(one.front()));
        return out;
      });

  const auto put_peak = [&](io::StudySummary& to, const std::string& head, double speed, double height, double factor) {
    const io::PeakEntry entry = entry_of("", {speed, height, factor, {}, {}}, unit, operating);
    for (const PeakValue& v : peak_values())
      if (const io::Quantity& q = entry.*v.member; !q.unit.empty()) to.set(head + v.name, q.value, q.unit);
  };
  const system::ShownPlaces shown = machine.places();
  std::vector<Listed> peaks;
  std::map<std::string, std::string> without_height;  // speed: labels of the places
  for (std::size_t p = 0; p < places.size(); ++p) {
    const ResponseCurve of = curve_at(curve, places[p].of, places[p].at);
    int number = 0;
    for (const std::size_t k : tops_of(of)) {
      const Peak peak = peak_at(of, k);
      const std::string head = fmt::format("{}.peak.{}.", places[p].head, ++number);
      put_peak(summary, head, peak.speed, peak.height, peak.amplification);
      const std::vector<double> saddles = saddles_of(of, k);
      if (std::isfinite(peak.height) && !saddles.empty())
        summary.set(head + prominence, peak.height - saddle_height(of, saddles), "m");
      io::PeakEntry entry = entry_of(places[p].label, peak, unit, operating);
      if (stable.known()) entry.stability = StableSpeeds::word(stable.at(peak.speed));
      if (const std::string bearing = touched(nearest(curve, peak.speed), shown); !bearing.empty())
        entry.notes.push_back("no answer: the motion leaves bearing " + bearing + " too little film");
      peaks.push_back({entry, {head, p, peak.speed, peak.height, peak.amplification, peak.errors, saddles}});
      if (std::isfinite(peak.height)) continue;
      // Places see one resonance at speeds that differ by the tolerance.
      std::string& where = without_height[fmt::format("{:.5g}", deck::from_si(peak.speed, unit))];
      where += (where.empty() ? "" : "; ") + places[p].label;
    }
  }
  for (const auto& [speed, where] : without_height)
    summary.warnings.push_back(
        fmt::format("the peak near {} {} has no height ({}): it grows as the speed comes nearer, as an undamped "
                    "resonance does",
                    speed, unit, where));
  // The first node named in the deck is the one the report speaks of; its highest peak comes first.
  std::vector<NamedPeak> named;
  int number = 0;
  for (const Listed& p : peaks) {
    named.push_back(p.named);
    if (p.named.place > 0) continue;
    NamedPeak first = p.named;
    first.head = fmt::format("peak.{}.", ++number);
    first.saddles.clear();
    summary.set(first.head + "node", nodes.front(), "1");
    put_peak(summary, first.head, first.speed, first.height, first.amplification);
    named.push_back(std::move(first));
  }
  // A speed outside the range may have no answer: the others keep theirs.
  std::string reason;
  const bool operating_known =
      operating_speed &&
      has_answer([&] { put_operating(names, nodes, at_speeds({operating_speed->value}).front(), summary); }, &reason);
  if (operating_speed && !operating_known)
    summary.warnings.push_back(fmt::format(
        "no response at the {} of {:.6g} {}: {}", options.operating_speed ? "operating_speed" : "service_speed",
        deck::from_si(operating_speed->value, operating_speed->unit), operating_speed->unit, reason));
  std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  if (has_shaft_mesh(context.machine, context.layout)) meshes.push_back(cut_shaft_mesh);
  put_response_bars(summary, meshes, law_of(context.machine, context.layout), named, put_peak,
                    [&](const FilmMesh& mesh, std::vector<double> at, const std::string& piece) {
                      std::optional<Responder> other;
                      if (mesh.spacing != 1) other.emplace(context, layout, options, nodes, mesh);
                      if (operating_known) at.push_back(operating_speed->value);
                      std::vector<Response> all = solve_at(other ? *other : machine, at, piece);
                      MeshResponse out;
                      if (operating_known) {
                        put_operating(names, nodes, all.back(), out.operating);
                        all.pop_back();
                      }
                      for (const Response& r : all) {
                        out.height.emplace_back();
                        for (const Place& place : places)
                          out.height.back().push_back((r.*place.of)[place.at].semi_major());
                      }
                      return out;
                    });
  for (Listed& p : peaks) {
    take_bars(summary, p.named.head, p.entry);
    p.named.vanishes = std::ranges::any_of(named, [&](const auto& n) { return n.head == p.named.head && n.vanishes; });
    judge(summary, p);
    summary.peaks.push_back(p.entry);
  }

  auto& group = results.group();
  put_films(group, summary, shown, curve, unit);
  put_stability(group, summary, curve, stable, operating_speed, unit);
  warn_of_amplification(summary);
  const auto most_by_shaft = [&](const char* name) {
    double most = 0;
    for (const auto& [of, q] : summary.values)
      if (const auto error = q.more.find("uncertainty_shaft_mesh"); error != q.more.end() && of.ends_with(name))
        most = std::max(most, error->second / std::abs(q.value));
    return most;
  };
  warn_of_shaft_mesh(summary, context.machine.rotor,
                     {{"the speeds of these peaks", most_by_shaft(".speed"), most_of_frequency},
                      {"their heights", most_by_shaft(".semi_major"), most_of_amplitude}});
  if (operating) put_operating_range(summary, *operating, unit);
  auto& response = group.child("response");
  response.put("speed", speeds_of(curve), "rad/s", "shaft speed");
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
