// A film with bush and journal over the mesh: rounds, Newton and Krylov iterations, time and memory of the coupled
// solution, beside one linear energy solve of the same size, of first and of second order, and a STREAM triad in the
// same run. Seconds are wall time;
// "proc. s" and the ratio to the linear solve are processor time of the busiest rank, which a busy machine changes
// less. bench_thd [--fluid gas|oil] [--order 1|2] [--eccentricity 0.8] [--speed rad/s] [--reynolds] [--walls
// isothermal]
// [--layers n] [cells ...], on any number of ranks; 10,000,000 cells want 8 GB. The pressure alone: --pressure.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "bench/timing.hpp"
#include "whirl/core/session.hpp"
#include "whirl/core/shell.hpp"
#include "whirl/thermal/thd_solver.hpp"

namespace {

using namespace whirl;

struct Case {
  bool gas = true, solids = true, reynolds = false, pressure_only = false;
  int order = 2, layers = 0;
  double eccentricity = 0.5, speed = 0;
};

// MB at its most, of all ranks.
double memory() {
  constexpr const char* what = "VmHWM:";
  double value = 0;
  char line[256];
  if (FILE* f = std::fopen("/proc/self/status", "r")) {
    while (std::fgets(line, sizeof line, f))
      if (std::string(line).rfind(what, 0) == 0) value = std::atof(line + std::strlen(what)) / 1024;
    std::fclose(f);
  }
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return value;
}

// GB/s of a = b + 3 c over all ranks, 24 bytes an entry (McCalpin 1995), 96 MB in all.
double triad() {
  const auto n = static_cast<std::size_t>(4000000 / core::size_of(PETSC_COMM_WORLD));
  std::vector<double> a(n, 0.0), b(n, 1.0), c(n, 2.0);
  double scalar = 3;
  const bench::Timing t = bench::least(PETSC_COMM_WORLD, 20, [&] {
    for (std::size_t k = 0; k < n; ++k) a[k] = b[k] + scalar * c[k];
    scalar = a[n / 2] > 0 ? 3 : 4;  // the loop is wanted
  });
  return 24e-9 * static_cast<double>(n) * core::size_of(PETSC_COMM_WORLD) / t.wall;
}

// Bearing A of Skarolek (2011), or the bearing of Ferron, Frene and Boncompain (1983) full of oil; solids as in
// inputs/thd.
thermal::ThdSetup setup_of(const thermal::Mesh& mesh, const Case& c) {
  using thermal::WallOptions;
  thermal::ThdSetup s;
  s.order = c.order;
  s.flow.fluid.gas = c.gas;
  s.bush.type = s.journal.type = c.solids ? WallOptions::Type::solid : WallOptions::Type::isothermal;
  if (c.gas) {
    s.flow.fluid.viscosity = thermal::Sutherland{};
    s.flow.fluid.heat_capacity = 1006;
    s.flow.fluid.conductivity = 0.0263;
    s.flow.ambient = 101325;
    s.flow.speed = c.speed > 0 ? c.speed : 1e4;
    for (int k = 0; k < 8; ++k) s.flow.orifices.push_back({k * mesh.around / 8, mesh.along / 2, 2e-4, 5e5, 300});
    s.bush.conductivity = 45;
    s.bush.radius = 0.025;
    s.bush.convection = 50;
    s.journal.conductivity = 16;
    s.journal.radius = 0.005;
    s.journal.convection = 200;
    s.journal.shaft_length = 0.1;
    s.journal.shaft_before = 0.02;
    s.inlet_from_bush = c.solids;
    return s;
  }
  constexpr double warm = 313.15;
  thermal::Quadratic oil;
  oil.viscosity = 0.0277;
  oil.celsius = 40;
  oil.coefficients = {3.287, -3.064, 0.777};
  s.flow.fluid.viscosity = oil;
  s.flow.fluid.density = 860;
  s.flow.fluid.heat_capacity = 2000;
  s.flow.fluid.conductivity = 0.13;
  s.flow.speed = c.speed > 0 ? c.speed : 314.159;
  using Cavitation = thermal::FilmFlowOptions::Cavitation;
  s.flow.cavitation = c.reynolds ? Cavitation::reynolds : Cavitation::half_sommerfeld;
  const int first = mesh.around * 121 / 360, last = mesh.around * 139 / 360;
  s.flow.feeds = {{first, last, mesh.along / 16, mesh.along - mesh.along / 16, 7e4}};
  s.ambient = s.bush.ambient = s.journal.ambient = s.bush.temperature = s.journal.temperature = warm;
  s.bush.conductivity = 250;
  s.bush.radius = 0.1;
  s.bush.convection = s.journal.convection = 80;
  s.journal.conductivity = 50;
  s.journal.shaft_length = 0.4;
  s.journal.shaft_before = 0.16;
  return s;
}

thermal::Mesh mesh_of(double cells, const Case& c) {
  thermal::Mesh mesh;
  // Four nodes around to one along; more layers on finer meshes. Skarolek's 291,600 (360 x 90 x 9) ask for --layers 9.
  mesh.across = c.layers > 0 ? c.layers : cells > 2e6 ? 24 : 16;
  mesh.along = static_cast<int>(std::sqrt(cells / mesh.across / 4) / 2 + 0.5) * 2;
  mesh.around = 4 * mesh.along;
  mesh.radius = c.gas ? 0.015 : 0.05;
  mesh.length = c.gas ? 0.03 : 0.08;
  return mesh;
}

// One linear solve of the energy equation of second order, what a Newton step solves: its exact derivative at a
// temperature, from zero until the residual is 1e-10 of that at the ambient's temperature. Iterations.
int solve_linearised(thermal::Energy& energy, Vec at, double ambient) {
  energy.linearise(at);
  core::Vector b = core::duplicate(at), x = core::duplicate(at);
  core::check(VecSet(x.get(), ambient));
  energy.residual(x.get(), b.get());
  core::check(VecSet(x.get(), 0));
  core::LinearSolver ksp;
  core::check(KSPCreate(PETSC_COMM_WORLD, ksp.put()));
  core::check(KSPSetOperators(ksp.get(), energy.jacobian(), energy.jacobian()));
  core::check(KSPSetType(ksp.get(), KSPGMRES));
  core::check(KSPSetPCSide(ksp.get(), PC_RIGHT));
  core::check(KSPSetTolerances(ksp.get(), 1e-10, 0, PETSC_DEFAULT, PETSC_DEFAULT));
  PC pc = nullptr;
  core::check(KSPGetPC(ksp.get(), &pc));
  core::Gate gate(PETSC_COMM_WORLD);
  core::set_shell(pc, gate, [&](Vec r, Vec y) { energy.precondition(r, y); });
  core::check(KSPSolve(ksp.get(), b.get(), x.get()));
  PetscInt iterations = 0;
  core::check(KSPGetIterationNumber(ksp.get(), &iterations));
  return static_cast<int>(iterations);
}

void row(double wanted, const Case& c, double stream) {
  const thermal::Mesh mesh = mesh_of(wanted, c);
  const thermal::Rows rows(mesh, PETSC_COMM_WORLD);
  const double clearance = c.gas ? 2e-5 : 1.45e-4, attitude = c.gas ? 0 : 310 * std::numbers::pi / 180;
  std::vector<double> h;
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < mesh.around; ++i)
      h.push_back(clearance * (1 - c.eccentricity * std::cos(mesh.theta(i) - attitude)));
  const thermal::ThdSetup setup = setup_of(mesh, c);
  const double n = static_cast<double>(mesh.around) * mesh.nodes_along() * mesh.across;
  const bool prints = core::rank_of(PETSC_COMM_WORLD) == 0;
  if (c.pressure_only) {
    thermal::FilmFlow film(rows, setup.flow, h);
    film.set_temperature(std::vector<double>(h.size() * static_cast<std::size_t>(mesh.across), setup.ambient));
    int newton[2] = {};
    const bench::Timing cold = bench::least(PETSC_COMM_WORLD, 1, [&] { newton[0] = film.solve(); });
    film.set_temperature(std::vector<double>(h.size() * static_cast<std::size_t>(mesh.across), setup.ambient + 5));
    const bench::Timing warm = bench::least(PETSC_COMM_WORLD, 1, [&] { newton[1] = film.solve(); });
    const double most = memory();
    if (prints)
      fmt::print("{:9.0f} nodes: {} Newton {:7.2f} s, from 5 K away {} Newton {:7.2f} s, {:6.0f} MB\n", n / mesh.across,
                 newton[0], cold.wall, newton[1], warm.wall, most);
    return;
  }
  auto thd = std::make_unique<thermal::ThdSolver>(rows, setup, h);
  thermal::ThdSolve solved;
  const bench::Timing time = bench::least(PETSC_COMM_WORLD, 1, [&] { solved = thd->solve(); });
  const double most = memory();
  const thermal::EnergyBudget budget = thd->budget();
  double reversed[2] = {};
  for (const double m : thd->flows().around) reversed[m < 0] += 1;
  MPI_Allreduce(MPI_IN_PLACE, reversed, 2, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  // One linear energy equation of this flow, from the ambient's temperature.
  const thermal::Flow flow = thd->flows();
  core::Vector t;
  core::check(DMCreateGlobalVector(rows.cells(), t.put()));
  {
    const core::WriteArray to(t.get());
    std::copy(thd->temperature().begin(), thd->temperature().end(), to.data());
  }
  thd.reset();
  const double k = setup.flow.fluid.conductivity;
  const thermal::Wall wall{thermal::Energy::half_layer(rows, k, h), std::vector<double>(h.size(), setup.ambient)};
  const auto equation = [&](int order) {
    return std::make_unique<thermal::Energy>(rows, flow, thermal::EnergyModel{setup.flow.fluid.heat_capacity, k, order},
                                             h, thermal::Surroundings{wall, wall, setup.ambient, {}, {}});
  };
  int second_its = 0;
  bench::Timing second;
  {
    const auto energy = equation(2);
    second = bench::least(PETSC_COMM_WORLD, 1, [&] { second_its = solve_linearised(*energy, t.get(), setup.ambient); });
  }
  const auto energy = equation(1);
  core::check(VecSet(t.get(), setup.ambient));
  thermal::EnergySolve linear;
  const bench::Timing one = bench::least(PETSC_COMM_WORLD, 1, [&] { linear = energy->solve(t.get()); });
  if (!prints) return;
  fmt::print(
      "{:9.0f} {:>4} {:4.2f} {:3} {:6.1f} {:6} {:6} {:6} {:6} {:6} {:8.2f} {:8.2f} {:8.2f} {:7.2f} {:7.2f} {:7.2f} "
      "{:6.2f} "
      "{:3} "
      "{:6.1f} {:6.2f} {:3} {:6.1f} {:7.0f} {:6.0f} {:8.1e} {:6.1f} {}\n",
      n, c.gas ? "gas" : "oil", c.eccentricity, c.order, 100 * reversed[1] / n, solved.iterations, solved.pressure,
      solved.energy_newton, solved.energy_krylov, solved.solid, time.wall, time.processor, solved.seconds.pressure,
      solved.seconds.flow, solved.seconds.energy, solved.seconds.solids, one.wall, linear.krylov,
      time.processor / one.processor, second.wall, second_its, time.processor / second.processor, most, 1e6 * most / n,
      budget.residual() / budget.heat, stream, solved.converged ? "" : "not converged");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  core::Session session(argc, argv);
  Case c;
  std::vector<double> meshes;
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const bool more = k + 1 < argc;
    if (word == "--fluid" && more)
      c.gas = std::string(argv[++k]) != "oil";
    else if (word == "--order" && more)
      c.order = std::atoi(argv[++k]);
    else if (word == "--eccentricity" && more)
      c.eccentricity = std::atof(argv[++k]);
    else if (word == "--speed" && more)
      c.speed = std::atof(argv[++k]);
    else if (word == "--layers" && more)
      c.layers = std::atoi(argv[++k]);
    else if (word == "--walls" && more)
      c.solids = std::string(argv[++k]) == "solid";
    else if (word == "--reynolds")
      c.reynolds = true;
    else if (word == "--pressure")
      c.pressure_only = true;
    else if (const std::string before = argv[k - 1]; word[0] != '-' && (before[0] != '-' || before[1] == '-'))
      meshes.push_back(std::stod(word));  // not the value of an option of PETSc
  }
  if (meshes.empty()) meshes = {291600, 1e6, 3e6};
  const double stream = triad();
  if (core::rank_of(PETSC_COMM_WORLD) == 0 && !c.pressure_only)
    fmt::print(
        "{:>9} {:>4} {:>4} {:>3} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>8} {:>8} {:>8} {:>7} {:>7} {:>7} {:>6} {:>3} "
        "{:>6} {:>6} {:>3} {:>6} "
        "{:>7} "
        "{:>6} {:>8} {:>6}\n",
        "bricks", "", "ecc", "ord", "rev. %", "rounds", "press.", "newton", "krylov", "solid", "s", "proc. s",
        "pressure", "flow", "energy", "solids", "linear", "its", "ratio", "second", "its", "ratio", "MB", "B/c",
        "balance", "triad");
  for (const double cells : meshes) row(cells, c, stream);
}
