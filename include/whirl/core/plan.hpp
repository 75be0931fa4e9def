#pragma once
// How to solve: every choice between two ways to one answer, by sizes or by a PETSc option, stands here. Counts decide,
// never clocks, so that a choice repeats itself on any number of ranks. Who holds what is chosen in study/layout.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

namespace whirl::core::plan {

/// A PETSc option that chooses a way, or says up to which size one is taken.
struct SolverOption {
  const char* name;       ///< with its prefix
  const char* otherwise;  ///< what holds where it is not given
  const char* text;
};
[[nodiscard]] std::span<const SolverOption> options();

/// A solver of PETSc or SLEPc: all its options begin with `name`.
struct Prefix {
  const char *name, *text;
};
[[nodiscard]] std::span<const Prefix> prefixes();

// Each of the following may be decided by an option; core::InputError, on all ranks, where its value is no way.

/// How the intervals of a cycle are joined: by one dense matrix, by sweeps of columns, by modes in time.
enum class CycleWay { dense, sweeps, modes };
/// What each costs, in the unit of cost.hpp.
struct CycleCosts {
  double dense, sweeps, modes;
};
/// Sweeps want `films` with states, modes in time Radau points and a machine that is linear but for thin forces
/// (`linear`); else the matrix is dense.
[[nodiscard]] CycleWay cycle(const CycleCosts& costs, bool films, bool linear);

/// Factors of a step in time on one rank.
enum class StepWay { dense, sparse };
[[nodiscard]] StepWay step(std::int64_t states, std::int64_t entries);

/// Products of a stage with the linear blocks of a machine, or with its sparse matrix of so many entries.
[[nodiscard]] StepWay rates(std::int64_t states, std::int64_t entries);

/// A level of a multigrid cycle around a ring: all lines on every rank, or a share on each.
enum class LevelWay { repeated, shared };
[[nodiscard]] LevelWay level(std::int64_t lines, std::int64_t line, int ranks);

/// Where the modes of a machine of parts are sought: in its pencil, or by the transfer functions of its films.
enum class ModesWay { whole, transfer };
[[nodiscard]] ModesWay modes(std::int64_t states);

/// Parts of a machine by inverses of their own, where they have some, or by factors.
enum class PartsWay { own, factors };
[[nodiscard]] PartsWay parts();

/// Pressure of a film with heat: MUMPS, or BoomerAMG.
enum class PressureWay { direct, multigrid };
[[nodiscard]] PressureWay pressure(std::int64_t nodes);

/// Whether a film of `cells` cells starts from its solution on half the intervals. `above` [cells] is the limit of its
/// deck; 0: never.
[[nodiscard]] bool starts_coarse(double cells, int above);

/// Parts up to this size keep their factors from one frequency to the next, and with them the analysis of the pattern.
/// Factors of larger ones would fill the memory; where they have inverses of their own, these are used instead.
[[nodiscard]] std::int64_t kept_states();
/// Machines with up to this many states are factorised where approximate inverses of their parts do not serve.
[[nodiscard]] std::int64_t whole_states();
/// Products with the monodromy matrix in one search for multipliers, at most.
[[nodiscard]] std::int64_t products();
/// What is said where a machine has more.
[[nodiscard]] std::string too_large(std::int64_t states);

/// Sweeps over the columns of a film's energy equation; 0: as the flow wants.
[[nodiscard]] int energy_sweeps();
/// Whether each field of a part stands by itself in PCFIELDSPLIT.
[[nodiscard]] bool splits_quantities();
/// Whether steps in time, whose options begin with `prefix`, take assembled matrices, and whether PETSc makes them.
[[nodiscard]] bool assembles_steps(const std::string& prefix, bool otherwise);
[[nodiscard]] bool steps_by_petsc(const std::string& prefix);
/// The relative tolerance of a linear solver, where an option gives it.
[[nodiscard]] std::optional<double> tolerance(const std::string& prefix);

/// Says to the innermost Record which way was taken; nothing without one.
void note(CycleWay way);
void note(StepWay way);
void note(ModesWay way);
void note(PressureWay way);

/// Collects while it lives what note() says, of each kind the first: later ones belong to other meshes.
class Record {
public:
  Record();
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;
  ~Record();
  /// "cycles by sweeps over the intervals; modes by transfer functions of the films"; empty if nothing was chosen.
  [[nodiscard]] std::string text() const;
  void add(const char* kind, const char* way) { ways_.try_emplace(kind, way); }

private:
  std::map<std::string, std::string> ways_;
  Record* outer_;
};

}  // namespace whirl::core::plan
