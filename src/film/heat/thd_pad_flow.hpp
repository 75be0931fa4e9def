#pragma once
// Thickness, flows and the balances of volumes of a pad with heat; for thd_pad.cpp alone.
#include <algorithm>
#include <cmath>

#include "film/fluid/mobility.hpp"
#include "film/heat/thd_pad.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

template <int Count, int Most>
thermal::Valued ThdPad<Count, Most>::viscosity_at(double t) {
  if (!(t > 200.0 && t < 1000.0)) throw core::DomainError("a temperature of the film is not that of an oil");
  const thermal::Valued mu = viscosity_.at(t);
  if (!(mu.value > 0.0 && std::isfinite(mu.value)))
    throw core::DomainError("the viscosity has no value at a temperature of the film");
  return mu;
}

template <int Count, int Most>
void ThdPad<Count, Most>::read(const JournalMotion& motion, std::span<const double> states) {
  const bool tilt = options_.tilt;
  const double X = motion.position[0] - pad_.centre_x, Y = motion.position[1] - pad_.centre_y;
  const double tx = tilt ? motion.position[2] : 0.0, ty = tilt ? motion.position[3] : 0.0;
  const double vtx = tilt ? motion.velocity[2] : 0.0, vty = tilt ? motion.velocity[3] : 0.0;
  speed_ = motion.speed;
  h_min_ = least_(X, Y, tx, ty);
  require_thickness(h_min_);
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    Node& here = nodes_[n];
    here.value = &states[n * static_cast<std::size_t>(block())];
    here.h = pad_.clearance - (X + here.z * tx) * here.cosine - (Y + here.z * ty) * here.sine;
    here.over_h = 1.0 / here.h;
    here.rate = -(motion.velocity[0] + here.z * vtx) * here.cosine - (motion.velocity[1] + here.z * vty) * here.sine;
    for (int k = 0; k < layers(); ++k) {
      const thermal::Valued mu = viscosity_at(here.value[1 + k]);
      here.mu(k) = mu.value;
      here.mu_t(k) = mu.slope;
    }
  }
  for (Face& f : faces_) f.h = pad_.clearance - (X + f.z * tx) * f.cosine - (Y + f.z * ty) * f.sine;
}

template <int Count, int Most>
void ThdPad<Count, Most>::turbulence() {
  const double surface = std::abs(speed_) * pad_.radius;
  turbulent_ = options_.turbulence != Turbulence::laminar && surface > 0.0;
  if (!turbulent_) return;
  for (std::size_t k = 0; k < faces_.size(); ++k) {
    const Face& f = faces_[k];
    const Node &a = nodes_[static_cast<std::size_t>(f.from)], &b = nodes_[static_cast<std::size_t>(f.to)];
    reynolds_[k] = lubricant_.density * surface * f.h / (0.5 * (a.mu + b.mu).mean());
  }
  const int along = static_cast<int>(faces_.size()) - around_;
  const double* re = reynolds_.data();
  powers(resistance_around_.factor, resistance_around_.exponent, around_, re, resisting_.data());
  powers(resistance_along_.factor, resistance_along_.exponent, along, re + around_, resisting_.data() + around_);
  powers(couette_.factor, couette_.exponent, around_, re, sheared_.data());
}

// In turbulence the flow by pressure has the share c = 12/k(Re) of the laminar one, and so has its dissipation; the
// shear of the Couette flow grows by s. Re is that of the mean viscosity at the face.
template <int Count, int Most>
void ThdPad<Count, Most>::flow(int face, bool tangents) {
  const auto number = static_cast<std::size_t>(face);
  Face& f = faces_[number];
  const Node &a = nodes_[static_cast<std::size_t>(f.from)], &b = nodes_[static_cast<std::size_t>(f.to)];
  mean_ = 0.5 * (a.mu + b.mu);
  profile_.set(mean_, tangents);
  const auto& p = profile_;
  const double u = f.around ? speed_ * pad_.radius : 0.0, h = f.h, over_h = 1.0 / h,
               g = (b.value[0] - a.value[0]) * f.over_step;
  double c = 1.0, c_re = 0.0, s = 1.0, s_re = 0.0;
  if (turbulent_) {
    const Resistance& r = f.around ? resistance_around_ : resistance_along_;
    const double k = 12.0 + resisting_[number];
    c = 12.0 / k;
    c_re = -c / k * r.exponent * resisting_[number];  // by ln Re
    s = 1.0 + sheared_[number];
    s_re = couette_.exponent * sheared_[number];
  }
  const double h3 = h * h * h;
  f.q = u * h * p.drag + (c * h3 * g) * p.pressure;
  f.d = (s * u * u * over_h) * p.couette + (c * u * h * g) * p.cross + (c * h3 * g * g) * p.poiseuille;
  if (!tangents) return;
  Slopes& by = slopes_[number];
  by.q_g = (c * h3) * p.pressure;
  by.d_g = (c * u * h) * p.cross + (2.0 * c * h3 * g) * p.poiseuille;
  by.q_h = u * p.drag + (3.0 * c * h * h * g) * p.pressure;
  by.d_h =
      (-s * u * u * over_h * over_h) * p.couette + (c * u * g) * p.cross + (3.0 * c * h * h * g * g) * p.poiseuille;
  by.q_u.setZero();
  by.d_u.setZero();
  if (f.around) {
    by.q_u = h * p.drag;
    by.d_u = (2.0 * s * u * over_h) * p.couette + (c * h * g) * p.cross;
  }
  by.q_mu = (u * h) * p.d_drag + (c * h3 * g) * p.d_pressure;
  by.d_mu = (s * u * u * over_h) * p.d_couette + (c * u * h * g) * p.d_cross + (c * h3 * g * g) * p.d_poiseuille;
  if (!turbulent_) return;
  const double mu = mean_.mean();
  const Vector q_re = (c_re * h3 * g) * p.pressure;
  const Vector d_re =
      (s_re * u * u * over_h) * p.couette + (c_re * u * h * g) * p.cross + (c_re * h3 * g * g) * p.poiseuille;
  by.q_h += q_re * over_h;
  by.d_h += d_re * over_h;
  const double signed_surface = speed_ * pad_.radius;
  by.q_u += q_re / signed_surface;
  by.d_u += d_re / signed_surface;
  by.q_mu.colwise() -= q_re / (mu * layers_);
  by.d_mu.colwise() -= d_re / (mu * layers_);
}

template <int Count, int Most>
double ThdPad<Count, Most>::left_over(std::size_t n, int layer) const {
  double out = nodes_[n].area * nodes_[n].rate / layers();
  for (const Side& s : sides_[n])
    if (s.face >= 0) {
      const Face& f = faces_[static_cast<std::size_t>(s.face)];
      out += s.sign * f.width * f.q(layer);
    }
  return -out;
}

template <int Count, int Most>
typename ThdPad<Count, Most>::Balance ThdPad<Count, Most>::balance(std::size_t n) const {
  const Node& here = nodes_[n];
  const int L = layers();
  const double* T = here.value + 1;
  Balance b{here.area * here.rate, Vector::Zero(L), Vector::Zero(L)};
  for (const Side& s : sides_[n]) {
    if (s.face < 0) continue;
    const Face& f = faces_[static_cast<std::size_t>(s.face)];
    const double* other = nodes_[static_cast<std::size_t>(s.sign > 0 ? f.to : f.from)].value + 1;
    for (int k = 0; k < L; ++k) {
      const double out = s.sign * f.width * f.q(k);
      b.out += out;
      b.advected(k) += std::min(out, 0.0) * (other[k] - T[k]);
    }
    b.dissipated += (0.5 * f.step * f.width) * f.d;
  }
  if (here.edge) {
    for (int k = 0; k < L; ++k) b.advected(k) += std::min(left_over(n, k), 0.0) * (options_.feed - T[k]);
    return b;
  }
  double upwards = 0.0;
  for (int k = 0; k + 1 < L; ++k) {
    upwards += left_over(n, k);
    const int into = upwards > 0.0 ? k + 1 : k, from = upwards > 0.0 ? k : k + 1;
    b.advected(into) -= std::abs(upwards) * (T[from] - T[into]);
  }
  return b;
}

}  // namespace whirl::film
