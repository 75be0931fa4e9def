#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "study/bars/beyond.hpp"
#include "study/bars/branch_brief.hpp"
#include "study/locus/locus.hpp"

namespace whirl::study {
namespace {

using LocusWord = std::pair<std::string_view, const char*>;

constexpr std::array<LocusWord, 5> words_of_curves{{{"fold", "limit points (folds)"},
                                                    {"hopf", "Hopf points"},
                                                    {"cyclic_fold", "limit points of cycles (folds)"},
                                                    {"flip", "flips (period doublings)"},
                                                    {"neimark_sacker", "Neimark-Sacker points"}}};
constexpr std::array<LocusWord, 13> words_of_points{
    {{"meeting", "two of them meet: the curve turns in {1}"},
     {"meeting_over_second", "the curve turns in {0}"},
     {"resonance_1_1", "resonance 1:1"},
     {"resonance_1_2", "resonance 1:2"},
     {"resonance_1_3", "resonance 1:3"},
     {"resonance_1_4", "resonance 1:4"},
     {"cusp", "cusp of two folds"},
     {"bogdanov_takens", "Bogdanov-Takens point"},
     {"generalised_hopf", "generalised Hopf point: super- to subcritical"},
     {"generalised_flip", "generalised flip: super- to subcritical"},
     {"fold_flip", "fold and flip"},
     {"fold_hopf", "fold and Hopf point"},
     {"fold_neimark_sacker", "fold and Neimark-Sacker point"}}};

template <std::size_t N>
std::string in_words_of(const std::array<LocusWord, N>& names, const std::string& key) {
  const auto at = std::ranges::find(names, key, [](const LocusWord& n) { return n.first; });
  return at == names.end() ? key : at->second;
}

// Columns of the curve by name.
struct LocusColumns {
  explicit LocusColumns(const io::StudySummary& s) : summary(s) {}
  [[nodiscard]] const io::Column* column(const char* name) const {
    const auto at = std::ranges::find(summary.curve, name, &io::Column::name);
    return at == summary.curve.end() ? nullptr : &*at;
  }
  [[nodiscard]] io::Quantity at(const char* name, std::size_t k) const {
    const io::Column* values = column(name);
    const io::Column* bars = column((std::string(name) + "_uncertainty").c_str());
    if (!values || k >= values->values.size()) return {};
    io::Quantity q{values->values[k], values->unit};
    if (bars && std::isfinite(bars->values[k])) q.more["uncertainty"] = bars->values[k];
    return q;
  }
  const io::StudySummary& summary;
};

}  // namespace

io::Brief Locus::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const LocusColumns curve(result.summary);
  const io::Column *first = curve.column("parameter"), *others = curve.column("others_unstable");
  const io::Column* over = curve.column("second");
  if (!first || !over || first->values.empty()) return {};
  const io::Group& group = result.group;
  const std::string one = parameter_word(group.text("parameter")), two = parameter_word(options.second.path);
  const auto [low, high] = std::ranges::minmax_element(first->values);
  const auto [least, most] = std::ranges::minmax_element(over->values);
  const bool limit = options.limit.has_value();
  const std::string what =
      limit
          ? fmt::format("The {} is {} along a curve from '{}', which", words_of(*options.limit),
                        io::reading({group.real("limit_value"), group.text("limit_unit")}), options.of)
          : fmt::format("The curve of {} of '{}'", in_words_of(words_of_curves, group.text("bifurcation")), options.of);
  io::Brief brief;
  brief.sentences.push_back(fmt::format("{} runs over {} {} and {} {}.", what, one, from_to(*low, *high, first->unit),
                                        two, from_to(*least, *most, over->unit)));
  const auto start = static_cast<std::size_t>(group.integer("start"));
  if (others && others->values[start] == 0 && group.has_attribute("stable_side"))
    brief.sentences.push_back(fmt::format("Where it was begun, the motion is stable on the side of the {} {}.",
                                          group.text("stable_side") == "below" ? "lower" : "higher", one));
  if (limit)
    brief.sentences.push_back(fmt::format("Where it was begun, the {} is larger at {} {}.", words_of(*options.limit),
                                          group.text("larger_side") == "below" ? "lower" : "higher", one));
  io::BriefTable table{
      "Ends and extremes of the curve", {{"where"}, {one, first->unit}, {two, over->unit}, {"beside"}}, {}, {}};
  const auto row = [](const auto& values, const auto& at) { return static_cast<std::size_t>(at - values.begin()); };
  std::vector<std::pair<std::size_t, std::string>> shown;
  const auto add = [&](std::size_t k, const std::string& where) {
    const auto known = std::ranges::find(shown, k, [](const auto& s) { return s.first; });
    if (known == shown.end())
      shown.emplace_back(k, where);
    else
      known->second += ", " + where;
  };
  add(0, "one end");
  add(row(first->values, low), "lowest " + one);
  add(row(first->values, high), "highest " + one);
  add(row(over->values, least), "lowest " + two);
  add(row(over->values, most), "highest " + two);
  add(first->values.size() - 1, "other end");
  for (const auto& [k, where] : shown)
    table.rows.push_back({where, curve.at("parameter", k), curve.at("second", k),
                          !others || others->values[k] == 0 ? ""
                          : limit                           ? "the cycle is unstable"
                                                            : "something else is unstable"});
  io::BriefTable special{"Special points of the curve",
                         {{"what"}, {one, first->unit}, {two, over->unit}, {"curve"}},
                         {},
                         "bar: of one parameter with the other one fixed, from other meshes"};
  for (const io::CodimensionTwo& c : result.summary.codimension_two) {
    io::Quantity here = c.value, there = c.second_value;
    if (const auto bar = c.more.find("value_uncertainty"); bar != c.more.end()) here.more["uncertainty"] = bar->second;
    if (std::isfinite(c.uncertainty)) there.more["uncertainty"] = c.uncertainty;
    special.rows.push_back({fmt::format(fmt::runtime(in_words_of(words_of_points, c.type)), one, two), here, there,
                            c.more.contains("end_of_curve") ? "ends here" : ""});
  }
  brief.tables = {std::move(special), std::move(table), table_of_suspicions(result.summary)};
  return brief;
}

}  // namespace whirl::study
