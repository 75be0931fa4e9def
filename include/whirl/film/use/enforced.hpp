#pragma once
// Stiffness and damping of a film from the forces that a harmonic motion of its journal causes, however large.

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// Forces along all ports of a film by a motion of the journal along one: -F_i = k_i q + b_i q' + a constant, by least
/// squares over one period. Zero beyond the film's ports.
struct EnforcedForces {
  std::array<double, 4> stiffness{}, damping{};
  std::array<double, 4> mean{};  ///< of each force less that at rest [N, N m]
  /// What the two terms leave of the forces (of slopes: moments) about their mean, as a ratio of root mean squares;
  /// zero of a linear film.
  double distortion = 0;
  double tail = 0;             ///< size of the highest two harmonics of these forces over that of the first
  int points = 0;              ///< of time in the period
  int newton = 0, krylov = 0;  ///< steps and iterations with them
};

/// The journal of a film goes to and fro about a place of rest along one port,
///
///     q = A sin(omega t),   q' = A omega cos(omega t),
///
/// until the film repeats itself: states s_k at N = 2 H + 1 equal points of the period with
///
///     g(w(t_k), s_k, sum_j D_kj s_j) = 0,   D_kj = (-1)^(k-j) omega/(2 sin(pi (k-j)/N)),
///
/// D the derivative of the trigonometric polynomial through the points. All are found at once by Newton's method with
/// the exact derivatives; its linear equations by GMRES, preconditioned by dg/ds + i k omega dg/ds' at rest, harmonic
/// by harmonic, which of small amplitudes is exact. N doubles until the tail is small. Not thread-safe.
/// Source: Skarolek (2011) secs. 3.4.1, 3.4.3 with the velocity of (3.40) as above; there by steps in time.
class Enforced {
public:
  /// @param rest,states journal at rest and the film that has come to rest with it
  /// @param omega frequency of the motion [rad/s], positive
  Enforced(Film& film, const JournalMotion& rest, std::vector<double> states, double omega);
  ~Enforced();
  /// @param port number of the port along which the journal moves, in the film's order
  /// @param amplitude 0 to peak [m, of slopes 1], positive
  /// Throws core::DomainError where the surfaces touch on the way, core::NotConverged where no such film is found.
  [[nodiscard]] EnforcedForces along(std::size_t port, double amplitude);
  /// Bytes that this takes at most, of a film with `states` states on a mesh.
  [[nodiscard]] static double memory(double states);

private:
  struct Factors;
  class Period;
  Film& film_;
  JournalMotion rest_;
  std::vector<double> states_;
  double omega_;
  std::array<double, 4> force_{};     // at rest
  std::unique_ptr<Factors> factors_;  // of the harmonics so far
};

}  // namespace whirl::film
