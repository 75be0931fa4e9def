// The mesh of a pad, and the coefficients of its equation at a motion of the journal.
#include "film/sheet/pad_equations.hpp"

#include <cmath>

#include "film/sheet/groove.hpp"

namespace whirl::film {

PadEquations::PadEquations(const Pad& pad, const Reynolds& options, const Lubricant& lubricant)
    : pad_(pad),
      grid_(pad, options.cells),
      least_(pad),
      tilt_(options.tilt),
      whole_(options.tilt || !options.holes.empty()),
      resistance_around_(resistance_around(options.turbulence)),
      resistance_along_(resistance_along(options.turbulence)),
      viscosity_(lubricant.viscosity),
      density_(lubricant.density),
      rows_(whole_ ? grid_.n_z - 1 : grid_.n_z / 2),
      z_faces_(whole_ ? rows_ + 1 : rows_),
      last_share_(!whole_ && grid_.n_z % 2 == 0 ? 0.5 : 1.0),
      first_(pad.closed ? 0 : 1),
      holes_(pad_, grid_, options.holes) {
  for (const Hole& hole : options.holes) hole_pressure_.push_back(hole.pressure);
  const auto n = static_cast<std::size_t>(grid_.n_theta);
  a_.resize(whole_ ? n * static_cast<std::size_t>(rows_) : n);
  b_.resize(whole_ ? n * static_cast<std::size_t>(z_faces_) : n);
  source_.assign((n - static_cast<std::size_t>(first_)) * static_cast<std::size_t>(rows_), 0.0);
  if (!pad.closed) return;
  grooves_ = grooved(grid_.n_theta, options.grooves);
  groove_pressure_ = pressures_in_grooves(grid_.n_theta, options.grooves);
}

void PadEquations::coefficients(const JournalMotion& motion) {
  conductances(motion);
  for (int i = first_; i < grid_.n_theta; ++i) source(motion, i);
}

void PadEquations::conductances(const JournalMotion& motion) {
  const int n = grid_.n_theta;
  speed_ = motion.speed;
  ahead_ = speed_ < 0.0 ? -1 : 1;
  X_ = motion.position[0] - pad_.centre_x;
  Y_ = motion.position[1] - pad_.centre_y;
  tx_ = tilt_ ? motion.position[2] : 0.0;
  ty_ = tilt_ ? motion.position[3] : 0.0;
  const double c = pad_.clearance;
  h_min_ = least_(X_, Y_, tx_, ty_);
  require_thickness(h_min_);

  const int a_columns = whole_ ? rows_ : 1, b_columns = whole_ ? z_faces_ : 1;
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    for (int j = 0; j < a_columns; ++j) {
      const double z = row_z(j);
      a_.h[around(i, j)] = c - (X_ + z * tx_) * grid_.face_cos[k] - (Y_ + z * ty_) * grid_.face_sin[k];
    }
    for (int j = 0; j < b_columns; ++j) {
      const double z = row_z(j) - 0.5 * grid_.dz;
      b_.h[along(i, j)] = c - (X_ + z * tx_) * grid_.node_cos[k] - (Y_ + z * ty_) * grid_.node_sin[k];
    }
  }
  const double step = pad_.radius * grid_.dtheta, speed = motion.speed;
  const double inverse_speed = speed == 0.0 ? 0.0 : 1.0 / speed;
  const double reynolds_per_h = density_ * std::abs(speed) * pad_.radius / viscosity_;
  const auto mobilities = [&](Faces& f, const Resistance& resistance, double length) {
    mobility(resistance, {1.0 / (viscosity_ * length * length), reynolds_per_h, inverse_speed},
             static_cast<int>(f.h.size()), f.h.data(), f.value.data(), f.d_h.data(), f.d_speed.data());
  };
  mobilities(a_, resistance_around_, step);
  mobilities(b_, resistance_along_, grid_.dz);
  const auto shorten = [](Faces& f, std::size_t face, double longer) {
    for (auto* v : {&f.value, &f.d_h, &f.d_speed}) (*v)[face] *= longer;
  };
  for (const HoleMesh::Cut& cut : holes_.around()) shorten(a_, around(cut.i, cut.j), cut.longer);
  for (const HoleMesh::Cut& cut : holes_.along()) shorten(b_, along(cut.i, cut.j), cut.longer);
}

// Exact cell means of (Omega/2) dh/dtheta + dh/dt.
void PadEquations::source(const JournalMotion& motion, int column) {
  const double txd = tilt_ ? motion.velocity[2] : 0.0, tyd = tilt_ ? motion.velocity[3] : 0.0, speed = motion.speed;
  const auto k = static_cast<std::size_t>(column);
  for (int j = 0; j < rows_; ++j) {
    const double z = row_z(j);
    const double sine = 0.5 * speed * (X_ + z * tx_) - (motion.velocity[1] + z * tyd);
    const double cosine = 0.5 * speed * (Y_ + z * ty_) + (motion.velocity[0] + z * txd);
    source_[at(column, j)] = share(j) * grid_.mean * (sine * grid_.node_sin[k] - cosine * grid_.node_cos[k]);
  }
}

}  // namespace whirl::film
