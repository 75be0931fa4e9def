// Rows and derivatives of one pad with heat, face by face and node by node.
#include "film/heat/thd_pad.hpp"

#include <algorithm>
#include <cmath>

#include "film/fluid/mobility.hpp"
#include "film/heat/thd_pad_flow.hpp"
#include "film/heat/thd_pad_report.hpp"
#include "whirl/thermal/truncation.hpp"

namespace whirl::film {

using thermal::EdgeInterval, thermal::IntervalIntegral, thermal::truncated_edge, thermal::truncated_linear;
namespace {

// Conduction across a film of L layers, in lambda/h: out of layer k flows (K T - b)_k. One layer is a parabola, which a
// wall of given temperature takes 6 T - 4 T_wall - 2 T_other from between two such walls, 3 (T - T_wall) beside an
// adiabatic one.
void conduction(const Thd& o, auto& k, auto& b) {
  const int n = o.layers;
  k.setZero(n, n);
  b.setZero(n);
  const std::array<const HeatedWall*, 2> walls = {&o.bush, &o.journal};
  const auto held = [&](std::size_t w) { return walls[w]->type == HeatedWall::Type::isothermal; };
  if (n == 1) {
    const double each = held(0) && held(1) ? 6.0 : 3.0;
    for (std::size_t w = 0; w < 2; ++w)
      if (held(w)) {
        k(0, 0) += each;
        b(0) += each * walls[w]->temperature;
      }
    return;
  }
  for (int i = 0; i + 1 < n; ++i) {
    k(i, i) += n;
    k(i + 1, i + 1) += n;
    k(i, i + 1) -= n;
    k(i + 1, i) -= n;
  }
  for (std::size_t w = 0; w < 2; ++w) {
    if (!held(w)) continue;
    const int i = w == 0 ? 0 : n - 1;
    k(i, i) += 2.0 * n;
    b(i) += 2.0 * n * walls[w]->temperature;
  }
}

}  // namespace

template <int Count, int Most>
ThdPad<Count, Most>::ThdPad(const Pad& pad, const Thd& options, const Lubricant& lubricant)
    : pad_(pad),
      options_(options),
      grid_(pad, options.cells),
      least_(pad),
      lubricant_(lubricant),
      whole_(options.tilt),
      layers_(options.layers),
      columns_(grid_.n_theta + 1),
      rows_(whole_ ? grid_.n_z + 1 : grid_.n_z / 2 + 1),
      resistance_around_(resistance_around(options.turbulence)),
      resistance_along_(resistance_along(options.turbulence)),
      couette_(couette_excess(options.turbulence)),
      profile_(options.layers),
      viscosity_(options.viscosity ? options.viscosity->law
                                   : thermal::Viscosity(thermal::ConstantViscosity{lubricant.viscosity})) {
  mean_.resize(options.layers);
  conduction(options, conduction_, walls_);
  const double step = pad.radius * grid_.dtheta;
  over_rho_c_ = 1.0 / (lubricant.density * options.heat_capacity);
  diffusivity_ = options.layers * options.conductivity * over_rho_c_;
  hold_ = pad.clearance * pad.clearance * pad.clearance / (12.0 * lubricant.viscosity * step * step);
  lay_out();
}

template <int Count, int Most>
void ThdPad<Count, Most>::lay_out() {
  const double step = pad_.radius * grid_.dtheta;
  nodes_.resize(static_cast<std::size_t>(nodes()));
  sides_.assign(nodes_.size(), {{{-1, -1}, {-1, 1}, {-1, -1}, {-1, 1}}});
  for (int i = 0; i < columns_; ++i)
    for (int j = 0; j < rows_; ++j) {
      Node& n = nodes_[node(i, j)];
      const bool first = i == 0 || i + 1 == columns_, side = j == 0 || (whole_ && j + 1 == rows_);
      const bool halved = side || (!whole_ && grid_.n_z % 2 == 0 && j + 1 == rows_);
      n.edge = first || side;
      n.along = grid_.dz * (halved ? 0.5 : 1.0);
      n.area = n.along * step * (first ? 0.5 : 1.0);
      n.over_area = 1.0 / n.area;
      n.z = j * grid_.dz - 0.5 * pad_.length;
      const auto k = static_cast<std::size_t>(i);
      const double mean = first ? 1.0 : grid_.mean;
      n.cosine = mean * grid_.node_cos[k];
      n.sine = mean * grid_.node_sin[k];
      n.mu.resize(layers_);
      n.mu_t.resize(layers_);
    }
  const auto add = [&](int i, int j, bool around) {
    Face f;
    const std::size_t from = node(i, j), to = around ? node(i + 1, j) : node(i, j + 1);
    const auto k = static_cast<std::size_t>(i);
    f.from = static_cast<int>(from);
    f.to = static_cast<int>(to);
    f.around = around;
    f.step = around ? step : grid_.dz;
    f.over_step = 1.0 / f.step;
    f.width = around ? nodes_[from].along : step * (i == 0 || i + 1 == columns_ ? 0.5 : 1.0);
    f.cosine = around ? grid_.face_cos[k] : grid_.node_cos[k];
    f.sine = around ? grid_.face_sin[k] : grid_.node_sin[k];
    f.z = nodes_[from].z + (around ? 0.0 : 0.5 * grid_.dz);
    f.q.resize(layers_);
    f.d.resize(layers_);
    Slopes s;
    for (Vector* v : {&s.q_g, &s.q_h, &s.q_u, &s.d_g, &s.d_h, &s.d_u}) v->resize(layers_);
    for (Matrix* m : {&s.q_mu, &s.d_mu}) m->resize(layers_, layers_);
    slopes_.push_back(std::move(s));
    const int number = static_cast<int>(faces_.size());
    sides_[from][around ? 1 : 3].face = number;
    sides_[to][around ? 0 : 2].face = number;
    faces_.push_back(std::move(f));
  };
  for (int i = 0; i + 1 < columns_; ++i)
    for (int j = 0; j < rows_; ++j) add(i, j, true);
  around_ = static_cast<int>(faces_.size());
  for (int i = 0; i < columns_; ++i)
    for (int j = 0; j + 1 < rows_; ++j) add(i, j, false);
  for (std::vector<double>* v : {&reynolds_, &resisting_, &sheared_}) v->assign(faces_.size(), 0.0);
}

template <int Count, int Most>
void ThdPad<Count, Most>::add_places(int first, Places& states, Places& rates) const {
  const int b = block();
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const int row = first + static_cast<int>(n) * b;
    const auto square = [&](int other) {
      for (int r = 0; r < b; ++r)
        for (int c = 0; c < b; ++c) states.add(row + r, first + other * b + c);
    };
    square(static_cast<int>(n));
    for (const Side& s : sides_[n])
      if (s.face >= 0) {
        const Face& f = faces_[static_cast<std::size_t>(s.face)];
        square(s.sign > 0 ? f.to : f.from);
      }
    for (int r = 1; r < b; ++r) rates.add(row + r, row + r);
  }
}

template <int Count, int Most>
void ThdPad<Count, Most>::row(int number, std::span<const double> rates, Need need, std::size_t first, std::size_t at,
                              std::size_t at_rates, StateResponse& response) {
  constexpr int Block = Count == Eigen::Dynamic ? Eigen::Dynamic : Count + 1,
                MostBlock = Most == Eigen::Dynamic ? Eigen::Dynamic : Most + 1;
  constexpr int by_columns = Eigen::ColMajor;
  using OfLayers = Vector;
  using OfRows = Eigen::Matrix<double, Block, 1, by_columns, MostBlock, 1>;
  using RowsByLayers = Eigen::Matrix<double, Block, Count, by_columns, MostBlock, Most>;
  using Square = Eigen::Matrix<double, Block, Block, by_columns, MostBlock, MostBlock>;
  const auto n = static_cast<std::size_t>(number);
  const Node& here = nodes_[n];
  const int L = layers(), b = block();
  const double* T = here.value + 1;
  const double over_volume = L * here.over_area * here.over_h;
  const auto [all, advected, heat] = balance(n);
  const Eigen::Map<const OfLayers> t(T, L);
  const double conduct = diffusivity_ * here.over_h * here.over_h;
  const OfLayers conducted = conduct * (conduction_.lazyProduct(t) - walls_);
  const std::size_t r = first + n * static_cast<std::size_t>(b);
  response.residual[r] = here.edge ? hold_ * here.value[0] : all * here.over_area;
  for (int k = 0; k < L; ++k)
    response.residual[r + 1 + static_cast<std::size_t>(k)] =
        rates[n * static_cast<std::size_t>(b) + 1 + static_cast<std::size_t>(k)] +
        over_volume * (advected(k) - over_rho_c_ * heat(k)) + conducted(k);
  if (need == Need::force) return;
  // M: what rows, without the heat, change by with the flows out of the layers through any side (common), and through
  // each side beside that. Row 0 is the pressure's.
  RowsByLayers common = RowsByLayers::Zero(b, L);
  std::array<OfLayers, 4> own;
  for (std::size_t side = 0; side < 4; ++side) {
    const Side& s = sides_[n][side];
    if (s.face < 0) continue;
    const Face& f = faces_[static_cast<std::size_t>(s.face)];
    const double* other = nodes_[static_cast<std::size_t>(s.sign > 0 ? f.to : f.from)].value + 1;
    own[side].setZero(L);
    for (int k = 0; k < L; ++k)
      if (s.sign * f.q(k) < 0.0) own[side](k) = other[k] - T[k];
  }
  if (here.edge) {
    for (int k = 0; k < L; ++k)
      if (left_over(n, k) < 0.0) common(1 + k, k) -= options_.feed - T[k];
  } else {
    double upwards = 0.0;
    common.row(0).setConstant(here.over_area);
    for (int k = 0; k + 1 < L; ++k) {
      upwards += left_over(n, k);
      const int into = upwards > 0.0 ? k + 1 : k, from = upwards > 0.0 ? k : k + 1;
      const double jump = T[from] - T[into], size = upwards > 0.0 ? -1.0 : 1.0;  // out of `into` flows size upwards
      for (int m = 0; m <= k; ++m) common(1 + into, m) -= size * jump;
    }
  }
  common.template bottomRows<Count>(L) *= over_volume;

  // By this block and those of the neighbours, in the order of the places.
  std::array<Square, 5> by;
  by[0].setZero(b, b);
  if (here.edge) by[0](0, 0) = hold_;
  by[0].template bottomRightCorner<Count, Count>(L, L) += conduct * conduction_;
  OfRows by_thickness = OfRows::Zero(b), by_rate = common.rowwise().sum() * (here.area / L), by_speed = OfRows::Zero(b);
  by_thickness.template bottomRows<Count>(L) =
      -here.over_h * (over_volume * (advected - over_rho_c_ * heat) + 2.0 * conducted);
  Eigen::Matrix<double, Block, 4, by_columns, MostBlock, 4> by_position;
  by_position.setZero(b, 4);
  const auto thickness = [&](const OfRows& rows, double cosine, double sine, double z) {
    by_position.col(0) -= cosine * rows;
    by_position.col(1) -= sine * rows;
    by_position.col(2) -= z * cosine * rows;
    by_position.col(3) -= z * sine * rows;
  };
  for (std::size_t side = 0; side < 4; ++side) {
    const Side& s = sides_[n][side];
    if (s.face < 0) continue;
    const Face& f = faces_[static_cast<std::size_t>(s.face)];
    const Node& other = nodes_[static_cast<std::size_t>(s.sign > 0 ? f.to : f.from)];
    const Slopes& d = slopes_[static_cast<std::size_t>(s.face)];
    RowsByLayers flows = common;
    flows.template bottomRows<Count>(L).diagonal() += over_volume * own[side];
    flows *= s.sign * f.width;
    const double warm = -0.5 * f.step * f.width * over_volume * over_rho_c_;
    const auto rows = [&](const Vector& q, const Vector& heat_d) {
      OfRows out = flows.lazyProduct(q);
      out.template bottomRows<Count>(L) += warm * heat_d;
      return out;
    };
    RowsByLayers by_mu = flows.lazyProduct(d.q_mu);
    by_mu.template bottomRows<Count>(L) += warm * d.d_mu;
    const OfRows by_g = rows(d.q_g, d.d_g) * (s.sign * f.over_step);
    Square& there = by[side + 1];
    there.resize(b, b);
    there.col(0) = by_g;
    by[0].col(0) -= by_g;
    there.template rightCols<Count>(L) = by_mu * (0.5 * other.mu_t).asDiagonal();
    by[0].template rightCols<Count>(L) += by_mu * (0.5 * here.mu_t).asDiagonal();
    for (int k = 0; k < L; ++k) {
      const double out = s.sign * f.width * f.q(k);
      if (out >= 0.0) continue;
      there(1 + k, 1 + k) += over_volume * out;
      by[0](1 + k, 1 + k) -= over_volume * out;
    }
    thickness(rows(d.q_h, d.d_h), f.cosine, f.sine, f.z);
    by_speed += pad_.radius * rows(d.q_u, d.d_u);
  }
  if (here.edge) {
    for (int k = 0; k < L; ++k) {
      const double out = left_over(n, k);
      if (out < 0.0) by[0](1 + k, 1 + k) -= over_volume * out;
    }
  } else {
    double upwards = 0.0;
    for (int k = 0; k + 1 < L; ++k) {
      upwards += left_over(n, k);
      const int into = upwards > 0.0 ? k + 1 : k, from = upwards > 0.0 ? k : k + 1;
      const double flow = -over_volume * std::abs(upwards);
      by[0](1 + into, 1 + from) += flow;
      by[0](1 + into, 1 + into) -= flow;
    }
  }
  thickness(by_thickness, here.cosine, here.sine, here.z);
  const auto put = [&](const Square& m) {
    for (int i = 0; i < b; ++i)
      for (int j = 0; j < b; ++j) response.d_states[at++] = m(i, j);
  };
  put(by[0]);
  for (std::size_t side = 0; side < 4; ++side)
    if (sides_[n][side].face >= 0) put(by[side + 1]);
  for (int k = 0; k < L; ++k) response.d_rates[at_rates++] = 1.0;
  const std::array<double, 4> velocity = {-here.cosine, -here.sine, -here.z * here.cosine, -here.z * here.sine};
  for (std::size_t port = 0; port < static_cast<std::size_t>(response.forces.rows()); ++port)
    for (int k = 0; k < b; ++k) {
      const std::size_t to = r + static_cast<std::size_t>(k);
      response.by_position(port)[to] = by_position(k, static_cast<Eigen::Index>(port));
      response.by_velocity(port)[to] = velocity[port] * by_rate(k);
    }
  for (int k = 0; k < b; ++k) response.d_speed[r + static_cast<std::size_t>(k)] = by_speed(k);
}

// As that of the film of one temperature: exact means of cos and sin between two columns, the positive part of the
// pressure within cells.
template <int Count, int Most>
void ThdPad<Count, Most>::integrate(Need need, std::size_t first, StateResponse& response) const {
  const bool truncated = options_.cavitation == Thd::Cavitation::half_sommerfeld;
  const double area = pad_.radius * grid_.dtheta * grid_.mean;
  for (int strip = 0; strip + 1 < columns_; ++strip) {
    const auto face = static_cast<std::size_t>(strip);
    const double x = -area * grid_.face_cos[face], y = -area * grid_.face_sin[face];
    const bool begins = strip == 0, edge = begins || strip + 2 == columns_;
    const int near = begins ? 1 : strip, far = begins ? 2 : edge ? strip - 1 : strip + 1;
    for (int j = 0; j < rows_; ++j) {
      const double times = nodes_[node(strip, j)].along * (whole_ ? 1.0 : 2.0), z = nodes_[node(strip, j)].z;
      const std::array<double, 4> weight = {times * x, times * y, times * z * x, times * z * y};
      const double p = pressure(near, j), q = pressure(far, j);
      double d_p = 0.5, d_q = edge ? 0.0 : 0.5, integral = d_p * p + d_q * q;
      if (truncated && edge) {
        const EdgeInterval part = truncated_edge(p, q);
        integral = part.integral, d_p = part.d_near, d_q = part.d_far;
      } else if (truncated && std::min(p, q) < 0.0) {
        const IntervalIntegral<double> part = truncated_linear(p, q);
        integral = part.integral, d_p = part.d_left, d_q = part.d_right;
      }
      for (std::size_t c = 0; c < (options_.tilt ? 4U : 2U); ++c) {
        response.journal.force[c] += weight[c] * integral;
        if (need == Need::force) continue;
        const auto b = static_cast<std::size_t>(block());
        response.of_force(c)[first + node(near, j) * b] += weight[c] * d_p;
        response.of_force(c)[first + node(far, j) * b] += weight[c] * d_q;
      }
    }
  }
}

template <int Count, int Most>
std::size_t ThdPad<Count, Most>::entries() {
  if (entries_.empty()) {
    std::size_t before = 0;
    for (const auto& sides : sides_) {
      entries_.push_back(before);
      const auto beside = std::count_if(sides.begin(), sides.end(), [](const Side& s) { return s.face >= 0; });
      before += static_cast<std::size_t>((1 + beside) * block() * block());
    }
    entries_.push_back(before);
  }
  return entries_.back();
}

template <int Count, int Most>
void ThdPad<Count, Most>::evaluate(const JournalMotion& motion, std::span<const double> states,
                                   std::span<const double> rates, Need need, std::size_t first, std::size_t& at,
                                   std::size_t& at_rates, StateResponse& response) {
  read(motion, states);
  response.journal.min_thickness = std::min(response.journal.min_thickness, h_min_);
  turbulence();
  for (std::size_t f = 0; f < faces_.size(); ++f) flow(static_cast<int>(f), need == Need::tangents);
  const std::size_t all = entries();
  for (int n = 0; n < nodes(); ++n)
    row(n, rates, need, first, at + entries_[static_cast<std::size_t>(n)],
        at_rates + static_cast<std::size_t>(n * layers_), response);
  at += all;
  at_rates += static_cast<std::size_t>(nodes() * layers_);
  integrate(need, first, response);
}

template class ThdPad<1, 1>;
template class ThdPad<Eigen::Dynamic, 8>;
template class ThdPad<Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace whirl::film
