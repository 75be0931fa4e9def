#include <fmt/core.h>

#include <cmath>

#include "study/make_plant.hpp"
#include "study/motion/assessment.hpp"
#include "study/motion/section.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/options.hpp"

namespace whirl::study {
namespace {

// What names and units of a machine's coordinates are.
struct Named {
  system::ShownPlaces places;
  PetscInt states = 0;
};

Named named(const system::Machine& machine) {
  // A rotor's states need its whole model, and mean little after a reduction: journals are named there.
  if (system::is_rotor(machine)) return {{system::bearing_names(machine), {}, "m", "m/s", {}}, 0};
  const auto plant = make_plant(PETSC_COMM_SELF, machine, {.unbalance = {}, .value = 1});
  return {plant->places(), plant->size()};
}

void check_pieces(const std::string& key, int piece, double revolutions, const deck::Report& report) {
  if (piece > revolutions)
    report.fail(key + ".revolutions", fmt::format("a piece of {} revolutions is longer than the record of {:.0f}",
                                                  piece, std::floor(revolutions)));
}

}  // namespace

std::vector<PlaneTerm> SectionOptions::terms() const {
  return of.empty() ? plane : std::vector<PlaneTerm>{{of, 1}};
}

void describe(deck::Description<PlaneTerm>& d) {
  d.add("of", &PlaneTerm::of,
        "coordinate: PLACE.x, PLACE.y, PLACE.vx or PLACE.vy, or state.K of a system without a rotor")
      .required();
  d.add("factor", &PlaneTerm::factor, deck::any, "what it is multiplied by");
}

void describe(deck::Description<SectionOptions>& d) {
  using O = SectionOptions;
  d.add(
      "of", &O::of,
      "the coordinate that takes a value on the section: x, y, vx, vy of a place as in B1.x (a journal relative to its "
      "bearing, and its velocity), or state.K of a system without a rotor");
  d.add("plane", &O::plane, "a sum of such coordinates instead");
  d.add("value", &O::value, "*", deck::any, "what the coordinate or the sum is on the section, in its unit").required();
  d.add("direction", &O::direction, "which crossings count");
  d.check([](const O& o, const deck::Report& r) {
    if (o.of.empty() == o.plane.empty())
      return r.fail("", "a section has either a coordinate 'of' or a 'plane' of several");
    bool any = !o.of.empty();
    for (const PlaneTerm& t : o.plane) any = any || t.factor != 0;
    if (!any) r.fail("plane", "all factors are zero: no plane");
  });
}

void describe(deck::Description<OrderOptions>& d) {
  using O = OrderOptions;
  d.add("track", &O::track, deck::Check{.min = 0, .max = 1000, .min_open = true},
        "orders to follow: frequencies per speed of the shaft")
      .required();
  d.add("revolutions", &O::revolutions, deck::in(1, 1e6), "length of the pieces that amplitudes are taken over");
  d.add("advance", &O::advance, deck::in(1, 1e6), "revolutions from the beginning of one piece to that of the next");
  d.add("window", &O::window, "what multiplies a piece");
  d.check([](const O& o, const deck::Report& r) {
    if (o.track.empty()) r.fail("track", "'track' is empty");
    for (std::size_t k = 0; k < o.track.size(); ++k)
      if (const double lines = o.track[k] * o.revolutions; std::abs(lines - std::round(lines)) > 1e-9)
        r.fail(fmt::format("track.{}", k + 1),
               fmt::format("{} revolutions do not hold whole turns of order {:g}", o.revolutions, o.track[k]));
  });
}

void describe(deck::Description<WaterfallOptions>& d) {
  using O = WaterfallOptions;
  d.add("highest", &O::highest, deck::positive, "highest order of the spectra");
  d.add("revolutions", &O::revolutions, deck::in(2, 1e6), "length of the pieces whose spectra are taken");
  d.add("advance", &O::advance, deck::in(1, 1e6), "revolutions from the beginning of one piece to that of the next");
  d.add("window", &O::window, "what multiplies a piece");
}

void check_section(const std::string& key, const SectionOptions& section, const system::Machine& machine,
                   const deck::Report& report) {
  const Named here = named(machine);
  std::string unit;
  const std::vector<PlaneTerm> terms = section.terms();
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const std::string path = section.of.empty() ? fmt::format("{}.plane.{}.of", key, k + 1) : key + ".of";
    try {
      const StateAt c = state_at(terms[k].of, here.places.names, here.states);
      const std::string own = c.place < 0 ? "1" : c.which < 2 ? here.places.unit : here.places.rate_unit;
      // Systems without dimensions count time in seconds and mix states with rates.
      const bool bare = here.places.unit == "1";
      if (!unit.empty() && own != unit && !bare)
        throw core::InputError(fmt::format("'{}' is in {}, those before it in {}", terms[k].of, own, unit));
      unit = bare ? "1" : own;
    } catch (const core::InputError& e) {
      return report.fail(path, e.what());
    }
  }
  try {
    if ((section.value.unit.empty() || section.value.unit == "1") && unit != "1")
      throw core::InputError(fmt::format("'value' needs a unit such as {}", unit == "m" ? "um" : "mm/s"));
    deck::check_kind(section.value.unit, unit);
  } catch (const core::InputError& e) {
    report.fail(key + ".value", e.what());
  }
}

void check_orders(const std::string& key, const OrderOptions& orders, double revolutions, int samples,
                  const deck::Report& report) {
  check_pieces(key, orders.revolutions, revolutions, report);
  for (std::size_t k = 0; k < orders.track.size(); ++k)
    if (2 * orders.track[k] >= samples)
      report.fail(fmt::format("{}.track.{}", key, k + 1),
                  fmt::format("{} samples a revolution do not show order {:g}", samples, orders.track[k]));
}

void check_waterfall(const std::string& key, const WaterfallOptions& waterfall, double revolutions, int samples,
                     const deck::Report& report) {
  check_pieces(key, waterfall.revolutions, revolutions, report);
  if (2 * waterfall.highest > samples)
    report.fail(key + ".highest",
                fmt::format("{} samples a revolution do not show order {:g}", samples, waterfall.highest));
}

}  // namespace whirl::study
