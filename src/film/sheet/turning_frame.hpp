#pragma once
// The frame in which the inlet of a film at the maximum gap stands still.

#include "whirl/film/contract/response.hpp"

namespace whirl::film {

/// Axes x', y' with x' from the journal's centre to that of the bearing, where the gap of a round bore is largest:
/// x' = (-e, 0). With R the rotation by the angle phi of x', block by block for position and slopes, and G the force of
/// the film whose inlet is fixed at x',
///
///     F(x, v) = R G(R^T x, R^T v),    dF/dx = R (G_x + q g^T) R^T,    dF/dv = R G_v R^T
///     q = J G - G_x J x' - G_v J v',  g = (0, -1/e, 0, 0) = R^T dphi/dx,  J a turn by 90 deg.
///
/// At the centre of the bearing phi is a limit that depends on the direction: F is continuous there for a journal at
/// rest only, whose tangent is that of F = R(phi) G_x (-e, 0) with a small e; it is taken for a moving journal as well,
/// and phi as 90 deg.
class TurningFrame {
public:
  /// `length` [m]: a billionth of it counts as the centre.
  TurningFrame(const JournalMotion& motion, double length);
  /// The motion seen from the frame.
  [[nodiscard]] const JournalMotion& motion() const { return motion_; }
  /// phi [rad]
  [[nodiscard]] double angle() const;
  /// Turns the response of the film seen from the frame into the axes of the bearing, with the turn's own derivative.
  void turn_back(Need need, Response& response) const;

private:
  JournalMotion motion_;
  double cosine_, sine_, eccentricity_;
  bool centred_;
};

}  // namespace whirl::film
