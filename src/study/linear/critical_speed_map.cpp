#include "study/linear/critical_speed_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "study/bars/shaft_mesh.hpp"
#include "study/common.hpp"
#include "study/evenly.hpp"
#include "study/linear/linear_brief.hpp"
#include "study/linear/mode_bars.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/rotor/critical_speeds.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::study {

void describe(deck::Description<CriticalSpeedMapOptions>& d) {
  using O = CriticalSpeedMapOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add(
       "stiffness", &O::stiffness, "N/m", deck::positive,
       "range of the stiffness of each bearing and of each element that is a support, equal in x and y; other elements "
       "are left out")
      .required();
  d.add("points", &O::points, deck::in(2, 1e6), "values in the range, evenly spaced in the logarithm");
  d.add("count", &O::count, deck::in(1, 1000), "critical speeds of forward and of backward whirl, the lowest ones");
}

void CriticalSpeedMap::validate(const system::Machine& machine, const deck::Report& report) const {
  if (machine.rotor.type == rotor::Options::Type::rigid)
    report.fail("", "a rigid rotor has no critical speeds but those of its bearings: give 'rotor' segments");
  if (system::support_nodes(machine).size() < 2) report.fail("", "a shaft on springs needs two bearings");
  check_held(machine, report);
  if (!(options.stiffness.from < options.stiffness.to))
    report.fail("stiffness", "the range rises: give the smaller stiffness as 'from'");
}

double CriticalSpeedMap::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  const double n = 2.0 * static_cast<double>(machine.rotor.segments.size() + 1);
  return 8 * 6 * n * n;
}

namespace {

constexpr std::array whirl_directions{rotor::Whirl::forward, rotor::Whirl::backward};
constexpr std::array whirl_names{"forward", "backward"};

// What the shaft of a train stands on.
struct Springs {
  std::vector<rotor::SpringAt> at;
  std::vector<rotor::Stand> stands;
};

Springs springs_of(const system::Train& train) {
  Springs out;
  std::map<std::string, int> stand_of;  // by bearing
  for (const system::Support& s : train.supports) {
    out.at.push_back({s.node, s.has_pedestal ? static_cast<int>(out.stands.size()) : -1});
    stand_of[s.name] = out.at.back().stand;
    if (s.has_pedestal) out.stands.push_back({s.mass, s.stiffness});
  }
  for (const system::Element& e : train.elements)
    if (system::holds_shaft(e)) out.at.push_back({e.node, e.to_pedestal ? stand_of.at(*e.to_pedestal) : -1});
  return out;
}

// The larger one of the bars of the neighbours, which stand at the rising places `known` among all of them.
double bar_between(const std::vector<std::size_t>& known, const std::vector<std::vector<double>>& bars, std::size_t i,
                   std::size_t k) {
  const auto right = std::ranges::lower_bound(known, i);
  const auto left = *right == i ? right : std::prev(right);
  const double a = bars[static_cast<std::size_t>(left - known.begin())][k],
               b = bars[static_cast<std::size_t>(right - known.begin())][k];
  return std::isnan(a) || std::isnan(b) ? unknown : std::max(a, b);
}

// "the lowest critical speed of forward whirl rises from 120.3 rpm at 1 kN/m to 4567 rpm at 10 GN/m", and how steeply
// at both ends.
std::string course(const std::vector<double>& stiffness, const std::vector<double>& speeds, std::size_t count,
                   const char* whirl) {
  const std::size_t last = stiffness.size() - 1;
  const auto speed = [&](std::size_t i) { return speeds[i * count]; };
  if (!std::isfinite(speed(0)) || !std::isfinite(speed(last))) return {};
  const auto shown = [&](std::size_t i) {
    return fmt::format("{} rpm at {}", io::reading(deck::from_si(speed(i), "rpm")), io::reading({stiffness[i], "N/m"}));
  };
  const auto power = [&](std::size_t i) {
    return std::log(speed(i + 1) / speed(i)) / std::log(stiffness[i + 1] / stiffness[i]);
  };
  const double soft = power(0), stiff = power(last - 1);
  std::string text = fmt::format("the lowest critical speed of {} whirl: {}, {}", whirl, shown(0), shown(last));
  if (std::isfinite(soft) && std::isfinite(stiff))
    text += fmt::format(
        "; it rises with the power {:.2f} of the stiffness at the soft end and {:.2f} at the stiff end (0.5: a rigid "
        "rotor on springs; 0: the springs no longer matter)",
        soft, std::abs(stiff));
  return text;
}

}  // namespace

StudyResult CriticalSpeedMap::run(Context& context) {
  const system::Train train = system::train_of(context.machine);
  auto& results = context.results;
  const auto count = static_cast<std::size_t>(options.count), points = static_cast<std::size_t>(options.points);
  const auto speeds_of = [&](const system::Train& of, double stiffness, rotor::Whirl whirl) {
    const Springs springs = springs_of(of);
    return rotor::critical_speeds(of.rotor, springs.at, stiffness, whirl, options.count, springs.stands);
  };
  const bool barred = has_shaft_mesh(context.machine, context.layout);
  const std::vector<std::size_t> few = few_of(points, most_with_bars);
  const std::vector<double> stiffness = by_ratios(options.stiffness.from, options.stiffness.to, options.points);
  std::vector<double> speeds[2], bars[2];
  double largest = 0;
  core::agree(context.comm, [&] {
    for (std::size_t w = 0; w < 2; ++w) {
      std::vector<std::vector<double>> known;  // bars at few of them
      for (std::size_t i = 0; i < points; ++i) {
        std::vector<double> found = speeds_of(train, stiffness[i], whirl_directions[w]);
        if (barred && known.size() < few.size() && few[known.size()] == i) {
          known.push_back(bars_of_shaft(found, train.rotor, order_of_shaft(train.rotor.element), [&](int parts) {
            return speeds_of(with_cut_shaft(train, parts), stiffness[i], whirl_directions[w]);
          }));
          largest = std::max(largest, largest_part(known.back(), found));
          known.back().resize(count, unknown);
        }
        found.resize(count, io::no_value);
        speeds[w].insert(speeds[w].end(), found.begin(), found.end());
      }
      for (std::size_t i = 0; barred && i < points; ++i)
        for (std::size_t k = 0; k < count; ++k) bars[w].push_back(bar_between(few, known, i, k));
    }
  });
  auto& table = results.group().child("map");
  table.put("stiffness", stiffness, "N/m", "of each bearing, in x and y");
  for (std::size_t w = 0; w < 2; ++w) {
    table.put(whirl_names[w], {points, count}, speeds[w], "rad/s",
              fmt::format("undamped critical speeds of {} whirl [stiffness][number]", whirl_names[w]));
    if (barred)
      table.put(fmt::format("{}_uncertainty", whirl_names[w]), {points, count}, bars[w], "rad/s",
                "estimated error from the mesh of the shaft");
    for (std::size_t k = 0; k < count; ++k)
      for (const auto& [end, at] : {std::pair{"softest", std::size_t{0}}, {"stiffest", points - 1}})
        if (const std::size_t place = at * count + k; !std::isnan(speeds[w][place]))
          results.summary().set(fmt::format("{}.{}.{}", end, whirl_names[w], k + 1), speeds[w][place], "rad/s",
                                barred ? std::map<std::string, double>{{"uncertainty", bars[w][place]}}
                                       : std::map<std::string, double>{});
  }
  put_shaft_error(results.summary(), train.rotor, largest);
  table.label_each({io::numbered(count, "critical")});
  results.summary().points = static_cast<long>(points);
  return results.finish("completed", true);
}

io::Brief CriticalSpeedMap::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  if (!result.delivered || !result.group.has_group("map")) return {};
  const io::Group& map = result.group.group("map");
  const std::vector<double>& stiffness = map.reals("stiffness");
  const auto count = static_cast<std::size_t>(options.count);
  constexpr std::size_t most_shown = 8;
  io::Brief out;
  for (const char* whirl : whirl_names) {
    const std::vector<double>& speeds = map.reals(whirl);
    const std::string bars = fmt::format("{}_uncertainty", whirl);
    io::BriefTable table{fmt::format("Undamped critical speeds of {} whirl", whirl),
                         {{"stiffness"}},
                         {},
                         "equal springs in x and y at all supports, on their pedestals; no damping, no films"};
    for (std::size_t k = 0; k < count; ++k) table.columns.push_back({fmt::format("no. {}", k + 1), "rpm"});
    for (const std::size_t i : few_of(stiffness.size(), most_shown)) {
      auto& row = table.rows.emplace_back();
      row.emplace_back(to_digits({stiffness[i], "N/m"}, 4));
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t at = i * count + k;
        io::Quantity q{speeds[at], "rad/s"};
        if (map.has_dataset(bars)) q.more["uncertainty"] = map.reals(bars)[at];
        row.emplace_back(scaled(q, deck::from_si(1, "rpm"), "rpm"));
      }
    }
    out.sentences.push_back(course(stiffness, speeds, count, whirl));
    out.tables.push_back(std::move(table));
  }
  if (!out.sentences.front().empty()) out.sentences.resize(1);
  return out;
}

}  // namespace whirl::study
