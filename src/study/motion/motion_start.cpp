#include "study/motion/motion_start.hpp"

#include <array>
#include <numbers>

#include "study/make_plant.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/cycle/cycle_problem.hpp"
#include "whirl/solve/newton/newton.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::study {
namespace {

using core::check;

// The synchronous cycle, from the equilibrium held for the whole turn; x becomes its state at angle zero.
std::vector<std::complex<double>> to_cycle(system::Plant& system, Vec x) {
  if (core::size_of(system.comm()) > 1)
    throw core::NotConverged("cycles are for systems that fit one rank; start from the equilibrium");
  // Gauss points: multipliers of order eight.
  solve::CycleOptions options;
  options.degree = 4;
  options.points = solve::Points::gauss;
  solve::CycleProblem problem(system.comm(), system, options, solve::uniform_mesh(80));
  const std::vector<double> whole = system.gather(x);
  solve::Cycle guess{problem.mesh(), {}, 2 * std::numbers::pi / system.speed(), system.parameter()};
  guess.x = Eigen::Map<const Eigen::VectorXd>(whole.data(), system.size())
                .replicate(1, guess.intervals() * problem.scheme().degree);
  core::Vector u = problem.scatter(guess), row = core::duplicate(u.get());
  solve::parameter_row(problem, row.get());
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  const auto result = solve::newton(problem, u.get(), row.get(), system.parameter(), newton);
  if (!result.converged) throw core::NotConverged("no synchronous cycle to start from: " + result.reason);
  problem.linearise(u.get(), row.get());
  const Eigen::VectorXd first = problem.gather(u.get()).at(problem.scheme(), 0);
  const core::WriteArray out(x);
  for (PetscInt i = 0; i < out.size(); ++i) out[i] = first(i);
  return spectral::eigenvalues(problem.comm(), problem.monodromy());
}

}  // namespace

StartState start_state(system::Plant& system, const MotionStart& start) {
  StartState state;
  state.x = find_rest(system);
  if (start.from == MotionStart::From::cycle) state.multipliers = to_cycle(system, state.x.get());
  std::array<double, 2> offset = start.offset;
  if (start.from == MotionStart::From::centre) {
    const std::array<double, 2> place = system.observe(state.x.get()).shown.front().position;
    for (std::size_t d = 0; d < 2; ++d) offset[d] -= place[d] / system.places().clearances.front();
  }
  system.displace(state.x.get(), offset);
  return state;
}

std::string thinnest(const FilmLimit& films, system::Plant& system, const transient::Integrator& motion, Vec x) {
  motion.state(x);
  try {
    return films.thinnest(system.observe(x).film_thickness);
  } catch (const core::DomainError&) {
  } catch (const core::NotConverged&) {
    // Of walls that yield the film has to be solved.
  }
  return "";
}

}  // namespace whirl::study
