#include <fmt/core.h>

#include <algorithm>

#include "whirl/study/cycle_branch.hpp"

namespace whirl::study {

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
  d.add("unbalance", &O::unbalance, "names of the unbalances to apply, all at once; required for forced cycles");
  d.embed(&O::parameter);
  d.add("start", &O::start, "*", deck::any, "value of the parameter to start at; that of range.from if not given");
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed, where the parameter is another one");
  d.add("intervals", &O::intervals, deck::at_least(4), "intervals of the time mesh");
  d.add("degree", &O::degree, deck::in(1, 7), "degree of the polynomials in time");
  d.add("points", &O::points, "collocation points");
  d.add("adapt_mesh", &O::adapt_mesh,
        "split and merge intervals of the time mesh as the cycle changes along the branch");
  d.add("adapt_every", &O::adapt_every, deck::positive, "points of the branch between adaptations of the time mesh");
  d.add("mesh_tolerance", &O::mesh_tolerance, deck::positive,
        "estimated error per interval above which it is split, relative to the orbit");
  d.add("tolerance", &O::tolerance, deck::between(0, 1e-2),
        "root mean square of the scaled residual at which Newton's method stops");
  d.add("at", &O::at, "*", deck::any,
        "parameter values inside the range at which the cycle is solved and reported as at.VALUE.*");
  d.add("multipliers", &O::multipliers, deck::positive, "Floquet multipliers to report, the largest");
  d.add("period", &O::period, deck::positive, "revolutions per cycle");
  d.add("max_points", &O::max_points, deck::positive, "points after which the branch ends");
  d.add("max_eccentricity", &O::max_eccentricity, deck::between(0, 1),
        "the branch ends, as in contact, where the journal's eccentricity per clearance reaches this; no limit if not "
        "given");
  d.add("detect", &O::detect, "bifurcations to locate");
  d.add("follow_flips", &O::follow_flips,
        "also follow the cycles of twice the period born at the flips found, each as a study 'NAME flip K'");
  d.add("orbits", &O::orbits, deck::non_negative, "cycles whose time history is stored, spread over the branch");
  d.add("checkpoint", &O::checkpoint, "write checkpoints to resume from");
  d.check([](const O& o, const deck::Report& r) {
    for (std::size_t i = 0; i < o.detect.size(); ++i)
      if (o.detect[i] == Event::fold || o.detect[i] == Event::hopf)
        r.fail(fmt::format("detect.{}", i + 1), "cycles have cyclic_fold, flip, neimark_sacker and branch_point");
  });
}

void CycleBranch::validate(const system::Machine& machine, const deck::Report& report) const {
  if (!options.unbalance.empty()) check_unbalance(options.unbalance, machine, report);
  const bool forced = options.origin == CycleBranchOptions::Origin::equilibrium;
  if (forced && options.unbalance.empty())
    report.fail("", "'unbalance' is missing (forced cycles need a force; self-excited ones have 'origin: hopf')");
  if (!forced && !options.unbalance.empty())
    report.fail("unbalance", "self-excited cycles (origin: hopf) are those of the balanced machine");
  if (!forced && options.start) report.fail("start", "self-excited cycles start at the Hopf point");
  check_parameter(options.parameter, options.speed, machine, report);
  const deck::Range& range = options.parameter.range;
  const auto inside = [&](const char* option, const std::string& path, const deck::Quantity& q) {
    if (!deck::same_kind(q.unit, range.unit))
      report.fail(path, fmt::format("'{}' has another unit than the range ({})", option, range.unit));
    else if (q.value < std::min(range.from, range.to) || q.value > std::max(range.from, range.to))
      report.fail(path, fmt::format("'{}' lies outside the range", option));
  };
  for (std::size_t i = 0; i < options.at.size(); ++i) inside("at", fmt::format("at.{}", i + 1), options.at[i]);
  if (options.start) inside("start", "start", *options.start);
}

}  // namespace whirl::study
