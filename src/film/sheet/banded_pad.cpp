// The equation of a pad, its force without complementarity, and all derivatives by adjoints.
#include <algorithm>
#include <cmath>

#include "film/sheet/banded_pad.hpp"
#include "whirl/thermal/truncation.hpp"

namespace whirl::film {

using thermal::EdgeInterval, thermal::IntervalIntegral, thermal::truncated_edge, thermal::truncated_linear;

BandedPad::BandedPad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant)
    : PadEquations(pad, options, lubricant),
      cavitation_(options.cavitation),
      stiffen_(1.0 + std::pow(4.0 * pad.radius * grid_.dtheta / pad.length, 4)),
      band_((grid_.n_theta - first_) * rows_, (pad.closed ? 2 : 1) * rows_),
      base_(cavitation_ == Reynolds::Cavitation::reynolds ? (grid_.n_theta - first_) * rows_ : 0,
            (pad.closed ? 2 : 1) * rows_) {
  const std::size_t size = source_.size();
  cavitated_.assign(size, 0);
  for (int i = first_; i < grid_.n_theta; ++i)
    for (int j = 0; j < rows_; ++j) cavitated_[at(i, j)] = held(i, j);
  if (cavitation_ == Reynolds::Cavitation::reynolds) enter_ruptured();
  x_.assign(size, 0.0);
  load_.assign(size, Quad::zero());
  if (cavitation_ == Reynolds::Cavitation::mass_conserving) enter_conserving(options.edge_fill);
}

void BandedPad::assemble() {
  core::BandLu& band = cavitation_ == Reynolds::Cavitation::reynolds ? base_ : band_;
  const auto entry = [&](std::size_t row, std::size_t column) -> double& {
    return band.entry(static_cast<int>(row), static_cast<int>(column));
  };
  const auto couple = [&](std::size_t a, std::size_t b, double value) {
    entry(a, b) -= value;
    entry(b, a) -= value;
  };
  band.clear();
  for (int i = first_; i < grid_.n_theta; ++i) {
    for (int j = 0; j < rows_; ++j) {
      const std::size_t here = at(i, j);
      if (cavitated_[here]) {
        entry(here, here) = 1.0;
        continue;
      }
      const double left = share(j) * a_.value[around(wrap(i - 1), j)], right = share(j) * a_.value[around(i, j)];
      const double up = j + 1 < z_faces_ ? b_.value[along(i, j + 1)] : 0.0;
      entry(here, here) = left + right + b_.value[along(i, j)] + up;
      if (j + 1 < rows_ && !cavitated_[here + 1]) couple(here, here + 1, up);
      // Of two neighbours the one that comes first tells.
      for (const auto& [side, value] : {std::pair{i + 1, right}, std::pair{i - 1, left}}) {
        if (wall(side)) continue;
        const std::size_t there = at(wrap(side), j);
        if (there > here && !cavitated_[there]) couple(here, there, value);
      }
    }
  }
}

void BandedPad::solve() {
  if (cavitation_ == Reynolds::Cavitation::reynolds) return solve_ruptured();
  if (cavitation_ == Reynolds::Cavitation::mass_conserving) return solve_conserving();
  assemble();
  band_.factor();
  ++factorisations_;
  for (std::size_t k = 0; k < x_.size(); ++k) x_[k] = cavitated_[k] ? 0.0 : -source_[k];
  band_.solve(false, x_.data(), x_.data(), 1);
}

// Force, and its derivatives in the nodal pressures into load_.
void BandedPad::integrate(Need need, Response& response) {
  if (cavitation_ == Reynolds::Cavitation::reynolds) return integrate_ruptured(need, response);
  if (cavitation_ == Reynolds::Cavitation::mass_conserving) return integrate_conserving(need, response);
  const bool truncated = cavitation_ == Reynolds::Cavitation::half_sommerfeld;
  const double area = pad_.radius * grid_.dtheta * grid_.dz * grid_.mean;
  std::fill(load_.begin(), load_.end(), Quad::zero());
  Quad force = Quad::zero();
  for (int strip = 0; strip < grid_.n_theta; ++strip) {
    const auto face = static_cast<std::size_t>(strip);
    const double cosine = -area * grid_.face_cos[face], sine = -area * grid_.face_sin[face];
    if (wall(strip) && wall(strip + 1)) continue;
    const bool edge = wall(strip) || wall(strip + 1);
    // Left and right column, or near and far column of an edge.
    const int first = wrap(wall(strip) ? strip + 1 : strip), second = wrap(wall(strip) ? strip + 2
                                                                           : edge      ? strip - 1
                                                                                       : strip + 1);
    for (int j = 0; j < rows_; ++j) {
      const double times = whole_ ? 1.0 : 2.0 * share(j), z = tilt_ ? row_z(j) : 0.0;
      const Quad weight = {Quad::Vector{times * cosine, times * sine, times * z * cosine, times * z * sine}};
      Quad &load_first = load_[at(first, j)], &load_second = load_[at(second, j)];
      const double p = x_[at(first, j)], q = x_[at(second, j)];
      double d_p = 0.5, d_q = edge ? 0.0 : 0.5, integral = d_p * p + d_q * q;
      if (truncated && edge) {
        const EdgeInterval part = truncated_edge(p, q);
        integral = part.integral, d_p = part.d_near, d_q = part.d_far;
      } else if (truncated && std::min(p, q) < 0.0) {
        const IntervalIntegral<double> part = truncated_linear(p, q);
        integral = part.integral, d_p = part.d_left, d_q = part.d_right;
      }
      force += integral * weight;
      if (need == Need::force) continue;
      load_first += d_p * weight;
      load_second += d_q * weight;
    }
  }
  for (int f = 0; f < 4; ++f) response.force[static_cast<std::size_t>(f)] += force[f];
}

void BandedPad::adjoint(const JournalMotion& motion, Response& response) {
  for (std::size_t k = 0; k < load_.size(); ++k) {
    if (cavitated_[k]) load_[k] = Quad::zero();
  }
  const bool ruptured = cavitation_ == Reynolds::Cavitation::reynolds;
  const bool conserving = cavitation_ == Reynolds::Cavitation::mass_conserving;
  sides_.resize(std::ssize(load_), tilt_ ? 4 : 2);
  for (Eigen::Index k = 0; k < sides_.rows(); ++k)
    for (int f = 0; f < sides_.cols(); ++f) sides_(k, f) = load_[static_cast<std::size_t>(k)][f];
  band_.solve(conserving, sides_.data(), sides_.data(), sides_.cols());  // the others are symmetric
  for (Eigen::Index k = 0; k < sides_.rows(); ++k)
    for (int f = 0; f < sides_.cols(); ++f) load_[static_cast<std::size_t>(k)].set(f, sides_(k, f));
  // The equation of a node that is held has no derivative; nodes in walls are left out below.
  if (conserving && !holes_.empty())
    for (std::size_t k = 0; k < load_.size(); ++k)
      if (cavitated_[k]) load_[k] = Quad::zero();
  if (ruptured) weigh_ruptured();
  const auto lambda = [&](int i, int j) {
    return wall(i) || j < 0 || j >= rows_ ? Quad::zero() : load_[at(wrap(i), j)];
  };
  // Sums of e = (jump of lambda)(jump of p) over faces, weighted as dh = -cos (dx + z dtx) - sin (dy + z dty) asks, and
  // of lambda over cells as d src asks; lanes are F_x, F_y, M_x, M_y.
  std::array<Quad, 4> position = {Quad::zero(), Quad::zero(), Quad::zero(), Quad::zero()}, source = position;
  Quad speed = Quad::zero();
  const auto spread = [](std::array<Quad, 4>& sums, Quad level, Quad moment, double cosine, double sine) {
    sums[0] += cosine * level;
    sums[1] += sine * level;
    sums[2] += cosine * moment;
    sums[3] += sine * moment;
  };
  for (int i = 0; i < grid_.n_theta; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Quad level = Quad::zero(), moment = Quad::zero();
    for (int j = 0; j < rows_; ++j) {
      Quad e = (share(j) * (pressure_at(i + 1, j) - pressure_at(i, j))) * (lambda(i + 1, j) - lambda(i, j));
      if (ruptured) {
        for (const int node : {i, i + 1})
          if (!wall(node)) e += 0.5 * stiffen_ * by_mobility_[at(wrap(node), j)];
      }
      Quad slope = a_.d_h[around(i, j)] * e;
      if (conserving) {
        const int up = ahead_ > 0 ? i : i + 1;
        const double s = 0.5 * share(j) * deficit_at(up, j) / grid_.dtheta;
        slope += s * (lambda(up + ahead_, j) - lambda(up, j));
        // The deficit given at an edge grows with the speed.
        if (wall(up) && !pad_.closed && void_at_edge_ != 0.0)
          speed += (ahead_ * carried(i, j) * void_at_edge_) * lambda(up + ahead_, j);
      }
      level += slope;
      moment += row_z(j) * slope;
      speed += a_.d_speed[around(i, j)] * e;
    }
    spread(position, level, moment, grid_.face_cos[k], grid_.face_sin[k]);
    if (i < first_) continue;
    level = moment = Quad::zero();
    for (int j = 0; j < z_faces_; ++j) {
      const Quad e = (pressure_at(i, j) - pressure_at(i, j - 1)) * (lambda(i, j) - lambda(i, j - 1));
      const Quad slope = b_.d_h[along(i, j)] * e;
      level += slope;
      moment += (row_z(j) - 0.5 * grid_.dz) * slope;
      speed += b_.d_speed[along(i, j)] * e;
    }
    spread(position, level, moment, grid_.node_cos[k], grid_.node_sin[k]);
    level = moment = Quad::zero();
    for (int j = 0; j < rows_; ++j) {
      const Quad e = ruptured ? (wall(i) ? Quad::zero() : grid_.mean * by_source_[at(i, j)])
                              : (share(j) * grid_.mean) * lambda(i, j);
      level += e;
      moment += row_z(j) * e;
    }
    spread(source, level, moment, grid_.node_cos[k], grid_.node_sin[k]);
  }
  const double half = 0.5 * motion.speed;
  const std::size_t components = tilt_ ? 4 : 2;
  for (std::size_t f = 0; f < components; ++f) {
    const int lane = static_cast<int>(f);
    for (std::size_t j = 0; j < components; ++j) {
      const std::size_t other = j ^ 1;  // x is driven by sin, y by -cos
      const double wedge = (j % 2 == 0 ? half : -half) * source[other][lane];
      response.d_position[f][j] += position[j][lane] - wedge;
      response.d_velocity[f][j] += source[j][lane];
    }
    response.d_speed[f] -= speed[lane] + 0.5 * (X_ * source[1][lane] + tx_ * source[3][lane] - Y_ * source[0][lane] -
                                                ty_ * source[2][lane]);
  }
}

void BandedPad::add(const JournalMotion& motion, Need need, Response& response) {
  if (solved_ != motion) {
    solved_.reset();
    coefficients(motion);
    solve();
    solved_ = motion;
  }
  // The adjoints want the equations at the solution.
  if (need == Need::tangents && stale_) factor_ruptured();
  integrate(need, response);
  response.min_thickness = std::min(response.min_thickness, h_min_);
  if (need == Need::tangents) adjoint(motion, response);
}

void BandedPad::start_from(const PadSolver& other) {
  const auto* pad = dynamic_cast<const BandedPad*>(&other);
  if (!pad || pad->cavitation_ != cavitation_ || pad->grid_.n_theta != grid_.n_theta || pad->rows_ != rows_) return;
  solved_.reset();
  u_ = pad->u_;
  full_ = pad->full_;
}

std::vector<double> BandedPad::pressure(const JournalMotion& motion) {
  solved_.reset();
  coefficients(motion);
  solve();
  const bool truncated =
      cavitation_ == Reynolds::Cavitation::half_sommerfeld || cavitation_ == Reynolds::Cavitation::reynolds;
  std::vector<double> values;
  for (int i = 0; i <= grid_.n_theta; ++i) {
    for (int j = 0; j <= grid_.n_z; ++j) {
      const int row = row_of(j);
      const double p = pressure_at(i, row);
      values.push_back(truncated ? std::max(p, 0.0) : p);
    }
  }
  return values;
}

std::vector<double> BandedPad::fill(const JournalMotion& motion) {
  if (cavitation_ != Reynolds::Cavitation::mass_conserving) return {};
  Response ignored;
  add(motion, Need::force, ignored);
  std::vector<double> values;
  for (int i = 0; i <= grid_.n_theta; ++i) {
    for (int j = 0; j <= grid_.n_z; ++j) {
      // The sides have what stands beside them.
      const int row = std::clamp(row_of(j), 0, rows_ - 1);
      values.push_back(speed_ == 0.0 ? 1.0 : 1.0 - deficit_at(i, row) / std::abs(speed_));
    }
  }
  return values;
}

std::unique_ptr<PadSolver> make_banded_pad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant) {
  return std::make_unique<BandedPad>(pad, options, lubricant);
}

}  // namespace whirl::film
