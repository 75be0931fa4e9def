// Hopf points and folds of equilibria on finer and finer film meshes.

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "study/bifurcation.hpp"
#include "study/common.hpp"
#include "study/convergence/shared_convergence.hpp"
#include "study/equilibrium/equilibrium_event.hpp"
#include "study/located.hpp"
#include "study/pieces.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {

const EquilibriumBranch* equilibria_called(const Context& context, const std::string& name) {
  for (const auto& s : context.studies)
    if (const auto* branch = dynamic_cast<const EquilibriumBranch*>(s.get()); branch && branch->name() == name)
      return branch;
  return nullptr;
}

StudyResult converge(Context& context, const MeshConvergenceOptions& options, const EquilibriumBranchOptions& branch,
                     const std::vector<Located>& all, const std::vector<int>& chosen) {
  auto& results = context.results;
  const std::string& unit = branch.parameter.range.unit;
  const double scale = deck::number_to_si(1, unit);
  io::Table rows = convergence_table(unit);
  std::string trouble;
  Pieces pieces(results, context.resume);
  const auto system = plant_of(context, branch);
  solve::NewtonOptions newton;
  newton.max_iterations = 20;
  for (const int which : chosen) {
    const Located& origin = all[static_cast<std::size_t>(which) - 1];
    solve::LocatedEvent found;
    found.event = origin.event;
    found.critical = origin.critical;
    found.parameter = origin.cycle.parameter / scale;
    found.sensitivity = origin.sensitivity;
    system->set_parameter(origin.cycle.parameter);
    const core::Vector x = state_in(*system, origin.cycle);
    const EquilibriumEvent event{*system,
                                 x.get(),
                                 found,
                                 scale,
                                 state_weight_of(continuation_of(branch)),
                                 newton,
                                 {},
                                 {},
                                 [&](const auto& cells) { return plant_of(context, branch, cells); }};
    std::vector<double> value{found.parameter}, frequency{std::abs(found.critical.imag())}, seconds{0};
    for (int level = 1; level <= options.doublings; ++level) {
      const double times = std::exp2(level), begin = results.seconds();
      const auto there = pieces.numbers(fmt::format("{} level {}", which, level), [&] {
        return numbers_on(event, {times, times});
      });
      if (there.empty()) {
        trouble += fmt::format("{}bifurcation {} was not found on {} times the cells of the deck",
                               trouble.empty() ? "" : "; ", which, times);
        break;
      }
      value.push_back(there[0]);
      frequency.push_back(there[1]);
      seconds.push_back(results.seconds() - begin);
    }
    const MeshLaw law = law_of(context.machine, context.layout);
    const MeshLimit limit = mesh_limit(value, law.film_order, law.kinks),
                    whirl = mesh_limit(frequency, law.film_order, law.kinks);
    io::Bifurcation b =
        bifurcation_at(type_of(found.event), limit.limit, branch.parameter.path, unit, context.machine, {}, *system);
    // Newton's method, of the last mesh.
    const double left = newton.tolerance * std::abs(limit.limit);
    b.uncertainty = limit.error + left;
    b.criticality_by = "see the branch";
    b.more["uncertainty_film_mesh"] = limit.error;
    b.more["uncertainty_location"] = left;
    b.more["observed_order"] = limit.order;
    if (found.event == solve::Event::hopf) {
      b.period_s = 2 * std::numbers::pi / whirl.limit;
      b.more["whirl_frequency_rad_s"] = whirl.limit;
      b.more["uncertainty_whirl_frequency_rad_s"] = whirl.error;
    }
    for (std::size_t k = 0; k < value.size(); ++k) {
      b.more[fmt::format("refined_{}", 1 << k)] = value[k];
      rows.append({static_cast<double>(which), std::exp2(k), value[k], 0, seconds[k]});
    }
    results.summary().bifurcations.push_back(b);
  }
  return finish_convergence(context, options, rows, branch.parameter, trouble);
}

}  // namespace whirl::study
