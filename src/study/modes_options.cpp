#include "whirl/study/modes.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace whirl::study {

std::span<const deck::Name<ModesOptions::Supports>> names(ModesOptions::Supports) {
  using enum ModesOptions::Supports;
  static constexpr deck::Name<ModesOptions::Supports> table[] = {{films, "films", "linearised films and pedestals"},
                                                                 {pinned, "pinned", "journals held, slopes free"},
                                                                 {free, "free", "no bearings"}};
  return table;
}

void describe(deck::Description<ModesOptions>& d) {
  d.add("name", &ModesOptions::name, "name in the results; the kind if not given");
  d.add("supports", &ModesOptions::supports, "what holds the journals");
  d.add("range", &ModesOptions::range, "rad/s", deck::non_negative, "range of speeds; results carry its unit");
  d.add("points", &ModesOptions::points, deck::at_least(2), "speeds in the range, evenly spaced with both ends");
  d.add("speeds", &ModesOptions::speeds, "rad/s", deck::non_negative, "single speeds instead of a range");
  d.add("count", &ModesOptions::count, deck::positive, "modes at each speed, those of lowest frequency");
  d.add("max_frequency", &ModesOptions::max_frequency, "rad/s", deck::positive,
        "whirl frequency up to which modes are reported");
  d.add("shapes_at", &ModesOptions::shapes_at, "rad/s", deck::positive,
        "speeds at which mode shapes are kept and drawn; the last of the speeds if not given");
  d.check([](const ModesOptions& o, const deck::Report& r) {
    if (o.range && !o.speeds.empty()) r.fail("speeds", "give either 'range' or 'speeds', not both");
    // Without films the shaft is taken at rest, whatever its speed.
    if (o.supports != ModesOptions::Supports::films) return;
    if (!o.range && o.speeds.empty()) r.fail("", "'range' is missing (of speeds), or a list 'speeds'");
  });
}

std::vector<double> ModesOptions::all_speeds() const {
  std::vector<double> s;
  for (const deck::Quantity& q : speeds) s.push_back(q.value);
  if (range)
    for (int i = 0; i < points; ++i) s.push_back(range->from + (range->to - range->from) * i / (points - 1));
  return s;
}

std::vector<double> ModesOptions::all_shape_speeds() const {
  std::vector<double> s;
  for (const deck::Quantity& q : shapes_at) s.push_back(q.value);
  if (s.empty()) s.push_back(all_speeds().back());
  return s;
}

std::string ModesOptions::unit() const {
  return range ? range->unit : speeds.empty() ? "rad/s" : speeds.front().unit;
}

void Modes::validate(const system::Machine& machine, const deck::Report& report) const {
  if (options.supports != ModesOptions::Supports::films) return;
  const std::vector<double> speeds = options.all_speeds();
  if (std::none_of(speeds.begin(), speeds.end(), [](double s) { return s <= 0; })) return;
  for (const system::Bearing& b : machine.bearings)
    if (b.film.kind != film::Options::Kind::linear)
      return report.fail(options.range ? "range" : "speeds",
                         fmt::format("the film of bearing {} carries no load at rest: speeds must be positive (linear "
                                     "films have coefficients at rest, too)",
                                     b.name));
}

}  // namespace whirl::study
