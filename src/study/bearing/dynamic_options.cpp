
#include <algorithm>

#include "study/bars/film_mesh.hpp"
#include "study/bearing/dynamic_coefficients.hpp"
#include "study/bearing/held_film.hpp"
#include "study/evenly.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/film/use/enforced.hpp"

namespace whirl::study {

std::span<const deck::Name<DynamicCoefficientsOptions::Method>> names(DynamicCoefficientsOptions::Method) {
  using enum DynamicCoefficientsOptions::Method;
  static constexpr deck::Name<DynamicCoefficientsOptions::Method> table[] = {
      {perturbation, "perturbation", "of infinitely small motions"},
      {enforced, "enforced",
       "beside it of the amplitudes given: forces of a harmonic motion, fitted by least squares"}};
  return table;
}

void describe(deck::Description<DynamicCoefficientsOptions>& d) {
  using O = DynamicCoefficientsOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("bearing", &O::bearing, "bearing to look at; the first of the deck if not given");
  d.add("speeds", &O::speeds, "rad/s", deck::positive, "shaft speeds, one after the other").required().alias("speed");
  describe_place(d);
  d.add("tilt", &O::tilt, "4 x 4 coefficients: slopes dx/dz, dy/dz and their moments beside x and y");
  d.add("frequencies", &O::frequencies, deck::positive, "frequencies omega/Omega, shown in the summary");
  d.add("frequency_range", &O::frequency_range, deck::positive,
        "lowest and highest of more frequencies omega/Omega, which only the tables and the pictures show");
  d.add("points", &O::points, deck::in(2, 1e6), "frequencies in that range, evenly spaced in their logarithm");
  d.add("method", &O::method, "how stiffness and damping are found", "003 sec. 3.4");
  d.add("amplitudes", &O::amplitudes, deck::between(0, 1),
        "0 to peak of the enforced motion along x and y, in clearances; slopes: the same over twice the length",
        "003 (3.40)");
  d.check([](const O& o, const deck::Report& r) {
    const bool enforced = o.method == O::Method::enforced;
    if (enforced && o.amplitudes.empty())
      r.fail("method", "'enforced' motions have amplitudes: give 'amplitudes: [0.05]', in clearances");
    if (!enforced && !o.amplitudes.empty())
      r.fail("amplitudes", "only enforced motions have amplitudes: add 'method: enforced' or leave them out");
    if (o.frequency_range && !((*o.frequency_range)[0] < (*o.frequency_range)[1]))
      r.fail("frequency_range", "'frequency_range' goes from the lowest to the highest frequency");
    check_place(o, r);
  });
}

std::vector<double> DynamicCoefficientsOptions::all_frequencies() const {
  std::vector<double> out = frequencies;
  if (!frequency_range) return out;
  const std::vector<double> more = by_ratios((*frequency_range)[0], (*frequency_range)[1], points);
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

double DynamicCoefficients::memory(const system::Machine& machine, const LayoutOptions& layout) const {
  const double table = 600.0 * static_cast<double>(options.all_frequencies().size() * options.speeds.size() *
                                                   (1 + options.amplitudes.size()));
  const auto found =
      options.bearing.empty() ? std::optional<std::size_t>(0) : system::find_bearing(machine, options.bearing);
  if (!found || *found >= machine.bearings.size()) return table;
  const system::Bearing& b = machine.bearings[*found];
  const auto states_of = [&](const film::Options& film) {
    return static_cast<double>(film::facts(film, b.geometry.value_or(film::Geometry{})).states);
  };
  double states = states_of(b.film);  // of the finest mesh, which error bars need
  for (const FilmMesh& mesh : film_meshes(machine, layout))
    states = std::max(states, states_of(film::refined(b.film, mesh.factor)));
  return table + 5000 * states + (options.amplitudes.empty() ? 0 : film::Enforced::memory(states));
}

void DynamicCoefficients::validate(const system::Machine& machine, const deck::Report& report) const {
  const auto found = bearing_to_look_at(machine, options.bearing, report);
  if (options.speeds.empty()) report.fail("speeds", "the list is empty");
  if (options.frequencies.empty()) report.fail("frequencies", "the list is empty");
  if (!found) return;
  const film::Options& film = machine.bearings[*found].film;
  if (film::facts(film).coefficients)
    report.fail(options.bearing.empty() ? "" : "bearing", "the coefficients of a linear film are those of its deck");
  else if (options.tilt && !film::tilting(film))
    report.fail("tilt", "a film of this kind does not follow the tilt of its journal: leave 'tilt' out");
}

}  // namespace whirl::study
