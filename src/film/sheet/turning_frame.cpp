#include "film/sheet/turning_frame.hpp"

#include <cmath>

namespace whirl::film {
namespace {

using Four = std::array<double, 4>;

Four turned(const Four& v, double cosine, double sine) {
  return {cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1], cosine * v[2] - sine * v[3],
          sine * v[2] + cosine * v[3]};
}

Four quarter(const Four& v) {
  return {-v[1], v[0], -v[3], v[2]};
}

// R M R^T
void turn(std::array<Four, 4>& m, double cosine, double sine) {
  for (Four& row : m) row = turned(row, cosine, sine);
  for (std::size_t j = 0; j < 4; ++j) {
    const Four column = turned({m[0][j], m[1][j], m[2][j], m[3][j]}, cosine, sine);
    for (std::size_t i = 0; i < 4; ++i) m[i][j] = column[i];
  }
}

}  // namespace

TurningFrame::TurningFrame(const JournalMotion& motion, double length)
    : eccentricity_(std::hypot(motion.position[0], motion.position[1])), centred_(eccentricity_ <= 1e-9 * length) {
  cosine_ = centred_ ? 0.0 : -motion.position[0] / eccentricity_;
  sine_ = centred_ ? 1.0 : -motion.position[1] / eccentricity_;
  // A film without any pressure does not know which half of it carries.
  if (centred_) eccentricity_ = 1e-9 * length;
  motion_ = {turned(motion.position, cosine_, -sine_), turned(motion.velocity, cosine_, -sine_), motion.speed};
  motion_.position[0] = -eccentricity_;
  motion_.position[1] = 0.0;
}

double TurningFrame::angle() const {
  return std::atan2(sine_, cosine_);
}

void TurningFrame::turn_back(Need need, Response& r) const {
  if (need == Need::tangents) {
    const auto along = [](const std::array<Four, 4>& m, const Four& v) {
      Four out{};
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) out[i] += m[i][j] * v[j];
      return out;
    };
    const Four straight = quarter({r.d_position[0][0], r.d_position[1][0], r.d_position[2][0], r.d_position[3][0]});
    const Four force = quarter(r.force), moved = along(r.d_position, quarter(motion_.position)),
               driven = along(r.d_velocity, quarter(motion_.velocity));
    for (std::size_t i = 0; i < 4; ++i) {
      if (centred_)
        r.d_position[i][1] = straight[i];
      else
        r.d_position[i][1] -= (force[i] - moved[i] - driven[i]) / eccentricity_;
    }
    turn(r.d_position, cosine_, sine_);
    turn(r.d_velocity, cosine_, sine_);
    r.d_speed = turned(r.d_speed, cosine_, sine_);
  }
  r.force = turned(r.force, cosine_, sine_);
}

}  // namespace whirl::film
