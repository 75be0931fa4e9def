#include <fmt/core.h>

#include <algorithm>

#include "study/cycle/cycle_branch.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "study/locus/locus.hpp"

namespace whirl::study {

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
