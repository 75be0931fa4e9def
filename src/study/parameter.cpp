#include "study/parameter.hpp"

#include <fmt/core.h>

namespace whirl::study {
namespace {

deck::Access access(system::Machine& machine, std::string_view path) {
  const deck::Access a = deck::find_option(machine, path);
  if (!a.continuable) throw core::InputError(fmt::format("studies may not vary '{}'", path));
  return a;
}

}  // namespace

std::span<const deck::Name<Event>> names(Event) {
  static constexpr deck::Name<Event> table[] = {
      {Event::fold, "fold", "equilibria turn back in the parameter"},
      {Event::hopf, "hopf", "a pair of eigenvalues crosses the imaginary axis"},
      {Event::branch_point, "branch_point", "two branches cross"},
      {Event::cyclic_fold, "cyclic_fold", "a multiplier passes +1"},
      {Event::flip, "flip", "a multiplier passes -1"},
      {Event::neimark_sacker, "neimark_sacker", "a pair of multipliers leaves the unit circle"}};
  return table;
}

std::span<const deck::Name<Following>> names(Following) {
  static constexpr deck::Name<Following> table[] = {
      {Following::arclength, "arclength", "pseudo-arclength: folds are passed, the parameter may turn back"},
      {Following::natural, "natural", "the parameter goes on in steps of its own: the branch ends at a fold"}};
  return table;
}

void describe(deck::Description<BranchStep>& d) {
  d.add("initial", &BranchStep::initial, "*", deck::positive, "length of the first step").required();
  d.add("min", &BranchStep::min, "*", deck::positive, "length below which the branch ends").required();
  d.add("max", &BranchStep::max, "*", deck::positive, "longest step").required();
  d.check([](const BranchStep& s, const deck::Report& r) {
    if (s.min.value > s.initial.value) r.fail("min", "'min' is larger than 'initial'");
    if (s.max.value < s.initial.value) r.fail("max", "'max' is smaller than 'initial'");
  });
}

void describe(deck::Description<Deflation>& d) {
  d.add("solutions", &Deflation::solutions, deck::at_least(2),
        "solutions wanted in all; the search ends when so many are known");
  d.add("attempts", &Deflation::attempts, deck::Check{.min = 1, .max = 10000}, "guesses to search from");
  d.add(
      "power", &Deflation::power, deck::positive,
      "p of the factor 1/|u - r|^p + 1 that takes a known solution r out of the equations, with u in root mean square "
      "clearances",
      "004 eq. 3.1 with errata 26");
}

void describe(deck::Description<Parameter>& d) {
  d.add("parameter", &Parameter::path, "speed, or the path of an option that studies may vary");
  d.add("range", &Parameter::range, "*", deck::any,
        "values to cover, from the first towards the second; results carry its unit")
      .required();
  d.add("step", &Parameter::step, "lengths of steps, in the unit of the range");
  d.add("continuation", &Parameter::continuation, "how the branch goes on from point to point");
  d.add("deflation", &Parameter::deflation,
        "search for further solutions at the start of the branch; each begins a branch of its own, 'NAME solution K'");
  d.add(
      "beta_1", &Parameter::beta_1, "rad", deck::Check{.min = 0, .max = std::numbers::pi, .min_open = true},
      "angle between the predictor and the line from point to point above which a step is halved; the tangent may turn "
      "by twice as much",
      "van de Vrande (2001), Sec. 3.3");
  d.add("beta_2", &Parameter::beta_2, "rad", deck::Check{.min = 0, .max = std::numbers::pi, .min_open = true},
        "the same angle without the direction of the parameter; 180 deg: any, because the states alone turn round "
        "wherever an amplitude has a maximum",
        "van de Vrande (2001), Sec. 3.3");
}

std::string parameter_unit(const system::Machine& machine, std::string_view path) {
  if (path == "speed") {
    if (!system::is_rotor(machine))
      throw core::InputError(
          fmt::format("a {} has no 'speed'; give the path of one of its options", machine.system.name));
    return "rad/s";
  }
  system::Machine copy = machine;
  return access(copy, path).unit;
}

double value_of(const system::Machine& machine, std::string_view path) {
  system::Machine copy = machine;
  return *access(copy, path).value;
}

system::Machine with_parameter(const system::Machine& machine, std::string_view path, double value) {
  system::Machine copy = machine;
  const deck::Access a = access(copy, path);
  if (!a.check.holds(value))
    throw core::DomainError(fmt::format("'{}' must be {}, not {}", path, a.check.text(), value));
  *a.value = value;
  return copy;
}

void check_parameter(const Parameter& p, const std::optional<deck::Quantity>& speed, const system::Machine& machine,
                     const deck::Report& report) {
  std::string si = "rad/s";
  deck::Check check = deck::positive;
  try {
    si = parameter_unit(machine, p.path);
    if (p.path != "speed") {
      system::Machine copy = machine;
      check = access(copy, p.path).check;
    }
  } catch (const core::InputError& e) {
    return report.fail("parameter", e.what());
  }
  auto fits = [&](const std::string& path, const std::string& unit, double value, const deck::Check& c) {
    try {
      if ((unit.empty() || unit == "1") && si != "1")
        throw core::InputError(fmt::format("{} needs a unit such as {}", p.path, si == "rad/s" ? "rpm" : si));
      deck::check_kind(unit, si);
      if (!c.holds(value)) throw core::InputError(fmt::format("'{}' must be {}", p.path, c.text()));
    } catch (const core::InputError& e) {
      report.fail(path, e.what());
    }
  };
  fits("range.from", p.range.unit, p.range.from, check);
  if (deck::same_kind(p.range.unit, si)) fits("range.to", p.range.unit, p.range.to, check);
  if (p.step) {
    fits("step.initial", p.step->initial.unit, p.step->initial.value, deck::positive);
    fits("step.min", p.step->min.unit, p.step->min.value, deck::positive);
    fits("step.max", p.step->max.unit, p.step->max.value, deck::positive);
  }
  if (p.path == "speed" && speed)
    report.fail("speed", "'speed' is the parameter of this branch and has no fixed value");
  if (!system::is_rotor(machine)) {
    if (speed) report.fail("speed", fmt::format("a {} has no shaft speed", machine.system.name));
    return;
  }
  if (p.path != "speed" && !speed) report.fail("", "'speed' is missing (shaft speed of the branch)");
}

}  // namespace whirl::study
