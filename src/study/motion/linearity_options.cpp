#include <fmt/core.h>

#include "study/cost.hpp"
#include "study/motion/linearity.hpp"

namespace whirl::study {

void describe(deck::Description<LinearityOptions>& d) {
  using O = LinearityOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed").required().alias("speeds");
  d.add("bearing", &O::bearing, "bearing whose journal is excited and watched; the first one if no 'node' is given");
  d.add("node", &O::node, deck::at_least(1), "instead: node of the shaft that is excited and watched");
  d.add("levels", &O::levels, "N", deck::positive,
        "root mean square of each of two independent forces along x and y; a run for each level, rising", "003 3.5")
      .required();
  d.add("cutoff", &O::cutoff, "Hz", deck::positive,
        "frequency at which the low pass of the white noise halves its power", "003 fig. 3.47");
  d.add("oversampling", &O::oversampling, deck::in(3, 100),
        "samples per period of the cut-off frequency; each costs at least one step in time");
  d.add("seed", &O::seed, deck::in(0, 1e9), "which noise");
  d.add("settle", &O::settle, "s", deck::non_negative, "time before the record");
  d.add("duration", &O::duration, "s", deck::positive, "length of the record");
  d.add("segments", &O::segments, deck::in(4, 1e6), "segments of the record under Hann's window, which overlap by half",
        "003 (3.42) with the errata");
  d.add("highest", &O::highest, "Hz", deck::positive, "frequency up to which transfer functions are reported");
  d.add("probability", &O::probability, deck::between(0, 1), "with which each number lies within its bounds");
  d.add("tolerance", &O::tolerance, deck::in(1e-13, 1e-2),
        "error allowed to a step, in clearances; rounding lets none be smaller than the limit");
  d.add("checkpoint", &O::checkpoint, "write checkpoints to resume from");
  d.check([](const O& o, const deck::Report& r) {
    if (o.levels.empty()) r.fail("levels", "'levels' is empty");
    for (std::size_t k = 1; k < o.levels.size(); ++k)
      if (!(o.levels[k] > o.levels[k - 1])) return r.fail("levels", "'levels' must rise");
    if (o.bearing && o.node) r.fail("node", "either a 'bearing' or a 'node' is excited");
    if (o.highest > o.cutoff)
      r.fail("highest", "'highest' must not be above 'cutoff': there is no force there to answer");
    // A segment holds 2/(segments + 1) of the record.
    const double lines = o.highest * 2 * o.duration / (o.segments + 1);
    if (lines < 8)
      r.fail("duration", fmt::format("segments of {:.3g} s part frequencies by {:.3g} Hz: too coarse for 'highest'; a "
                                     "longer record or fewer segments",
                                     2 * o.duration / (o.segments + 1), (o.segments + 1) / (2 * o.duration)));
  });
}

void Linearity::validate(const system::Machine& machine, const deck::Report& report) const {
  if (options.bearing && !system::find_bearing(machine, *options.bearing))
    report.fail("bearing", fmt::format("there is no bearing '{}'{}", *options.bearing,
                                       deck::did_you_mean_one_of(*options.bearing, system::bearing_names(machine))));
  if (options.node) check_nodes("node", {*options.node}, machine, report);
}

double Linearity::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  const double samples = (options.settle + options.duration) * options.cutoff * options.oversampling;
  const double lines = options.duration * options.cutoff * options.oversampling / options.segments;
  return memory_of_equilibria(machine) + 60 * samples + 800 * lines * static_cast<double>(options.levels.size());
}

}  // namespace whirl::study
