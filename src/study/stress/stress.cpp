#include "study/stress/stress.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "study/bars/error_bar.hpp"
#include "study/bars/film_limit.hpp"
#include "study/bars/film_mesh.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/brief.hpp"
#include "study/common.hpp"
#include "study/growth.hpp"
#include "study/layout.hpp"
#include "study/linear/synchronous.hpp"
#include "study/stress/bending.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/rotor/divide.hpp"
#include "whirl/rotor/element.hpp"

namespace whirl::study {
namespace {

// The whole shaft, whatever its reduction: a reduced one has no inertia between its masters.
system::Train train_on(const system::Machine& machine, const StressOptions& o, const FilmMesh& mesh) {
  system::Train train = system::train_of(machine, o.unbalance);
  train.rotor.reduction = {};
  return on_mesh(std::move(train), mesh);
}

// The machine at its speed. Collective.
class Bent {
public:
  Bent(const system::Machine& machine, MPI_Comm space, const StressOptions& o, const FilmMesh& mesh)
      : options_(o), system_(space, train_on(machine, o, mesh), o.speed.value), walker_(system_) {
    for (int node = 1; node <= static_cast<int>(machine.rotor.segments.size()) + 1; ++node)
      nodes_.insert(rotor::node_after(machine.rotor, node, parts_of(mesh)));
  }
  [[nodiscard]] system::RotorSystem& system() { return system_; }
  [[nodiscard]] Vec rest() { return walker_.at(options_.speed.value); }
  // At the nodes of the deck.
  [[nodiscard]] std::vector<BendingAt> ends() {
    Vec x = rest();
    const system::Train& train = system_.train();
    std::array<ShaftShape, 2> vibration;
    const ShaftShape still = system_.shaft(x, 0, true);
    if (!options_.unbalance.empty()) {
      solve::FrequencyResolvent solver(system_);
      const auto state = synchronous_response(system_, solver, x, options_.speed.value);
      for (std::size_t part = 0; part < 2; ++part) vibration[part] = system_.shaft(state[part].data(), 0, false);
    }
    std::vector<BendingAt> all =
        bending_of(train.rotor, still, {train.gravity_x, -train.gravity}, vibration, options_.speed.value);
    std::erase_if(all, [&](const BendingAt& b) { return !nodes_.contains(b.node); });
    return all;
  }

private:
  const StressOptions& options_;
  system::RotorSystem system_;
  Walker walker_;
  std::set<int> nodes_;  // of the deck, on this mesh
};

// Segments of one diameter side by side, nodes first to last: `begin` to `end` in the list of ends.
struct Section {
  int first = 0, last = 0;
  std::size_t begin = 0, end = 0;
};

std::vector<Section> sections_of(const rotor::Options& shaft) {
  const auto outline = [](const rotor::Segment& s) {
    return s.outer_stiffness_diameter > 0 ? std::pair(s.outer_stiffness_diameter, s.inner_stiffness_diameter)
                                          : std::pair(s.outer_mass_diameter, s.inner_mass_diameter);
  };
  const auto tapered = [](const rotor::Segment& s) { return s.right_outer_diameter || s.right_inner_diameter; };
  std::vector<Section> out;
  std::size_t at = 0;
  for (std::size_t e = 0; e < shaft.segments.size(); ++e) {
    if (rotor::coupling_at(shaft, e)) continue;
    const int node = static_cast<int>(e) + 1;
    const rotor::Segment& s = shaft.segments[e];
    const bool goes_on = !out.empty() && out.back().last == node && !tapered(s) && !tapered(shaft.segments[e - 1]) &&
                         outline(s) == outline(shaft.segments[e - 1]);
    if (!goes_on) out.push_back({node, node, at, at});
    out.back().last = node + 1;
    out.back().end = at += 2;
  }
  return out;
}

// What the stresses take of the strength: without a limit, their size [Pa].
double taken(const BendingAt& b, const StressOptions& o) {
  if (!o.endurance) return b.largest();
  return b.alternating() / *o.endurance + (o.strength ? b.mean() / *o.strength : 0);
}

std::string head_of(std::size_t section) {
  return fmt::format("section.{}.", section + 1);
}

// Calls `use` with each section and the end where it is stressed most.
template <class Use>
void each_worst(const std::vector<Section>& sections, const std::vector<BendingAt>& ends, const StressOptions& o,
                const Use& use) {
  for (std::size_t k = 0; k < sections.size(); ++k)
    use(head_of(k), sections[k],
        *std::max_element(ends.begin() + static_cast<std::ptrdiff_t>(sections[k].begin),
                          ends.begin() + static_cast<std::ptrdiff_t>(sections[k].end),
                          [&](const BendingAt& a, const BendingAt& b) { return taken(a, o) < taken(b, o); }));
}

void put_stresses(io::StudySummary& summary, const std::vector<Section>& sections, const std::vector<BendingAt>& ends,
                  const StressOptions& o) {
  each_worst(sections, ends, o, [&](const std::string& head, const Section&, const BendingAt& b) {
    summary.set(head + "alternating", b.alternating(), "Pa");
    if (!o.unbalance.empty()) summary.set(head + "mean", b.mean(), "Pa");
    summary.set(head + "largest", b.largest(), "Pa");
    if (o.endurance) summary.set(head + "margin", 1 / taken(b, o), "1");
  });
}

void put_table(io::Group& group, const std::vector<BendingAt>& ends) {
  io::Table table({{"z", "m", "place along the shaft; both ends of each segment"},
                   {"node", "1", "of the shaft"},
                   {"diameter", "m", "outer diameter of the section"},
                   {"moment_x", "N m", "bending moment of what stands still in the plane of x, M = E I d(dx/dz)/dz"},
                   {"moment_y", "N m", "the same in the plane of y, sagging positive"},
                   {"forward", "N m", "moment by unbalance that turns with the shaft"},
                   {"backward", "N m", "moment by unbalance that turns against the shaft"},
                   {"shear_x", "N", "shear force of what stands still in the plane of x, dM/dz"},
                   {"shear_y", "N", "the same in the plane of y"},
                   {"alternating", "Pa", "amplitude of the stress of the fibre that feels most of it"},
                   {"mean", "Pa", "stress that stays in a fibre, at the most"},
                   {"largest", "Pa", "largest stress of any fibre in a revolution"}});
  for (const BendingAt& b : ends)
    table.append({b.z, static_cast<double>(b.node), b.outer, b.still.real(), b.still.imag(), std::abs(b.forward),
                  std::abs(b.backward), b.shear.real(), b.shear.imag(), b.alternating(), b.mean(), b.largest()});
  table.write(group);
}

std::string nodes_of(const Values& v, const std::string& head) {
  return fmt::format("{:.0f} to {:.0f}", v[head + "first_node"].value, v[head + "last_node"].value);
}

// Sections from the one with the least reserve on.
std::vector<std::string> by_reserve(const Values& v) {
  std::vector<std::string> heads;
  for (const std::string& k : v.between("section.", ".largest")) heads.push_back("section." + k + ".");
  std::ranges::stable_sort(heads, {}, [&](const std::string& head) {
    const auto margin = v.get(head + "margin");
    return margin ? *margin : -v[head + "largest"].value;
  });
  return heads;
}

void warn_of_margins(io::StudySummary& summary) {
  std::string too_small, doubtful;
  const Values v(summary);
  for (const std::string& head : by_reserve(v)) {
    const io::Quantity margin = v[head + "margin"];
    if (!std::isfinite(margin.value) || margin.value - std::fmax(margin.bar(), 0) >= 1) continue;
    std::string& list = decided(margin.value, std::fmax(margin.bar(), 0), 1) ? too_small : doubtful;
    list += (list.empty() ? "" : ", ") + nodes_of(v, head) + " (" + io::reading(margin) + ")";
  }
  if (!doubtful.empty())
    summary.warnings.push_back("the margins of these nodes may be one or less, within their bars: " + doubtful);
  if (!too_small.empty())
    warn_first(summary,
               "the shaft does not bear its stresses for ever, the margins of these nodes are below one: " + too_small);
}

}  // namespace

StudyResult Stress::run(Context& context) {
  const Layout layout = plan(context, Sharing::meshes);
  const std::string where =
      fmt::format("at {:.6g} {}", deck::from_si(options.speed.value, options.speed.unit), options.speed.unit);
  io::StudySummary& summary = context.results.summary();
  Bent here(context.machine, layout.space, options, {});
  Vec at = here.rest();
  FilmLimit(here.system().places()).warn(here.system().observe(at).film_thickness, "at rest", summary);
  if (context.machine.rotor.loss_factor == 0)  // equilibria know of none
    put_growth(growth_at(here.system(), at), where, "The shaft does not stay where these stresses hold", summary);
  const std::vector<Section> sections = sections_of(context.machine.rotor);
  const std::vector<BendingAt> ends = here.ends();
  put_stresses(summary, sections, ends, options);
  {
    SummaryBars bars(summary, law_of(context.machine, context.layout));
    std::vector<FilmMesh> meshes = film_meshes(context.machine, context.layout);
    // At rest moments at nodes do not depend on the length of elements.
    if (!options.unbalance.empty() && has_shaft_mesh(context.machine, context.layout)) meshes.push_back(cut_shaft_mesh);
    Pieces pieces(context.results, context.resume);
    bars.add(layout, pieces, meshes, [&](const FilmMesh& mesh, io::StudySummary& there) {
      put_stresses(there, sections, Bent(context.machine, layout.space, options, mesh).ends(), options);
    });
    bars.write(1e-9);
  }
  each_worst(sections, ends, options, [&](const std::string& head, const Section& s, const BendingAt& b) {
    summary.set(head + "first_node", s.first, "1");
    summary.set(head + "last_node", s.last, "1");
    summary.set(head + "node", b.node, "1");
    summary.set(head + "z", b.z, "m");
    summary.set(head + "diameter", b.outer, "m");
  });
  warn_of_margins(summary);
  io::Group& group = context.results.group();
  group.set("speed", options.speed.value);
  put_table(group.child("shaft"), ends);
  summary.points = 1;
  return context.results.finish("completed", true);
}

io::Brief Stress::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  const std::vector<std::string> heads = by_reserve(v);
  if (heads.empty()) return {};
  const std::string& worst = heads.front();
  std::string words =
      fmt::format("largest bending stress {} at node {:.0f} (z = {})", io::reading(v[worst + "largest"]),
                  v[worst + "node"].value, io::reading(v[worst + "z"]));
  if (const auto margin = v.get(worst + "margin"))
    words = fmt::format("least margin {} at node {:.0f} (z = {}), bending stress up to {}",
                        io::reading(v[worst + "margin"]), v[worst + "node"].value, io::reading(v[worst + "z"]),
                        io::reading(v[worst + "largest"]));
  io::BriefTable table{
      fmt::format("Most stressed sections at {}",
                  io::reading({deck::from_si(options.speed.value, options.speed.unit), options.speed.unit})),
      {{"nodes"},
       {"diameter", "m"},
       {"at node"},
       {"alternating", "Pa"},
       {"mean", "Pa"},
       {"largest", "Pa"},
       {"margin", "1"}},
      {},
      "nominal stresses by bending, without notches and torsion; alternating: amplitude, as the shaft turns in what "
      "stands still and in backward whirl; mean: by forward whirl"};
  if (options.endurance)
    table.note +=
        options.strength ? "; margin: 1/(alternating/endurance + mean/strength)" : "; margin: endurance/alternating";
  constexpr std::size_t most = 8;
  for (std::size_t k = 0; k < std::min(most, heads.size()); ++k) {
    const std::string& head = heads[k];
    table.rows.push_back({nodes_of(v, head), v[head + "diameter"], fmt::format("{:.0f}", v[head + "node"].value),
                          v[head + "alternating"], v[head + "mean"], v[head + "largest"], v[head + "margin"]});
  }
  return {{std::move(words)}, {std::move(table)}};
}

}  // namespace whirl::study
