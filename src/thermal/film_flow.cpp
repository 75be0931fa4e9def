// The equation for the pressure of a film and its Newton method; what flows is in film_flow_result.cpp.
#include "thermal/film_flow_work.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "thermal/profile.hpp"
#include "thermal/row_halo.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/from_options.hpp"

namespace whirl::thermal {

using core::check;

FilmFlow::FilmFlow(const Rows& rows, FilmFlowOptions options, std::vector<double> thickness)
    : w_(std::make_unique<Work>(rows, std::move(options), std::move(thickness))) {}
FilmFlow::~FilmFlow() = default;
void FilmFlow::set_temperature(const std::vector<double>& cells) {
  w_->set_temperature(cells);
}
void FilmFlow::set_thickness(const std::vector<double>& thickness) {
  w_->h = with_halo(w_->rows, thickness, Work::at(w_->n));
}
void FilmFlow::start(const std::vector<double>& pressure) {
  core::require(pressure.size() == w_->pressure.size(), "a pressure for each node of this rank");
  w_->pressure = pressure;
  w_->filled.assign(pressure.size(), 1.0);
  w_->cold = false;
}
const std::vector<double>& FilmFlow::fill() const {
  return w_->filled;
}
bool FilmFlow::conserves_mass() const {
  return w_->conserving;
}
int FilmFlow::solve(double tolerance, double reduction) {
  return w_->solve(tolerance, reduction);
}
const std::vector<double>& FilmFlow::pressure() const {
  return w_->pressure;
}
void FilmFlow::residual(Vec u, Vec f) {
  w_->residual(u, f);
}
void FilmFlow::jacobian(Vec u, Mat j) {
  w_->jacobian(u, j);
}
Vec FilmFlow::state() const {
  return w_->u.get();
}
Mat FilmFlow::matrix() const {
  return w_->j.get();
}

FilmFlow::Work::Work(const Rows& r, FilmFlowOptions o, std::vector<double> thickness)
    : rows(r), mesh(r.mesh()), options(std::move(o)), n(mesh.nodes_around()), h(with_halo(r, thickness, at(n))) {
  place();
  // Node numbers of the rows beside those of this rank.
  const int rank = core::rank_of(rows.comm()), size = core::size_of(rows.comm());
  const auto local = static_cast<PetscInt>(n * rows.count()) + static_cast<PetscInt>(here.size());
  u = core::make_vector(rows.comm(), local, PETSC_DETERMINE);
  f = core::duplicate(u.get());
  std::vector<PetscInt> firsts(at(size));
  check(VecGetOwnershipRange(u.get(), &first, nullptr));
  MPI_Allgather(&first, 1, MPIU_INT, firsts.data(), 1, MPIU_INT, rows.comm());
  const int m = mesh.nodes_along();
  if (rank > 0)
    first_before = firsts[at(rank - 1)] + static_cast<PetscInt>(n) * (m * rank / size - 1 - m * (rank - 1) / size);
  if (rank + 1 < size) first_behind = firsts[at(rank + 1)];
  std::vector<PetscInt> entries(at(static_cast<int>(local)), 6);
  j = core::make_matrix(rows.comm(), local, entries);
  // From the middle, where about half of the supply may stand, the square of the pressure of a gas falls to the ends.
  double supply = options.ambient;
  for (const Orifice& source : options.orifices) supply = std::max(supply, source.pressure);
  pressure.resize(at(n * rows.count()));
  filled.assign(pressure.size(), 1.0);
  for (int q = rows.begin(); q < rows.end(); ++q)
    for (int i = 0; i < n; ++i) {
      const double middle = 1 - std::abs(2.0 * q / mesh.along - 1), over = std::pow(0.6 * supply, 2);
      const double guess =
          options.orifices.empty() ? options.ambient : std::sqrt(std::pow(options.ambient, 2) + middle * over);
      const std::size_t k = at(rows.node(i, q));
      pressure[k] = fixed[k] ? given[k] : guess;
    }
  hole.resize(here.size());
  for (std::size_t k = 0; k < here.size(); ++k) hole[k] = 0.5 * (options.ambient + options.orifices[here[k]].pressure);
  mu_at_.resize(at(mesh.across));
}

// Which nodes have their pressure, and which orifices are this rank's.
void FilmFlow::Work::place() {
  const int m = mesh.along;
  fixed.assign(at(n * rows.count()), false);
  given.assign(fixed.size(), options.ambient);
  for (int q = rows.begin(); q < rows.end(); ++q)
    for (int i = 0; i < n; ++i)
      if (q == 0 || q == m || (!mesh.closed && (i == 0 || i == n - 1))) fixed[at(rows.node(i, q))] = true;
  for (const Feed& feed : options.feeds)
    for (int q = std::max(feed.first_along, rows.begin()); q <= std::min(feed.last_along, rows.end() - 1); ++q)
      for (int i = feed.first_around; i <= feed.last_around; ++i) {
        const int k = mesh.closed ? ((i % n) + n) % n : i;
        fixed[at(rows.node(k, q))] = true;
        given[at(rows.node(k, q))] = feed.pressure;
      }
  core::agree(rows.comm(), [&] {
    if (conserving && (options.fluid.gas || options.speed == 0))
      throw core::Error("a film conserves the mass of its cavity if it is a liquid in motion");
    for (std::size_t k = 0; k < options.orifices.size(); ++k) {
      const Orifice& o = options.orifices[k];
      if (o.i < 0 || o.i >= n || o.j <= 0 || o.j >= m) throw core::Error("an orifice lies outside the film");
      for (std::size_t q = 0; q < k; ++q)
        if (options.orifices[q].i == o.i && options.orifices[q].j == o.j)
          throw core::InputError("two orifices lie at one node: the mesh is too coarse for them");
      if (o.j >= rows.begin() && o.j < rows.end()) here.push_back(k);
    }
  });
}

// Of faces around (i | i + 1) and along (j - 1 | j): mass flow per unit of gradient and by the journal's drag.
void FilmFlow::Work::set_temperature(const std::vector<double>& cells) {
  const auto l = at(mesh.across), width = at(n) * l;
  temperature = with_halo(rows, cells, width);
  mu.resize(temperature.size());
  for (std::size_t k = 0; k < mu.size(); ++k)
    mu[k] = temperature[k] > 0 ? viscosity(options.fluid.viscosity, temperature[k]).value : 0;
  core::agree(rows.comm(), [&] {
    if (options.fluid.gas || is_constant(options.fluid.density_law)) return;
    for (const double t : cells)
      if (!(options.fluid.rho(0, t) > 0))
        throw core::DomainError("the law of the density of the lubricant has left what is positive");
  });
  around.assign(at(n * rows.count()), {});
  along.assign(at(n * (rows.count() + 1)), {});
  const double surface = options.speed * mesh.radius;
  Profile profile(mesh.across);
  const auto conductance = [&](std::size_t a, std::size_t b, double drag, const Resistance& law) {
    face(a, b, profile);
    Face out;
    for (std::size_t k = 0; k < l; ++k) {
      const double dense = density(a, b, k);
      out.gradient += dense * profile.by_pressure[k];
      out.drag += dense * profile.by_drag[k] * drag;
    }
    if (turbulent) {
      out.reynolds = reynolds(a, b);
      if (!options.fluid.gas) out.gradient /= resist(law, out.reynolds).value;
    }
    return out;
  };
  for (int q = rows.begin(); q < rows.end(); ++q)
    for (int i = 0; i < (mesh.closed ? n : n - 1); ++i)
      around[at(rows.node(i, q))] = conductance(halo(i, q), halo((i + 1) % n, q), surface, law_around);
  for (int q = std::max(rows.begin(), 1); q <= std::min(rows.end(), mesh.along); ++q)
    for (int i = 0; i < n; ++i)
      along[at((q - rows.begin()) * n + i)] = conductance(halo(i, q - 1), halo(i, q), 0, law_along);
  if (conserving) choose_scale();
  // Of a point source: p^2 = -mdot ln(r)/(2 pi g) with the mass flow g d(p^2)/dr per unit of width.
  at_hole.clear();
  for (const std::size_t k : here) {
    const Orifice& o = options.orifices[k];
    const std::size_t node = halo(o.i, o.j);
    face(node, node, profile);
    double g = 0;
    for (std::size_t q = 0; q < l; ++q) g -= density(node, node, q) * profile.by_pressure[q] / 2;
    const double r0 = std::exp(-std::numbers::egamma) / 4 * std::hypot(mesh.dx(), mesh.dz());
    const double area = std::numbers::pi / 4 * o.diameter * o.diameter;
    at_hole.push_back({2 * std::numbers::pi * g, std::log(o.diameter / 2 / r0), area * discharge(h[node], o.diameter),
                       turbulent ? reynolds(node, node) : 0.0});
  }
}

void FilmFlow::Work::face(std::size_t a, std::size_t b, Profile& profile) {
  const auto l = at(mesh.across);
  for (std::size_t k = 0; k < l; ++k) mu_at_[k] = 0.5 * (mu[a * l + k] + mu[b * l + k]);
  profile.set(0.5 * (h[a] + h[b]), mu_at_.data());
}

// kg/m^3, of a gas that per pressure.
double FilmFlow::Work::density(std::size_t a, std::size_t b, std::size_t k) const {
  const auto l = at(mesh.across);
  if (!options.fluid.gas)
    return is_constant(options.fluid.density_law)
               ? options.fluid.density
               : 0.5 * (options.fluid.rho(0, temperature[a * l + k]) + options.fluid.rho(0, temperature[b * l + k]));
  return 2 / (options.fluid.gas_constant * (temperature[a * l + k] + temperature[b * l + k]));
}

MassFlow FilmFlow::Work::through_hole(std::size_t k, double p) const {
  const Orifice& o = options.orifices[here[k]];
  const MassFlow m = nozzle({options.fluid.gas_constant, options.heat_ratio}, o.pressure, o.temperature, p);
  return {m.value * at_hole[k].area, m.slope * at_hole[k].area};
}

// Mass flow through a face of width `width` between nodes `step` apart, and its derivatives.
Flux FilmFlow::Work::through(const Face& side, const Resistance& law, double width, double step, double p,
                             double q) const {
  const double gradient = side.gradient * width / step, drag = side.drag * width;
  if (conserving) return through_partly(gradient, drag, p, q);
  if (!options.fluid.gas) return {gradient * (q - p) + drag, -gradient, gradient};
  if (turbulent) {
    const Valued more = resist(law, side.reynolds * 0.5 * (p + q));
    const double now = gradient / more.value, flow = 0.5 * now * (q * q - p * p);
    const double less = -flow * more.slope / more.value * 0.5 * side.reynolds;
    return {flow + 0.5 * drag * (p + q), -now * p + less + 0.5 * drag, now * q + less + 0.5 * drag};
  }
  return {0.5 * gradient * (q * q - p * p) + 0.5 * drag * (p + q), -gradient * p + 0.5 * drag,
          gradient * q + 0.5 * drag};
}

template <class Node, class Edge>
void FilmFlow::Work::visit(const std::vector<double>& p, const Node& node, const Edge& edge) const {
  const int last = mesh.along;
  for (int q = rows.begin(); q < rows.end(); ++q)
    for (int i = 0; i < n; ++i) node(rows.node(i, q), halo(i, q));
  for (int q = rows.begin(); q < rows.end(); ++q)
    for (int i = 0; i < (mesh.closed ? n : n - 1); ++i) {
      const int k = (i + 1) % n;
      edge(i, q, k, q,
           through(around[at(rows.node(i, q))], law_around, mesh.depth(q), mesh.dx(), p[halo(i, q)], p[halo(k, q)]));
    }
  for (int q = std::max(rows.begin(), 1); q <= std::min(rows.end(), last); ++q)
    for (int i = 0; i < n; ++i)
      edge(i, q - 1, i, q,
           through(along[at((q - rows.begin()) * n + i)], law_along, mesh.width(i), mesh.dz(), p[halo(i, q - 1)],
                   p[halo(i, q)]));
}

std::vector<double> FilmFlow::Work::nodes_of(const double* state) const {
  return with_halo(rows, {state, state + n * rows.count()}, at(n));
}

// Mass that leaves the volume of each node less what enters; a pressure that is given, less that.
void FilmFlow::Work::residual(Vec state, Vec out) const {
  const core::ReadArray x(state);
  const std::vector<double> p = nodes_of(x.data());
  const core::WriteArray r(out);
  std::fill_n(r.data(), r.size(), 0.0);
  const auto add = [&](int i, int q, double value) {
    if (q >= rows.begin() && q < rows.end() && !fixed[at(rows.node(i, q))]) r[rows.node(i, q)] += value;
  };
  visit(
      p,
      [&](PetscInt k, std::size_t at_halo) {
        if (fixed[at(k)]) r[k] = p[at_halo] - given[at(k)];
      },
      [&](int i, int q, int k, int s, const Flux& flux) {
        add(i, q, flux.value);
        add(k, s, -flux.value);
      });
  for (std::size_t k = 0; k < here.size(); ++k) {
    const Orifice& o = options.orifices[here[k]];
    const auto row = static_cast<PetscInt>(n * rows.count()) + static_cast<PetscInt>(k);
    const double ps = x[row], pn = p[halo(o.i, o.j)];
    const double m = through_hole(k, ps).value;
    add(o.i, o.j, -m);
    r[row] = (ps * ps - pn * pn) * at_hole[k].conductance * around_hole(k, pn).value + at_hole[k].logarithm * m;
  }
}

void FilmFlow::Work::jacobian(Vec state, Mat matrix) const {
  const core::ReadArray x(state);
  const std::vector<double> p = nodes_of(x.data());
  check(MatZeroEntries(matrix));
  const auto number = [&](int i, int q) -> PetscInt {
    if (q < rows.begin()) return first_before + i;
    if (q >= rows.end()) return first_behind + i;
    return first + rows.node(i, q);
  };
  const auto add = [&](int i, int q, int k, int s, double value) {
    if (q >= rows.begin() && q < rows.end() && !fixed[at(rows.node(i, q))])
      check(MatSetValue(matrix, number(i, q), number(k, s), value, ADD_VALUES));
  };
  visit(
      p,
      [&](PetscInt k, std::size_t) {
        check(MatSetValue(matrix, first + k, first + k, fixed[at(k)] ? 1 : 0, ADD_VALUES));
      },
      [&](int i, int q, int k, int s, const Flux& flux) {
        add(i, q, i, q, flux.before);
        add(i, q, k, s, flux.behind);
        add(k, s, i, q, -flux.before);
        add(k, s, k, s, -flux.behind);
      });
  for (std::size_t k = 0; k < here.size(); ++k) {
    const Orifice& o = options.orifices[here[k]];
    const PetscInt row = first + static_cast<PetscInt>(n * rows.count()) + static_cast<PetscInt>(k),
                   node = number(o.i, o.j);
    const double ps = x[row - first], pn = p[halo(o.i, o.j)], slope = through_hole(k, ps).slope;
    const Valued share = around_hole(k, pn);
    check(MatSetValue(matrix, node, row, -slope, ADD_VALUES));
    const double conductance = at_hole[k].conductance;
    check(MatSetValue(matrix, row, row, 2 * ps * conductance * share.value + at_hole[k].logarithm * slope, ADD_VALUES));
    check(MatSetValue(matrix, row, node, conductance * ((ps * ps - pn * pn) * share.slope - 2 * pn * share.value),
                      ADD_VALUES));
  }
  check(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

PetscErrorCode FilmFlow::Work::form_residual(SNES snes, Vec x, Vec out, void* context) {
  auto& w = *static_cast<Work*>(context);
  const PetscErrorCode code = w.gate.run([&] {
    PetscReal least = 0;
    check(VecMin(x, nullptr, &least));
    if (w.options.fluid.gas && !(least > 0)) {
      core::DomainError error("the pressure of the gas is not positive");
      error.mark_agreed();  // all ranks have the least pressure of all
      throw error;
    }
    w.residual(x, out);
  });
  return w.gate.domain_error() ? SNESSetFunctionDomainError(snes) : code;
}

PetscErrorCode FilmFlow::Work::form_jacobian(SNES /*snes*/, Vec x, Mat /*a*/, Mat matrix, void* context) {
  auto& w = *static_cast<Work*>(context);
  return w.gate.run([&] { w.jacobian(x, matrix); });
}

void FilmFlow::Work::prepare_solver() {
  using Cavitation = FilmFlowOptions::Cavitation;
  const bool ruptures = options.cavitation == Cavitation::reynolds;
  check(SNESCreate(rows.comm(), snes.put()));
  check(SNESSetOptionsPrefix(snes.get(), "film_pressure_"));
  check(SNESSetType(snes.get(), ruptures ? SNESVINEWTONRSLS : SNESNEWTONLS));
  check(SNESSetFunction(snes.get(), f.get(), form_residual, this));
  check(SNESSetJacobian(snes.get(), j.get(), j.get(), form_jacobian, this));
  choose_linear_solver();
  SNESLineSearch search = nullptr;
  check(SNESGetLineSearch(snes.get(), &search));
  check(SNESLineSearchSetType(search, ruptures || conserving ? SNESLINESEARCHBASIC : SNESLINESEARCHBT));
  if (ruptures) {
    low = core::duplicate(u.get());
    high = core::duplicate(u.get());
    check(VecSet(low.get(), 0));
    check(VecSet(high.get(), PETSC_INFINITY));
    check(SNESVISetVariableBounds(snes.get(), low.get(), high.get()));
  }
  core::set_from_options(snes.get(), ruptures ? std::initializer_list<const char*>{SNESVINEWTONRSLS, SNESVINEWTONSSLS}
                                              : core::newton_types);
  // What flows where nothing is in balance measures what is left.
  load(std::vector<double>(pressure.size(), options.ambient));
  residual(u.get(), f.get());
  typical = core::norm(f.get());
  if (typical == 0) typical = 1;
}

void FilmFlow::Work::load(const std::vector<double>& p) {
  const core::WriteArray a(u.get());
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double state = conserving && filled[k] < 1 ? scale * (filled[k] - 1) : p[k];
    a[static_cast<PetscInt>(k)] = fixed[k] ? given[k] : state;
  }
  for (std::size_t k = 0; k < hole.size(); ++k) a[static_cast<PetscInt>(p.size() + k)] = hole[k];
}

int FilmFlow::Work::solve(double tolerance, double reduction) {
  if (!snes) prepare_solver();
  if (cold) begin_on_half();
  cold = false;
  load(pressure);
  finish_linear_solver();
  check(SNESSetTolerances(snes.get(), tolerance * typical, std::max(reduction, 1e-30), 1e-14, 60, 10000));
  limit_linear_solver(0.3 * tolerance * typical);
  gate.rethrow(SNESSolve(snes.get(), nullptr, u.get()));
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt iterations = 0, krylov = 0;
  PetscReal left = 0;
  check(SNESGetConvergedReason(snes.get(), &reason));
  check(SNESGetIterationNumber(snes.get(), &iterations));
  check(SNESGetLinearSolveIterations(snes.get(), &krylov));
  choose_lag(static_cast<int>(iterations), static_cast<int>(krylov));
  check(SNESGetFunctionNorm(snes.get(), &left));
  // A line search that finds no smaller residual at rounding has arrived.
  if (reason < 0 && !(left <= std::max(tolerance, 1e-9) * typical)) {
    gate.rethrow(0);
    core::agree(rows.comm(), [] { throw core::NotConverged("the pressure of the film was not found"); });
  }
  const core::ReadArray a(u.get());
  std::copy_n(a.data(), pressure.size(), pressure.begin());
  for (std::size_t k = 0; k < pressure.size() && conserving; ++k) {
    filled[k] = 1 + std::min(0.0, pressure[k]) / scale;
    pressure[k] = std::max(0.0, pressure[k]);
  }
  std::copy_n(a.data() + pressure.size(), hole.size(), hole.begin());
  return static_cast<int>(iterations);
}

}  // namespace whirl::thermal
