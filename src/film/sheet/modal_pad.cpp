// Aligned pad by sine modes along z.
//
// h does not depend on z, so p_ij = sum_k S_kj q_ik with S_kj = c_k sin(k pi j/n_z), k odd, turns the five-point
// equation into one tridiagonal system per mode around the pad,
//     A_k q_k = -src,   (A_k q)_i = G [a_(i-1/2) (q_i - q_(i-1)) - a_(i+1/2) (q_(i+1) - q_i)] + s_k b_i q_i,
// G = 1/(R dtheta)^2, s_k = (2/dz sin(k pi/(2 n_z)))^2, c_k = (2/n_z) cot(k pi/(2 n_z)) (the sine coefficients of 1).
// Eight modes share a Pack. With m_k = A_k^-1 dF/dq_k the derivative of any force in any parameter is
//     dF = -sum_k m_k . (d src + dA_k q_k).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "film/algebra/pack.hpp"
#include "film/fluid/mobility.hpp"
#include "film/sheet/pad.hpp"
#include "whirl/thermal/truncation.hpp"

namespace whirl::film {
namespace {

using thermal::EdgeInterval, thermal::IntervalIntegral, thermal::truncated_edge, thermal::truncated_linear;

class ModalPad final : public PadSolver {
public:
  ModalPad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant);
  void add(const JournalMotion& motion, Need need, Response& response) override;
  std::vector<double> pressure(const JournalMotion& motion) override;

private:
  enum class Strip : unsigned char { full, empty, mixed };
  void thickness(const JournalMotion& motion);
  void factor_and_solve();
  void synthesise();
  void truncate(bool gradient);
  struct Edge {  // the strip between an edge and its neighbour column `near`; its parabola also uses column `far`
    std::size_t strip, near, far;
    std::vector<Pack> load_far;
  };
  void analyse(const std::vector<Pack>& rows, Pack* modes) const;
  void integrate_mixed(std::size_t strip, bool gradient);
  void integrate_edge(Edge& edge, bool gradient);
  void adjoint(const JournalMotion& motion, Response& response);
  double node(std::size_t i, std::size_t j) const { return scalars(p_)[i * stride_ + j]; }

  Pad pad_;
  Grid grid_;
  LeastThickness least_;
  bool truncated_;
  Resistance around_, along_;
  double viscosity_, density_;
  int n_modes_;          // odd modes = nodes in half the length
  std::size_t n_packs_;  // packs of modes, and of half-length nodes
  std::size_t stride_;   // doubles per column of nodes
  double cell_area_;     // R dtheta dz

  std::vector<Pack> s_;           // [pack] eigenvalues s_k; 1 in unused lanes
  std::vector<Pack> synthesis_;   // [mode][pack of nodes] S_kj
  std::vector<Pack> analysis_;    // [node][pack of modes] S_kj
  std::vector<Pack> row_weight_;  // [pack of nodes] area of a cell times the rows of the pad that a row stands for
  std::vector<Pack> strip_load_;  // [pack of modes] derivative of the integral over a full strip in one of its columns

  std::array<Edge, 2> edges_;

  // Per evaluation, around the pad. Faces lie at i + 1/2.
  double X_ = 0.0, Y_ = 0.0, h_min_ = 0.0;
  std::vector<double> h_face_, h_node_, a_, a_h_, a_speed_, b_, b_h_, b_speed_, source_;
  std::vector<Pack> q_, multiplier_, inverse_;  // [pack of modes][n_theta + 1]
  std::vector<Pack> p_;                         // [n_theta + 1][pack of half-length nodes]
  std::vector<Pack> y_x_, y_y_;                 // [n_theta + 1] of one pack of modes, forward sweeps of the adjoints
  std::vector<Strip> strip_;                    // [n_theta]
  std::vector<double> integral_;                // [n_theta] of max(p, 0) over mixed strips
  std::vector<Pack> rows_left_, rows_right_;    // [pack of nodes] derivatives of one strip integral
  std::vector<Pack> load_left_, load_right_;    // [n_theta][pack of modes] derivatives of the strip integrals
};

ModalPad::ModalPad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant)
    : pad_(pad),
      grid_(pad, options.cells),
      least_(pad),
      truncated_(options.cavitation == Reynolds::Cavitation::half_sommerfeld),
      around_(resistance_around(options.turbulence)),
      along_(resistance_along(options.turbulence)),
      viscosity_(lubricant.viscosity),
      density_(lubricant.density),
      n_modes_(grid_.n_z / 2),
      n_packs_(packs(n_modes_)),
      stride_(n_packs_ * kLanes),
      cell_area_(pad.radius * grid_.dtheta * grid_.dz) {
  const auto n_faces = static_cast<std::size_t>(grid_.n_theta);
  const auto n_nodes = n_faces + 1;
  const auto modes = static_cast<std::size_t>(n_modes_);
  s_.assign(n_packs_, Pack::fill(1.0));
  synthesis_.assign(modes * n_packs_, Pack::zero());
  analysis_.assign(modes * n_packs_, Pack::zero());
  for (auto* v : {&strip_load_, &row_weight_, &rows_left_, &rows_right_}) v->assign(n_packs_, Pack::zero());
  for (std::size_t m = 0; m < modes; ++m) {
    const double angle = (2.0 * static_cast<double>(m) + 1.0) * std::numbers::pi / grid_.n_z;
    const double root = 2.0 / grid_.dz * std::sin(0.5 * angle);
    const double c = 2.0 / grid_.n_z / std::tan(0.5 * angle);
    scalars(s_)[m] = root * root;
    for (std::size_t j = 0; j < modes; ++j) {
      const double value = c * std::sin(angle * static_cast<double>(j + 1));
      scalars(synthesis_)[m * stride_ + j] = value;
      scalars(analysis_)[j * stride_ + m] = value;
      const bool middle = grid_.n_z % 2 == 0 && j + 1 == modes;
      scalars(row_weight_)[j] = cell_area_ * (middle ? 1.0 : 2.0);
      scalars(strip_load_)[m] += 0.5 * value * scalars(row_weight_)[j];
    }
  }
  for (auto* v : {&h_face_, &a_, &a_h_, &a_speed_, &integral_}) v->assign(n_faces, 0.0);
  for (auto* v : {&h_node_, &b_, &b_h_, &b_speed_, &source_}) v->assign(n_nodes, 0.0);
  for (auto* v : {&q_, &multiplier_, &inverse_, &p_}) v->assign(n_nodes * n_packs_, Pack::zero());
  for (auto* v : {&y_x_, &y_y_}) v->assign(n_nodes, Pack::zero());
  for (auto* v : {&load_left_, &load_right_}) v->assign(n_faces * n_packs_, Pack::zero());
  strip_.assign(n_faces, Strip::full);
  edges_[0] = {0, 1, 2, std::vector<Pack>(n_packs_, Pack::zero())};
  edges_[1] = {n_faces - 1, n_faces - 1, n_faces - 2, std::vector<Pack>(n_packs_, Pack::zero())};
}

void ModalPad::thickness(const JournalMotion& motion) {
  const int n = grid_.n_theta;
  X_ = motion.position[0] - pad_.centre_x;
  Y_ = motion.position[1] - pad_.centre_y;
  const double X = X_, Y = Y_, c = pad_.clearance;
  const double *nc = grid_.node_cos.data(), *ns = grid_.node_sin.data();
  const double *fc = grid_.face_cos.data(), *fs = grid_.face_sin.data();
  h_min_ = least_(X, Y);
  require_thickness(h_min_);
  h_node_[static_cast<std::size_t>(n)] = c - X * nc[n] - Y * ns[n];
  for (int i = 0; i < n; ++i) {
    h_node_[static_cast<std::size_t>(i)] = c - X * nc[i] - Y * ns[i];
    h_face_[static_cast<std::size_t>(i)] = c - X * fc[i] - Y * fs[i];
  }

  const double speed = motion.speed;
  const double step = pad_.radius * grid_.dtheta;
  const double inverse_speed = speed == 0.0 ? 0.0 : 1.0 / speed;
  const double reynolds_per_h = density_ * std::abs(speed) * pad_.radius / viscosity_;
  mobility(around_, {1.0 / (viscosity_ * step * step), reynolds_per_h, inverse_speed}, n, h_face_.data(), a_.data(),
           a_h_.data(), a_speed_.data());
  mobility(along_, {1.0 / viscosity_, reynolds_per_h, inverse_speed}, n + 1, h_node_.data(), b_.data(), b_h_.data(),
           b_speed_.data());

  // Exact cell means of (Omega/2) dh/dtheta + dh/dt: a half-speed whirl of h gives no source at all.
  const double along_sin = grid_.mean * (0.5 * speed * X - motion.velocity[1]);
  const double along_cos = -grid_.mean * (0.5 * speed * Y + motion.velocity[0]);
  for (int i = 0; i <= n; ++i) source_[static_cast<std::size_t>(i)] = along_sin * ns[i] + along_cos * nc[i];
}

void ModalPad::factor_and_solve() {
  const int n = grid_.n_theta;
  for (std::size_t pack = 0; pack < n_packs_; ++pack) {
    const Pack s = s_[pack];
    Pack* const q = &q_[pack * static_cast<std::size_t>(n + 1)];
    Pack* const l = &multiplier_[pack * static_cast<std::size_t>(n + 1)];
    Pack* const inverse = &inverse_[pack * static_cast<std::size_t>(n + 1)];
    const double *a = a_.data(), *b = b_.data(), *f = source_.data();
    Pack inv = 1.0 / ((a[0] + a[1]) + b[1] * s);
    inverse[1] = inv;
    q[1] = Pack::fill(-f[1]);
    for (int i = 2; i < n; ++i) {
      const Pack d = ((a[i - 1] + a[i]) + b[i] * s) - (a[i - 1] * a[i - 1]) * inv;
      l[i] = a[i - 1] * inv;
      q[i] = l[i] * q[i - 1] - Pack::fill(f[i]);
      inv = 1.0 / d;
      inverse[i] = inv;
    }
    q[n - 1] = q[n - 1] * inv;
    for (int i = n - 2; i > 0; --i) q[i] = q[i] * inverse[i] + l[i + 1] * q[i + 1];
  }
}

void ModalPad::synthesise() {
  const int n = grid_.n_theta;
  for (int i = 1; i < n; ++i) {
    for (std::size_t pack = 0; pack < n_packs_; ++pack) {
      Pack even = Pack::zero(), odd = Pack::zero();
      for (std::size_t source = 0; source < n_packs_; ++source) {
        const double* q =
            scalars(q_) + (source * static_cast<std::size_t>(n + 1) + static_cast<std::size_t>(i)) * kLanes;
        const int count = std::min(kLanes, n_modes_ - static_cast<int>(source) * kLanes);
        const Pack* S = &synthesis_[source * kLanes * n_packs_ + pack];
        int k = 0;
        for (; k + 1 < count; k += 2) {
          even += q[k] * S[static_cast<std::size_t>(k) * n_packs_];
          odd += q[k + 1] * S[static_cast<std::size_t>(k + 1) * n_packs_];
        }
        if (k < count) even += q[k] * S[static_cast<std::size_t>(k) * n_packs_];
      }
      p_[static_cast<std::size_t>(i) * n_packs_ + pack] = even + odd;
    }
  }
}

void ModalPad::truncate(bool gradient) {
  const std::size_t n = h_face_.size();
  if (!truncated_) return;
  synthesise();
  double low_left = 0.0, high_left = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    Pack low = p_[i * n_packs_], high = low;
    for (std::size_t pack = 1; pack < n_packs_; ++pack) {
      low = min(low, p_[i * n_packs_ + pack]);
      high = max(high, p_[i * n_packs_ + pack]);
    }
    const double low_right = lowest(low), high_right = highest(high);
    strip_[i - 1] = std::min(low_left, low_right) >= 0.0     ? Strip::full
                    : std::max(high_left, high_right) <= 0.0 ? Strip::empty
                                                             : Strip::mixed;
    if (strip_[i - 1] == Strip::mixed && i > 1) integrate_mixed(i - 1, gradient);
    low_left = low_right;
    high_left = high_right;
  }
  for (Edge& edge : edges_) integrate_edge(edge, gradient);
}

// Derivatives in nodal pressures, given per row, turned into derivatives in the modes.
void ModalPad::analyse(const std::vector<Pack>& rows, Pack* modes) const {
  const double* g = scalars(rows);
  std::fill(modes, modes + n_packs_, Pack::zero());
  for (std::size_t j = 0; j < static_cast<std::size_t>(n_modes_); ++j) {
    for (std::size_t pack = 0; pack < n_packs_; ++pack) modes[pack] += g[j] * analysis_[j * n_packs_ + pack];
  }
}

// A strip between two columns of nodes whose pressures differ in sign.
void ModalPad::integrate_mixed(std::size_t strip, bool gradient) {
  Pack total = Pack::zero();
  for (std::size_t pack = 0; pack < n_packs_; ++pack) {
    const IntervalIntegral<Pack> part =
        truncated_linear(p_[strip * n_packs_ + pack], p_[(strip + 1) * n_packs_ + pack]);
    const Pack weight = row_weight_[pack];
    total += weight * part.integral;
    rows_left_[pack] = weight * part.d_left;
    rows_right_[pack] = weight * part.d_right;
  }
  integral_[strip] = sum(total);
  if (!gradient) return;
  analyse(rows_left_, &load_left_[strip * n_packs_]);
  analyse(rows_right_, &load_right_[strip * n_packs_]);
}

// The first and the last strip.
void ModalPad::integrate_edge(Edge& edge, bool gradient) {
  Pack* const near = edge.near == 1 ? &load_right_[0] : &load_left_[edge.strip * n_packs_];
  double total = 0.0;
  for (std::size_t j = 0; j < static_cast<std::size_t>(n_modes_); ++j) {
    const EdgeInterval part = truncated_edge(node(edge.near, j), node(edge.far, j));
    const double weight = scalars(row_weight_)[j];
    total += weight * part.integral;
    scalars(rows_left_)[j] = weight * part.d_near;
    scalars(rows_right_)[j] = weight * part.d_far;
  }
  if (gradient) {
    analyse(rows_left_, near);
    analyse(rows_right_, edge.load_far.data());
  }
  integral_[edge.strip] = total;
  strip_[edge.strip] = Strip::mixed;
}

void ModalPad::add(const JournalMotion& motion, Need need, Response& response) {
  thickness(motion);
  factor_and_solve();
  truncate(need == Need::tangents);
  const int n = grid_.n_theta;
  const auto nodes = static_cast<std::size_t>(n + 1);
  double fx = 0.0, fy = 0.0;
  Pack sum_x = Pack::zero(), sum_y = Pack::zero();
  for (int i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (strip_[at] == Strip::empty) continue;
    if (strip_[at] == Strip::mixed) {
      fx += grid_.face_cos[at] * integral_[at];
      fy += grid_.face_sin[at] * integral_[at];
      continue;
    }
    for (std::size_t pack = 0; pack < n_packs_; ++pack) {
      const Pack* q = &q_[pack * nodes + at];
      const Pack I = strip_load_[pack] * (q[0] + q[1]);
      sum_x += grid_.face_cos[at] * I;
      sum_y += grid_.face_sin[at] * I;
    }
  }
  response.force[0] -= grid_.mean * (fx + sum(sum_x));
  response.force[1] -= grid_.mean * (fy + sum(sum_y));
  response.min_thickness = std::min(response.min_thickness, h_min_);
  if (need == Need::tangents) adjoint(motion, response);
}

void ModalPad::adjoint(const JournalMotion& motion, Response& response) {
  const int n = grid_.n_theta;
  const auto nodes = static_cast<std::size_t>(n + 1);
  struct Sums {
    Pack face_cos = Pack::zero(), face_sin = Pack::zero(), speed = Pack::zero();
    Pack source_cos = Pack::zero(), source_sin = Pack::zero();
  };
  std::array<Sums, 2> sums;
  for (std::size_t pack = 0; pack < n_packs_; ++pack) {
    const Pack* const q = &q_[pack * nodes];
    const Pack* const l = &multiplier_[pack * nodes];
    const Pack* const inverse = &inverse_[pack * nodes];
    const Pack zero = Pack::zero(), full = strip_load_[pack];
    const auto load = [&](int strip, const std::vector<Pack>& mixed) {
      const auto at = static_cast<std::size_t>(strip);
      return strip_[at] == Strip::full ? full : strip_[at] == Strip::empty ? zero : mixed[at * n_packs_ + pack];
    };
    Pack previous_x = zero, previous_y = zero;
    for (int i = 1; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const Pack from_left = load(i - 1, load_right_), from_right = load(i, load_left_);
      previous_x = grid_.face_cos[at - 1] * from_left + grid_.face_cos[at] * from_right + l[i] * previous_x;
      previous_y = grid_.face_sin[at - 1] * from_left + grid_.face_sin[at] * from_right + l[i] * previous_y;
      for (const Edge& edge : edges_) {
        if (edge.far != at) continue;
        previous_x += grid_.face_cos[edge.strip] * edge.load_far[pack];
        previous_y += grid_.face_sin[edge.strip] * edge.load_far[pack];
      }
      y_x_[at] = previous_x;
      y_y_[at] = previous_y;
    }
    std::array<Pack, 2> right = {zero, zero};
    for (int i = n - 1; i >= 0; --i) {
      const auto at = static_cast<std::size_t>(i);
      std::array<Pack, 2> m = {zero, zero};
      if (i > 0) {
        m[0] = y_x_[at] * inverse[i] + l[i + 1] * right[0];
        m[1] = y_y_[at] * inverse[i] + l[i + 1] * right[1];
      }
      const Pack jump = q[i + 1] - q[i];
      const Pack level = s_[pack] * q[i];
      for (std::size_t f = 0; f < 2; ++f) {
        Sums& S = sums[f];
        const Pack across = (right[f] - m[f]) * jump, along = m[f] * level;
        S.face_cos += (a_h_[at] * grid_.face_cos[at]) * across + (b_h_[at] * grid_.node_cos[at]) * along;
        S.face_sin += (a_h_[at] * grid_.face_sin[at]) * across + (b_h_[at] * grid_.node_sin[at]) * along;
        S.speed += a_speed_[at] * across + b_speed_[at] * along;
        S.source_cos += grid_.node_cos[at] * m[f];
        S.source_sin += grid_.node_sin[at] * m[f];
        right[f] = m[f];
      }
    }
  }
  // F = -mean sum(load q), and m = A^-1 load: dF = mean sum m (d src + dA q); dh = -cos dx - sin dy.
  for (std::size_t f = 0; f < 2; ++f) {
    const double source_cos = grid_.mean * sum(sums[f].source_cos), source_sin = grid_.mean * sum(sums[f].source_sin);
    const double half = 0.5 * motion.speed, mean = grid_.mean;
    response.d_position[f][0] += mean * (half * source_sin - sum(sums[f].face_cos));
    response.d_position[f][1] += mean * (-half * source_cos - sum(sums[f].face_sin));
    response.d_velocity[f][0] -= mean * source_cos;
    response.d_velocity[f][1] -= mean * source_sin;
    response.d_speed[f] += mean * (0.5 * (X_ * source_sin - Y_ * source_cos) + sum(sums[f].speed));
  }
}

std::vector<double> ModalPad::pressure(const JournalMotion& motion) {
  thickness(motion);
  factor_and_solve();
  synthesise();
  std::vector<double> values;
  for (int i = 0; i <= grid_.n_theta; ++i) {
    for (int j = 0; j <= grid_.n_z; ++j) {
      const int from_side = std::min(j, grid_.n_z - j);
      const double p =
          from_side == 0 ? 0.0 : node(static_cast<std::size_t>(i), static_cast<std::size_t>(from_side - 1));
      values.push_back(truncated_ ? std::max(p, 0.0) : p);
    }
  }
  return values;
}

}  // namespace

std::unique_ptr<PadSolver> make_modal_pad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant) {
  return std::make_unique<ModalPad>(pad, options, lubricant);
}

}  // namespace whirl::film
