#pragma once
// What a machine asks of its parts.

#include <petscvec.h>

#include <span>
#include <string>
#include <vector>

#include "whirl/problem/system.hpp"

namespace whirl::system {

/// A state of the machine, and how its shaft turns there.
struct Instant {
  double angle;         // rad
  double speed;         // Omega [rad/s]
  double acceleration;  // alpha [rad/s^2]
  bool forcing;         // unbalance acts
  Vec x, xdot;
};

/// Rows of one part of a machine: the hub (rotor and pedestals) or a film. Parts are joined at ports, and nothing else
/// couples them: the hub moves the ports, the other parts see these motions and return forces there. Every part is
/// asked on all ranks, and each answers with its rows there.
class Part {
public:
  Part() = default;
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
  virtual ~Part() = default;
  /// First local row and state, and their number; zero where the part has none on this rank.
  [[nodiscard]] virtual PetscInt row() const = 0;
  [[nodiscard]] virtual PetscInt rows() const = 0;
  /// Its fields on this rank, by the name of the part; none if it has no rows on any rank.
  [[nodiscard]] virtual std::vector<problem::Field> fields(const std::string& name) const = 0;
  /// Typical magnitudes of its states and rows here [rows()].
  virtual void scales(double* states, double* rows) const = 0;
  /// f [rows()] = its rows, the forces at the ports of other parts left out. Films: as evaluated last. Collective.
  virtual void residual(const Instant& at, double* f) const = 0;
  /// f [rows()] = their derivatives in the speed, likewise.
  virtual void speed_derivative(const Instant& at, double* f) const = 0;
};

}  // namespace whirl::system
