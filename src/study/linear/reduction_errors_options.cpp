#include <fmt/core.h>

#include <algorithm>

#include "study/linear/reduction_errors.hpp"
#include "whirl/film/contract/describe.hpp"

namespace whirl::study {

std::span<const deck::Name<ReductionMethod>> names(ReductionMethod) {
  using enum ReductionMethod;
  static constexpr deck::Name<ReductionMethod> table[] = {
      {modal_supported, "modal_supported", "real modes of the shaft at rest on springs at its masters"},
      {modal_free, "modal_free", "real modes of the free shaft at rest"},
      {craig_bampton, "craig_bampton", "masters and real modes of the shaft with its masters held"},
      {craig_bampton_state, "craig_bampton_state",
       "masters, their velocities and complex modes of the turning shaft with its masters held"}};
  return table;
}

void describe(deck::Description<ReductionOrbits>& d) {
  using O = ReductionOrbits;
  d.add("freedoms", &O::freedoms, deck::positive, "freedoms of the reduced shafts whose orbits are computed");
  d.add("unbalance", &O::unbalance, "names of the unbalances that set in at once, at an angle of zero").required();
  d.add("node", &O::node, deck::positive, "node of the shaft whose orbit is shown").required();
  d.add("revolutions", &O::revolutions, deck::positive, "length of the motion");
  d.add("samples", &O::samples, deck::in(8, 1e5), "samples per revolution");
  d.check([](const O& o, const deck::Report& r) {
    if (o.freedoms.empty()) r.fail("freedoms", "'freedoms' is empty");
    if (o.unbalance.empty()) r.fail("unbalance", "a balanced machine stays at rest: give the name of an unbalance");
  });
}

void describe(deck::Description<ReductionErrorsOptions>& d) {
  using O = ReductionErrorsOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("speed", &O::speed, "rad/s", deck::positive, "shaft speed, also that of complex modes")
      .required()
      .alias("speeds");
  d.add("methods", &O::methods, "reductions to compare; that of the rotor plays no part");
  d.add("freedoms", &O::freedoms, deck::positive,
        "freedoms kept, of both planes together: masters and modes. In state space each stands for two states",
        "003 figures 2.11 to 2.25");
  d.add("masters", &O::masters, deck::positive, "master nodes beside those of the bearings");
  d.add("support", &O::support, "N/m", deck::non_negative,
        "springs at the masters of 'modal_supported'; 0: the mean direct stiffness of the films");
  d.add("count", &O::count, deck::in(1, 1000), "modes compared, those of lowest frequency");
  d.add("maps", &O::maps, deck::non_negative,
        "freedoms of the reduced matrices that are kept in the results, with V^T G V and R; 0: none",
        "003 figures 2.9, 2.10, 2.15 to 2.17, 2.22, 2.23");
  d.add("orbits", &O::orbits, "orbits of whole and reduced shafts side by side", "003 figures 2.13 to 2.27");
  d.check([](const O& o, const deck::Report& r) {
    if (o.methods.empty()) r.fail("methods", "'methods' is empty");
    if (o.freedoms.empty()) r.fail("freedoms", "'freedoms' is empty");
  });
}

namespace {

// Each plane keeps the same; masters are motions of the modes, or stand beside at least one of them.
void check_freedoms(const std::string& path, int freedoms, const ReductionErrorsOptions& o,
                    const system::Machine& machine, const deck::Report& report) {
  std::vector<int> nodes(o.masters);
  for (const int node : system::acting_nodes(machine))
    if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) nodes.push_back(node);
  const int slopes = static_cast<int>(system::slope_nodes(machine).size());
  const int least = 2 * (static_cast<int>(nodes.size()) + slopes + 1),
            most = 4 * (static_cast<int>(machine.rotor.segments.size()) + 1);
  if (freedoms % 2 != 0)
    report.fail(path, fmt::format("{} freedoms: both planes keep the same, so that the number is even", freedoms));
  else if (freedoms < least || freedoms > most)
    report.fail(path, fmt::format("{} freedoms are not between {} (masters and a mode in each plane) and the {} of the "
                                  "shaft",
                                  freedoms, least, most));
}

}  // namespace

void ReductionErrors::validate(const system::Machine& machine, const deck::Report& report) const {
  if (machine.rotor.type == rotor::Options::Type::rigid)
    return report.fail("", "a rigid rotor has nothing to reduce: give 'rotor' segments");
  if (system::support_nodes(machine).size() < 2)
    report.fail("", "reductions are compared on a shaft in two bearings or more");
  for (const system::Bearing& b : machine.bearings)
    if (film::facts(b.film, b.geometry.value_or(film::Geometry{})).states > 0)
      return report.fail(
          "", fmt::format("the film of bearing {} has states of its own, which this study does not take", b.name));
  check_nodes("masters", options.masters, machine, report);
  for (std::size_t i = 0; i < options.freedoms.size(); ++i) {
    const std::string path = fmt::format("freedoms.{}", i + 1);
    check_freedoms(path, options.freedoms[i], options, machine, report);
    if (options.freedoms[i] < options.count)
      report.fail(path, fmt::format("{} freedoms have no {} modes to compare", options.freedoms[i], options.count));
  }
  if (options.maps > 0) {
    check_freedoms("maps", options.maps, options, machine, report);
    if (options.maps < options.count)
      report.fail("maps", fmt::format("{} freedoms have no {} modes to compare", options.maps, options.count));
  }
  if (!options.orbits) return;
  const int n_nodes = static_cast<int>(machine.rotor.segments.size()) + 1;
  if (options.orbits->node > n_nodes)
    report.fail("orbits.node",
                fmt::format("node {} does not exist: the shaft has nodes 1 to {}", options.orbits->node, n_nodes));
  check_unbalance(options.orbits->unbalance, machine, report.below("orbits"));
  for (std::size_t i = 0; i < options.orbits->freedoms.size(); ++i)
    check_freedoms(fmt::format("orbits.freedoms.{}", i + 1), options.orbits->freedoms[i], options, machine, report);
}

double ReductionErrors::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  const double n = 4.0 * static_cast<double>(machine.rotor.segments.size() + 1);
  const double samples = options.orbits ? options.orbits->revolutions * options.orbits->samples : 0;
  return 8 * (30 * n * n + 2 * samples * static_cast<double>(4 * options.methods.size() + 1));
}

}  // namespace whirl::study
