#include <fmt/core.h>

#include <algorithm>

#include "study/cycle/cycle_branch.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "study/locus/locus.hpp"

namespace whirl::study {

std::span<const deck::Name<LimitOptions::Quantity>> names(LimitOptions::Quantity) {
  using enum LimitOptions::Quantity;
  static constexpr deck::Name<LimitOptions::Quantity> table[] = {
      {amplitude, "amplitude", "half of the travel of a place in a direction (0-peak)"},
      {peak_to_peak, "peak_to_peak", "its whole travel"},
      {eccentricity, "eccentricity", "largest eccentricity of a journal, in clearances"},
      {period, "period", "period of a self-excited cycle"},
      {whirl_ratio, "whirl_ratio", "frequency of a self-excited cycle over that of the shaft"}};
  return table;
}

std::span<const deck::Name<LimitOptions::Direction>> names(LimitOptions::Direction) {
  using enum LimitOptions::Direction;
  static constexpr deck::Name<LimitOptions::Direction> table[] = {{x, "x", "horizontal"}, {y, "y", "vertical"}};
  return table;
}

void describe(deck::Description<LimitOptions>& d) {
  using L = LimitOptions;
  using enum LimitOptions::Quantity;
  d.add("quantity", &L::quantity, "what has the same value all along the curve");
  d.add("bearing", &L::bearing, "bearing whose journal moves")
      .only(&L::quantity, {amplitude, peak_to_peak, eccentricity});
  d.add("node", &L::node, deck::at_least(1), "instead: node of the shaft that moves in space")
      .only(&L::quantity, {amplitude, peak_to_peak});
  d.add("direction", &L::direction, "along which it moves").only(&L::quantity, {amplitude, peak_to_peak});
  d.add("value", &L::value, "*", deck::positive, "the value: of amplitudes a length, of a period a time").required();
  d.add("passing", &L::passing, deck::positive,
        "where the curve begins: 1 is the first point along the branch at which the quantity passes the value");
  d.check([](const L& o, const deck::Report& r) {
    const bool length = o.quantity == amplitude || o.quantity == peak_to_peak;
    const char* unit = length ? "m" : o.quantity == period ? "s" : "1";
    if (!deck::same_kind(o.value.unit, unit))
      r.fail("value", fmt::format("the {} is not measured in '{}'", words_of(o), o.value.unit));
    if (o.bearing && o.node) r.fail("node", "either the journal of a 'bearing' or a 'node' moves");
    if (has_place(o) && !o.bearing && !o.node)
      r.fail("", length ? "'bearing' or 'node' is missing" : "'bearing' is missing");
  });
}

void check_limit(const LimitOptions& limit, const system::Machine& machine, const deck::Report& report) {
  if (limit.node) check_nodes("limit.node", {*limit.node}, machine, report);
  if (!limit.bearing) return;
  const auto found = system::find_bearing(machine, *limit.bearing);
  if (!found)
    report.fail("limit.bearing",
                fmt::format("there is no bearing '{}'{}", *limit.bearing,
                            deck::did_you_mean_one_of(*limit.bearing, system::bearing_names(machine))));
  else if (limit.quantity == LimitOptions::Quantity::eccentricity && !machine.bearings[*found].geometry)
    report.fail("limit.bearing", fmt::format("bearing '{}' has no clearance to measure in", *limit.bearing));
}

void describe(deck::Description<LocusOptions>& d) {
  using O = LocusOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add(
       "of", &O::of,
       "name of an earlier cycle_branch or equilibrium_branch, one of whose bifurcations is followed; 'NAME flip 1' is "
       "the branch of twice the period born at the first flip of a branch NAME with follow_flips")
      .required();
  d.add(
      "bifurcation", &O::bifurcation, deck::positive,
      "which one: 1 is the first that its summary lists. Marked along a curve of folds: cusp, of cyclic folds "
      "fold_flip and resonance_1_1, too; of flips: generalised_flip (from supercritical to subcritical), "
      "resonance_1_2, "
      "fold_flip; of Neimark-Sacker points: resonance_1_1, 1_2, 1_3, 1_4, fold_neimark_sacker; of Hopf points: "
      "generalised_hopf, bogdanov_takens, fold_hopf; of all: meeting and meeting_over_second, where the curve turns in "
      "the second and in the first parameter. resonance_1_1 and generalised_flip are those of forced cycles");
  d.add(
      "limit", &O::limit,
      "instead of a bifurcation: follow cycles with this amplitude or period, from where a cycle_branch passes it; of "
      "folds of the curve, meeting and meeting_over_second are marked");
  d.embed(&O::second);
  d.add("first_range", &O::first_range, "*", deck::any,
        "values of the branch's own parameter at which the curve ends; the range of the branch if not given");
  d.add("max_points", &O::max_points, deck::positive,
        "points in each direction after which the curve ends, without those that `picture_tolerance` adds");
  d.add("picture_tolerance", &O::picture_tolerance, deck::in(0, 1), text_of_picture_tolerance);
}

void Locus::validate(const system::Machine& machine, const deck::Report& report) const {
  if (options.second.path == "speed")
    return report.fail("parameter", "the second parameter is another option than the speed: let the branch vary that");
  if (options.second.deflation) report.fail("deflation", "a curve of bifurcations begins at one that was found");
  check_parameter(options.second, deck::Quantity{1, "rad/s"}, machine, report);
  if (options.limit) check_limit(*options.limit, machine, report);
  if (options.limit && options.bifurcation != 1)
    report.fail("bifurcation", "a 'limit' begins where the branch passes it: 'passing' says which time");
  try {
    const double value = value_of(machine, options.second.path);
    const deck::Range& range = options.second.range;
    if (value < std::min(range.from, range.to) || value > std::max(range.from, range.to))
      report.fail("range",
                  fmt::format("the curve begins at the deck's own value of '{}', {:.6g} in SI units, which lies "
                              "outside the range",
                              options.second.path, value));
  } catch (const core::InputError&) {
    // check_parameter has said it
  }
}

void Locus::validate_among(std::span<const std::unique_ptr<Study>> before, const deck::Report& report) const {
  std::vector<std::string> names;
  for (const auto& s : before) {
    const Parameter* first = nullptr;
    const bool called = s->name() == options.of || branch_called(*s, options.of);
    if (const auto* cycles = dynamic_cast<const CycleBranch*>(s.get()); cycles) first = &cycles->given().parameter;
    if (const auto* rest = dynamic_cast<const EquilibriumBranch*>(s.get()); rest) first = &rest->given().parameter;
    if (!first) continue;
    names.push_back(s->name());
    if (!called) continue;
    const auto cycles = branch_called(*s, options.of);
    if (cycles && cycles->method != CycleBranchOptions::Method::collocation)
      report.fail("of", fmt::format("curves go by collocation: give '{}' no other 'method'", options.of));
    if (options.limit && !cycles)
      report.fail("limit",
                  fmt::format("'{}' is a branch of equilibria, which have no amplitude and no period", options.of));
    else if (options.limit && !has_place(*options.limit) && cycles->origin != CycleBranchOptions::Origin::hopf)
      report.fail("limit.quantity",
                  "the period of forced cycles is that of the shaft: 'origin: hopf' has cycles with their own");
    if (first->path == options.second.path)
      report.fail("parameter", fmt::format("'{}' is the first parameter already", first->path));
    if (options.first_range && !deck::same_kind(options.first_range->unit, first->range.unit))
      report.fail("first_range", fmt::format("'first_range' has another unit than the range of '{}' ({})", options.of,
                                             first->range.unit));
    return;
  }
  report.fail("of", fmt::format("there is no cycle_branch or equilibrium_branch '{}' before this study{}", options.of,
                                deck::did_you_mean(options.of, names)));
}

}  // namespace whirl::study
