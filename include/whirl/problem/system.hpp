#pragma once
// The one equation of Whirl: F(angle, x, dx/dt; p) = 0.

#include <petscmat.h>
#include <petscvec.h>

#include <memory>
#include <string>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/problem/entries.hpp"
#include "whirl/problem/kinematic.hpp"
#include "whirl/problem/part_inverse.hpp"

namespace whirl::problem {

class BlockStructure;

/// States of one kind of one part (a body or a film) on this rank: local rows [begin, end) of x, and as many again
/// `stride` further on, `repeats` times in all.
struct Field {
  std::string name{};  ///< of the part
  PetscInt begin = 0, end = 0;
  std::string quantity{};  ///< what they are: "thickness"; empty if they differ,
  std::string unit{};      ///< and so is this, and
  double scale = 0.0;      ///< their typical magnitude is zero
  int part = 0;            ///< number of the part, whose fields follow each other: 0 is the hub
  PetscInt stride = 0, repeats = 1;

  /// End of the last of its rows.
  [[nodiscard]] PetscInt last() const { return repeats > 0 ? end + (repeats - 1) * stride : begin; }
  /// visit(row) for each of its rows.
  template <class Visit>
  void each(const Visit& visit) const {
    for (PetscInt r = 0; r < repeats; ++r)
      for (PetscInt i = begin; i < end; ++i) visit(i + r * stride);
  }
};

/// The same with the fields of each part as one, whose rows are [begin, end).
[[nodiscard]] std::vector<Field> parts_of(const std::vector<Field>& fields);

class System;
/// Numbers of the hub's states among all, rising, the same on every rank. Collective.
[[nodiscard]] std::vector<PetscInt> hub_numbers(const System& system);
/// One pass of the entries of alpha dF/dx + sigma dF/d(dx/dt) into `out`: of a system that lists none, from `jacobian`,
/// which is made where it is null. Collective.
void list_entries(System& system, const Point& at, double alpha, double sigma, core::Matrix& jacobian, Entries& out);

/// Everything that moves: F(angle, x, dx/dt; p) = 0 with its exact derivatives, on one communicator.
///
/// The state x is distributed by rows in natural order: entry k means the same on any number of ranks. Forcing depends
/// on the shaft angle and the speed, never on time itself, so that dF/dp stays bounded on a cycle whose period follows
/// the speed. `p` is the active parameter: the speed [rad/s] unless the system was made with another one. All members
/// are collective on comm() unless they say not.
class System {
public:
  System() = default;
  System(const System&) = delete;
  System& operator=(const System&) = delete;
  virtual ~System() = default;

  [[nodiscard]] virtual MPI_Comm comm() const = 0;
  /// Number of states over all ranks / on this rank. Not collective.
  [[nodiscard]] virtual PetscInt size() const = 0;
  [[nodiscard]] virtual PetscInt local_size() const = 0;

  /// Active parameter and shaft speed [rad/s]. Not collective.
  [[nodiscard]] virtual double parameter() const = 0;
  virtual void set_parameter(double p) = 0;
  [[nodiscard]] virtual double speed() const = 0;
  /// True if the parameter is the speed, so that a forced cycle's period changes with it. Not collective.
  [[nodiscard]] virtual bool parameter_is_speed() const = 0;

  /// f = F(angle [rad], x, xdot). Throws core::DomainError on all ranks outside the validity of a film.
  virtual void residual(double angle, Vec x, Vec xdot, Vec f) = 0;
  /// A matrix with the nonzero pattern of dF/dx + sigma dF/d(dx/dt).
  [[nodiscard]] virtual core::Matrix make_jacobian() = 0;
  /// j = alpha dF/dx + sigma dF/d(dx/dt) at (angle, x, xdot).
  virtual void jacobian(double angle, Vec x, Vec xdot, double alpha, double sigma, Mat j) = 0;
  /// One pass of the same entries into `out`, for whoever needs no assembled matrix: false, and nothing done, of a
  /// system that knows its matrix only as a whole. The same answer on all ranks.
  virtual bool entries(double /*angle*/, Vec /*x*/, Vec /*xdot*/, double /*alpha*/, double /*sigma*/,
                       Entries& /*out*/) {
    return false;
  }
  /// f = dF/dp at fixed angle, x and xdot.
  virtual void parameter_derivative(double angle, Vec x, Vec xdot, Vec f) = 0;

  /// Typical magnitude of each state and of each row of F, all positive, in SI: solvers work on x/state_scale and
  /// F/residual_scale.
  virtual void scales(Vec state_scale, Vec residual_scale) = 0;

  /// All states, the same fields on every rank: first the hub, to which the other parts are joined by few of its
  /// states; these do not see each other. Not collective.
  [[nodiscard]] virtual std::vector<Field> fields() const { return {{"state", 0, local_size()}}; }

  /// The rows of the hub that say which of its states are rates of others, the same on every rank: solvers eliminate
  /// them. Numbers of all states. Not collective.
  [[nodiscard]] virtual std::vector<KinematicRow> kinematic() const { return {}; }

  /// Whether some states follow the others at once in equilibrium, through equations that are only piecewise smooth, so
  /// that settle() finds them. Not collective, the same on all ranks.
  [[nodiscard]] virtual bool settles() const { return false; }
  /// Brings these states in x to where their own equations at rest hold, the others unchanged. Newton's method on the
  /// whole does so along its steps: which nodes of a film are full is then never asked of a line search. Throws
  /// core::DomainError or core::NotConverged, agreed on all ranks; x is then as it was or partly settled.
  virtual void settle(Vec /*x*/) {}

  /// A new one where every part but the hub offers an approximate inverse, else null, on all ranks. Collective.
  [[nodiscard]] virtual std::unique_ptr<PartInverse> make_part_inverse() { return nullptr; }

  /// Linear blocks and thin couplings if this rank holds the whole system (communicator of size 1) and it has them,
  /// else nullptr. Not collective.
  [[nodiscard]] virtual BlockStructure* structure() { return nullptr; }
};

}  // namespace whirl::problem
