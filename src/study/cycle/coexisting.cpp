#include "study/cycle/coexisting.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>

#include "study/bars/summary_bars.hpp"
#include "study/cycle/cycle_record.hpp"
#include "study/make_plant.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/newton/equilibrium.hpp"

namespace whirl::study {
namespace {

using core::check;

// x moved by a smooth pattern in all states, of the root mean square `size` in scaled ones.
void disturb(system::Plant& plant, Vec x, double size, int k) {
  core::Vector scale = core::duplicate(x), other = core::duplicate(x);
  plant.scales(scale.get(), other.get());
  PetscInt begin = 0;
  check(VecGetOwnershipRange(x, &begin, nullptr));
  const core::ReadArray s(scale.get());
  const core::WriteArray a(x);
  for (PetscInt i = 0; i < a.size(); ++i)
    a[i] += std::sqrt(2.0) * size * s[i] * std::sin(1.0 + 2.399963 * (k + 1) * static_cast<double>(begin + i + 1));
}

}  // namespace

solve::DeflationOptions deflation_options(const Deflation& deflation, const solve::NewtonOptions& newton) {
  solve::DeflationOptions o;
  o.solutions = deflation.solutions;
  o.attempts = deflation.attempts;
  o.power = deflation.power;
  o.newton = newton;
  o.newton.max_iterations = 50;
  return o;
}

std::vector<solve::Cycle> coexisting_equilibria(system::Plant& plant, const Deflation& deflation,
                                                const solve::NewtonOptions& newton) {
  const core::Vector rest = find_rest(plant);
  const double parameter = plant.parameter(), unit = parameter != 0 ? std::abs(parameter) : 1;
  solve::EquilibriumProblem problem(plant, unit, 1);
  std::vector<core::Vector> known;
  known.push_back(problem.make_unknown());
  problem.from_state(rest.get(), parameter, known.front().get());
  core::Vector x = core::duplicate(rest.get());
  const auto guess = [&](int k) {
    check(VecCopy(rest.get(), x.get()));
    // Other places of the journals, farther and farther out on a spiral; other patterns of all states.
    const double out = 0.1 + 0.8 * (k / 2) / std::max(1, deflation.attempts / 2), angle = 2.399963 * k;
    try {
      if (k % 2 == 0)
        plant.displace(x.get(), {out * std::cos(angle), out * std::sin(angle)});
      else
        disturb(plant, x.get(), out, k);
    } catch (const core::DomainError&) {
      disturb(plant, x.get(), 0.01, k);
    }
    core::Vector u = problem.make_unknown();
    problem.from_state(x.get(), parameter, u.get());
    return u;
  };
  plant.set_forcing(false);
  const auto found = solve::deflate(problem, 1, known, guess, deflation_options(deflation, newton));
  plant.set_forcing(true);
  plant.set_parameter(parameter);
  std::vector<solve::Cycle> out;
  for (const auto& u : found) {
    problem.to_state(u.get(), x.get());
    out.push_back(as_cycle(plant, x.get(), parameter));
  }
  return out;
}

namespace {

// x(rate s + by) at the nodes of x(s).
solve::Cycle replayed(const solve::Cycle& cycle, const solve::Scheme& scheme, double rate, double by) {
  solve::Cycle out = cycle;
  for (Eigen::Index i = 0; i < cycle.intervals(); ++i)
    for (Eigen::Index l = 1; l <= scheme.degree; ++l) {
      const double begin = cycle.mesh[static_cast<std::size_t>(i)],
                   here = begin + (cycle.mesh[static_cast<std::size_t>(i) + 1] - begin) * scheme.node(l),
                   s = rate * here + by;
      out.x.col(i * scheme.degree + l - 1) = cycle.at(scheme, s - std::floor(s));
    }
  return out;
}

}  // namespace

solve::Cycle delayed(const solve::Cycle& cycle, const solve::Scheme& scheme, double by) {
  return replayed(cycle, scheme, 1, by);
}

// From a motion of one turn run through several times Newton's method finds such motions only: every other guess is the
// first turn spread over all of them.
solve::Cycle other_vibration(const solve::Cycle& cycle, const solve::Scheme& scheme, int turns, int k) {
  constexpr std::array<double, 7> sizes{4, 2, 0.25, 1, 0.5, 8, 16};
  constexpr std::array<double, 4> phases{0, 0.25, 0.5, 0.75};
  const bool slow = turns > 1 && k % 2 == 0;
  const auto n = static_cast<std::size_t>(turns > 1 ? k / 2 : k);
  const double size = sizes[n % sizes.size()], phase = phases[(n / sizes.size() + n) % phases.size()] / turns;
  solve::Cycle out = replayed(cycle, scheme, slow ? 1.0 / turns : 1, phase);
  const Eigen::VectorXd mean = out.x.rowwise().mean();
  out.x = (size * (out.x.colwise() - mean)).colwise() + mean;
  return out;
}

std::vector<solve::Cycle> put_solutions(io::Group& group, io::StudySummary& summary,
                                        const std::function<std::vector<solve::Cycle>()>& find,
                                        const SharedRows& like) {
  std::vector<solve::Cycle> further;
  std::string reason;
  if (!has_answer([&] { further = find(); }, &reason))
    summary.warnings.push_back(
        fmt::format("deflation was given up, other solutions at the start are not known: {}", reason));
  auto& all = group.child("solutions");
  all.set("count", static_cast<int>(further.size()));
  for (std::size_t k = 0; k < further.size(); ++k) write_cycle(all.child(fmt::format("{}", k + 2)), further[k], like);
  summary.set("solutions", static_cast<double>(further.size() + 1), "1");
  return further;
}

std::vector<io::Group> solutions_in(const io::Group& group) {
  std::vector<io::Group> out;
  if (!group.has_group("solutions")) return out;
  const io::Group& all = group.group("solutions");
  for (long k = 0; k < all.integer("count"); ++k) out.push_back(all.group(fmt::format("{}", k + 2)));
  return out;
}

}  // namespace whirl::study
