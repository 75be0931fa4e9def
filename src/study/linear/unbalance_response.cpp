#include "study/linear/unbalance_response.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "study/bars/film_mesh.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/columns.hpp"
#include "study/common.hpp"
#include "study/evenly.hpp"
#include "study/layout.hpp"
#include "study/linear/open_ends.hpp"
#include "study/linear/peak_list.hpp"
#include "study/linear/resonances.hpp"
#include "study/linear/responder.hpp"
#include "study/linear/response_bars.hpp"
#include "study/linear/response_record.hpp"
#include "study/linear/stable_speeds.hpp"
#include "study/lost_points.hpp"
#include "study/pieces.hpp"
#include "study/service_speeds.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

std::vector<double> speeds_of(const std::vector<ResponseAtSpeed>& curve) {
  return column(curve, &ResponseAtSpeed::speed);
}

const ResponseAtSpeed& nearest(const std::vector<ResponseAtSpeed>& curve, double speed) {
  return *std::ranges::min_element(curve, {}, [&](const ResponseAtSpeed& r) { return std::abs(r.speed - speed); });
}

// A peak of the list with the numbers that its bars stand on.
struct Listed {
  io::PeakEntry entry;
  NamedPeak named;
  std::string unsettled;  // why its numbers are not settled; empty if they are
};

// Marks the speeds at which the equilibrium is unstable: there nothing settles into the linear motion.
void put_stability(io::Group& group, io::StudySummary& summary, const std::vector<ResponseAtSpeed>& curve,
                   const StableSpeeds& stable, const std::optional<deck::Quantity>& operating,
                   const std::string& unit) {
  if (!stable.known()) return;
  group.child("response")
      .put("unstable_count", column(curve, [&](const ResponseAtSpeed& r) { return stable.at(r.speed); }),
           "eigenvalues that grow about the equilibrium, between the speeds counted as beside them; -1: some may be "
           "missing");
  put_verdict(summary, stable, unit,
              "no vibration settles into the linear response there, and its peaks, amplification factors and margins "
              "describe no real motion");
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
  const std::vector<ResponsePlace> places = places_of(nodes, names);
  // Responses at several speeds, shared between the groups of ranks.
  std::size_t ready = 0, calls = 0;
  Pieces pieces(results, context.resume);
  LostSpeeds lost;
  const auto solve_at = [&](Responder& which, const std::vector<double>& speeds, const std::string& piece,
                            LostSpeeds& without) {
    const auto compute = [&](std::size_t i) {
      auto here = answered([&] { return which.at(speeds[i]); });
      results.progress(fmt::format("{}: {} speeds on this rank, {:.1f} {}, {:.1f} s", summary.name, ++ready,
                                   deck::from_si(speeds[i], unit), unit, results.seconds()));
      return here;
    };
    std::vector<ResponseAtSpeed> out;
    std::size_t k = 0;
    for (auto& [there, why] : distribute(layout, speeds.size(), compute, pieces, piece, which.trail())) {
      if (there)
        out.push_back(std::move(*there));
      else
        without[speeds[k]] = std::move(why);
      ++k;
    }
    return out;
  };
  const auto at_speeds = [&](const std::vector<double>& speeds) {
    return solve_at(machine, speeds, fmt::format("{} speed", ++calls), lost);
  };
  // The same for the curve: a speed without an equilibrium is a gap of it.
  const auto rows_at = [&](const std::vector<double>& speeds) {
    std::vector<ResponseAtSpeed> rows = at_speeds(speeds);
    for (const double speed : speeds)
      if (const auto at = lost.find(speed); at != lost.end() && at->second != solve::singular_at_frequency)
        rows.push_back(ResponseAtSpeed::without_answer(speed, nodes.size(), names.size()));
    return rows;
  };
  const std::vector<double> grid = evenly(options.range.from, options.range.to, options.points);
  std::vector<ResponseAtSpeed> curve = rows_at(grid);
  if (std::ranges::all_of(curve, [](const ResponseAtSpeed& r) { return std::isnan(r.largest); }))
    return results.finish(lost.begin()->second, false);

  // Speeds added around the peaks of each place until the parabola of 1/f^2 settles the speed to 1e-5.
  const auto by_speed = [](const ResponseAtSpeed& a, const ResponseAtSpeed& b) { return a.speed < b.speed; };
  std::sort(curve.begin(), curve.end(), by_speed);
  const auto add = [&](std::vector<double> speeds) {
    std::vector<double> known = speeds_of(curve);
    for (const auto& [speed, why] : lost)
      if (!std::ranges::binary_search(known, speed)) known.insert(std::ranges::upper_bound(known, speed), speed);
    speeds = worth_asking(std::move(speeds), known);
    for (ResponseAtSpeed& r : rows_at(speeds)) curve.push_back(std::move(r));
    std::sort(curve.begin(), curve.end(), by_speed);
    return !speeds.empty();
  };
  // Until no top of any place asks for more.
  const auto add_rounds = [&](int passes, const auto& ask) {
    for (int pass = 0; pass < passes; ++pass) {
      std::vector<double> speeds;
      for (const ResponsePlace& place : places) {
        const ResponseCurve of = curve_at(curve, place.of, place.at);
        for (const std::size_t k : of.tops()) ask(of, k, pass, speeds);
      }
      if (speeds.empty() || !add(std::move(speeds))) return;
    }
  };
  // Then speeds around the two places where each peak has fallen to 0.707 of its height; these may show a higher top.
  const auto refine = [&] {
    for (int round = 0; round < 3; ++round) {
      add_rounds(10, ask_for_top);
      add_rounds(10, [](const ResponseCurve& of, std::size_t k, int, std::vector<double>& speeds) {
        ask_for_width(of, k, speeds);
      });
    }
  };
  if (options.refine) refine();

  const auto operating = operating_range(options.operating, options.operating_speed, context.machine.service_speed);
  const auto& operating_speed = options.operating_speed ? options.operating_speed : context.machine.service_speed;
  // Eigenvalues at some speeds say where the machine is unstable, and between which speeds a resonance may hide.
  std::map<double, int> growing;
  Spectra spectra;
  const auto look = [&](std::vector<double> speeds) {
    std::ranges::sort(speeds);
    speeds.erase(std::unique(speeds.begin(), speeds.end()), speeds.end());
    for (const auto& [speed, why] : lost)
      if (why != solve::singular_at_frequency) growing.try_emplace(speed, SpectrumAt{}.growing);
    std::erase_if(speeds, [&](double speed) { return growing.contains(speed); });
    const auto compute = [&](std::size_t i) { return machine.spectrum(speeds[i]); };
    auto found =
        distribute(layout, speeds.size(), compute, pieces, fmt::format("{} stability", ++calls), machine.trail());
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      SpectrumAt& here = found[i];
      growing[speeds[i]] = here.growing;
      if (!here.values.empty()) spectra[speeds[i]] = std::move(here.values);
    }
  };
  // Eigenvalues are counted without a loss factor, so that nothing is said of a shaft with one.
  const bool lossless = context.machine.rotor.loss_factor == 0;
  // A resonance takes about four spectra. Small dense matrices have cheap ones: enough for 75 resonances. A spectrum of
  // a larger machine costs as much as many responses: enough for six.
  const ResonanceSearch search = search_of(context.machine.rotor, machine.whole_spectra() ? 300 : 24);
  std::vector<double> counted{curve.front().speed, curve.back().speed}, tops;
  if (lossless) counted = few_speeds(speeds_of(curve));
  if (operating_speed) counted.push_back(operating_speed->value);
  const std::vector<double> rows = tabled_speeds(context.machine, curve.front().speed, curve.back().speed, curve.size(),
                                                 machine.states(), summary, unit);
  counted.insert(counted.end(), rows.begin(), rows.end());
  add_tops(tops, curve, places, true);
  add_tops(counted, curve, places, false);
  std::vector<double> at_first = counted;
  at_first.insert(at_first.end(), tops.begin(), tops.end());
  if (search.limit < curve.back().speed) at_first.push_back(search.limit);
  look(at_first);
  const HiddenResonances hidden = hidden_resonances(spectra, speeds_of(curve), tops, search, look);
  std::vector<double> beside;
  for (const Resonance& r : hidden.found)
    for (const double speed : around(r))
      if (speed > curve.front().speed && speed < curve.back().speed) beside.push_back(speed);
  // Nobody asked for these speeds: where one has no answer the study goes on.
  bool added = false;
  const bool reached = !options.refine || has_answer([&] { added = add(beside); });
  if (added) refine();
  // Lines between samples cut the flanks of peaks: a few more there, none of which anybody asked for. They may show
  // tops of other places.
  if (options.refine)
    (void)has_answer([&] {
      std::vector<double> flanks;
      for (const ResponsePlace& place : places) {
        const ResponseCurve of = curve_at(curve, place.of, place.at);
        for (const std::size_t k : of.tops()) ask_for_flanks(of, k, flanks);
      }
      if (add(std::move(flanks))) refine();
    });
  add_tops(counted, curve, places, false);
  if (!options.refine && !beside.empty())
    if (const auto words = shown_by(curve, answer_of([&] { return at_speeds(beside); }), hidden.found, places, unit);
        !words.empty())
      summary.warnings.push_back(fmt::format(
          "the speeds computed miss resonances that stand between them: {}. 'refine: true' adds speeds there",
          fmt::join(words, ", ")));
  if (hidden.gave_up || !reached)
    summary.warnings.emplace_back(
        "not all resonances between the speeds computed could be looked for: more 'points' or a narrower 'range' show "
        "what is missing");
  for (std::string& line : beyond_beams(context.machine.rotor, curve.back().speed, unit))
    summary.warnings.push_back(std::move(line));
  for (std::string& line : open_ends(curve, places, spectra, unit)) summary.warnings.push_back(std::move(line));

  StableSpeeds stable;
  if (lossless) {
    std::vector<double> all = speeds_of(curve);
    for (const auto& [speed, why] : lost) {
      all.push_back(speed);
      counted.push_back(speed);
    }
    all.insert(all.end(), rows.begin(), rows.end());
    if (operating_speed) all.push_back(operating_speed->value);
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    for (const double at : where_growth_may_hide(spectra, search)) {
      const auto next = std::ranges::lower_bound(all, at);
      if (next != all.end()) counted.push_back(*next);
      if (next != all.begin()) counted.push_back(*std::prev(next));
    }
    stable = StableSpeeds(std::move(all), counted, [&](const std::vector<double>& speeds) {
      look(speeds);
      std::vector<int> out;
      for (const double speed : speeds) out.push_back(growing.at(speed));
      return out;
    });
  }

  const auto put_peak = [&](io::StudySummary& to, const std::string& head, double speed, double height, double factor) {
    const io::PeakEntry entry = entry_of("", {speed, height, factor, {}, {}}, unit, operating);
    for (const PeakValue& v : peak_values())
      if (const io::Quantity& q = entry.*v.member; !q.unit.empty()) to.set(head + v.name, q.value, q.unit);
  };
  const system::ShownPlaces shown = machine.places();
  std::vector<Listed> peaks;
  std::map<std::pair<std::string, bool>, std::string> narrow;  // speed and whether undamped: labels of the places
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
      const bool endless =
          peak.too_narrow() && entry.stability == StableSpeeds::word(0) && undamped_at(spectra, peak.speed, search);
      if (endless) entry.stability = undamped;
      if (peak.too_narrow()) entry.notes.push_back(narrow_words(endless));
      if (const std::string bearing = touched(nearest(curve, peak.speed), shown); !bearing.empty())
        entry.notes.push_back("no answer: the motion leaves bearing " + bearing + " too little film");
      peaks.push_back({entry,
                       {head, p, peak.speed, peak.height, peak.amplification, peak.errors, saddles},
                       unsettled(of, k, peak, options.refine, unit)});
      if (!peak.too_narrow()) continue;
      // Places see one resonance at speeds that differ by the tolerance.
      std::string& where = narrow[{fmt::format("{:.5g}", deck::from_si(peak.speed, unit)), endless}];
      where += (where.empty() ? "" : "; ") + places[p].label;
    }
  }
  for (const auto& [peak, where] : narrow)
    summary.warnings.push_back(
        fmt::format("the peak near {} {} ({}) is {}", peak.first, unit, where, narrow_words(peak.second)));
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
  double operating_rounding = 0;  // [m]
  const auto take_operating = [&] {
    const std::vector<ResponseAtSpeed> found = at_speeds({operating_speed->value});
    if (found.empty()) throw core::NotConverged(lost.at(operating_speed->value));
    if (stands_on_pole(found.front(), spectra, search, at_speeds))
      throw core::NotConverged(solve::singular_at_frequency);
    const ResponseAtSpeed& there = found.front();
    put_operating(names, nodes, there, summary);
    summary.set("operating_speed.answer", touched(there, shown).empty() ? 1 : 0, "1");
    operating_rounding = motion_rounding * there.largest;
  };
  const bool operating_known = operating_speed && has_answer(take_operating, &reason);
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
                      LostSpeeds without;
                      std::vector<ResponseAtSpeed> all = solve_at(other ? *other : machine, at, piece, without);
                      if (!without.empty()) throw core::NotConverged(without.begin()->second);
                      MeshResponse out;
                      if (operating_known) {
                        put_operating(names, nodes, all.back(), out.operating);
                        all.pop_back();
                      }
                      for (const ResponseAtSpeed& r : all) {
                        out.height.emplace_back();
                        for (const ResponsePlace& place : places)
                          out.height.back().push_back((r.*place.of)[place.at].semi_major());
                      }
                      return out;
                    });
  for (Listed& p : peaks) {
    take_bars(summary, *std::ranges::find(named, p.named.head, &NamedPeak::head), p.unsettled, p.entry);
    summary.peaks.push_back(p.entry);
  }

  for (const ResponseAtSpeed& r : curve)
    if (stands_on_pole(r, spectra, search, at_speeds)) lost[r.speed] = solve::singular_at_frequency;
  const auto beside_grid = [&](double speed) { return std::ranges::find(grid, speed) == grid.end(); };
  std::erase_if(curve, [&](const ResponseAtSpeed& r) { return lost.contains(r.speed) && beside_grid(r.speed); });
  std::erase_if(lost, [&](const auto& l) { return beside_grid(l.first); });
  put_lost(curve, lost, summary, unit);
  summary.points = static_cast<long>(curve.size() - lost.size());

  auto& group = results.group();
  put_films(group, summary, shown, curve, unit);
  put_stability(group, summary, curve, stable, operating_speed, unit);
  if (!lossless)
    summary.warnings.emplace_back(
        "this study does not tell where a shaft with a loss factor is unstable: `modes` over the speed does. Where "
        "modes "
        "grow, no vibration settles into this response");
  // Nothing grows, and something does not decay.
  if (constexpr std::string_view word = "stable";
      std::ranges::find(summary.peaks, undamped, &io::PeakEntry::stability) != summary.peaks.end() &&
      summary.stability.starts_with(word))
    summary.stability.replace(0, word.size(), "stable or undamped");
  warn_of_amplification(summary);
  warn_of_shaft_mesh(summary, context.machine.rotor, named, nodes, operating_rounding);
  if (operating) put_operating_range(summary, *operating, options.range);
  auto& response = group.child("response");
  response.put("speed", speeds_of(curve), "rad/s", "shaft speed");
  response.put("node", std::vector<std::int64_t>(nodes.begin(), nodes.end()), "shaft nodes, 1-based");
  put_motion(response, curve, &ResponseAtSpeed::nodes, "absolute motion of the shaft");
  response.label_each({io::node_labels(nodes)});
  put_bearings(group, context.machine);
  put_motion(group.child("bearings"), curve, &ResponseAtSpeed::bearings, "journal relative to its pedestal");
  group.child("bearings").label_each({names_of_bearings(context.machine)});
  group.set("speed_unit", unit);
  if (operating_known) group.set("operating_at", operating_speed->value);
  group.set("unbalance", fmt::format("{}", fmt::join(options.unbalance, ", ")));
  return results.finish(status_of(lost.size(), grid.size(), "speeds", "response"), true);
}

}  // namespace whirl::study
