// What the deck says of a film of gas.
#include "whirl/film/gas.hpp"

#include "film/gas_film.hpp"
#include "film/refine.hpp"
#include "whirl/film/describe.hpp"

namespace whirl::film {

std::span<const deck::Name<Gas::Source>> names(Gas::Source) {
  static constexpr deck::Name<Gas::Source> table[] = {
      {Gas::Source::rim, "rim",
       "pressure at the rim of the orifice, by the field of a point source; the mesh does not show"},
      {Gas::Source::node, "node",
       "pressure of the node that the orifice feeds; load drifts with the mesh and never converges"}};
  return table;
}

void describe(deck::Description<OrificeRow>& d) {
  d.add("count", &OrificeRow::count, deck::in(1, 1000), "number of orifices, evenly spaced around the bore");
  d.add("z", &OrificeRow::z, "m", deck::any, "place along the shaft, from the mid-plane; moved to the nearest node");
  d.add("angle", &OrificeRow::angle, "rad", deck::any, "of the first one, from +x; a line of nodes is there");
  d.add("diameter", &OrificeRow::diameter, "m", deck::positive, "diameter").required();
  d.add("supply", &OrificeRow::supply, "Pa", deck::positive, "pressure of the supply, absolute").required();
}

void describe(deck::Description<Gas>& d) {
  d.add("states", &Gas::states,
        "dynamic: the pressure is a state, and damping falls with the frequency; condensed: it is at every moment that "
        "of "
        "the motion at that moment, and its damping that of a pressure that stands still");
  d.add("source", &Gas::source, "what the orifices see of the pressure", "003 errata sec. 2");
  d.add("cells", &Gas::cells, deck::in(4, 4000), "intervals around and along the bearing");
  d.add("tilt", &Gas::tilt, "follow the slope of the journal, and turn it by moments");
  d.add("ambient", &Gas::ambient, "Pa", deck::positive, "pressure at both ends, absolute");
  d.add("temperature", &Gas::temperature, "K", deck::positive, "of the film and of the supply");
  d.add("gas_constant", &Gas::gas_constant, "J/(kg K)", deck::positive, "specific gas constant");
  d.add("heat_ratio", &Gas::heat_ratio, deck::Check{.min = 1, .max = 2, .min_open = true}, "ratio of specific heats");
  d.add(
      "orifices", &Gas::orifices,
      "rows of simple orifices without pockets; without any the bearing is self-acting. The dip of the pressure in the "
      "jet behind an orifice is not modelled",
      "Skarolek 2011 eqs. 3.4-3.8");
}

void refine(Gas& options, const std::array<double, 2>& factor) {
  for (std::size_t d = 0; d < 2; ++d) options.cells[d] = refined(options.cells[d], factor[d], false);
}

Facts facts_of(const Gas& o, const Geometry& geometry) {
  Facts f;
  f.tilts = o.tilt;
  f.cells = o.cells;
  f.own_states = o.states == States::dynamic;
  if (f.own_states) f.states = o.cells[0] * (o.cells[1] - 1);
  if (!o.orifices.empty())
    f.smoothness = {1, "flow through orifices has kinks in its slope where it becomes choked or nearly stops"};
  if (geometry.type != Geometry::Bore::cylindrical && geometry.radius > 0.0)
    f.misplaced = {"type", "a film of gas stands in a whole circle: a cylindrical bore"};
  return f;
}

std::unique_ptr<Film> make(const Geometry& geometry, const Gas& options, const Lubricant& lubricant) {
  auto film = std::make_unique<GasFilm>(geometry, options, lubricant);
  if (options.states == States::dynamic) return film;
  return condense(std::move(film));
}

}  // namespace whirl::film
