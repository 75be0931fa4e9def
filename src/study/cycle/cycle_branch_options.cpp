#include <fmt/core.h>

#include <algorithm>

#include "study/cost.hpp"
#include "study/cycle/cycle_branch.hpp"
#include "study/layout.hpp"

namespace whirl::study {

int steps_of(const CycleBranchOptions& o) {
  using enum CycleBranchOptions::Method;
  if (o.method == finite_difference) return 1;
  if (o.steps) return *o.steps;
  constexpr int per_period = 120;
  return o.method == shooting ? per_period : (per_period + o.intervals - 1) / o.intervals;
}

std::span<const deck::Name<CycleBranchOptions::Method>> names(CycleBranchOptions::Method) {
  using enum CycleBranchOptions::Method;
  static constexpr deck::Name<CycleBranchOptions::Method> table[] = {
      {collocation, "collocation",
       "orthogonal collocation on an adaptive mesh; ranks share the intervals, or the states of films that have many"},
      {shooting, "shooting", "single shooting: the state at the start is the unknown; every rank does the same"},
      {multiple_shooting, "multiple_shooting", "states at the ends of intervals; intervals are shared by the ranks"},
      {finite_difference, "finite_difference", "one step of the scheme in each interval, shared by the ranks"},
      {newton_picard, "newton_picard",
       "Newton-Picard Gauss-Seidel: Newton for the multipliers above a radius, Picard iterations for the rest; never "
       "forms the monodromy matrix; the states are shared by the ranks. One interval: shooting-based; an explicit "
       "scheme with one step in each interval: finite-difference-based"}};
  return table;
}

std::span<const deck::Name<CycleBranchOptions::Stepping>> names(CycleBranchOptions::Stepping) {
  using enum CycleBranchOptions::Stepping;
  static constexpr deck::Name<CycleBranchOptions::Stepping> table[] = {
      {sdirk_2, "sdirk_2", "singly diagonally implicit, 2 stages, order 2, L-stable (Alexander 1977)"},
      {sdirk_4, "sdirk_4", "singly diagonally implicit, 5 stages, order 4, L-stable (Hairer and Wanner 1996)"},
      {radau_iia_2, "radau_iia_2", "fully implicit, 2 stages, order 3, L-stable; not for newton_picard"},
      {radau_iia_3, "radau_iia_3", "fully implicit, 3 stages, order 5, L-stable; not for newton_picard"},
      {improved_euler, "improved_euler", "explicit, order 2; stable for short steps only"},
      {third_order, "third_order", "explicit, order 3; stable for short steps only"},
      {classical, "classical", "explicit Runge-Kutta scheme of order 4; stable for short steps only"}};
  return table;
}

std::span<const deck::Name<CycleBranchOptions::Points>> names(CycleBranchOptions::Points) {
  using enum CycleBranchOptions::Points;
  static constexpr deck::Name<CycleBranchOptions::Points> table[] = {
      {radau, "radau", "Radau points: stiff modes are damped as they should"},
      {gauss, "gauss", "Gauss points: one order higher, but stiff modes show spurious multipliers"}};
  return table;
}

std::span<const deck::Name<CycleBranchOptions::Origin>> names(CycleBranchOptions::Origin) {
  using enum CycleBranchOptions::Origin;
  static constexpr deck::Name<CycleBranchOptions::Origin> table[] = {
      {equilibrium, "equilibrium", "forced cycles: the response to unbalance, from range.from on"},
      {hopf, "hopf", "self-excited cycles of the balanced machine, born at the first Hopf point of the range"}};
  return table;
}

void describe(deck::Description<CycleBranchOptions>& d) {
  using O = CycleBranchOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("origin", &O::origin, "where the branch begins");
  d.add("unbalance", &O::unbalance,
        "names of the unbalances to apply, all at once, and 'discs' for what eccentric and skewed discs do; required "
        "for forced cycles");
  d.embed(&O::parameter);
  d.add("start", &O::start, "*", deck::any, "value of the parameter to start at; that of range.from if not given");
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed, where the parameter is another one");
  using enum O::Method;
  d.add("method", &O::method, "solver of the periodic solutions", "van de Vrande (2001), ch. 3");
  d.add("intervals", &O::intervals, deck::Check{.min = 1, .max = 100000}, "intervals of the time mesh")
      .only(&O::method, {collocation, multiple_shooting, finite_difference, newton_picard});
  d.add("scheme", &O::scheme, "scheme of integration")
      .only(&O::method, {shooting, multiple_shooting, finite_difference, newton_picard});
  d.add("steps", &O::steps, deck::in(1, 1e6),
        "steps of the scheme in each interval, in the whole period for shooting; as many as make 120 a period if not "
        "given")
      .only(&O::method, {shooting, multiple_shooting, newton_picard});
  d.add("radius", &O::radius, deck::between(0, 1),
        "multipliers above this are found and left to Newton's method; the rest shrinks by it in a Picard iteration")
      .only(&O::method, {newton_picard});
  d.add("degree", &O::degree, deck::in(1, 7), "degree of the polynomials in time").only(&O::method, {collocation});
  d.add("points", &O::points, "collocation points").only(&O::method, {collocation});
  d.add("adapt_mesh", &O::adapt_mesh,
        "split and merge intervals of the time mesh as the cycle changes along the branch; at Radau points a shaft "
        "that is "
        "not reduced keeps the mesh it begins with")
      .only(&O::method, {collocation});
  d.add("adapt_every", &O::adapt_every, deck::positive, "points of the branch between adaptations of the time mesh")
      .only(&O::method, {collocation});
  d.add("mesh_tolerance", &O::mesh_tolerance, deck::in(1e-13, 1),
        "estimated error per interval above which it is split, relative to the orbit")
      .only(&O::method, {collocation});
  d.add("tolerance", &O::tolerance, deck::in(1e-13, 1e-2),
        "root mean square of the scaled residual at which Newton's method stops");
  d.add("at", &O::at, "*", deck::any,
        "parameter values inside the range at which the cycle is solved and reported as at.VALUE.*");
  d.add("multipliers", &O::multipliers, deck::in(1, 1e4),
        "Floquet multipliers to report, the largest; where they are searched for (films with states, whole shafts), "
        "those above 0.2, as many as this or 24");
  d.add("period", &O::period, deck::in(1, 1e4), "revolutions per cycle");
  d.add("max_points", &O::max_points, deck::positive,
        "points after which the branch ends, without those that `picture_tolerance` adds");
  d.add("picture_tolerance", &O::picture_tolerance, deck::in(0, 1), text_of_picture_tolerance);
  d.add("max_eccentricity", &O::max_eccentricity, deck::between(0, 1),
        "the branch ends, as in contact, where the journal's eccentricity per clearance reaches this; no limit if not "
        "given");
  d.add("detect", &O::detect, "bifurcations to locate");
  d.add("follow_flips", &O::follow_flips,
        "also follow the cycles of twice the period born at the flips found, each as a study 'NAME flip K'");
  d.add("flips", &O::flips, deck::positive,
        "which of them, 1 being the first found; all if not given. A branch that runs back into the simple cycle meets "
        "another flip there, whose branch is the same");
  d.add("nodes", &O::nodes, deck::positive, "nodes of the shaft to report beside the bearings");
  d.add("orbits", &O::orbits, deck::non_negative, "cycles whose time history is stored, spread over the branch");
  d.add("checkpoint", &O::checkpoint, "write checkpoints to resume from");
  d.check([](const O& o, const deck::Report& r) {
    for (std::size_t i = 0; i < o.detect.size(); ++i)
      if (o.detect[i] == Event::fold || o.detect[i] == Event::hopf)
        r.fail(fmt::format("detect.{}", i + 1), "cycles have cyclic_fold, flip, neimark_sacker and branch_point");
    if (!o.flips.empty() && !o.follow_flips) r.fail("flips", "'flips' belongs to 'follow_flips: true'");
    const bool by_steps = o.method != collocation && o.method != finite_difference;
    if (!by_steps && o.intervals < 4) r.fail("intervals", "a cycle needs at least 4 intervals");
    if (by_steps && (o.method == shooting ? 1 : o.intervals) * steps_of(o) < 4)
      r.fail("steps", "a cycle needs at least 4 steps");
    if (o.method == newton_picard && (o.scheme == O::Stepping::radau_iia_2 || o.scheme == O::Stepping::radau_iia_3))
      r.fail("scheme", "newton_picard solves one stage after the other: sdirk_2, sdirk_4 or an explicit scheme");
  });
}

double CycleBranch::memory(const system::Machine& machine, const LayoutOptions& layout) const {
  using enum CycleBranchOptions::Method;
  const CycleBranchOptions& o = options;
  const double intervals = o.method == shooting ? 1 : o.intervals, steps = o.method == collocation ? 1 : steps_of(o);
  const double stages = o.method == collocation ? o.degree : 1;
  const bool radau = o.method == collocation && o.points == CycleBranchOptions::Points::radau;
  // Newton-Picard never forms a dense block; the bound of a sparse one holds for it.
  if (o.method == newton_picard) return memory_of_equilibria(machine) * (1 + intervals / 100);
  const double stored = std::min(o.orbits, o.max_points) * 8 * intervals * stages * n_states(machine);
  const double one = radau && spreads_cycles(layout, machine, intervals, stages)
                         ? memory_of_spread_cycles(machine, intervals, stages)
                         : memory_of_cycles(machine, intervals, stages, radau);
  // Flips are followed on twice the intervals.
  return one * (o.follow_flips ? 2 : 1) + stored + 64 * intervals * steps;
}

void CycleBranch::validate(const system::Machine& machine, const deck::Report& report) const {
  if (!options.unbalance.empty()) check_unbalance(options.unbalance, machine, report);
  if (system::is_rotor(machine))
    check_nodes("nodes", options.nodes, machine, report);
  else if (!options.nodes.empty())
    report.fail("nodes", "this system has no shaft");
  const bool forced = options.origin == CycleBranchOptions::Origin::equilibrium;
  if (forced && options.unbalance.empty() && !system::own_forcing(machine))
    report.fail("", "'unbalance' is missing (forced cycles need a force; self-excited ones have 'origin: hopf')");
  if (!forced && !options.unbalance.empty())
    report.fail("unbalance", "self-excited cycles (origin: hopf) are those of the balanced machine");
  if (!forced && options.parameter.deflation)
    report.fail("deflation", "self-excited cycles start at the Hopf point, where there is one solution");
  if (!forced && options.start) report.fail("start", "self-excited cycles start at the Hopf point");
  check_parameter(options.parameter, options.speed, machine, report);
  const deck::Range& range = options.parameter.range;
  const auto inside = [&](const char* option, const std::string& path, const deck::Quantity& q) {
    if (!deck::same_kind(q.unit, range.unit))
      report.fail(path, fmt::format("'{}' has another unit than the range ({})", option, range.unit));
    else if (q.value < std::min(range.from, range.to) || q.value > std::max(range.from, range.to))
      report.fail(path, fmt::format("'{}' lies outside the range", option));
  };
  using enum CycleBranchOptions::Stepping;
  const bool steps = options.method != CycleBranchOptions::Method::collocation;
  const bool explicit_stages =
      options.scheme == improved_euler || options.scheme == third_order || options.scheme == classical;
  // Explicit stages take F as linear in dx/dt, which the force of a film is not where its pressure depends on rates.
  for (const system::Bearing& b : machine.bearings)
    if (steps && explicit_stages &&
        (film::facts(b.film).force_by_rates || options.parameter.path.ends_with(".liner_damping")))
      report.fail("scheme", fmt::format("the damped liner of bearing {} wants an implicit scheme", b.name));
  // Films with states in a rigid bore hold their content. Their stages have kinks wherever a node becomes full: a
  // scheme whose stages jump back and forth in time does not end (docs/mass_conserving.md).
  for (const system::Bearing& b : machine.bearings) {
    const film::Facts film = film::facts(b.film);
    if (options.method == CycleBranchOptions::Method::newton_picard && options.scheme != sdirk_2 && film.own_states &&
        !film.gives_way)
      report.fail("scheme", fmt::format("newton_picard solves stages of films with dynamic contents, as in bearing {}, "
                                        "by sdirk_2 only; collocation settles such films",
                                        b.name));
  }
  for (std::size_t i = 0; i < options.at.size(); ++i) inside("at", fmt::format("at.{}", i + 1), options.at[i]);
  if (options.start) inside("start", "start", *options.start);
}

}  // namespace whirl::study
