// Film of finite length in a full cylindrical bore with an elastic liner: the thickness on a mesh around and along the
// bearing is the state.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "film/compliant.hpp"
#include "film/kinds.hpp"
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
// with h at faces midway between nodes from both neighbours.
class FiniteFilm final : public StateModel {
public:
  FiniteFilm(const Geometry& geometry, const Options& options, const Lubricant& lubricant)
      : g_(geometry),
        viscosity_(lubricant.viscosity),
        simpson_(options.quadrature == Options::Quadrature::simpson),
        upwind_(options.differences == Options::Differences::upwind),
        cells_(options.cells[1]),
        scales_(geometry, options, lubricant),
        ring_(options.cells[0], options.quadrature) {
    const double slenderness = g_.length / g_.radius;  // 2 L/D
    around_ = 0.5 / (ring_.step() * ring_.step());
    along_ = 0.5 * cells_ * cells_ / (slenderness * slenderness);
    for (int j = 1; j < cells_; ++j)
      z_weight_.push_back((simpson_ ? (j % 2 == 0 ? 2.0 : 4.0) / 3.0 : 1.0) / static_cast<double>(cells_));
  }

  [[nodiscard]] std::size_t states() const override { return at(ring_.nodes() * inner()); }
  [[nodiscard]] Ring ring() const override { return {ring_.nodes(), upwind_ ? 2 : 1}; }
  [[nodiscard]] int row_entries() const override { return Stencil::n_places + 1; }
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
  [[nodiscard]] int reach() const { return upwind_ ? 2 : 1; }
  [[nodiscard]] double rigid(const Motion& m, int line) const {
    return 1.0 - (m.position[0] * ring_.cosine(line) + m.position[1] * ring_.sine(line)) / g_.clearance;
  }
  // Node j (0 and `cells_` on the edges) of the line at `row` of the work space.
  [[nodiscard]] std::size_t node(int row, int j) const { return at(row * (cells_ + 1) + j); }
  void set(const Motion& motion, Lines part, std::span<const double> states);
  void integrate(Lines part, Need need, StateResponse& response);
  void residual(Lines part, double speed, std::span<const double> rates, StateResponse& response) const;
  void derivatives(Lines part, double speed, StateResponse& response) const;

  Geometry g_;
  double viscosity_;
  bool simpson_, upwind_;
  int cells_;  // along the bearing
  CompliantScales scales_;
  RingQuadrature ring_;
  double around_ = 0.0, along_ = 0.0;  // 1/(2 d^2), s/2
  std::vector<double> z_weight_;       // of the mean along z, per inner node
  // Of the lines at hand and their neighbours, with the edges: h in clearances, P in 1/s.
  std::vector<double> h_, p_;
  std::vector<std::array<double, 2>> forces_;  // d force*/d P of the lines at hand
};

void FiniteFilm::set(const Motion& motion, Lines part, std::span<const double> states) {
  const int rows = part.count() + 2 * reach();
  core::require(states.size() == at(rows * inner()), "lines of a film with their neighbours");
  h_.resize(at(rows * (cells_ + 1)));
  p_.resize(h_.size());
  const double clearance = 1.0 / g_.clearance, stiffness = 1.0 / scales_.liner;
  double least = 1.0;
  bool numbers = true;
  for (int row = 0; row < rows; ++row) {
    const double r = rigid(motion, part.begin - reach() + row);
    double *h = &h_[node(row, 0)], *p = &p_[node(row, 0)];
    const double* s = states.data() + row * inner() - 1;
    h[0] = h[cells_] = r;
    p[0] = p[cells_] = 0.0;
    least = std::min(least, r);
    for (int j = 1; j < cells_; ++j) {
      h[j] = s[j] * clearance;
      p[j] = (h[j] - r) * stiffness;
      least = std::min(least, h[j]);
      numbers = numbers && !std::isnan(h[j]);
    }
  }
  if (!(least > 0.0 && numbers))
    throw core::DomainError("the journal touches the liner: the film thickness is not positive");
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
  const double scale = scales_.force / (scales_.liner * g_.clearance);
  for (int i = 0; i < part.count(); ++i) {
    const double c = ring_.cosine(part.begin + i), s = ring_.sine(part.begin + i);
    for (int j = 0; j < inner(); ++j)
      for (std::size_t d = 0; d < 2; ++d) {
        const double slope = scale * forces_[at(i * inner() + j)][d];
        response.force_d_states[at(i * inner() + j)][d] = slope;
        out.d_position[d][0] += slope * c;
        out.d_position[d][1] += slope * s;
      }
  }
}

void FiniteFilm::residual(Lines part, double speed, std::span<const double> rates, StateResponse& response) const {
  const auto cube = [](double x) { return x * x * x; };
  const double wedge = 0.25 * speed / ring_.step(), c = g_.clearance;
  const std::size_t stride = node(1, 0);
  for (int i = 0; i < part.count(); ++i) {
    const double *h = &h_[node(i + reach(), 1)], *p = &p_[node(i + reach(), 1)];
    const double *hb = h - stride, *hf = h + stride, *pb = p - stride, *pf = p + stride;
    const double* hs = upwind_ ? hb - stride : hb;
    const double* rate = rates.data() + (i + reach()) * inner();
    double* g = &response.residual[at(i * inner())];
    for (int j = 0; j < inner(); ++j) {
      const double slope = upwind_ ? 3.0 * h[j] - 4.0 * hb[j] + hs[j] : hf[j] - hb[j];
      const double in =
          around_ * (cube(0.5 * (h[j] + hf[j])) * (pf[j] - p[j]) - cube(0.5 * (hb[j] + h[j])) * (p[j] - pb[j])) +
          along_ *
              (cube(0.5 * (h[j] + h[j + 1])) * (p[j + 1] - p[j]) - cube(0.5 * (h[j - 1] + h[j])) * (p[j] - p[j - 1]));
      g[j] = rate[j] + c * (wedge * slope - in);
    }
  }
}

// A face between nodes a and b carries f = w ((h_a + h_b)/2)^3 (P_b - P_a) from b to a: df/dh_a = df/dh_b = q,
// df/dP_b = -df/dP_a = k. A node's P = (h - 1 + e_x cos + e_y sin)/b.
void FiniteFilm::derivatives(Lines part, double speed, StateResponse& response) const {
  const double wedge = 0.25 * speed / ring_.step(), stiffness = 1.0 / scales_.liner;
  const std::size_t stride = node(1, 0);
  struct Face {
    double k, q;
  };
  const auto face = [](double w, double ha, double hb, double pa, double pb) {
    const double h = 0.5 * (ha + hb);
    return Face{w * h * h * h, 1.5 * w * h * h * (pb - pa)};
  };
  Stencil& s = response.by_states;
  for (int i = 0; i < part.count(); ++i) {
    const int line = part.begin + i;
    const double *h = &h_[node(i + reach(), 1)], *p = &p_[node(i + reach(), 1)];
    const std::array<double, 3> cosine = {ring_.cosine(line - 1), ring_.cosine(line), ring_.cosine(line + 1)},
                                sine = {ring_.sine(line - 1), ring_.sine(line), ring_.sine(line + 1)};
    for (int j = 0; j < inner(); ++j) {
      const std::size_t k = at(i * inner() + j);
      const double *hj = h + j, *pj = p + j;
      const Face after = face(around_, hj[0], hj[stride], pj[0], pj[stride]),
                 before = face(around_, *(hj - stride), hj[0], *(pj - stride), pj[0]),
                 above = face(along_, hj[0], hj[1], pj[0], pj[1]), below = face(along_, hj[-1], hj[0], pj[-1], pj[0]);
      const double sum = after.k + before.k + above.k + below.k;
      s.at[Stencil::centre][k] =
          (upwind_ ? 3.0 * wedge : 0.0) - (after.q - before.q + above.q - below.q) + stiffness * sum;
      s.at[Stencil::before][k] = (upwind_ ? -4.0 : -1.0) * wedge + before.q - stiffness * before.k;
      s.at[Stencil::after][k] = (upwind_ ? 0.0 : wedge) - after.q - stiffness * after.k;
      if (upwind_) s.at[Stencil::second_before][k] = wedge;
      const double below_h = below.q, above_h = -above.q;
      s.at[Stencil::below][k] = j > 0 ? below_h - stiffness * below.k : 0.0;
      s.at[Stencil::above][k] = j + 1 < inner() ? above_h - stiffness * above.k : 0.0;
      // P of the inner nodes follows the journal; on an edge P is zero and h follows.
      const double own = sum - (j > 0 ? below.k : 0.0) - (j + 1 < inner() ? above.k : 0.0);
      const double edge = (j > 0 ? 0.0 : below_h) + (j + 1 < inner() ? 0.0 : above_h);
      auto& d = response.d_position[k];
      d[0] = stiffness * (own * cosine[1] - before.k * cosine[0] - after.k * cosine[2]) - edge * cosine[1];
      d[1] = stiffness * (own * sine[1] - before.k * sine[0] - after.k * sine[2]) - edge * sine[1];
      const double slope =
          upwind_ ? 3.0 * hj[0] - 4.0 * *(hj - stride) + *(hj - 2 * stride) : hj[stride] - *(hj - stride);
      response.d_speed[k] = 0.25 * g_.clearance / ring_.step() * slope;
    }
  }
}

void FiniteFilm::evaluate_lines(const Motion& motion, Lines part, std::span<const double> states,
                                std::span<const double> rates, Need need, StateResponse& response) {
  set(motion, part, states);
  const std::size_t n = at(part.count() * inner()), m = need == Need::tangents ? n : 0;
  response.journal = {};
  response.residual.resize(n);
  response.d_position.assign(m, {});
  response.d_velocity.assign(m, {});
  response.d_speed.assign(m, 0.0);
  response.force_d_states.assign(m, {});
  for (std::size_t place = 0; place < Stencil::n_places; ++place)
    response.by_states.at[place].assign(place == Stencil::second_before && !upwind_ ? 0 : m, 0.0);
  response.by_rates.at[Stencil::centre].assign(m, 1.0);
  response.journal.min_thickness =
      g_.clearance * *std::min_element(h_.begin() + static_cast<std::ptrdiff_t>(node(reach(), 0)),
                                       h_.begin() + static_cast<std::ptrdiff_t>(node(reach() + part.count(), 0)));
  integrate(part, need, response);
  residual(part, motion.speed, rates, response);
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
  set(motion, all, with_neighbours(*this, all, states));
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
  set(motion, all, with_neighbours(*this, all, states));
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
