// Short and long films of a full cylindrical bore with an elastic liner: the film thickness around the bearing is the
// state.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "film/compliant.hpp"
#include "film/kinds.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

constexpr double kPi = std::numbers::pi;

// Nodes k = 0 .. N - 1 at theta = 90 deg + k d. With thickness h, eccentricity e in clearances and P = p (c/R)^2/(6 mu)
// in 1/s the liner gives P = (h - 1 + e_x cos + e_y sin)/b. A long film has P = 0 at node 0, which is no state.
class CompliantFilm final : public StateModel {
public:
  CompliantFilm(const Geometry& geometry, const Options& options, const Lubricant& lubricant)
      : g_(geometry),
        viscosity_(lubricant.viscosity),
        long_(options.kind == Options::Kind::compliant_long),
        upwind_(options.differences == Options::Differences::upwind),
        n_(options.cells[0]),
        first_(long_ ? 1 : 0),
        scales_(geometry, options, lubricant),
        ring_(n_, options.quadrature),
        step_(ring_.step()) {
    const double ld = 0.5 * g_.length / g_.radius;
    side_ = 1.5 / (ld * ld);
    h_.resize(at(n_ + halo));
    p_.resize(at(n_));
    forces_.resize(at(n_));
    for (int k = 0; k < n_; ++k) {
      cos_.push_back(ring_.cosine(k));
      sin_.push_back(ring_.sine(k));
      // Of a node between two cells without negative pressure.
      const RingQuadrature::Weights before = ring_.weights(k - 1, 1.0, 1.0), behind = ring_.weights(k, 1.0, 1.0);
      full_.push_back({before.right[0] + behind.left[0], before.right[1] + behind.left[1]});
    }
    simpson_ = options.quadrature == Options::Quadrature::simpson;
  }

  [[nodiscard]] std::size_t states() const override { return static_cast<std::size_t>(n_ - first_); }
  [[nodiscard]] int row_entries() const override { return 12; }
  [[nodiscard]] double state_scale() const override { return g_.clearance; }
  void unloaded(const Motion& motion, std::span<double> states) const override {
    for (int k = first_; k < n_; ++k) states[index(k)] = rigid(motion, k) * g_.clearance;
  }
  void evaluate_lines(const Motion& motion, Lines part, std::span<const double> states, std::span<const double> rates,
                      Need need, StateResponse& response) override;
  void resample(const Motion& motion, const StateModel& other, std::span<const double> from,
                std::span<double> to) const override;
  Summary summary(const Motion& motion, std::span<const double> states) override;
  std::vector<Field> fields(const Motion& motion, std::span<const double> states) override;

private:
  [[nodiscard]] int wrap(int k) const { return (k + n_) % n_; }
  [[nodiscard]] std::size_t index(int k) const { return static_cast<std::size_t>(k - first_); }
  [[nodiscard]] static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  [[nodiscard]] double rigid(const Motion& m, int k) const {
    return 1.0 - (m.position[0] * cos_[at(k)] + m.position[1] * sin_[at(k)]) / g_.clearance;
  }
  void set(const Motion& motion, std::span<const double> states);
  void integrate(Need need, StateResponse& response);
  void row(int k, double speed, Need need, StateResponse& response);
  void short_rows(double speed, Need need, StateResponse& response);
  // dg_k/dh_j and dg_k/dP_j to the derivatives in the states and in the position of the journal.
  void chain(int k, int j, double by_h, double by_p, StateResponse& response) const;

  Geometry g_;
  double viscosity_;
  bool long_, upwind_;
  int n_, first_;
  CompliantScales scales_;
  RingQuadrature ring_;
  double step_, side_ = 0.0;                   // -; 1.5/(L/D)^2
  static constexpr int halo = 1;               // nodes that stand behind the last one again
  std::vector<double> cos_, sin_;              // at all nodes
  std::vector<double> h_, p_;                  // at all nodes (h also around the ring), in clearances and 1/s
  std::vector<std::array<double, 2>> forces_;  // d force*/d P of every node
  std::vector<std::array<double, 2>> full_;    // the same where all pressure is positive
  bool simpson_;
};

void CompliantFilm::set(const Motion& motion, std::span<const double> states) {
  const double per_clearance = 1.0 / g_.clearance, per_liner = 1.0 / scales_.liner,
               x = motion.position[0] * per_clearance, y = motion.position[1] * per_clearance;
  double least = 1.0;
  for (int k = first_; k < n_; ++k) h_[at(k)] = states[index(k)] * per_clearance;
  if (long_) h_[0] = 1.0 - x * cos_[0] - y * sin_[0];
  for (int k = 0; k < n_; ++k) {
    p_[at(k)] = (h_[at(k)] - (1.0 - x * cos_[at(k)] - y * sin_[at(k)])) * per_liner;
    least = h_[at(k)] > 0.0 ? least : -1.0;  // NaN too
  }
  if (long_) p_[0] = 0.0;
  for (int k = 0; k < halo; ++k) h_[at(n_ + k)] = h_[at(k)];
  if (least < 0.0) throw core::DomainError("the journal touches the liner: the film thickness is not positive");
}

// F* = -int max(P, 0) (cos, sin) and dF*/dP of every node.
void CompliantFilm::integrate(Need need, StateResponse& response) {
  std::array<double, 2> sum{};
  if (simpson_) {
    // The rule sees each node by itself.
    for (int k = 0; k < n_; ++k)
      for (std::size_t i = 0; i < 2; ++i) {
        forces_[at(k)][i] = p_[at(k)] > 0.0 ? full_[at(k)][i] : 0.0;
        sum[i] += forces_[at(k)][i] * p_[at(k)];
      }
  } else {
    std::fill(forces_.begin(), forces_.end(), std::array<double, 2>{});
  }
  for (int k = 0; k < n_ && !simpson_; ++k) {
    const int next = wrap(k + 1);
    const RingQuadrature::Weights w = ring_.weights(k, p_[at(k)], p_[at(next)]);
    for (std::size_t i = 0; i < 2; ++i) {
      sum[i] += w.left[i] * p_[at(k)] + w.right[i] * p_[at(next)];
      forces_[at(k)][i] += w.left[i];
      forces_[at(next)][i] += w.right[i];
    }
  }
  Response& out = response.journal;
  for (std::size_t i = 0; i < 2; ++i) out.force[i] = scales_.force * sum[i];
  if (need == Need::force) return;
  const double scale = scales_.force / (scales_.liner * g_.clearance);
  for (int k = first_; k < n_; ++k)
    for (std::size_t i = 0; i < 2; ++i) {
      const double slope = scale * forces_[at(k)][i];
      response.force_d_states[index(k)][i] = slope;
      out.d_position[i][0] += slope * cos_[at(k)];
      out.d_position[i][1] += slope * sin_[at(k)];
    }
}

void CompliantFilm::chain(int k, int j, double by_h, double by_p, StateResponse& response) const {
  if (j < first_) {  // h = 1 - e_y at the inlet
    response.d_position[index(k)][0] -= by_h * cos_[at(j)];
    response.d_position[index(k)][1] -= by_h * sin_[at(j)];
    return;
  }
  response.d_states.push_back({static_cast<int>(index(k)), static_cast<int>(index(j)), by_h + by_p / scales_.liner});
  response.d_position[index(k)][0] += by_p / scales_.liner * cos_[at(j)];
  response.d_position[index(k)][1] += by_p / scales_.liner * sin_[at(j)];
}

// (4.29): dh/dt = (1/2) (d/dtheta (h^3 dP/dtheta) - Omega dh/dtheta).
void CompliantFilm::row(int k, double speed, Need need, StateResponse& response) {
  const int b2 = wrap(k - 2), b = wrap(k - 1), f = wrap(k + 1);
  const auto h = [&](int j) { return h_[at(j)]; };
  const double slope = upwind_ ? (3.0 * h(k) - 4.0 * h(b) + h(b2)) / (2.0 * step_) : (h(f) - h(b)) / (2.0 * step_);
  double g = 0.5 * speed * slope;
  // Thickness at the faces k - 1/2 and k + 1/2 from three nodes (source) or two.
  const double w0 = upwind_ ? -0.125 : 0.0, w1 = upwind_ ? 0.75 : 0.5, w2 = upwind_ ? 0.375 : 0.5;
  const double left = w0 * h(b2) + w1 * h(b) + w2 * h(k), right = w0 * h(b) + w1 * h(k) + w2 * h(f);
  const double dl = (p_[at(k)] - p_[at(b)]) / (step_ * step_), dr = (p_[at(f)] - p_[at(k)]) / (step_ * step_);
  g -= 0.5 * (right * right * right * dr - left * left * left * dl);
  response.residual[index(k)] += g_.clearance * g;
  if (need == Need::force) return;
  const double c = 0.25 * speed / step_;
  if (upwind_) {
    chain(k, k, 3.0 * c, 0.0, response);
    chain(k, b, -4.0 * c, 0.0, response);
    chain(k, b2, c, 0.0, response);
  } else {
    chain(k, f, c, 0.0, response);
    chain(k, b, -c, 0.0, response);
  }
  response.d_speed[index(k)] = 0.5 * g_.clearance * slope;
  const double r2 = 1.5 * right * right * dr, l2 = 1.5 * left * left * dl;
  const double r3 = 0.5 * right * right * right / (step_ * step_), l3 = 0.5 * left * left * left / (step_ * step_);
  chain(k, f, -r2 * w2, -r3, response);
  chain(k, k, -r2 * w1 + l2 * w2, r3 + l3, response);
  chain(k, b, -r2 * w0 + l2 * w1, -l3, response);
  if (upwind_) chain(k, b2, l2 * w0, 0.0, response);
}

// (4.27): dh/dt = -(1/2) (3 h^3 P/(L/D)^2 + Omega dh/dtheta), all rows in loops without calls: steps in time spend
// their time here.
void CompliantFilm::short_rows(double speed, Need need, StateResponse& response) {
  const double c = 0.25 * speed / step_,
               w[4] = {upwind_ ? 1.0 : 0.0, upwind_ ? -4.0 : -1.0, upwind_ ? 3.0 : 0.0, upwind_ ? 0.0 : 1.0};
  for (int k = 0; k < n_; ++k) {
    const double *before = h_.data() + (k < 2 ? k + n_ - 2 : k - 2), here = h_[at(k)];
    const double slope = w[0] * before[0] + w[1] * before[1] + w[2] * here + w[3] * h_[at(k + 1)];
    response.residual[at(k)] += g_.clearance * (c * slope + side_ * here * here * here * p_[at(k)]);
    if (need == Need::tangents) response.d_speed[at(k)] = 0.25 / step_ * g_.clearance * slope;
  }
  if (need == Need::force) return;
  response.d_states.resize(at(3 * n_));
  const double per_liner = 1.0 / scales_.liner;
  const int other = upwind_ ? n_ - 2 : 1;  // the third node of a row is k - 2 or k + 1
  for (int k = 0; k < n_; ++k) {
    const double h = h_[at(k)], by_p = side_ * h * h * h * per_liner;
    Entry* e = response.d_states.data() + 3 * k;
    e[0] = {k, k, w[2] * c + 3.0 * side_ * h * h * p_[at(k)] + by_p};
    e[1] = {k, k > 0 ? k - 1 : n_ - 1, w[1] * c};
    e[2] = {k, k + other < n_ ? k + other : k + other - n_, (upwind_ ? w[0] : w[3]) * c};
    response.d_position[at(k)] = {by_p * cos_[at(k)], by_p * sin_[at(k)], 0.0, 0.0};
  }
}

void CompliantFilm::evaluate_lines(const Motion& motion, Lines /*part*/, std::span<const double> states,
                                   std::span<const double> rates, Need need, StateResponse& response) {
  set(motion, states);
  response.journal = {};
  response.residual.assign(rates.begin(), rates.end());
  response.d_states.clear();
  response.d_rates.clear();
  const std::size_t n = need == Need::tangents ? states.size() : 0;
  response.d_position.assign(n, {});
  response.d_velocity.assign(n, {});
  response.d_speed.assign(n, 0.0);
  response.force_d_states.assign(n, {});
  response.journal.min_thickness = g_.clearance * *std::min_element(h_.begin(), h_.end());
  integrate(need, response);
  if (long_)
    for (int k = first_; k < n_; ++k) row(k, motion.speed, need, response);
  else
    short_rows(motion.speed, need, response);
  for (int k = 0; k < static_cast<int>(n); ++k) response.d_rates.push_back({k, k, 1.0});
}

// Deflections, which are periodic and zero at the inlet, are interpolated linearly.
void CompliantFilm::resample(const Motion& motion, const StateModel& /*other*/, std::span<const double> from,
                             std::span<double> to) const {
  const int other = static_cast<int>(from.size()) + first_;
  const double step = 2.0 * kPi / other;
  const auto deflection = [&](int k) {
    if (k < first_) return 0.0;
    const double theta = 0.5 * kPi + step * k;
    return from[index(k)] - g_.clearance + motion.position[0] * std::cos(theta) + motion.position[1] * std::sin(theta);
  };
  for (int k = first_; k < n_; ++k) {
    const double place = static_cast<double>(k) * other / n_;
    const int j = std::min(static_cast<int>(place), other - 1);
    const double s = place - j;
    to[index(k)] = rigid(motion, k) * g_.clearance + (1.0 - s) * deflection(j) + s * deflection((j + 1) % other);
  }
}

// Side flow of a short film from its parabola, (H^3/12 mu) 6 p/L out of each side; friction mu U/H on the whole
// circumference and half the pressure flow, -U/(2 R) int p dH/dtheta.
Summary CompliantFilm::summary(const Motion& motion, std::span<const double> states) {
  set(motion, states);
  Summary s;
  s.min_thickness = g_.clearance * *std::min_element(h_.begin(), h_.end());
  const double U = motion.speed * g_.radius;
  for (int k = 0; k < n_; ++k) {
    const double p = scales_.pressure * std::max(p_[at(k)], 0.0), h = g_.clearance * h_[at(k)];
    s.max_pressure = std::max(s.max_pressure, (long_ ? 1.0 : 1.5) * p);
    if (!long_) s.side_flow += step_ * g_.radius * h * h * h * p / (viscosity_ * g_.length);
    const double slope = g_.clearance * (h_[at(wrap(k + 1))] - h_[at(wrap(k - 1))]) / 2.0;
    s.power_loss += U * g_.length * (viscosity_ * U * g_.radius * step_ / h - 0.5 * p * slope);
  }
  return s;
}

std::vector<Field> CompliantFilm::fields(const Motion& motion, std::span<const double> states) {
  set(motion, states);
  const std::size_t around = p_.size() + 1, along = long_ ? 2 : 17;
  Field theta{0, "theta", "rad", {around}, {}}, z{0, "z", "m", {along}, {}};
  Field pressure{0, "pressure", "Pa", {around, along}, {}}, h{0, "thickness", "m", {around, along}, {}};
  for (std::size_t j = 0; j < along; ++j)
    z.values.push_back(g_.length * (static_cast<double>(j) / static_cast<double>(along - 1) - 0.5));
  for (int k = 0; k <= n_; ++k) {
    theta.values.push_back(ring_.angle(k));
    const std::size_t i = at(wrap(k));
    for (std::size_t j = 0; j < along; ++j) {
      const double from_middle = 2.0 * z.values[j] / g_.length;
      pressure.values.push_back(scales_.pressure * p_[i] * (long_ ? 1.0 : 1.5 * (1.0 - from_middle * from_middle)));
      h.values.push_back(g_.clearance * h_[i]);
    }
  }
  return {theta, z, pressure, h};
}

}  // namespace

std::unique_ptr<StateModel> make_compliant(const Geometry& g, const Options& options, const Lubricant& lubricant) {
  check_compliant(g, options, lubricant);
  return std::make_unique<CompliantFilm>(g, options, lubricant);
}

}  // namespace whirl::film
