// What the deck says of a film of gas.
#include "whirl/film/contract/gas.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "film/gas/gas_feed.hpp"
#include "film/gas/gas_film.hpp"
#include "film/sheet/refine.hpp"
#include "whirl/film/contract/describe.hpp"

namespace whirl::film {
namespace {

bool has_pocket(const OrificeRow& row) {
  return row.pocket.has_value();
}

}  // namespace

std::span<const deck::Name<Gas::Source>> names(Gas::Source) {
  static constexpr deck::Name<Gas::Source> table[] = {
      {Gas::Source::rim, "rim",
       "pressure at the rim of the orifice, by the field of a point source; the mesh does not show"},
      {Gas::Source::node, "node",
       "pressure of the node that the orifice feeds; load drifts with the mesh and never converges"}};
  return table;
}

std::span<const deck::Name<Gas::Slip>> names(Gas::Slip) {
  static constexpr deck::Name<Gas::Slip> table[] = {
      {Gas::Slip::none, "none", "the gas sticks to the walls: Kn < 0.01"},
      {Gas::Slip::first, "first", "flow by pressure times 1 + 6 Kn (Burgdorfer 1959), for Kn < 0.1"},
      {Gas::Slip::second, "second", "flow by pressure times 1 + 6 Kn + 6 Kn^2 (Hsia and Domoto 1983), for Kn < 1"}};
  return table;
}

std::span<const deck::Name<OrificeRow::Law>> names(OrificeRow::Law) {
  using enum OrificeRow::Law;
  static constexpr deck::Name<OrificeRow::Law> table[] = {
      {thickness, "thickness",
       "coefficient 0.85 (1 - exp(-8.2 h_f/d)) of the orifice, h_f = h + depth of the pocket; with a pocket for h_f/d "
       "< "
       "0.1 (eq. 3.8)"},
      {reynolds, "reynolds",
       "the same times 1 - exp(-0.001 Re h_f/(h + 4 depth)), for 0.1 < h_f/d < 0.2 (eqs. 3.9-3.10; the fraction could "
       "not be verified)"},
      {curtain, "curtain",
       "coefficient 1.05 (1 - exp(-0.005 Re)) of the curtain pi d h, without pocket (eqs. 3.12-3.13 at the orifice)"},
      {two_restrictors, "two_restrictors",
       "'reynolds' into the pocket, then 'curtain' at its rim, for h_f/d >= 0.2 (eqs. 3.9-3.13)"}};
  return table;
}

void describe(deck::Description<Pocket>& d) {
  d.add("diameter", &Pocket::diameter, "m", deck::positive,
        "diameter; the film has the pressure behind the orifice at "
        "this rim")
      .required();
  d.add("depth", &Pocket::depth, "m", deck::positive,
        "below the bore; gas in this volume is compressed too, which takes damping away (pneumatic hammer)")
      .required()
      .continuable();
}

void describe(deck::Description<Lobes>& d) {
  d.add("count", &Lobes::count, deck::in(2, 12), "arcs around the bore, which touch each other");
  d.add("preload", &Lobes::preload, deck::Check{.min = 0, .max = 1, .max_open = true},
        "1 - clearance/clearance of an arc")
      .continuable();
  d.add("angle", &Lobes::angle, "rad", deck::any, "middle of the first one, from +x; lines of nodes are at the joints");
}

void describe(deck::Description<OrificeRow>& d) {
  d.add("count", &OrificeRow::count, deck::in(1, 1000), "number of orifices, evenly spaced around the bore");
  d.add("z", &OrificeRow::z, "m", deck::any, "place along the shaft, from the mid-plane");
  d.add("angle", &OrificeRow::angle, "rad", deck::any,
        "of the first one, from +x; in a round bore a line of nodes is at that of the first row");
  d.add("diameter", &OrificeRow::diameter, "m", deck::positive, "diameter").required().continuable();
  d.add("supply", &OrificeRow::supply, "Pa", deck::positive, "pressure of the supply, absolute")
      .required()
      .continuable();
  d.add("law", &OrificeRow::law, "how much flows", "Skarolek 2011 eqs. 3.7-3.13, after Belforte et al. 2007");
  d.add("pocket", &OrificeRow::pocket, "round recess of the bore around each orifice", "Skarolek 2011 fig. 3.4");
  d.check([](const OrificeRow& o, const deck::Report& r) {
    if (o.pocket && !(o.pocket->diameter > o.diameter))
      r.fail("pocket.diameter", "a pocket must be wider than its orifice");
    if (o.law == OrificeRow::Law::two_restrictors && !o.pocket)
      r.fail("law", "'two_restrictors' are an orifice and the rim of its pocket: give 'pocket'");
    if (o.law == OrificeRow::Law::curtain && o.pocket)
      r.fail("law", "'curtain' is that of an orifice without pocket: 'two_restrictors' has the one at a pocket's rim");
  });
}

void describe(deck::Description<Gas>& d) {
  d.add("states", &Gas::states,
        "dynamic: the pressure is a state, and damping falls with the frequency; condensed: it is at every moment that "
        "of the motion at that moment, and its damping that of a pressure that stands still");
  d.add("source", &Gas::source, "what the orifices see of the pressure", "003 errata sec. 2");
  d.add("slip", &Gas::slip, "rarefaction; Kn = mu sqrt(pi r T/2)/(p h)", "Skarolek 2011 sec. 1.3.1");
  d.add("cells", &Gas::cells, deck::in(4, 4000), "intervals around and along the bearing");
  d.add("tilt", &Gas::tilt, "follow the slope of the journal, and turn it by moments");
  d.add("ambient", &Gas::ambient, "Pa", deck::positive, "pressure at both ends, absolute").continuable();
  d.add("temperature", &Gas::temperature, "K", deck::positive, "of the film and of the supply").continuable();
  d.add("gas_constant", &Gas::gas_constant, "J/(kg K)", deck::positive, "specific gas constant");
  d.add("heat_ratio", &Gas::heat_ratio, deck::Check{.min = 1, .max = 2, .min_open = true}, "ratio of specific heats");
  d.add("orifices", &Gas::orifices,
        "rows of orifices, anywhere; without any the bearing is self-acting. The dip of the pressure in the jet behind "
        "an "
        "orifice without pocket is not modelled",
        "Skarolek 2011 eqs. 3.4-3.13");
  d.add("lobes", &Gas::lobes, "arcs of a larger radius in place of the circle of a cylindrical bore");
  d.add("grooves", &Gas::grooves,
        "axial grooves, full of gas of a pressure; a pressure of zero, or none, is that of the ends");
  d.check([](const Gas& o, const deck::Report& r) {
    if (o.source == Gas::Source::node && std::ranges::any_of(o.orifices, has_pocket))
      r.fail("source", "a pocket has the pressure along its rim, not that of a node: leave 'source: node' out");
  });
}

void refine(Gas& options, const std::array<double, 2>& factor) {
  for (std::size_t d = 0; d < 2; ++d) options.cells[d] = refined(options.cells[d], factor[d], false);
}

namespace {

// A pocket so deep that the law does not count all that holds back there.
Misplaced too_deep(const OrificeRow& r, const std::string& path, double clearance) {
  using enum OrificeRow::Law;
  if (!r.pocket || r.law == two_restrictors) return {};
  const double depth = (clearance + r.pocket->depth) / r.diameter;
  if (depth >= 0.2)
    return {path + ".law", fmt::format("(clearance + depth)/diameter is {:.3g}: from 0.2 on the rim of a pocket holds "
                                       "back too, which 'two_restrictors' counts (Skarolek 2011, eq. 3.9)",
                                       depth)};
  if (depth >= 0.1 && r.law == thickness)
    return {path + ".law",
            fmt::format("(clearance + depth)/diameter is {:.3g}: from 0.1 on the coefficient of a pocket "
                        "falls with the Reynolds number, as 'reynolds' says (Skarolek 2011, eq. 3.9)",
                        depth)};
  return {};
}

// The row up to `row` with an orifice in the cells about one of that row.
std::optional<std::size_t> crowded(const Gas& o, std::size_t row, const Geometry& g) {
  const double around = 2 * std::numbers::pi / o.cells[0], along = g.length / o.cells[1];
  const OrificeRow& r = o.orifices[row];
  for (std::size_t k = 0; k <= row; ++k) {
    const OrificeRow& other = o.orifices[k];
    if (!in_one_cell(r.z - other.z, along)) continue;
    for (int m = 0; m < r.count; ++m)
      for (int n = 0; n < (k == row ? m : other.count); ++n) {
        const double apart =
            r.angle + 2 * std::numbers::pi * m / r.count - (other.angle + 2 * std::numbers::pi * n / other.count);
        if (in_one_cell(std::remainder(apart, 2 * std::numbers::pi), around)) return k;
      }
  }
  return std::nullopt;
}

// What coarser meshes move to the next line of nodes, those of error bars too, the mesh of a deck does not.
Misplaced misplaced(const Gas& o, const Geometry& geometry) {
  if (Misplaced m = misplaced_orifice(o, geometry); !m.option.empty()) return m;
  const double cell = geometry.length / o.cells[1];
  for (std::size_t k = 0; k < o.orifices.size(); ++k) {
    const OrificeRow& r = o.orifices[k];
    const std::string path = "orifices." + std::to_string(k + 1);
    if (Misplaced m = too_deep(r, path, geometry.clearance); !m.option.empty()) return m;
    if (const auto other = crowded(o, k, geometry))
      return {path + (r.count > 1 && *other == k ? ".count" : ".z"),
              fmt::format("two orifices, of rows {} and {}, lie in one cell of a mesh of {} x {} 'cells': give it more "
                          "cells around or along the film",
                          *other + 1, k + 1, o.cells[0], o.cells[1])};
    const double rim = r.pocket ? 0.5 * r.pocket->diameter : 0.0;
    if (std::abs(r.z) + rim > 0.5 * geometry.length - cell * (1 - 1e-9))
      return {path + ".z", fmt::format("the {} lie less than a cell from an end, where there are no nodes to feed: "
                                       "'cells' are {:.3g} mm long along the bearing",
                                       r.pocket ? "pockets" : "orifices", 1e3 * cell)};
  }
  return {};
}

}  // namespace

Facts facts_of(const Gas& o, const Geometry& geometry) {
  Facts f;
  f.tilts = o.tilt;
  f.cells = o.cells;
  f.own_states = o.states == States::dynamic;
  if (f.own_states) f.states = o.cells[0] * (o.cells[1] - 1);
  if (!o.orifices.empty())
    f.smoothness = {1, "flow through orifices has kinks in its slope where it becomes choked or nearly stops"};
  if (geometry.radius > 0.0) {
    f.misplaced = misplaced(o, geometry);
    if (o.lobes && geometry.type != Geometry::Bore::cylindrical)
      f.misplaced = {"lobes", "lobes take the place of a circle: a cylindrical bore"};
  }
  return f;
}

std::unique_ptr<Film> make(const Geometry& geometry, const Gas& options, const Lubricant& lubricant) {
  auto film = std::make_unique<GasFilm>(geometry, options, lubricant);
  if (options.states == States::dynamic) return film;
  return condense(std::move(film));
}

}  // namespace whirl::film
