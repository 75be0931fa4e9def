#include "cost.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/plan.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/freedom.hpp"
#include "whirl/solve/cycle/cost.hpp"

namespace whirl::study {

double n_film_states(const system::Machine& machine) {
  double own = 0;
  for (const system::Bearing& b : machine.bearings)
    own += film::facts(b.film, b.geometry.value_or(film::Geometry{})).states;
  return own;
}

double n_states(const system::Machine& machine) {
  if (!system::is_rotor(machine))
    return machine.system.name == system::Brusselator::key
               ? 2.0 * (static_cast<const system::Slot<system::Brusselator>&>(machine).options.cells - 1)
               : 0;
  const rotor::Options& r = machine.rotor;
  const double masters = static_cast<double>(r.reduction.masters.size()), modes = r.reduction.modes,
               nodes = static_cast<double>(r.segments.size()) + 1;
  using enum rotor::Reduction::Type;
  double freedoms = r.type == rotor::Options::Type::rigid ? 2
                    : r.reduction.type == none
                        ? rotor::freedoms_per_node * nodes + 2.0 * rotor::n_inner(r.element) * (nodes - 1)
                    : r.reduction.type == modal ? 2 * modes
                    : r.reduction.type == guyan ? 2 * masters
                                                : 2 * (masters + modes);
  for (const system::Bearing& b : machine.bearings)
    if (b.pedestal) freedoms += 2;
  // Slopes that no reduction takes away.
  if (r.type == rotor::Options::Type::shaft && r.reduction.type != none)
    freedoms += 2 * static_cast<double>(system::slope_nodes(machine).size());
  return 2 * freedoms + n_film_states(machine);
}

double memory_of_equilibria(const system::Machine& machine) {
  // A state of a film at rest has more: evaluations, entries, the inverse of its film, and its matrices where modes are
  // asked for. 4.4 GB were measured on a branch with eigenvalues and 5.0 GB with ten modes, at 800,000 states.
  const double films = system::is_rotor(machine) ? n_film_states(machine) : 0;
  return 3000 * (n_states(machine) - films) + 6500 * films;
}

namespace {

// Doubles that an interval holds of the films' own states. A node sees the `line` of nodes on either side of its own:
// the band has 2 line + 1 entries a row. For each state: at every point two matrices and what they are made of
// (3 stages bands), the factors with blocks of stages x stages, as many columns of these as a line has nodes where a
// ring is closed, and the thin tangents at the points (50 a point).
double numbers_of_films(const system::Machine& machine, double stages, std::int64_t& width) {
  double all = 0;
  for (const system::Bearing& b : machine.bearings) {
    const film::Facts f = film::facts(b.film, b.geometry.value_or(film::Geometry{}));
    if (f.states == 0) continue;
    const double line = std::max(1.0, std::round(f.states / std::max(1.0, static_cast<double>(f.pads * f.cells[0]))));
    width = std::max(width, 2 * static_cast<std::int64_t>(line) + 1);
    all += f.states * ((2 * line + 1) * (3 * stages + stages * stages) + stages * stages * (4 + line) + 50 * stages);
  }
  return all;
}

}  // namespace

double memory_of_cycles(const system::Machine& machine, double intervals, double stages, bool radau) {
  const double n = n_states(machine);
  const bool rotor = system::is_rotor(machine);
  std::int64_t width = 0;
  const double films = rotor ? numbers_of_films(machine, stages, width) : 0;
  // Of a whole shaft no interval has a matrix, only the modes in time have their factors.
  // A node sees two others: 13 entries a state.
  const solve::cost::CycleCounts counts{.states = std::llround(n),
                                        .intervals = std::llround(intervals),
                                        .degree = std::llround(stages),
                                        .own = std::llround(n_film_states(machine)),
                                        .band = width,
                                        .forces = 2 * static_cast<std::int64_t>(machine.bearings.size()),
                                        .entries = std::llround(13 * n)};
  const bool whole = radau && rotor && machine.rotor.type == rotor::Options::Type::shaft &&
                     machine.rotor.reduction.type == rotor::Reduction::Type::none;
  const auto way = solve::cost::cheapest(counts, films > 0, whole);
  const double joined = way == core::plan::CycleWay::sweeps  ? 0
                        : way == core::plan::CycleWay::modes ? 40 * stages * n
                                                             : n * n;
  return 8 * intervals * (400 + (films > 0 ? films : 30 * (stages + 1) * n) + joined);
}

double memory_of_spread_cycles(const system::Machine& machine, double intervals, double stages) {
  return 8 * intervals * n_states(machine) * (stages * (40 + 4 * static_cast<double>(machine.bearings.size())) + 150);
}

}  // namespace whirl::study
