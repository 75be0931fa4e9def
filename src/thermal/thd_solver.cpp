#include "whirl/thermal/thd_solver.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "thermal/thd_coarse.hpp"
#include "thermal/thd_wall.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/from_options.hpp"
#include "whirl/core/gate.hpp"

namespace whirl::thermal {

using core::check;

namespace {

constexpr double least_film = 0.1;
// Each part of a round is solved until this is left of the residual that the round begins with, as the next round
// changes it again, and no further than `finest` of what it is at the ambient's temperature and pressure.
constexpr double reduction = 0.01, finest = 1e-11;
constexpr double most_exact = 50000;  // cells
// Rounds converge while the second half of those allowed leaves less than this of what the rounds before have reached,
// and end after so many times the number allowed.
constexpr double least_fall = 0.5;
constexpr int most_times = 20;

}  // namespace

struct ThdSolver::Work {
  Work(const Rows& r, ThdSetup s, std::vector<double> h)
      : rows(r),
        setup(std::move(s)),
        cold(std::move(h)),
        thickness(cold),
        half(half_layer()),
        film(rows, setup.flow, thickness),
        bush(rows, setup.bush, false, film_conductivity(), cold, half, temperature),
        journal(rows, setup.journal, true, film_conductivity(), cold, half, temperature),
        gate(rows.comm()) {
    cells = half.size() * static_cast<std::size_t>(rows.mesh().across);
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
    for (ThdWall* side : {&bush, &journal})
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
    if (bush.rise.empty() && journal.rise.empty()) return;
    const auto n = static_cast<std::size_t>(rows.mesh().nodes_around());
    closed = 0;
    for (std::size_t c = 0; c < thickness.size(); ++c) {
      thickness[c] = cold[c];
      for (const ThdWall* side : {&bush, &journal}) thickness[c] += side->growth(c / n);
      if (thickness[c] >= least_film * cold[c]) continue;
      thickness[c] = least_film * cold[c];
      closed = 1;
    }
    film.set_thickness(thickness);
    half = half_layer();
    for (ThdWall* side : {&bush, &journal}) side->follow();
  }

  [[nodiscard]] Surroundings surroundings() const {
    Surroundings out;
    out.bush = bush.beside_film();
    out.journal = journal.beside_film();
    out.ambient = setup.ambient;
    out.supply = setup.supply;
    out.mixed = setup.mixed;
    if (setup.inlet_from_bush) {
      out.supply.resize(half.size());
      for (std::size_t c = 0; c < half.size(); ++c) out.supply[c] = bush.surface(c);
    }
    return out;
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
    if (!is_constant(setup.flow.fluid.conductivity_law) || !flow.mixing.empty())
      for (ThdWall* side : {&bush, &journal})
        side->set_factor(energy->wall_factors(film_temperature.get(), side == &journal));
    lap(cost.seconds.energy);
    // A state that is gone on from knows the solid at its wall alone: the first round finds what is behind.
    for (ThdWall* side : {&bush, &journal}) cost.solid += side->conduct(cost.largest.empty() ? 0 : left);
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

  [[nodiscard]] double film_conductivity() const { return setup.flow.fluid.k(setup.ambient); }
  [[nodiscard]] std::vector<double> half_layer() const {
    return Energy::half_layer(rows, film_conductivity(), thickness);
  }

  const Rows& rows;
  const ThdSetup setup;
  const std::vector<double> cold;  // m [r, n], before the solids grow
  std::vector<double> thickness;
  int closed = 0;            // some film is thinner than least_film of what it was cold
  std::vector<double> half;  // W/K [r, n]
  FilmFlow film;
  Flow flow;
  std::unique_ptr<Energy> energy;
  ThdWall bush, journal;
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
  for (ThdWall* side : {&w.bush, &w.journal}) side->join(true);
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
  for (ThdWall* side : {&w.bush, &w.journal}) side->join(false);
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
    for (const ThdWall* side : {&w.bush, &w.journal}) out.push_back(side->solid ? side->seen[c] : side->behind[c]);
    for (const ThdWall* side : {&w.bush, &w.journal}) out.push_back(side->rise.empty() ? 0 : side->rise[c / n]);
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
    for (ThdWall* side : {&w.bush, &w.journal}) {
      if (side->solid) side->seen[c] = *from;
      side->behind[c] = *from++;
    }
    for (ThdWall* side : {&w.bush, &w.journal}) {
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
const Solid* ThdSolver::solid(bool journal) const {
  const ThdWall& wall = journal ? w_->journal : w_->bush;
  return wall.solid ? &*wall.solid : nullptr;
}
Vec ThdSolver::solid_temperature(bool journal) const {
  return (journal ? w_->journal : w_->bush).solid_temperature.get();
}
std::vector<double> ThdSolver::surface(bool journal) const {
  std::vector<double> out;
  for (std::size_t c = 0; c < w_->half.size(); ++c) out.push_back((journal ? w_->journal : w_->bush).surface(c));
  return out;
}

}  // namespace whirl::thermal
