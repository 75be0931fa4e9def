#include "whirl/core/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <petscsys.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string_view>
#include <vector>

#include "whirl/core/cost.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::core::plan {
namespace {

constexpr SolverOption table[] = {
    {"-cycles_by", "automatic", "`dense`, `sweeps` or `modes`: how the intervals of a cycle are joined"},
    {"-film_energy_sweeps", "0",
     "sweeps over the columns of a film's energy equation; 0: two, four where flow reverses"},
    {"-film_pressure_direct_nodes", "2000",
     "nodes of a film with heat up to which MUMPS solves its pressure, above BoomerAMG"},
    {"-levels_by", "automatic",
     "`repeated` or `shared`: coarse levels of multigrid around a ring on every rank, or a share on each"},
    {"-modes_by", "automatic",
     "`whole` or `transfer`: modes from the pencil of a machine with films, or by their transfer functions"},
    {"-modes_whole_states", "100000",
     "states of a machine with films up to which the pencil is searched: a limit of memory"},
    {"-monodromy_products", "500",
     "products after which a search for multipliers is given up; there may be a second search, above 0.5"},
    {"-motion_assembled", "0", "1: steps in time take matrices of all states, for comparison"},
    {"-motion_ts_type", "", "a scheme of PETSc makes the steps in time"},
    {"-newton_split_quantities", "0", "1: each field of a part stands by itself in `-newton_pc_type fieldsplit`"},
    {"-parts_by", "automatic", "`own` or `factors`: films by inverses of their own where they have some, or by LU"},
    {"-parts_kept_states", "20000",
     "states of a film up to which its factors are kept from one frequency to the next, above FGMRES solves"},
    {"-parts_whole_states", "1000000",
     "states of the largest machine that is factorised where FGMRES fails, and for transposes"},
    {"-rates_by", "automatic",
     "`dense` or `sparse`: products of Runge-Kutta stages with the blocks of a machine, or with its matrix"},
    {"-steps_by", "automatic", "`dense` or `sparse`: factors of steps in time on one rank"},
    {"-thd_coarse_start", "of the deck",
     "cells above which a film with heat starts from its solution on half the intervals; 0: never"},
};

constexpr Prefix solvers[] = {
    {"bordered_", "GMRES of the bordered monodromy matrix"},
    {"bush_", "temperature of a bush"},
    {"enforced_", "a film under an enforced motion"},
    {"equilibrium_", "FGMRES of equilibria of machines with films"},
    {"film_energy_", "temperature of a film"},
    {"film_pressure_", "pressure of a film with heat"},
    {"floquet_", "multipliers from dense matrices"},
    {"forces_", "GMRES of cycles joined by modes in time"},
    {"frequency_", "FGMRES of films at a frequency"},
    {"hub_", "the rest of a machine without its films"},
    {"interval_", "FGMRES of an interval of a cycle with its states spread"},
    {"journal_", "temperature of a journal"},
    {"modes_", "eigenvalues of the pencil"},
    {"motion_", "steps of PETSc in time"},
    {"newton_", "Newton's method on branches"},
    {"parts_", "films of a machine, each by itself"},
    {"rest_", "an equilibrium from the rest of films"},
    {"rotor_", "modes of the shaft alone"},
    {"rotor_states_", "modes of a shaft in its state-space reduction"},
    {"stage_", "stages of steps in time, of cycles and motions"},
    {"start_", "the first guess of an equilibrium"},
    {"tangent_", "linear equations at a solution of a branch"},
    {"thd_", "rounds between a film and its solids"},
    {"turn_", "GMRES of cycles joined by sweeps"},
};

const char* otherwise(const char* name) {
  const auto* row = std::ranges::find(table, std::string_view(name), &SolverOption::name);
  require(row != std::end(table), "an option of the table");
  return row->otherwise;
}

std::int64_t number(const char* name, std::optional<int> own = {}) {
  const std::string_view given = otherwise(name);
  PetscInt value = own.value_or(0);
  if (!own) std::from_chars(given.data(), given.data() + given.size(), value);
  check(PetscOptionsGetInt(nullptr, nullptr, name, &value, nullptr));
  return value;
}

bool flag(const std::string& name, bool without) {
  PetscBool value = without ? PETSC_TRUE : PETSC_FALSE;
  check(PetscOptionsGetBool(nullptr, nullptr, name.c_str(), &value, nullptr));
  return value == PETSC_TRUE;
}

// The way that an option names, of those with these words; nothing where it leaves the choice to the counts.
template <class Way>
std::optional<Way> asked(const char* name, std::initializer_list<const char*> words) {
  std::array<char, 32> text{};
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, nullptr, name, text.data(), text.size(), &given));
  const std::string_view way = given == PETSC_TRUE ? text.data() : otherwise(name);
  if (way == "automatic") return {};
  for (int k = 0; const char* word : words) {
    if (way == word) return static_cast<Way>(k);
    ++k;
  }
  InputError wrong(fmt::format("PETSc option {} {}: it is one of {}, automatic", name, way, fmt::join(words, ", ")));
  wrong.mark_agreed();
  throw wrong;
}

// Choices are made deep inside solvers, whose callers do not ask for them.
Record*& innermost() {
  static Record* record = nullptr;
  return record;
}

void note(const char* kind, const char* way) {
  if (innermost()) innermost()->add(kind, way);
}

}  // namespace

std::span<const SolverOption> options() {
  return table;
}

std::span<const Prefix> prefixes() {
  return solvers;
}

CycleWay cycle(const CycleCosts& costs, bool films, bool linear) {
  const auto way = asked<CycleWay>("-cycles_by", {"dense", "sweeps", "modes"});
  const CycleWay other = films ? CycleWay::sweeps : CycleWay::modes;
  if ((!films && !linear) || (way && *way != other)) return CycleWay::dense;
  return way || (films ? costs.sweeps : costs.modes) < costs.dense ? other : CycleWay::dense;
}

StepWay step(std::int64_t states, std::int64_t entries) {
  if (const auto way = asked<StepWay>("-steps_by", {"dense", "sparse"})) return *way;
  return cost::dense_is_cheaper(cost::Work::step, states, entries) ? StepWay::dense : StepWay::sparse;
}

StepWay rates(std::int64_t states, std::int64_t entries) {
  if (const auto way = asked<StepWay>("-rates_by", {"dense", "sparse"})) return *way;
  return cost::dense_is_cheaper(cost::Work::product, states, entries) ? StepWay::dense : StepWay::sparse;
}

LevelWay level(std::int64_t lines, std::int64_t line, int ranks) {
  if (ranks == 1) return LevelWay::shared;
  if (const auto way = asked<LevelWay>("-levels_by", {"repeated", "shared"})) return *way;
  return cost::repeated_level(lines, line, ranks) < cost::exchanged_level() ? LevelWay::repeated : LevelWay::shared;
}

ModesWay modes(std::int64_t states) {
  if (const auto way = asked<ModesWay>("-modes_by", {"whole", "transfer"})) return *way;
  // A limit of memory, which transfer functions spare: at 158 104 states both ways take the same time (docs/speed.md).
  return states > number("-modes_whole_states") ? ModesWay::transfer : ModesWay::whole;
}

PartsWay parts() {
  return asked<PartsWay>("-parts_by", {"own", "factors"}).value_or(PartsWay::own);
}

// Multigrid is quicker above, 0.09 s to 7.6 s in 43 steps with 2,400 nodes on a busy machine: see docs/speed.md.
PressureWay pressure(std::int64_t nodes) {
  return nodes > number("-film_pressure_direct_nodes") ? PressureWay::multigrid : PressureWay::direct;
}

bool starts_coarse(double cells, int above) {
  const std::int64_t most = number("-thd_coarse_start", above);
  return most > 0 && cells > static_cast<double>(most);
}

std::int64_t kept_states() {
  return number("-parts_kept_states");
}

std::int64_t products() {
  return number("-monodromy_products");
}

std::int64_t whole_states() {
  return number("-parts_whole_states");
}

std::string too_large(std::int64_t states) {
  return fmt::format("the {} states of the machine are more than -parts_whole_states {} allows to factorise", states,
                     whole_states());
}

int energy_sweeps() {
  return static_cast<int>(number("-film_energy_sweeps"));
}

bool splits_quantities() {
  return flag("-newton_split_quantities", false);
}

bool assembles_steps(const std::string& prefix, bool without) {
  return flag("-" + prefix + "assembled", without);
}

bool steps_by_petsc(const std::string& prefix) {
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsHasName(nullptr, nullptr, ("-" + prefix + "ts_type").c_str(), &given));
  return given == PETSC_TRUE;
}

std::optional<double> tolerance(const std::string& prefix) {
  PetscReal value = 0;
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetReal(nullptr, prefix.c_str(), "-ksp_rtol", &value, &given));
  return given == PETSC_TRUE ? std::optional(value) : std::nullopt;
}

void note(CycleWay way) {
  note("cycles", way == CycleWay::dense    ? "one dense matrix"
                 : way == CycleWay::sweeps ? "sweeps over the intervals"
                                           : "modes in time");
}
void note(StepWay way) {
  note("steps", way == StepWay::dense ? "dense factors" : "sparse factors");
}
void note(ModesWay way) {
  note("modes", way == ModesWay::whole ? "the pencil of the whole machine" : "transfer functions of the films");
}
void note(PressureWay way) {
  note("pressure", way == PressureWay::direct ? "MUMPS" : "BoomerAMG");
}

Record::Record() : outer_(innermost()) {
  innermost() = this;
}
Record::~Record() {
  innermost() = outer_;
}
std::string Record::text() const {
  std::vector<std::string> all;
  for (const auto& [kind, way] : ways_) all.push_back(kind + " by " + way);
  return fmt::format("{}", fmt::join(all, "; "));
}

}  // namespace whirl::core::plan
