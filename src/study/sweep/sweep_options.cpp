#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "whirl/deck/raw.hpp"
#include "whirl/study/deck.hpp"
#include "whirl/study/sweep/sweep.hpp"

namespace whirl::study {

void describe(deck::Description<SweepOptions>& d) {
  using O = SweepOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("of", &O::of,
        "names of earlier studies of the deck, which are repeated for each variant; all studies before this one if not "
        "given. What they start from is repeated with them");
  d.add("variants", &O::variants,
        "a map NAME: {PATH: VALUE, ...} of variants, each of which changes all its quantities at once. PATH and VALUE "
        "are those of --set: wildcards bearings.{B2,B3}.geometry.clearance, factors x1.2 or -20 %, changes by +500 um, "
        "names of tables. `at: NUMBER` among them places the variant on the axis of trends; if not given, that is its "
        "first quantity that changes as a number");
  d.add("grid", &O::grid,
        "a map PATH: VALUES of quantities of which every combination is a variant; VALUES is a list or {from, to, "
        "points, spacing: linear or log}, whose ends may be factors or changes. Together with `variants`: each of them "
        "at every point of the grid");
  d.add("at", &O::at, deck::any,
        "place of the deck as it stands on the axis of trends, beside the `at` of the variants");
  d.add("as_given", &O::as_given,
        "also run the studies for the deck as it stands, as the first row of the table; if not, they are run for the "
        "variants only");
  d.add("ranks", &O::ranks, deck::positive, "ranks that share one variant; the variants are spread over the groups");
}

bool Sweep::repeats(const std::string& name) const {
  return options.of.empty() || std::find(options.of.begin(), options.of.end(), name) != options.of.end();
}

double Sweep::memory(const system::Machine& /*machine*/, const LayoutOptions& /*layout*/) const {
  // The deck and the summary of a variant; its results are left in its checkpoint. A thousand equilibria of a train of
  // 184 segments in five bearings took 480 MB, most of them for the text of all summaries at the end.
  constexpr double kept = 4e5;
  double dearest = 0;
  for (const Variant& v : variants_)
    for (const auto& s : v.deck->studies) dearest = std::max(dearest, s->memory(v.deck->machine, layout_of(*v.deck)));
  return dearest + kept * static_cast<double>(variants_.size());
}

void Sweep::validate(const system::Machine& /*machine*/, const deck::Report& report) const {
  if (options.variants.items.empty() && options.grid.items.empty())
    report.fail("", "a sweep needs `variants` or a `grid`");
}

void Sweep::validate_among(std::span<const std::unique_ptr<Study>> before, const deck::Report& report) const {
  std::vector<std::string> names;
  for (const auto& s : before)
    if (s->kind() != key) names.push_back(s->name());
  if (names.empty()) report.fail("", "there is no study before this one that it could repeat");
  for (std::size_t i = 0; i < options.of.size(); ++i)
    if (std::find(names.begin(), names.end(), options.of[i]) == names.end())
      report.fail(fmt::format("of.{}", i + 1), fmt::format("there is no study '{}' before this one{}", options.of[i],
                                                           deck::did_you_mean_one_of(options.of[i], names)));
}

}  // namespace whirl::study
