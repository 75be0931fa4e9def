#include "whirl/study/linear/critical_speed_map.hpp"

#include <fmt/core.h>

#include <cmath>
#include <map>

#include "study/common.hpp"
#include "whirl/core/agree.hpp"
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

StudyResult CriticalSpeedMap::run(Context& context) {
  const system::Train train = system::train_of(context.machine);
  auto& results = context.results;
  std::vector<rotor::SpringAt> springs;
  std::vector<rotor::Stand> stands;
  std::map<std::string, int> stand_of;  // by bearing
  for (const system::Support& s : train.supports) {
    springs.push_back({s.node, s.has_pedestal ? static_cast<int>(stands.size()) : -1});
    stand_of[s.name] = springs.back().stand;
    if (s.has_pedestal) stands.push_back({s.mass, s.stiffness});
  }
  for (const system::Element& e : train.elements)
    if (system::holds_shaft(e)) springs.push_back({e.node, e.to_pedestal ? stand_of.at(*e.to_pedestal) : -1});
  const auto count = static_cast<std::size_t>(options.count), points = static_cast<std::size_t>(options.points);
  std::vector<double> stiffness, speeds[2];
  core::agree(context.comm, [&] {
    for (std::size_t i = 0; i < points; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(points - 1);
      stiffness.push_back(options.stiffness.from * std::pow(options.stiffness.to / options.stiffness.from, part));
      for (const auto whirl : {rotor::Whirl::forward, rotor::Whirl::backward}) {
        std::vector<double> found =
            rotor::critical_speeds(train.rotor, springs, stiffness.back(), whirl, options.count, stands);
        found.resize(count, io::no_value);
        std::vector<double>& to = speeds[whirl == rotor::Whirl::forward ? 0 : 1];
        to.insert(to.end(), found.begin(), found.end());
      }
    }
  });
  auto& table = results.group().child("map");
  table.put("stiffness", stiffness, "N/m", "of each bearing, in x and y");
  const char* names[] = {"forward", "backward"};
  for (std::size_t w = 0; w < 2; ++w) {
    table.put(names[w], {points, count}, speeds[w], "rad/s",
              fmt::format("undamped critical speeds of {} whirl [stiffness][number]", names[w]));
    for (std::size_t k = 0; k < count; ++k)
      for (const auto& [end, at] : {std::pair{"softest", std::size_t{0}}, {"stiffest", points - 1}})
        if (!std::isnan(speeds[w][at * count + k]))
          results.summary().set(fmt::format("{}.{}.{}", end, names[w], k + 1), speeds[w][at * count + k], "rad/s");
  }
  table.label_each({io::numbered(count, "critical")});
  results.summary().points = static_cast<long>(points);
  return results.finish("completed", true);
}

}  // namespace whirl::study
