#include "study/linear/mode_bars.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "study/bars/film_mesh.hpp"
#include "study/bars/reduction_error.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "whirl/deck/codecs.hpp"
#include "whirl/rotor/describe.hpp"
#include "whirl/rotor/divide.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {

namespace {

void append(std::vector<double>& out, std::complex<double> lambda) {
  out.insert(out.end(), {lambda.real(), lambda.imag(), spectral::log_decrement(lambda)});
}

// Real part, imaginary part and log decrement of each mode of `here` as it is among `there`.
std::vector<double> paired(const std::vector<spectral::ModePoint>& here,
                           const std::vector<spectral::ModePoint>& there) {
  const std::vector<int> before = spectral::match_modes(here, there, 0).before;
  std::vector<double> out;
  for (std::size_t k = 0; k < here.size(); ++k) {
    const auto at = std::find(before.begin(), before.end(), static_cast<int>(k));
    if (at == before.end())
      out.insert(out.end(), 3, unknown);
    else
      append(out, there[static_cast<std::size_t>(at - before.begin())].lambda);
  }
  return out;
}

// A shape at the nodes of a shaft whose beams were cut in two, at those of the `whole` one: x, then y.
std::vector<std::complex<double>> at_nodes_of(const rotor::Options& whole,
                                              const std::vector<std::complex<double>>& shape) {
  std::vector<std::complex<double>> out;
  for (std::size_t d = 0; d < 2; ++d)
    for (int node = 1; node <= rotor::n_nodes(whole); ++node)
      out.push_back(shape[d * shape.size() / 2 + static_cast<std::size_t>(rotor::node_after(whole, node, 2) - 1)]);
  return out;
}

// Numbers in a sentence: "1, 3 to 5".
std::string runs_of(const std::set<int>& numbers) {
  std::string out;
  for (auto at = numbers.begin(); at != numbers.end();) {
    auto end = std::next(at);
    int last = *at;
    for (; end != numbers.end() && *end == last + 1; ++end) ++last;
    out += fmt::format("{}{}", out.empty() ? "" : ", ", *at);
    if (last > *at) out += fmt::format("{}{}", last == *at + 1 ? ", " : " to ", last);
    at = end;
  }
  return out;
}

}  // namespace

// One task is one mesh at all these speeds, each from its neighbour.
ModeBars::ModeBars(const Context& context, const Layout& layout, Pieces& pieces,
                   const std::vector<SampledModes>& sampled,
                   const std::function<std::vector<spectral::ModePoint>(system::RotorSystem&, Vec)>& modes_at)
    : resolved_to_(resolved_to(context.machine.rotor)) {
  std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
  const bool shaft = has_shaft_mesh(context.machine, context.layout);
  if (shaft) meshes.push_back(cut_shaft_mesh);
  any_ = !meshes.empty();
  several_ = sampled.size() > 1;
  if (!any_ || sampled.empty()) return;
  // Nodes of a shaft that is cut which were there before are those of the modes here.
  const auto compute = [&](std::size_t i) {
    return answered([&] {
      std::vector<double> all;
      const system::Train given = system::train_of(context.machine);
      system::RotorSystem there(layout.space, on_mesh(given, meshes[i]), sampled.front().speed);
      Walker walker(there);
      for (const SampledModes& s : sampled) {
        auto other = modes_at(there, walker.at(s.speed));
        if (meshes[i].axis == Axis::shaft)
          for (spectral::ModePoint& m : other) m.shape = at_nodes_of(given.rotor, m.shape);
        const auto numbers = paired(s.modes, other);
        all.insert(all.end(), numbers.begin(), numbers.end());
      }
      return all;
    });
  };
  const auto on_meshes = distribute(layout, meshes.size(), compute, pieces, "other mesh", no_trail);
  std::vector<double> here;
  for (const SampledModes& s : sampled)
    for (const spectral::ModePoint& m : s.modes) append(here, m.lambda);
  Bars bars(here, law_of(context.machine, context.layout));
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const auto& [found, failed] = on_meshes[i];
    bars.add(meshes[i].axis, meshes[i].spacing, found.value_or(std::vector<double>{}));
    const bool of_shaft = meshes[i].axis == Axis::shaft;
    const char* const mesh = of_shaft ? "the shaft with every segment cut in two" : "another mesh of the films";
    const char* const advice = of_shaft ? "cut the segments shorter" : "give the films more cells";
    for (std::size_t s = 0, k = 0; s < sampled.size(); ++s)
      for (std::size_t m = 0; m < sampled[s].ids.size(); ++m, k += 3) {
        if (m >= sampled[s].listed || (found && !std::isnan((*found)[k]))) continue;
        without_[found ? fmt::format("{} has none like them; {}, or ask for fewer modes ('count')", mesh, advice)
                       : fmt::format("{} gave no modes ({})", mesh, failed)]
            .insert(sampled[s].ids[m]);
      }
  }
  std::size_t k = 0;
  for (const SampledModes& s : sampled)
    for (std::size_t m = 0; m < s.ids.size(); ++m) {
      const int id = s.ids[m];
      of_[id].push_back({s.speed, {bars[k].total(), bars[k + 1].total(), bars[k + 2].total()}});
      const double frequency = std::abs(here[k + 1]), part = bars[k + 1].shaft_mesh / frequency;
      if (shaft && m < s.listed && frequency > 0 && std::isfinite(part)) shaft_error_ = std::max(shaft_error_, part);
      k += 3;
    }
}

void ModeBars::tell(io::StudySummary& summary, const rotor::Options& rotor, const std::set<int>& shown) const {
  const std::string at_no_speed = "they occur at none of the speeds at which other meshes are computed";
  std::map<std::string, std::set<int>> without;
  for (const auto& [why, ids] : without_)
    std::ranges::set_intersection(ids, shown, std::inserter(without[why], without[why].end()));
  for (const int id : shown)
    if (any_ && !of_.contains(id)) without[at_no_speed].insert(id);
  for (const auto& [why, ids] : without)
    if (!ids.empty())
      summary.warnings.push_back(fmt::format("no error bars of mode{} {}{}: {}", ids.size() > 1 ? "s" : "",
                                             runs_of(ids), several_ && why != at_no_speed ? " at some speeds" : "",
                                             why));
  put_shaft_error(summary, rotor, shaft_error_);
}

std::array<double, 3> ModeBars::at(int id, double speed) const {
  std::array<double, 3> out{unknown, unknown, unknown};
  const auto found = of_.find(id);
  if (found == of_.end()) return out;
  const std::vector<Point>& points = found->second;
  const std::size_t last = points.size() - 1;
  const auto largest = [&](std::size_t at, std::size_t k) {
    double bar = points[at].bar[k];
    if (std::isnan(bar)) return unknown;
    for (std::size_t j = at > 0 ? at - 1 : 0; j <= std::min(at + 1, last); ++j) bar = std::fmax(bar, points[j].bar[k]);
    return bar;
  };
  std::size_t right = 0;
  while (right < last && points[right].speed < speed) ++right;
  const std::size_t left = right > 0 && points[right].speed != speed ? right - 1 : right;
  const double span = points[right].speed - points[left].speed,
               share = span > 0 ? std::clamp((speed - points[left].speed) / span, 0.0, 1.0) : 1;
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = largest(right, k);
    if (left != right) out[k] = (1 - share) * largest(left, k) + share * out[k];
  }
  return out;
}

std::map<std::string, double> ModeBars::named(int id, double speed) const {
  if (!any_) return {};
  const auto bar = at(id, speed);
  return {{"real_uncertainty", bar[0]}, {"imag_uncertainty", bar[1]}, {"log_decrement_uncertainty", bar[2]}};
}

std::map<std::string, double> ModeBars::as_bar(double error) const {
  if (!any_) return {};
  return {{"uncertainty", error}};
}

void ModeBars::put(io::Group& spectrum, const std::vector<std::int64_t>& ids, const std::vector<double>& speeds) const {
  if (!any_) return;
  std::array<std::vector<double>, 3> column;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    const auto bar = at(static_cast<int>(ids[k]), speeds[k]);
    for (std::size_t i = 0; i < 3; ++i) column[i].push_back(bar[i]);
  }
  spectrum.put("damping_real_uncertainty", column[0], "1/s", "estimated error from the meshes of films and shaft");
  spectrum.put("frequency_uncertainty", column[1], "rad/s", "likewise");
  spectrum.put("log_decrement_uncertainty", column[2], "1", "likewise");
}

ModeReduction::ModeReduction(const system::RotorSystem& system, Walker& walker,
                             const std::vector<SampledModes>& sampled) {
  if (!has_reduction_errors(system)) return;
  for (const SampledModes& at : sampled) {
    if (at.speed <= 0) continue;  // systems turn
    std::vector<std::complex<double>> values;
    for (const spectral::ModePoint& m : at.modes) values.push_back(m.lambda);
    auto errors = answer_of([&] { return reduction_errors(system, walker.at(at.speed), values); });
    if (!errors.empty()) of_[at.speed] = std::move(errors);
  }
}

void ModeReduction::put(io::StudySummary& summary, double speed, std::size_t k) {
  const auto found = of_.find(speed);
  if (found == of_.end()) return;
  const std::complex<double> error = found->second[k];
  summary.modes.back().more["real_reduction_error"] = error.real();
  summary.modes.back().more["imag_reduction_error"] = error.imag();
  if (!std::isnan(largest_))
    largest_ = std::isfinite(std::abs(error)) ? std::max(largest_, std::abs(error)) : std::abs(error);
  summary.set("reduction.largest_error", largest_, "rad/s");
}

}  // namespace whirl::study
