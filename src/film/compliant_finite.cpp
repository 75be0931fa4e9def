// Film of finite length in a full cylindrical bore with an elastic liner: the thickness on a mesh around and along the
// bearing is the state.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "film/compliant.hpp"
#include "film/groove.hpp"
#include "film/kinds.hpp"
#include "film/liner.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

// Line i lies at theta = 90 deg + i d, its states j = 0 .. M - 2 at z = L ((j + 1)/M - 1/2); h = 1 - e_x cos - e_y sin
// and P = 0 on both edges. With the scales of the other compliant films and s = 1/(4 (L/D)^2 (dz/L)^2), (4.22) reads
//
//     dh/dt = -Omega/2 dh/dtheta + 1/2 (delta_theta (h^3 delta_theta P)/d^2 + s delta_z (h^3 delta_z P))
//
// with h at faces midway between nodes from both neighbours. A line in a groove has P = 0 and stays among the states,
// so that lines form a ring: its deflection u falls by du/dt = -kappa u and is zero if it was, kappa being the rate at
// which a film of nominal thickness would let a node go.
class FiniteFilm final : public StateModel {
public:
  FiniteFilm(const Geometry& geometry, const Options& options, const Lubricant& lubricant)
      : g_(geometry),
        viscosity_(lubricant.viscosity),
        simpson_(options.quadrature == Options::Quadrature::simpson),
        cells_(options.cells[1]),
        scales_(geometry, options, lubricant),
        liner_(geometry, options, scales_.liner, scales_.pressure),
        neighbours_(options.differences),
        ring_(options.cells[0], options.quadrature),
        fixed_(grooved(options.cells[0], options.grooves)) {
    const double slenderness = g_.length / g_.radius;  // 2 L/D
    around_ = 0.5 / (ring_.step() * ring_.step());
    along_ = 0.5 * cells_ * cells_ / (slenderness * slenderness);
    for (int j = 1; j < cells_; ++j)
      z_weight_.push_back((simpson_ ? (j % 2 == 0 ? 2.0 : 4.0) / 3.0 : 1.0) / static_cast<double>(cells_));
  }

  [[nodiscard]] std::size_t states() const override { return at(ring_.nodes() * inner()); }
  [[nodiscard]] Ring ring() const override { return {ring_.nodes(), reach()}; }
  [[nodiscard]] int row_entries() const override { return Stencil::n_places + (liner_.damped() ? 5 : 1); }
  [[nodiscard]] bool constant_rates() const override { return !liner_.damped(); }
  [[nodiscard]] double state_scale() const override { return g_.clearance; }
  void unloaded(const Motion& motion, std::span<double> states) const override {
    for (int i = 0; i < ring_.nodes(); ++i)
      std::fill_n(states.begin() + i * inner(), inner(), rigid(motion, i) * g_.clearance);
  }
  void evaluate_lines(const Motion& motion, Lines part, std::span<const double> states, std::span<const double> rates,
                      Need need, StateResponse& response) override;
  void resample(const Motion& motion, const StateModel& other, std::span<const double> from,
                std::span<double> to) const override;
  Summary summary(const Motion& motion, std::span<const double> states) override;
  std::vector<Field> fields(const Motion& motion, std::span<const double> states) override;

private:
  [[nodiscard]] int inner() const { return cells_ - 1; }
  [[nodiscard]] int reach() const { return neighbours_.reach; }
  [[nodiscard]] double rigid(const Motion& m, int line) const {
    return 1.0 - (m.position[0] * ring_.cosine(line) + m.position[1] * ring_.sine(line)) / g_.clearance;
  }
  [[nodiscard]] bool fixed(int line) const { return fixed_[at((line + ring_.nodes()) % ring_.nodes())]; }
  // Node j (0 and `cells_` on the edges) of the line at `row` of the work space.
  [[nodiscard]] std::size_t node(int row, int j) const { return at(row * (cells_ + 1) + j); }
  void set(const Motion& motion, Lines part, std::span<const double> states, std::span<const double> rates);
  void set_settled(const Motion& motion, std::span<const double> states);
  void integrate(Lines part, Need need, StateResponse& response);
  void residual(Lines part, const Motion& motion, std::span<const double> rates, StateResponse& response) const;
  void derivatives(Lines part, double speed, StateResponse& response) const;
  // kappa
  [[nodiscard]] double release() const { return 2.0 * (around_ + along_) * liner_.stiffness(); }

  Geometry g_;
  double viscosity_;
  bool simpson_;
  int cells_;  // along the bearing
  CompliantScales scales_;
  LinerLaw liner_;
  Neighbours neighbours_;
  RingQuadrature ring_;
  std::vector<bool> fixed_;            // lines in grooves
  double around_ = 0.0, along_ = 0.0;  // 1/(2 d^2), s/2
  std::vector<double> z_weight_;       // of the mean along z, per inner node
  // Of the lines at hand and their neighbours, with the edges: h in clearances, P in 1/s, dP/du and dP/du'.
  std::vector<double> h_, p_, by_u_, by_rate_;
  std::vector<std::array<double, 2>> forces_;  // d force*/d P of the lines at hand
};

void FiniteFilm::set(const Motion& motion, Lines part, std::span<const double> states, std::span<const double> rates) {
  const int rows = part.count() + 2 * reach();
  core::require(states.size() == at(rows * inner()), "lines of a film with their neighbours");
  h_.resize(at(rows * (cells_ + 1)));
  p_.resize(h_.size());
  by_u_.assign(h_.size(), liner_.stiffness());
  by_rate_.assign(h_.size(), liner_.damping());
  const double clearance = 1.0 / g_.clearance, stiffness = liner_.stiffness();
  double least = 1.0;
  bool numbers = true;
  for (int row = 0; row < rows; ++row) {
    const int line = part.begin - reach() + row;
    const double r = rigid(motion, line);
    double *h = &h_[node(row, 0)], *p = &p_[node(row, 0)];
    const double* s = states.data() + row * inner() - 1;
    h[0] = h[cells_] = r;
    p[0] = p[cells_] = 0.0;
    for (auto* slope : {&by_u_, &by_rate_}) (*slope)[node(row, 0)] = (*slope)[node(row, cells_)] = 0.0;
    least = std::min(least, r);
    for (int j = 1; j < cells_; ++j) {
      h[j] = s[j] * clearance;
      p[j] = (h[j] - r) * stiffness;
      least = std::min(least, h[j]);
      numbers = numbers && !std::isnan(h[j]);
    }
    if (fixed(line)) {
      std::fill_n(p, cells_, 0.0);
      for (auto* slope : {&by_u_, &by_rate_})
        std::fill_n(slope->begin() + static_cast<long>(node(row, 0)), cells_, 0.0);
      continue;
    }
    for (int j = 1; j < cells_ && !liner_.linear(); ++j) {
      const LinerLaw::Value elastic = liner_.elastic(h[j] - r);
      p[j] = elastic.pressure;
      by_u_[node(row, j)] = elastic.slope;
    }
    if (!liner_.damped()) continue;
    const double moved = motion.velocity[0] * ring_.cosine(line) + motion.velocity[1] * ring_.sine(line);
    for (int j = 1; j < cells_; ++j) p[j] += liner_.damping() * clearance * (rates[at(row * inner() + j - 1)] + moved);
  }
  if (!(least > 0.0 && numbers))
    throw core::DomainError("the journal touches the liner: the film thickness is not positive");
}

// For reports, which know no rates.
void FiniteFilm::set_settled(const Motion& motion, std::span<const double> states) {
  const Lines all{0, ring_.nodes()};
  const std::vector<double> rates =
      liner_.damped() ? settled_rates(*this, motion, states) : std::vector<double>(states.size(), 0.0);
  set(motion, all, with_neighbours(*this, all, states), with_neighbours(*this, all, rates));
}

// F* = -int max(P, 0) (cos, sin), cell by cell around the bearing at every inner node of z, and dF*/dP. A part answers
// for the cells behind its lines, and needs the one in front for the derivatives.
void FiniteFilm::integrate(Lines part, Need need, StateResponse& response) {
  std::array<double, 2> sum{};
  const bool tangents = need == Need::tangents;
  if (tangents) forces_.assign(at(part.count() * inner()), {});
  for (int i = tangents ? -1 : 0; i < part.count(); ++i) {
    const RingQuadrature::Weights full = ring_.weights(part.begin + i, 1.0, 1.0);
    const double *a = &p_[node(i + reach(), 1)], *b = &p_[node(i + reach() + 1, 1)];
    double whole_a = 0.0, whole_b = 0.0;
    for (int j = 0; j < inner(); ++j) {
      if (a[j] <= 0.0 && b[j] <= 0.0) continue;
      const double w = z_weight_[at(j)];
      const bool whole = a[j] >= 0.0 && b[j] >= 0.0;
      const RingQuadrature::Weights weights = whole ? full : ring_.weights(part.begin + i, a[j], b[j]);
      if (whole) {
        whole_a += w * a[j];
        whole_b += w * b[j];
      }
      for (std::size_t d = 0; d < 2; ++d) {
        if (!whole && i >= 0) sum[d] += w * (weights.left[d] * a[j] + weights.right[d] * b[j]);
        if (!tangents) continue;
        if (i >= 0) forces_[at(i * inner() + j)][d] += w * weights.left[d];
        if (i + 1 < part.count()) forces_[at((i + 1) * inner() + j)][d] += w * weights.right[d];
      }
    }
    for (std::size_t d = 0; d < 2 && i >= 0; ++d) sum[d] += full.left[d] * whole_a + full.right[d] * whole_b;
  }
  Response& out = response.journal;
  for (std::size_t d = 0; d < 2; ++d) out.force[d] = scales_.force * sum[d];
  if (!tangents) return;
  const double scale = scales_.force / g_.clearance;
  for (int i = 0; i < part.count(); ++i) {
    const std::array<double, 2> n = {ring_.cosine(part.begin + i), ring_.sine(part.begin + i)};
    for (int j = 0; j < inner(); ++j) {
      const std::size_t k = at(i * inner() + j), x = node(i + reach(), j + 1);
      for (std::size_t d = 0; d < 2; ++d) {
        const double slope = scale * forces_[k][d] * by_u_[x], rate = scale * forces_[k][d] * by_rate_[x];
        response.force_d_states[k][d] = slope;
        if (liner_.damped()) response.force_d_rates[k][d] = rate;
        for (std::size_t e = 0; e < 2; ++e) {
          out.d_position[d][e] += slope * n[e];
          out.d_velocity[d][e] += rate * n[e];
        }
      }
    }
  }
}

void FiniteFilm::residual(Lines part, const Motion& motion, std::span<const double> rates,
                          StateResponse& response) const {
  const auto cube = [](double x) { return x * x * x; };
  const double wedge = 0.5 * motion.speed / ring_.step(), c = g_.clearance;
  const auto [w0, w1, w2, w3] = neighbours_.slope;
  const std::size_t stride = node(1, 0);
  for (int i = 0; i < part.count(); ++i) {
    const double *h = &h_[node(i + reach(), 1)], *p = &p_[node(i + reach(), 1)];
    const double *hb = h - stride, *hf = h + stride, *pb = p - stride, *pf = p + stride;
    const double* hs = reach() == 2 ? hb - stride : hb;
    const double* rate = rates.data() + (i + reach()) * inner();
    double* g = &response.residual[at(i * inner())];
    const int line = part.begin + i;
    if (fixed(line)) {
      const double moved = motion.velocity[0] * ring_.cosine(line) + motion.velocity[1] * ring_.sine(line);
      for (int j = 0; j < inner(); ++j) g[j] = rate[j] + moved + release() * c * (h[j] - rigid(motion, line));
      continue;
    }
    for (int j = 0; j < inner(); ++j) {
      const double slope = w0 * hs[j] + w1 * hb[j] + w2 * h[j] + w3 * hf[j];
      const double in =
          around_ * (cube(0.5 * (h[j] + hf[j])) * (pf[j] - p[j]) - cube(0.5 * (hb[j] + h[j])) * (p[j] - pb[j])) +
          along_ *
              (cube(0.5 * (h[j] + h[j + 1])) * (p[j + 1] - p[j]) - cube(0.5 * (h[j - 1] + h[j])) * (p[j] - p[j - 1]));
      g[j] = rate[j] + c * (wedge * slope - in);
    }
  }
}

// A face between nodes a and b carries f = w ((h_a + h_b)/2)^3 (P_b - P_a) from b to a: df/dh_a = df/dh_b = q,
// df/dP_b = -df/dP_a = k. The P of a node follows its h and the journal; on an edge P is zero and h follows.
void FiniteFilm::derivatives(Lines part, double speed, StateResponse& response) const {
  const double wedge = 0.5 * speed / ring_.step();
  const auto [w0, w1, w2, w3] = neighbours_.slope;
  const std::size_t stride = node(1, 0);
  struct Face {
    double k, q;
  };
  const auto face = [](double w, double ha, double hb, double pa, double pb) {
    const double h = 0.5 * (ha + hb);
    return Face{w * h * h * h, 1.5 * w * h * h * (pb - pa)};
  };
  Stencil &s = response.by_states, &r = response.by_rates;
  for (int i = 0; i < part.count(); ++i) {
    const int line = part.begin + i;
    const std::array<double, 3> cosine = {ring_.cosine(line - 1), ring_.cosine(line), ring_.cosine(line + 1)},
                                sine = {ring_.sine(line - 1), ring_.sine(line), ring_.sine(line + 1)};
    const bool held = fixed(line);
    for (int j = 0; j < inner(); ++j) {
      const std::size_t k = at(i * inner() + j), x = node(i + reach(), j + 1);
      auto &position = response.d_position[k], &velocity = response.d_velocity[k];
      if (held) {
        s.at[Stencil::centre][k] = release();
        position = {release() * cosine[1], release() * sine[1], 0.0, 0.0};
        velocity = {cosine[1], sine[1], 0.0, 0.0};
        continue;
      }
      const double *h = &h_[x], *p = &p_[x], *u = &by_u_[x];
      const Face after = face(around_, h[0], h[stride], p[0], p[stride]),
                 before = face(around_, *(h - stride), h[0], *(p - stride), p[0]),
                 above = face(along_, h[0], h[1], p[0], p[1]), below = face(along_, h[-1], h[0], p[-1], p[0]);
      const double sum = after.k + before.k + above.k + below.k;
      const bool first = j == 0, last = j + 1 == inner();
      s.at[Stencil::centre][k] = w2 * wedge - (after.q - before.q + above.q - below.q) + u[0] * sum;
      s.at[Stencil::before][k] = w1 * wedge + before.q - *(u - stride) * before.k;
      s.at[Stencil::after][k] = w3 * wedge - after.q - u[stride] * after.k;
      if (reach() == 2) s.at[Stencil::second_before][k] = w0 * wedge;
      s.at[Stencil::below][k] = first ? 0.0 : below.q - u[-1] * below.k;
      s.at[Stencil::above][k] = last ? 0.0 : -above.q - u[1] * above.k;
      // Of the P that `slope` moves with the journal.
      const auto through = [&](const double* slope) {
        return std::array{-before.k * *(slope - stride), sum * slope[0] - below.k * slope[-1] - above.k * slope[1],
                          -after.k * slope[stride]};
      };
      const auto [pb, pc, pa] = through(u);
      const double edge = (first ? below.q : 0.0) - (last ? above.q : 0.0);
      position[0] = pb * cosine[0] + (pc - edge) * cosine[1] + pa * cosine[2];
      position[1] = pb * sine[0] + (pc - edge) * sine[1] + pa * sine[2];
      response.d_speed[k] =
          0.5 * g_.clearance / ring_.step() *
          (w1 * *(h - stride) + w2 * h[0] + w3 * h[stride] + (reach() == 2 ? w0 * *(h - 2 * stride) : 0.0));
      if (!liner_.damped()) continue;
      const double* d = &by_rate_[x];
      const auto [vb, vc, va] = through(d);
      velocity[0] = vb * cosine[0] + vc * cosine[1] + va * cosine[2];
      velocity[1] = vb * sine[0] + vc * sine[1] + va * sine[2];
      r.at[Stencil::centre][k] = 1.0 + d[0] * sum;
      r.at[Stencil::before][k] = -*(d - stride) * before.k;
      r.at[Stencil::after][k] = -d[stride] * after.k;
      r.at[Stencil::below][k] = -d[-1] * below.k;
      r.at[Stencil::above][k] = -d[1] * above.k;
    }
  }
}

void FiniteFilm::evaluate_lines(const Motion& motion, Lines part, std::span<const double> states,
                                std::span<const double> rates, Need need, StateResponse& response) {
  set(motion, part, states, rates);
  const std::size_t n = at(part.count() * inner()), m = need == Need::tangents ? n : 0;
  response.journal = {};
  response.residual.resize(n);
  response.d_position.assign(m, {});
  response.d_velocity.assign(m, {});
  response.d_speed.assign(m, 0.0);
  response.force_d_states.assign(m, {});
  response.force_d_rates.assign(liner_.damped() ? m : 0, {});
  for (std::size_t place = 0; place < Stencil::n_places; ++place) {
    const bool second = place == Stencil::second_before;
    response.by_states.at[place].assign(second && reach() == 1 ? 0 : m, 0.0);
    response.by_rates.at[place].assign(second || !liner_.damped() ? 0 : m, 0.0);
  }
  response.by_rates.at[Stencil::centre].assign(m, 1.0);
  response.journal.min_thickness =
      g_.clearance * *std::min_element(h_.begin() + static_cast<std::ptrdiff_t>(node(reach(), 0)),
                                       h_.begin() + static_cast<std::ptrdiff_t>(node(reach() + part.count(), 0)));
  integrate(part, need, response);
  residual(part, motion, rates, response);
  if (need == Need::tangents) derivatives(part, motion.speed, response);
}

// Deflections, periodic around and zero at the edges, are interpolated linearly in both directions.
void FiniteFilm::resample(const Motion& motion, const StateModel& other, std::span<const double> from,
                          std::span<double> to) const {
  const auto* mesh = dynamic_cast<const FiniteFilm*>(&other);
  core::require(mesh != nullptr && from.size() == mesh->states(), "states of another film of finite length");
  const auto deflection = [&](int i, int j) {
    if (j == 0 || j == mesh->cells_) return 0.0;
    const int line = i % mesh->ring_.nodes();
    return from[at(line * mesh->inner() + j - 1)] - g_.clearance * mesh->rigid(motion, line);
  };
  const auto place = [](int k, int n, int m) {  // node k of n in cells of m
    const double x = static_cast<double>(k) * m / n;
    const int cell = std::min(static_cast<int>(x), m - 1);
    return std::pair{cell, x - cell};
  };
  for (int i = 0; i < ring_.nodes(); ++i) {
    const auto [a, s] = place(i, ring_.nodes(), mesh->ring_.nodes());
    for (int j = 1; j < cells_; ++j) {
      const auto [b, t] = place(j, cells_, mesh->cells_);
      to[at(i * inner() + j - 1)] = rigid(motion, i) * g_.clearance +
                                    (1.0 - s) * ((1.0 - t) * deflection(a, b) + t * deflection(a, b + 1)) +
                                    s * ((1.0 - t) * deflection(a + 1, b) + t * deflection(a + 1, b + 1));
    }
  }
}

// Side flow (H^3/12 mu) dp/dz through both edges with one-sided slopes of second order; friction mu U/H on the whole
// circumference and half the pressure flow, -U/(2 R) int p dH/dtheta.
Summary FiniteFilm::summary(const Motion& motion, std::span<const double> states) {
  const Lines all{0, ring_.nodes()};
  set_settled(motion, states);
  Summary s;
  s.min_thickness = g_.clearance * *std::min_element(h_.begin(), h_.end());
  const double U = motion.speed * g_.radius, area = ring_.step() * g_.radius * g_.length / cells_;
  const std::size_t stride = node(1, 0);
  for (int i = 0; i < all.end; ++i)
    for (int j = 0; j <= cells_; ++j) {
      const bool edge = j == 0 || j == cells_;
      const std::size_t k = node(i + reach(), j);
      const double p = scales_.pressure * std::max(p_[k], 0.0), h = g_.clearance * h_[k];
      s.max_pressure = std::max(s.max_pressure, p);
      const double slope = g_.clearance * (h_[k + stride] - h_[k - stride]) / (2.0 * ring_.step());
      s.power_loss += (edge ? 0.5 : 1.0) * area * U * (viscosity_ * U / h - 0.5 * p * slope / g_.radius);
      if (!edge) continue;
      const std::size_t first = j == 0 ? k + 1 : k - 1, second = j == 0 ? k + 2 : k - 2;
      const double rise = scales_.pressure * (4.0 * std::max(p_[first], 0.0) - std::max(p_[second], 0.0)) / 2.0;
      s.side_flow += ring_.step() * g_.radius * h * h * h / (12.0 * viscosity_) * rise * cells_ / g_.length;
    }
  return s;
}

std::vector<Field> FiniteFilm::fields(const Motion& motion, std::span<const double> states) {
  const Lines all{0, ring_.nodes()};
  set_settled(motion, states);
  const std::size_t around = at(all.end + 1), along = at(cells_ + 1);
  Field theta{0, "theta", "rad", {around}, {}}, z{0, "z", "m", {along}, {}};
  Field pressure{0, "pressure", "Pa", {around, along}, {}}, h{0, "thickness", "m", {around, along}, {}};
  for (int j = 0; j <= cells_; ++j) z.values.push_back(g_.length * (static_cast<double>(j) / cells_ - 0.5));
  for (int i = 0; i <= all.end; ++i) {
    theta.values.push_back(ring_.angle(i));
    for (int j = 0; j <= cells_; ++j) {
      pressure.values.push_back(scales_.pressure * p_[node(i + reach(), j)]);
      h.values.push_back(g_.clearance * h_[node(i + reach(), j)]);
    }
  }
  return {theta, z, pressure, h};
}

}  // namespace

std::unique_ptr<StateModel> make_compliant_finite(const Geometry& g, const Options& options,
                                                  const Lubricant& lubricant) {
  check_compliant(g, options, lubricant);
  return std::make_unique<FiniteFilm>(g, options, lubricant);
}

}  // namespace whirl::film
