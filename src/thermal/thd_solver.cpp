#include "whirl/thermal/thd_solver.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "thermal/bush.hpp"
#include "thermal/journal.hpp"
#include "thermal/thd_coarse.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/from_options.hpp"
#include "whirl/core/gate.hpp"

namespace whirl::thermal {

using core::check;

namespace {

constexpr double least_film = 0.1;
// Between the rounds film and solid meet in Robin conditions, p of the film's and q of the solid's (Gander 2006,
// optimized Schwarz methods). To a change along the wall of the wave number w the film answers with F >= k/h, the more
// the faster it is carried past, and the solid with S = k w; a round leaves |p - S|/(p + F) |q - F|/(q + S) of it. q =
// k/h, that of the film from wall to wall, ends what changes slowly. p is S from node to node: of metal that is as good
// as the solid's temperature itself, and a solid that conducts less than the film takes no more rounds. p = q = 8 k/h
// took 31 rounds of a gas film and 20 of an oil film of 1e5 cells, growing with the mesh; this 18 and 13.
double solid_answers(double conductivity, const Mesh& mesh) {
  return 0.5 * conductivity * mesh.nodes_around() / mesh.radius;
}

// Each part of a round is solved until this is left of the residual that the round begins with, as the next round
// changes it again, and no further than `finest` of what it is at the ambient's temperature and pressure.
constexpr double reduction = 0.01, finest = 1e-11;
constexpr double most_exact = 50000;  // cells
// Rounds converge while the second half of those allowed leaves less than this of what the rounds before have reached,
// and end after so many times the number allowed.
constexpr double least_fall = 0.5;
constexpr int most_times = 20;

Surface convection(double coefficient, double temperature) {
  return {Surface::Kind::convection, coefficient, temperature};
}

Solid bush_of(const Rows& rows, const WallOptions& o) {
  Bush bush;
  bush.material.conductivity = o.conductivity;
  bush.material.expansion = o.expansion;
  bush.outer_radius = o.radius;
  bush.layers = o.layers;
  const Surface free = convection(o.convection, o.ambient);
  bush.surfaces = {free, free, free, free};
  return make_solid(rows, bush);
}

Solid journal_of(const Rows& rows, const WallOptions& o) {
  Journal journal;
  journal.material.conductivity = o.conductivity;
  journal.material.expansion = o.expansion;
  journal.bore_radius = o.radius;
  journal.length = o.shaft_length > 0 ? o.shaft_length : rows.mesh().length;
  journal.before = o.shaft_before;
  journal.layers = o.layers;
  const Surface free = convection(o.convection, o.ambient);
  journal.surfaces = {convection(o.bore_convection.value_or(o.convection), o.ambient), free, free, free};
  return make_solid(rows, journal);
}

}  // namespace

struct ThdSolver::Work {
  // One side of the film.
  struct Side {
    const WallOptions* options = nullptr;
    int layer = 0;  // of the film, at this wall
    std::optional<Solid> solid;
    core::Vector temperature, rhs;
    std::vector<double> conductance;  // W/K [r, n], between the film's cell and what stands behind
    std::vector<double> behind;       // K [r, n]
    // Of a solid, [r, n]. What the film conducts to is not the solid's cell but one `beyond` it, K/W, whose temperature
    // is `seen`, K; the solid meets the film through `robin`, W/K. Both agree with conductance and behind in the end.
    std::vector<double> resistance, robin, beyond, seen;  // resistance, K/W, from the wall to the solid's cell
    std::vector<double> rise;    // K [r], growth over expansion times radius; empty: it does not grow
    double grows = 0;            // m/K, of the clearance
    std::vector<double> factor;  // - [r, n], of the film's half layer; empty: 1
  };

  Work(const Rows& r, ThdSetup s, std::vector<double> h)
      : rows(r),
        setup(std::move(s)),
        cold(std::move(h)),
        thickness(cold),
        film(rows, setup.flow, thickness),
        gate(rows.comm()) {
    const Mesh& mesh = rows.mesh();
    half = Energy::half_layer(rows, setup.flow.fluid.k(setup.ambient), thickness);
    const double film_k = setup.flow.fluid.k(setup.ambient);
    bush.options = &setup.bush;
    journal.options = &setup.journal;
    journal.layer = mesh.across - 1;
    for (Side* side : {&bush, &journal}) {
      const bool at_bush = side == &bush;
      side->behind.assign(half.size(), side->options->temperature);
      side->conductance = half;
      if (side->options->type == WallOptions::Type::adiabatic) side->conductance.assign(half.size(), 0.0);
      if (side->options->type != WallOptions::Type::solid) continue;
      side->solid.emplace(at_bush ? bush_of(rows, setup.bush) : journal_of(rows, setup.journal));
      side->solid->join(half);
      side->conductance = side->solid->joined();  // at the ambient's temperature
      for (std::size_t c = 0; c < half.size(); ++c) {
        side->resistance.push_back(1 / side->conductance[c] - 1 / half[c]);
        const double own = half[c] / (2 * mesh.across);
        side->robin.push_back(std::min(own, 0.5 * side->conductance[c]));
        // A journal that turns has one temperature around: no wave there moves it.
        side->beyond.push_back(
            side->resistance[c] == 0 ? 0 : film_k / (solid_answers(side->options->conductivity, mesh) * own * cold[c]));
      }
      side->seen.assign(half.size(), side->options->ambient);
      side->temperature = side->solid->temperature(side->options->ambient);
      side->rhs = core::duplicate(side->temperature.get());
      side->behind.assign(half.size(), side->options->ambient);
      if (!side->options->growth || side->options->expansion <= 0) continue;
      side->rise.assign(static_cast<std::size_t>(rows.count()), 0.0);
      side->grows = (at_bush ? 1 : -1) * side->options->expansion * side->solid->shape().wall_radius();
      growing = true;
    }
    cells = half.size() * static_cast<std::size_t>(mesh.across);
    temperature.assign(cells, setup.ambient);
    check(DMCreateGlobalVector(rows.cells(), film_temperature.put()));
    const std::size_t walls =
        (bush.solid ? half.size() : 0) + (journal.solid ? half.size() : 0) + bush.rise.size() + journal.rise.size();
    x = core::make_vector(rows.comm(), static_cast<PetscInt>(cells + walls), PETSC_DETERMINE);
    f = core::duplicate(x.get());
    put_state();
  }

  // What the iteration changes, in the order of x.
  template <class Visit>
  void each_part(const Visit& visit) {
    visit(temperature);
    for (Side* side : {&bush, &journal})
      if (side->solid) {
        visit(side->seen);
        visit(side->rise);
      }
  }

  void put_state() {
    const core::WriteArray to(x.get());
    double* at = to.data();
    each_part([&](const std::vector<double>& part) { at = std::copy(part.begin(), part.end(), at); });
  }

  // The thickness that the solids leave, and how well heat passes through it. Rounds on the way may overshoot: there
  // a tenth of the film stays, and where that is so at the end it touches.
  void grow() {
    if (!growing) return;
    const auto n = static_cast<std::size_t>(rows.mesh().nodes_around());
    closed = 0;
    for (std::size_t c = 0; c < thickness.size(); ++c) {
      thickness[c] = cold[c];
      for (const Side* side : {&bush, &journal})
        if (!side->rise.empty()) thickness[c] += side->grows * side->rise[c / n];
      if (thickness[c] >= least_film * cold[c]) continue;
      thickness[c] = least_film * cold[c];
      closed = 1;
    }
    film.set_thickness(thickness);
    half = Energy::half_layer(rows, setup.flow.fluid.k(setup.ambient), thickness);
    for (Side* side : {&bush, &journal}) {
      if (side->options->type == WallOptions::Type::adiabatic) continue;
      side->conductance = half;
      if (!side->solid) continue;
      for (std::size_t c = 0; c < half.size(); ++c) side->conductance[c] = 1 / (1 / half[c] + side->resistance[c]);
    }
  }

  // Behind the film's wall, what a cell of the film and one of the solid have between them.
  [[nodiscard]] double surface(const Side& side, std::size_t c) const {
    const double own =
        temperature[c * static_cast<std::size_t>(rows.mesh().across) + static_cast<std::size_t>(side.layer)];
    if (side.options->type == WallOptions::Type::adiabatic) return own;  // no gradient
    if (!side.solid) return side.behind[c];
    return own + through(side, c) / (half[c] * (side.factor.empty() ? 1.0 : side.factor[c])) * (side.behind[c] - own);
  }

  // W/K between a cell of the film and one of the solid at the temperature that the film has.
  [[nodiscard]] double through(const Side& side, std::size_t c) const {
    return side.factor.empty() ? side.conductance[c] : 1 / (1 / (half[c] * side.factor[c]) + side.resistance[c]);
  }

  [[nodiscard]] Surroundings surroundings() const {
    Surroundings out;
    for (const auto& [wall, side] : {std::pair{&out.bush, &bush}, std::pair{&out.journal, &journal}}) {
      *wall = {side->conductance, side->solid ? side->seen : side->behind};
      for (std::size_t c = 0; c < side->robin.size(); ++c)
        wall->conductance[c] = 1 / (1 / side->conductance[c] + side->beyond[c]);
    }
    out.ambient = setup.ambient;
    out.supply = setup.supply;
    out.mixed = setup.mixed;
    if (setup.inlet_from_bush) {
      out.supply.resize(half.size());
      for (std::size_t c = 0; c < half.size(); ++c) out.supply[c] = surface(bush, c);
    }
    return out;
  }

  // Where the film's conductance at a wall changes with the temperature or by turbulence, the solid has the same.
  void rejoin() {
    if (is_constant(setup.flow.fluid.conductivity_law) && flow.mixing.empty()) return;
    for (Side* side : {&bush, &journal}) side->factor = energy->wall_factors(film_temperature.get(), side == &journal);
  }

  // The solid meets the film through `robin`, during the rounds, or as it is.
  void join(bool rounds) {
    for (Side* side : {&bush, &journal}) {
      if (!side->solid) continue;
      std::vector<double> film_half(half.size());
      for (std::size_t c = 0; c < half.size(); ++c)
        film_half[c] = 1 / (1 / (rounds ? side->robin[c] : through(*side, c)) - side->resistance[c]);
      side->solid->join(film_half);
    }
  }

  // Heat of the film to a solid, and its temperature behind the wall.
  void conduct(Side& side) {
    if (!side.solid) return;
    std::vector<double> meets(half.size());
    for (std::size_t c = 0; c < meets.size(); ++c) {
      const double own =
          temperature[c * static_cast<std::size_t>(rows.mesh().across) + static_cast<std::size_t>(side.layer)];
      const double over = 1 / through(side, c), more = 1 / side.robin[c];
      meets[c] = own + (own - side.seen[c]) / (over + side.beyond[c]) * (more - over);
    }
    side.solid->load(meets, side.rhs.get());
    // A state that is gone on from knows the solid at its wall alone: the first round finds what is behind.
    cost.solid += side.solid->solve(side.rhs.get(), side.temperature.get(), cost.largest.empty() ? 0 : left);
    PetscInt first = 0;
    check(VecGetOwnershipRange(side.temperature.get(), &first, nullptr));
    const core::ReadArray t(side.temperature.get());
    for (std::size_t c = 0; c < meets.size(); ++c) {
      side.behind[c] = t[side.solid->wall()[c] - first];
      side.seen[c] = side.behind[c] - (meets[c] - side.behind[c]) * side.robin[c] * side.beyond[c];
    }
    if (side.rise.empty()) return;
    side.rise = side.solid->growth(side.temperature.get(), side.options->reference.value_or(side.options->ambient));
    for (double& rise : side.rise) rise /= std::abs(side.grows);
  }

  void take(const double* from) {
    each_part([&](std::vector<double>& part) {
      std::copy_n(from, part.size(), part.begin());
      from += part.size();
    });
  }

  // What all ranks know.
  [[noreturn]] static void not_found(const char* why) {
    core::NotConverged error(why);
    error.mark_agreed();
    throw error;
  }

  // One round from the temperatures of x; what it changes of them is `out`.
  void round(Vec at, Vec out) {
    const core::ReadArray old(at);
    take(old.data());
    double clock = MPI_Wtime();
    const auto lap = [&clock](double& seconds) {
      const double now = MPI_Wtime();
      seconds += now - clock;
      clock = now;
    };
    grow();
    film.set_temperature(temperature);
    lap(cost.seconds.flow);
    cost.pressure += film.solve(0.01 * finest, left);
    lap(cost.seconds.pressure);
    flow = {};  // two at a time would be most of the memory
    flow = film.flow();
    lap(cost.seconds.flow);
    if (!energy)
      energy = std::make_unique<Energy>(
          rows, flow,
          EnergyModel{setup.flow.fluid.heat_capacity, setup.flow.fluid.conductivity, setup.order,
                      setup.flow.fluid.heat_capacity_law, setup.flow.fluid.conductivity_law},
          thickness, surroundings());
    else
      energy->update(thickness, surroundings());
    {
      const core::WriteArray t(film_temperature.get());
      std::copy(temperature.begin(), temperature.end(), t.data());
    }
    solved = energy->solve(film_temperature.get(), finest, left);
    if (solved.stuck())  // the solver's word is that of all ranks
      not_found("the temperatures of the film were not found: its energy equation did not converge");
    cost.energy_newton += solved.newton;
    cost.energy_krylov += solved.krylov;
    {
      const core::ReadArray t(film_temperature.get());
      std::copy_n(t.data(), cells, temperature.begin());
    }
    rejoin();
    lap(cost.seconds.energy);
    conduct(bush);
    conduct(journal);
    lap(cost.seconds.solids);
    const core::WriteArray change(out);
    double most[2] = {0, 0};  // change; whether a number is none
    PetscInt at_row = 0;
    each_part([&](const std::vector<double>& now) {
      for (const double value : now) {
        change[at_row] = old[at_row] - value;
        most[0] = std::max(most[0], std::abs(change[at_row]));
        if (!std::isfinite(change[at_row])) most[1] = 1;
        ++at_row;
      }
    });
    MPI_Allreduce(MPI_IN_PLACE, most, 2, MPI_DOUBLE, MPI_MAX, rows.comm());
    cost.largest.push_back(most[0]);
    // PETSc would stop at them with an error of its own.
    if (most[1] > 0) not_found("the temperatures of the film grow beyond all numbers");
  }

  // Rounds that still converge go on beyond the number that is allowed to rounds that do not.
  static PetscErrorCode settled(SNES snes, PetscInt round, PetscReal x, PetscReal step, PetscReal change,
                                SNESConvergedReason* reason, void* self) {
    auto& w = *static_cast<Work*>(self);
    PetscCall(SNESConvergedDefault(snes, round, x, step, change, reason, nullptr));
    w.changes.resize(static_cast<std::size_t>(round));
    w.changes.push_back(change);
    const int allowed = w.setup.most_iterations;
    if (*reason != SNES_CONVERGED_ITERATING || round < allowed) return 0;
    const auto recent = w.changes.end() - std::max(1, allowed / 2);
    const double before = *std::min_element(w.changes.begin(), recent),
                 now = *std::min_element(recent, w.changes.end());
    if (!(now < least_fall * before)) *reason = SNES_DIVERGED_MAX_IT;
    return 0;
  }

  static PetscErrorCode form(SNES snes, Vec at, Vec out, void* self) {
    auto& w = *static_cast<Work*>(self);
    const PetscErrorCode code = w.gate.run([&] { w.round(at, out); });
    return w.gate.domain_error() ? SNESSetFunctionDomainError(snes) : code;
  }

  const Rows& rows;
  const ThdSetup setup;
  const std::vector<double> cold;  // m [r, n], before the solids grow
  std::vector<double> thickness;
  bool growing = false;
  int closed = 0;            // some film is thinner than least_film of what it was cold
  std::vector<double> half;  // W/K [r, n]
  FilmFlow film;
  Flow flow;
  std::unique_ptr<Energy> energy;
  Side bush, journal;
  std::size_t cells = 0;
  double left = 0;     // of residuals after a round
  bool begun = false;  // the state is more than the ambient's
  std::vector<double> temperature;
  core::Vector film_temperature, x, f;
  core::NonlinearSolver snes;
  core::Gate gate;
  ThdSolve cost;
  std::vector<double> changes;  // norm of what each round changes
  EnergySolve solved;           // of the last round
};

namespace {

PetscErrorCode destroy_options(PetscOptions* options) {
  return PetscOptionsDestroy(options);
}

// Anderson's method keeps two vectors of each of these rounds: PETSc's 30 would be a third of the memory of a large
// film, for one or two rounds less. It is an option only, in a list of its own so that the user's comes after it.
void few_vectors(SNES snes) {
  core::Handle<PetscOptions, destroy_options> own;
  check(PetscOptionsCreate(own.put()));
  check(PetscOptionsSetValue(own.get(), "-thd_snes_anderson_m", "10"));
  PetscObject object = reinterpret_cast<PetscObject>(snes);
  PetscOptions before = nullptr;
  check(PetscObjectGetOptions(object, &before));
  check(PetscObjectSetOptions(object, own.get()));
  check(SNESSetFromOptions(snes));
  check(PetscObjectSetOptions(object, before));
}

}  // namespace

ThdSolver::ThdSolver(const Rows& rows, ThdSetup setup, std::vector<double> thickness)
    : w_(std::make_unique<Work>(rows, std::move(setup), std::move(thickness))) {}
ThdSolver::~ThdSolver() = default;

ThdSolve ThdSolver::solve() {
  Work& w = *w_;
  if (!w.begun)
    if (const auto from = coarse_start(w.rows, w.setup, w.cold)) start(*from);
  w.begun = true;
  // Rounds of a small film cost nothing; solved to rounding they leave less at the end than `tolerance` asks for.
  const Mesh& mesh = w.rows.mesh();
  const bool large = static_cast<double>(mesh.nodes_around()) * mesh.nodes_along() * mesh.across > most_exact;
  if (!w.snes) {
    check(SNESCreate(w.rows.comm(), w.snes.put()));
    check(SNESSetOptionsPrefix(w.snes.get(), "thd_"));
    check(SNESSetType(w.snes.get(), SNESANDERSON));
    check(SNESSetFunction(w.snes.get(), w.f.get(), Work::form, &w));
    if (large) few_vectors(w.snes.get());
    core::set_from_options(w.snes.get(), {SNESANDERSON, SNESNGMRES, SNESNRICHARDSON, SNESQN, SNESNCG});
  }
  PetscInt n = 0;
  check(VecGetSize(w.x.get(), &n));
  check(SNESSetTolerances(w.snes.get(), w.setup.tolerance * w.setup.ambient * std::sqrt(static_cast<double>(n)), 1e-30,
                          0, most_times * w.setup.most_iterations, 100000));
  check(SNESSetConvergenceTest(w.snes.get(), Work::settled, &w, nullptr));
  w.cost = {};
  w.join(true);
  w.left = large ? reduction : 0;
  w.gate.rethrow(SNESSolve(w.snes.get(), nullptr, w.x.get()));
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0;
  check(SNESGetConvergedReason(w.snes.get(), &reason));
  check(SNESGetIterationNumber(w.snes.get(), &iterations));
  w.cost.iterations = static_cast<int>(iterations);
  w.cost.converged = reason > 0;
  // The balances hold to rounding whatever the rounds have reached.
  w.left = 0;
  w.round(w.x.get(), w.f.get());
  w.cost.converged = w.cost.converged && (w.solved.converged || w.solved.residual <= 1e-9 * w.solved.scale);
  w.join(false);
  w.put_state();
  MPI_Allreduce(MPI_IN_PLACE, &w.closed, 1, MPI_INT, MPI_MAX, w.rows.comm());
  core::agree(w.rows.comm(), [&] {
    if (w.closed != 0) throw core::NotConverged("bush and journal grow until the film is closed");
  });
  return w.cost;
}

std::vector<double> ThdSolver::state() const {
  const Work& w = *w_;
  const auto l = static_cast<std::size_t>(w.rows.mesh().across),
             n = static_cast<std::size_t>(w.rows.mesh().nodes_around());
  std::vector<double> out;
  for (std::size_t c = 0; c < w.half.size(); ++c) {
    for (std::size_t k = 0; k < l; ++k) out.push_back(w.temperature[c * l + k]);
    for (const Work::Side* side : {&w.bush, &w.journal}) out.push_back(side->solid ? side->seen[c] : side->behind[c]);
    for (const Work::Side* side : {&w.bush, &w.journal}) out.push_back(side->rise.empty() ? 0 : side->rise[c / n]);
    out.push_back(w.film.pressure()[c]);
  }
  return out;
}
void ThdSolver::start(const std::vector<double>& state) {
  Work& w = *w_;
  const auto l = static_cast<std::size_t>(w.rows.mesh().across),
             n = static_cast<std::size_t>(w.rows.mesh().nodes_around());
  core::require(state.size() == w.half.size() * (l + 5), "a state of a film on this mesh");
  std::vector<double> pressure;
  auto from = state.begin();
  for (std::size_t c = 0; c < w.half.size(); ++c) {
    for (std::size_t k = 0; k < l; ++k) w.temperature[c * l + k] = *from++;
    for (Work::Side* side : {&w.bush, &w.journal}) {
      if (side->solid) side->seen[c] = *from;
      side->behind[c] = *from++;
    }
    for (Work::Side* side : {&w.bush, &w.journal}) {
      if (!side->rise.empty()) side->rise[c / n] = *from;
      ++from;
    }
    pressure.push_back(*from++);
  }
  w.film.start(pressure);
  w.begun = true;
  w.put_state();
}
const std::vector<double>& ThdSolver::thickness() const {
  return w_->thickness;
}
const FilmFlow& ThdSolver::flow() const {
  return w_->film;
}
const Flow& ThdSolver::flows() const {
  return w_->flow;
}
const std::vector<double>& ThdSolver::temperature() const {
  return w_->temperature;
}
std::vector<double> ThdSolver::mixed() {
  return w_->energy->mixed(w_->film_temperature.get());
}
std::vector<double> ThdSolver::wall_heat(bool journal) {
  return w_->energy->wall_heat(w_->film_temperature.get(), journal);
}
EnergyBudget ThdSolver::budget() {
  return w_->energy->budget(w_->film_temperature.get());
}
const Solid* ThdSolver::bush() const {
  return w_->bush.solid ? &*w_->bush.solid : nullptr;
}
const Solid* ThdSolver::journal() const {
  return w_->journal.solid ? &*w_->journal.solid : nullptr;
}
Vec ThdSolver::bush_temperature() const {
  return w_->bush.temperature.get();
}
Vec ThdSolver::journal_temperature() const {
  return w_->journal.temperature.get();
}
std::vector<double> ThdSolver::bush_surface() const {
  std::vector<double> out;
  for (std::size_t c = 0; c < w_->half.size(); ++c) out.push_back(w_->surface(w_->bush, c));
  return out;
}
std::vector<double> ThdSolver::journal_surface() const {
  std::vector<double> out;
  for (std::size_t c = 0; c < w_->half.size(); ++c) out.push_back(w_->surface(w_->journal, c));
  return out;
}

}  // namespace whirl::thermal
