// Short and long films of a full cylindrical bore with an elastic liner: the film thickness around the bearing is the
// state.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "film/compliant.hpp"
#include "film/groove.hpp"
#include "film/kinds.hpp"
#include "film/liner.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

constexpr double kPi = std::numbers::pi;

// Nodes k = 0 .. N - 1 at theta = 90 deg + k d. With thickness h, eccentricity e in clearances and P = p (c/R)^2/(6 mu)
// in 1/s the liner gives P of its deflection u = h - 1 + e_x cos + e_y sin. Nodes in grooves have P = u = 0 and are no
// states; a long film has a groove at the top if none is given.
class CompliantFilm final : public StateModel {
public:
  CompliantFilm(const Geometry& geometry, const Options& options, const Lubricant& lubricant)
      : g_(geometry),
        viscosity_(lubricant.viscosity),
        long_(options.kind == Options::Kind::compliant_long),
        n_(options.cells[0]),
        scales_(geometry, options, lubricant),
        liner_(geometry, options, scales_.liner, scales_.pressure),
        neighbours_(options.differences),
        ring_(n_, options.quadrature),
        step_(ring_.step()) {
    const double ld = 0.5 * g_.length / g_.radius;
    side_ = 1.5 / (ld * ld);
    const bool top = long_ && options.grooves.empty();
    const std::vector<bool> fixed = grooved(n_, top ? std::vector{Groove{0.5 * kPi, 0.0}} : options.grooves);
    for (int k = 0; k < n_; ++k) state_.push_back(fixed[at(k)] ? -1 : states_++);
    nodes_.resize(at(n_));
  }

  [[nodiscard]] std::size_t states() const override { return at(states_); }
  [[nodiscard]] int row_entries() const override { return 8; }
  [[nodiscard]] bool constant_rates() const override { return !liner_.damped(); }
  [[nodiscard]] double state_scale() const override { return g_.clearance; }
  void unloaded(const Motion& motion, std::span<double> states) const override {
    for (int k = 0; k < n_; ++k)
      if (!fixed(k)) states[index(k)] = rigid(motion, k) * g_.clearance;
  }
  void evaluate_lines(const Motion& motion, Lines part, std::span<const double> states, std::span<const double> rates,
                      Need need, StateResponse& response) override;
  void resample(const Motion& motion, const StateModel& other, std::span<const double> from,
                std::span<double> to) const override;
  Summary summary(const Motion& motion, std::span<const double> states) override;
  std::vector<Field> fields(const Motion& motion, std::span<const double> states) override;

private:
  struct Node {
    double h = 0.0, p = 0.0;             // thickness in clearances, P of the film in 1/s
    double by_h = 0.0, by_u = 0.0;       // dP/dh in all, and its part by the deflection
    double contact = 0.0, stiff = 0.0;   // P of asperities, its slope in h
    std::array<double, 2> force{};       // d force*/dP
    std::array<double, 2> on_contact{};  // d force*/d contact
  };
  [[nodiscard]] int wrap(int k) const { return (k + n_) % n_; }
  [[nodiscard]] bool fixed(int k) const { return state_[at(k)] < 0; }
  [[nodiscard]] std::size_t index(int k) const { return at(state_[at(k)]); }
  [[nodiscard]] static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  [[nodiscard]] const Node& node(int k) const { return nodes_[at(k)]; }
  [[nodiscard]] std::array<double, 2> normal(int k) const { return {ring_.cosine(k), ring_.sine(k)}; }
  [[nodiscard]] double rigid(const Motion& m, int k) const {
    return 1.0 - (m.position[0] * ring_.cosine(k) + m.position[1] * ring_.sine(k)) / g_.clearance;
  }
  [[nodiscard]] double least() const {
    const auto thinner = [](const Node& a, const Node& b) { return a.h < b.h; };
    return g_.clearance * std::min_element(nodes_.begin(), nodes_.end(), thinner)->h;
  }
  void set(const Motion& motion, std::span<const double> states, std::span<const double> rates);
  void set_settled(const Motion& motion, std::span<const double> states);
  void integrate(Need need, StateResponse& response);
  void row(int k, double speed, Need need, StateResponse& response);
  // dg_k/dh_j and dg_k/dP_j to the derivatives in states, rates and the motion of the journal; without `flow` the
  // latter is always zero.
  void chain(int k, int j, double by_h, double by_p, bool flow, StateResponse& response) const;

  Geometry g_;
  double viscosity_;
  bool long_;
  int n_, states_ = 0;
  CompliantScales scales_;
  LinerLaw liner_;
  Neighbours neighbours_;
  RingQuadrature ring_;
  double step_, side_ = 0.0;  // -; 1.5/(L/D)^2
  std::vector<int> state_;    // of every node, or -1
  std::vector<Node> nodes_;
};

void CompliantFilm::set(const Motion& motion, std::span<const double> states, std::span<const double> rates) {
  for (int k = 0; k < n_; ++k) {
    Node& x = nodes_[at(k)];
    const double r = rigid(motion, k);
    x = {};
    x.h = fixed(k) ? r : states[index(k)] / g_.clearance;
    if (!(x.h > 0.0)) throw core::DomainError("the journal touches the liner: the film thickness is not positive");
    if (fixed(k)) continue;
    const LinerLaw::Value elastic = liner_.elastic(x.h - r), contact = liner_.contact(x.h);
    const double rate =
        (rates[index(k)] + motion.velocity[0] * ring_.cosine(k) + motion.velocity[1] * ring_.sine(k)) / g_.clearance;
    x.by_u = elastic.slope;
    x.contact = contact.pressure;
    x.stiff = contact.slope;
    x.by_h = x.by_u - x.stiff;
    x.p = elastic.pressure + liner_.damping() * rate - x.contact;
  }
}

// For reports, which know no rates.
void CompliantFilm::set_settled(const Motion& motion, std::span<const double> states) {
  set(motion, states, liner_.damped() ? settled_rates(*this, motion, states) : std::vector<double>(states.size(), 0.0));
}

// F* = -int (max(P, 0) + contact) (cos, sin) with its derivatives in both.
void CompliantFilm::integrate(Need need, StateResponse& response) {
  std::array<double, 2> sum{};
  for (int k = 0; k < n_; ++k) {
    Node &a = nodes_[at(k)], &b = nodes_[at(wrap(k + 1))];
    const RingQuadrature::Weights w = ring_.weights(k, a.p, b.p),
                                  full = liner_.touches() ? ring_.weights(k, 1.0, 1.0) : RingQuadrature::Weights{};
    for (std::size_t i = 0; i < 2; ++i) {
      sum[i] += w.left[i] * a.p + w.right[i] * b.p + full.left[i] * a.contact + full.right[i] * b.contact;
      a.force[i] += w.left[i];
      b.force[i] += w.right[i];
      a.on_contact[i] += full.left[i];
      b.on_contact[i] += full.right[i];
    }
  }
  Response& out = response.journal;
  for (std::size_t i = 0; i < 2; ++i) out.force[i] = scales_.force * sum[i];
  if (need == Need::force) return;
  const double scale = scales_.force / g_.clearance;
  for (int k = 0; k < n_; ++k) {
    if (fixed(k)) continue;
    const Node& x = node(k);
    for (std::size_t i = 0; i < 2; ++i) {
      response.force_d_states[index(k)][i] = scale * (x.force[i] * x.by_h + x.on_contact[i] * x.stiff);
      const double rate = scale * x.force[i] * liner_.damping();
      if (liner_.damped()) response.force_d_rates[index(k)][i] = rate;
      for (std::size_t j = 0; j < 2; ++j) {
        out.d_position[i][j] += scale * x.force[i] * x.by_u * normal(k)[j];
        out.d_velocity[i][j] += rate * normal(k)[j];
      }
    }
  }
}

void CompliantFilm::chain(int k, int j, double by_h, double by_p, bool flow, StateResponse& response) const {
  const std::array<double, 2> n = normal(j);
  const std::size_t to = index(k);
  if (fixed(j)) {  // h = 1 - e_x cos - e_y sin in a groove
    for (std::size_t i = 0; i < 2; ++i) response.d_position[to][i] -= by_h * n[i];
    return;
  }
  const int row = state_[at(k)], column = state_[at(j)];
  response.d_states.push_back({row, column, by_h + by_p * node(j).by_h});
  for (std::size_t i = 0; i < 2; ++i) response.d_position[to][i] += by_p * node(j).by_u * n[i];
  if (!flow || !liner_.damped()) return;
  const double rate = by_p * liner_.damping();
  response.d_rates.push_back({row, column, rate});
  for (std::size_t i = 0; i < 2; ++i) response.d_velocity[to][i] += rate * n[i];
}

// (4.27): dh/dt = -(1/2) (3 h^3 P/(L/D)^2 + Omega dh/dtheta); (4.29): dh/dt = (1/2) (d/dtheta (h^3 dP/dtheta) - Omega
// dh/dtheta).
void CompliantFilm::row(int k, double speed, Need need, StateResponse& response) {
  const std::array<int, 4> place = {wrap(k - 2), wrap(k - 1), k, wrap(k + 1)};
  const auto h = [&](std::size_t i) { return node(place[i]).h; };
  const auto p = [&](std::size_t i) { return node(place[i]).p; };
  const std::array<double, 4>&weights = neighbours_.slope, &face = neighbours_.face;
  double slope = 0.0;
  for (std::size_t i = 0; i < 4; ++i) slope += weights[i] / step_ * h(i);
  double g = 0.5 * speed * slope;
  // Thickness at the faces k - 1/2 and k + 1/2.
  const double left = face[0] * h(0) + face[1] * h(1) + face[2] * h(2),
               right = face[0] * h(1) + face[1] * h(2) + face[2] * h(3);
  const double dl = (p(2) - p(1)) / (step_ * step_), dr = (p(3) - p(2)) / (step_ * step_);
  if (long_)
    g -= 0.5 * (right * right * right * dr - left * left * left * dl);
  else
    g += side_ * h(2) * h(2) * h(2) * p(2);
  response.residual[index(k)] += g_.clearance * g;
  if (need == Need::force) return;
  std::array<double, 4> by_h{}, by_p{};
  for (std::size_t i = 0; i < 4; ++i) by_h[i] = 0.5 * speed * weights[i] / step_;
  response.d_speed[index(k)] = 0.5 * g_.clearance * slope;
  if (long_) {
    const double r2 = 1.5 * right * right * dr, l2 = 1.5 * left * left * dl;
    for (std::size_t i = 0; i < 3; ++i) {
      by_h[i + 1] -= r2 * face[i];
      by_h[i] += l2 * face[i];
    }
    const double r3 = 0.5 * right * right * right / (step_ * step_), l3 = 0.5 * left * left * left / (step_ * step_);
    by_p = {0.0, -l3, r3 + l3, -r3};
  } else {
    by_h[2] += 3.0 * side_ * h(2) * h(2) * p(2);
    by_p[2] = side_ * h(2) * h(2) * h(2);
  }
  for (std::size_t i = neighbours_.reach == 2 ? 0 : 1; i < 4; ++i)
    chain(k, place[i], by_h[i], by_p[i], long_ ? i > 0 : i == 2, response);
}

void CompliantFilm::evaluate_lines(const Motion& motion, Lines /*part*/, std::span<const double> states,
                                   std::span<const double> rates, Need need, StateResponse& response) {
  set(motion, states, rates);
  response.journal = {};
  response.residual.assign(rates.begin(), rates.end());
  response.d_states.clear();
  response.d_rates.clear();
  const std::size_t n = need == Need::tangents ? states.size() : 0;
  response.d_position.assign(n, {});
  response.d_velocity.assign(n, {});
  response.d_speed.assign(n, 0.0);
  response.force_d_states.assign(n, {});
  response.force_d_rates.assign(liner_.damped() ? n : 0, {});
  response.journal.min_thickness = least();
  integrate(need, response);
  for (int k = 0; k < n_; ++k) {
    if (fixed(k)) continue;
    row(k, motion.speed, need, response);
    if (need == Need::tangents) response.d_rates.push_back({state_[at(k)], state_[at(k)], 1.0});
  }
}

// Deflections, which are periodic and zero in grooves, are interpolated linearly.
void CompliantFilm::resample(const Motion& motion, const StateModel& other, std::span<const double> from,
                             std::span<double> to) const {
  const auto* mesh = dynamic_cast<const CompliantFilm*>(&other);
  core::require(mesh != nullptr && from.size() == mesh->states(), "states of another short or long film");
  const auto deflection = [&](int k) {
    return mesh->fixed(k) ? 0.0 : from[mesh->index(k)] - g_.clearance * mesh->rigid(motion, k);
  };
  for (int k = 0; k < n_; ++k) {
    if (fixed(k)) continue;
    const double place = static_cast<double>(k) * mesh->n_ / n_;
    const int j = std::min(static_cast<int>(place), mesh->n_ - 1);
    const double s = place - j;
    to[index(k)] = rigid(motion, k) * g_.clearance + (1.0 - s) * deflection(j) + s * deflection((j + 1) % mesh->n_);
  }
}

// Side flow of a short film from its parabola, (H^3/12 mu) 6 p/L out of each side; friction mu U/H on the whole
// circumference and half the pressure flow, -U/(2 R) int p dH/dtheta.
Summary CompliantFilm::summary(const Motion& motion, std::span<const double> states) {
  set_settled(motion, states);
  Summary s;
  s.min_thickness = least();
  const double U = motion.speed * g_.radius;
  for (int k = 0; k < n_; ++k) {
    const double p = scales_.pressure * std::max(node(k).p, 0.0), h = g_.clearance * node(k).h;
    s.max_pressure = std::max(s.max_pressure, (long_ ? 1.0 : 1.5) * p);
    if (!long_) s.side_flow += step_ * g_.radius * h * h * h * p / (viscosity_ * g_.length);
    const double slope = g_.clearance * (node(wrap(k + 1)).h - node(wrap(k - 1)).h) / 2.0;
    s.power_loss += U * g_.length * (viscosity_ * U * g_.radius * step_ / h - 0.5 * p * slope);
  }
  return s;
}

std::vector<Field> CompliantFilm::fields(const Motion& motion, std::span<const double> states) {
  set_settled(motion, states);
  const std::size_t around = nodes_.size() + 1, along = long_ ? 2 : 17;
  Field theta{0, "theta", "rad", {around}, {}}, z{0, "z", "m", {along}, {}};
  Field pressure{0, "pressure", "Pa", {around, along}, {}}, h{0, "thickness", "m", {around, along}, {}};
  for (std::size_t j = 0; j < along; ++j)
    z.values.push_back(g_.length * (static_cast<double>(j) / static_cast<double>(along - 1) - 0.5));
  for (int k = 0; k <= n_; ++k) {
    theta.values.push_back(ring_.angle(k));
    const Node& x = node(wrap(k));
    for (std::size_t j = 0; j < along; ++j) {
      const double from_middle = 2.0 * z.values[j] / g_.length;
      pressure.values.push_back(scales_.pressure * x.p * (long_ ? 1.0 : 1.5 * (1.0 - from_middle * from_middle)));
      h.values.push_back(g_.clearance * x.h);
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
