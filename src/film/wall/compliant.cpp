// Force, residual and tangents of short and long compliant films.
#include <Eigen/Core>
#include <algorithm>
#include <numeric>

#include "film/wall/compliant_around.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

using Array = Eigen::Map<const Eigen::ArrayXd>;

void CompliantFilm::place(const std::vector<bool>& fixed) {
  for (int k = 0; k < n_; ++k) {
    state_.push_back(fixed[at(k)] ? -1 : states_++);
    if (fixed[at(k)])
      fixed_.push_back(k);
    else if (k == 0 || fixed[at(k - 1)])
      runs_.push_back({k, state_.back(), 1});
    else
      ++runs_.back().count;
  }
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < n_; ++k) {
      if (fixed[at(k)]) continue;
      const int other = wrap(k + i - 2);
      const bool flow = long_ ? i > 0 : i == 2;  // by its P
      if (!flow && neighbours_.slope[at(i)] == 0.0) continue;
      if (fixed[at(other)]) {
        banks_.push_back({state_[at(k)], k, i, other});
        continue;
      }
      d_states_.add(state_[at(k)], state_[at(other)]);
      by_h_at_.push_back(at(i * n_ + k));
      if (i != 2 && !(flow && liner_.damped())) continue;
      d_rates_.add(state_[at(k)], state_[at(other)]);
      constant_rates_.push_back(i == 2 ? 1.0 : 0.0);
      by_p_at_.push_back(at((i - 1) * n_ + k));
    }
}

Share CompliantFilm::share(int begin, int end) const {
  core::require(begin == 0 && end == states_, "a film that is not cut");
  Share out{begin, end, std::vector<int>(at(states_)), d_states_, d_rates_};
  std::iota(out.seen.begin(), out.seen.end(), 0);
  return out;
}

void CompliantFilm::set(const JournalMotion& motion, std::span<const double> states, std::span<const double> rates) {
  const double per_clearance = 1.0 / g_.clearance, x = motion.position[0] * per_clearance,
               y = motion.position[1] * per_clearance;
  double* h = around(h_);
  const double *c = around(cos_), *s = around(sin_);
  for (const Run& r : runs_) {
    const double* from = states.data() + r.state;
    double* __restrict to = h + r.node;
    for (int j = 0; j < r.count; ++j) to[j] = from[j] * per_clearance;
  }
  for (const int k : fixed_) h[k] = 1.0 - x * c[k] - y * s[k];
  close(h_);
  least_ = Array(h, n_).minCoeff<Eigen::PropagateNaN>();
  if (!(least_ > 0.0)) throw core::DomainError("the journal touches the liner: the film thickness is not positive");
  double* __restrict u = u_.data();
  for (int k = 0; k < n_; ++k) u[k] = h[k] - (1.0 - x * c[k] - y * s[k]);
  for (const Run& r : runs_) {
    const std::size_t count = at(r.count);
    double* __restrict moved = moved_.data() + r.node;
    if (liner_.damped()) {
      const double *rate = rates.data() + r.state, *rc = c + r.node, *rs = s + r.node;
      const double vx = motion.velocity[0], vy = motion.velocity[1];
      for (int j = 0; j < r.count; ++j) moved[j] = (rate[j] + vx * rc[j] + vy * rs[j]) * per_clearance;
    }
    liner_.carry({h + r.node, count}, {u + r.node, count}, {moved, count}, at(r.node) + kFront, carried_);
  }
  for (auto* values : {&carried_.p, &carried_.by_h, &carried_.by_u}) close(*values);
  if (liner_.damped()) close(carried_.by_rate);
}

// dF*/dP at every node; F* = -int max(P, 0) (cos, sin) is homogeneous in P.
void CompliantFilm::slopes() {
  const double* p = around(carried_.p);
  double* __restrict sx = slope_[0].data(), * __restrict sy = slope_[1].data();
  if (ring_.nodal()) {
    const double *wx = full_[0].data(), *wy = full_[1].data();
    for (int k = 0; k < n_; ++k) {
      sx[k] = p[k] > 0.0 ? wx[k] : 0.0;
      sy[k] = p[k] > 0.0 ? wy[k] : 0.0;
    }
    return;
  }
  // Weights of a node are those of its sides, right = full - left; a cell with P < 0 at one end counts by itself.
  const double *fx = full_[0].data(), *fy = full_[1].data(), *lx = left_[0].data(), *ly = left_[1].data();
  for (int k = 0; k < n_; ++k) {
    const double a = p[k - 1], b = p[k], c = p[k + 1];
    const bool before = a >= 0.0 && b >= 0.0 && a + b > 0.0, after = b >= 0.0 && c >= 0.0 && b + c > 0.0;
    sx[k] = (before ? fx[k] - lx[k] : 0.0) + (after ? lx[k] : 0.0);
    sy[k] = (before ? fy[k] - ly[k] : 0.0) + (after ? ly[k] : 0.0);
  }
  for (int k = 0; k < n_; ++k) {
    if (p[k] * p[k + 1] >= 0.0) continue;
    const RingQuadrature::Weights w = ring_.part(k, p[k], p[k + 1]);
    const std::size_t here = at(k), next = at(wrap(k + 1));
    for (std::size_t i = 0; i < 2; ++i) {
      slope_[i][here] += w.left[i];
      slope_[i][next] += w.right[i];
    }
  }
}

// F* = -int (max(P, 0) + contact) (cos, sin) with its derivatives in both.
void CompliantFilm::integrate(Need need, StateResponse& response) {
  slopes();
  Response& out = response.journal;
  const auto nodes = [&](const double* values) { return Array(values, n_); };
  const auto p = nodes(around(carried_.p)), contact = nodes(around(carried_.contact));
  for (std::size_t i = 0; i < 2; ++i) {
    double sum = (nodes(slope_[i].data()) * p).sum();
    if (liner_.touches()) sum += (nodes(full_[i].data()) * contact).sum();
    out.force[i] = scales_.force * sum;
  }
  if (need == Need::force) return;
  const double scale = scales_.force / g_.clearance;
  const double *by_h = around(carried_.by_h), *by_u = around(carried_.by_u), *by_rate = around(carried_.by_rate),
               *stiff = around(carried_.stiff);
  const std::array<const double*, 2> normal = {around(cos_), around(sin_)};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j) {
      const auto weight = nodes(slope_[i].data()) * nodes(normal[j]);
      out.d_position[i][j] = scale * (weight * nodes(by_u)).sum();
      if (liner_.damped()) out.d_velocity[i][j] = scale * (weight * nodes(by_rate)).sum();
    }
  const double *sx = slope_[0].data(), *sy = slope_[1].data(), *fx = full_[0].data(), *fy = full_[1].data();
  for (const Run& r : runs_)
    for (int k = r.node; k < r.node + r.count; ++k) {
      const std::size_t to = at(r.state + k - r.node);
      response.of_force(0)[to] = scale * (sx[k] * by_h[k] + fx[k] * stiff[k]);
      response.of_force(1)[to] = scale * (sy[k] * by_h[k] + fy[k] * stiff[k]);
      if (!liner_.damped()) continue;
      response.of_force_rate(0)[to] = scale * sx[k] * by_rate[k];
      response.of_force_rate(1)[to] = scale * sy[k] * by_rate[k];
    }
}

// Through the face before node k, with h there from nodes k - 2 .. k, goes h^3 (P_k - P_(k-1))/(2 d^2).
void CompliantFilm::faces() {
  const double scale = 0.5 / (step_ * step_);
  const auto [w0, w1, w2, unused] = neighbours_.face;
  const double *h = around(h_), *p = around(carried_.p);
  double* __restrict k = conductance_.data(), * __restrict q = by_face_.data(), * __restrict f = flux_.data();
  for (int i = 0; i <= n_; ++i) {
    const double face = w0 * h[i - 2] + w1 * h[i - 1] + w2 * h[i], square = scale * face * face, rise = p[i] - p[i - 1];
    k[i] = square * face;
    q[i] = 3.0 * square * rise;
    f[i] = square * face * rise;
  }
}

// (4.27): dh/dt = -(1/2) (3 h^3 P/(L/D)^2 + Omega dh/dtheta); (4.29): dh/dt = (1/2) (d/dtheta (h^3 dP/dtheta) - Omega
// dh/dtheta).
void CompliantFilm::residual(double speed, std::span<const double> rates, std::span<double> g) const {
  const double c = g_.clearance, wedge = 0.5 * c * speed / step_, side = c * side_;
  const double w0 = wedge * neighbours_.slope[0], w1 = wedge * neighbours_.slope[1], w2 = wedge * neighbours_.slope[2],
               w3 = wedge * neighbours_.slope[3];
  for (const Run& r : runs_) {
    const double *h = around(h_) + r.node, *p = around(carried_.p) + r.node, *flux = flux_.data() + r.node,
                 *rate = rates.data() + r.state;
    double* __restrict to = g.data() + r.state;
    for (int j = 0; j < r.count; ++j) {
      const double slope = w0 * h[j - 2] + w1 * h[j - 1] + w2 * h[j] + w3 * h[j + 1];
      const double out = long_ ? c * (flux[j] - flux[j + 1]) : side * h[j] * h[j] * h[j] * p[j];
      to[j] = rate[j] + slope + out;
    }
  }
}

// by_h_ and by_p_, and the derivatives in states and rates.
void CompliantFilm::tangents(double speed, StateResponse& response) {
  const double wedge = 0.5 * speed / step_;
  const auto [s0, s1, s2, s3] = neighbours_.slope;
  const auto [f0, f1, f2, unused] = neighbours_.face;
  const double *h = around(h_), *p = around(carried_.p), *by_h = around(carried_.by_h),
               *conductance = conductance_.data(), *face = by_face_.data();
  double *__restrict a0 = by_h_.data(), *__restrict a1 = a0 + n_, *__restrict a2 = a1 + n_, *__restrict a3 = a2 + n_,
                     *__restrict b0 = by_p_.data(), *__restrict b1 = b0 + n_, *__restrict b2 = b1 + n_;
  if (long_) {
    for (int k = 0; k < n_; ++k) {
      const double l3 = conductance[k], r3 = conductance[k + 1], l2 = face[k], r2 = face[k + 1];
      a0[k] = wedge * s0 + l2 * f0;
      a1[k] = wedge * s1 + l2 * f1 - r2 * f0 - l3 * by_h[k - 1];
      a2[k] = wedge * s2 + l2 * f2 - r2 * f1 + (l3 + r3) * by_h[k];
      a3[k] = wedge * s3 - r2 * f2 - r3 * by_h[k + 1];
      b0[k] = -l3;
      b1[k] = l3 + r3;
      b2[k] = -r3;
    }
  } else {
    for (int k = 0; k < n_; ++k) {
      const double square = side_ * h[k] * h[k];
      a0[k] = wedge * s0;
      a1[k] = wedge * s1;
      a2[k] = wedge * s2 + 3.0 * square * p[k] + square * h[k] * by_h[k];
      a3[k] = wedge * s3;
      b1[k] = square * h[k];
    }
  }
  for (std::size_t e = 0; e < by_h_at_.size(); ++e) response.d_states[e] = by_h_[by_h_at_[e]];
  response.d_rates = constant_rates_;
  if (liner_.damped())
    for (std::size_t e = 0; e < by_p_at_.size(); ++e) response.d_rates[e] += liner_.damping() * by_p_[by_p_at_[e]];
}

void CompliantFilm::by_journal(StateResponse& response) const {
  const auto [s0, s1, s2, s3] = neighbours_.slope;
  const double wedge = 0.5 * g_.clearance / step_;
  const double *h = around(h_), *c = around(cos_), *s = around(sin_), *b0 = by_p_.data(), *b1 = b0 + n_, *b2 = b1 + n_;
  const auto through = [&](const double* by, const double* normal, int k) {
    const double here = b1[k] * by[k] * normal[k];
    if (!long_) return here;
    return here + b0[k] * by[k - 1] * normal[k - 1] + b2[k] * by[k + 1] * normal[k + 1];
  };
  const double *by_u = around(carried_.by_u), *by_rate = around(carried_.by_rate);
  double *by_speed = response.d_speed.data(), *by_x = response.by_position(0), *by_y = response.by_position(1),
         *by_vx = response.by_velocity(0), *by_vy = response.by_velocity(1);
  for (const Run& r : runs_)
    for (int k = r.node; k < r.node + r.count; ++k) {
      const std::size_t to = at(r.state + k - r.node);
      by_speed[to] = wedge * (s0 * h[k - 2] + s1 * h[k - 1] + s2 * h[k] + s3 * h[k + 1]);
      by_x[to] = through(by_u, c, k);
      by_y[to] = through(by_u, s, k);
      if (!liner_.damped()) continue;
      by_vx[to] = through(by_rate, c, k);
      by_vy[to] = through(by_rate, s, k);
    }
  // h = 1 - e_x cos - e_y sin in a groove.
  for (const Bank& b : banks_) {
    const double by = by_h_[at(b.place * n_ + b.row)];
    by_x[b.state] -= by * c[b.node];
    by_y[b.state] -= by * s[b.node];
  }
}

void CompliantFilm::evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                             std::span<const double> rates, Need need, StateResponse& response) {
  set(motion, states, rates);
  resize(share, need, response);
  response.journal.min_thickness = g_.clearance * least_;
  integrate(need, response);
  if (long_) faces();
  residual(motion.speed, rates, response.residual);
  if (need == Need::force) return;
  tangents(motion.speed, response);
  by_journal(response);
}

std::unique_ptr<Film> make(const Geometry& geometry, const CompliantShort& options, const Lubricant& lubricant) {
  return used(options, std::make_unique<CompliantFilm>(geometry, options, false, lubricant));
}
std::unique_ptr<Film> make(const Geometry& geometry, const CompliantLong& options, const Lubricant& lubricant) {
  return used(options, std::make_unique<CompliantFilm>(geometry, options, true, lubricant));
}

}  // namespace whirl::film
