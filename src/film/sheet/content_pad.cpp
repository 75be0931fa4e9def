// Rows, force and derivatives of one pad whose content is its state, node by node.
#include "film/sheet/content_pad.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::film {

// A closed pad starts behind a groove, so that its columns form a band.
ContentPad::ContentPad(const Pad& pad, const Reynolds& options, const Lubricant& lubricant)
    : PadEquations(pad, options, lubricant),
      bulk_modulus_(options.bulk_modulus),
      empty_at_edge_(1.0 - options.edge_fill),
      column_of_(static_cast<std::size_t>(grid_.n_theta + 1), -1),
      nodes_(static_cast<std::size_t>((grid_.n_theta + 1) * rows_)) {
  const double step = pad.radius * grid_.dtheta;
  in_holes_ = bulk_modulus_ * pad.clearance * pad.clearance / (12.0 * lubricant.viscosity) *
              (2.0 / (step * step) + 2.0 / (grid_.dz * grid_.dz));
  int start = 0;
  while (pad.closed && !wall(start)) ++start;
  for (int k = 0; k < grid_.n_theta; ++k) {
    const int i = pad.closed ? wrap(start + k) : k;
    if (wall(i)) continue;
    column_of_[static_cast<std::size_t>(i)] = static_cast<int>(columns_.size());
    columns_.push_back(i);
  }
}

bool ContentPad::sees(int column, int other) const {
  const int i = columns_[static_cast<std::size_t>(column)];
  return column_at(i - 1) == other || column_at(i + 1) == other;
}

// The places are those before and after around the pad, below and above along it, and the node itself.
void ContentPad::add_places(int place, PadShare& share, Places& to) const {
  constexpr std::array<std::array<int, 2>, places> offset = {{{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {0, 0}}};
  const auto [around_it, along_it] = offset[static_cast<std::size_t>(place)];
  share.at.resize(static_cast<std::size_t>((share.end - share.begin) * rows_));
  for (int c = share.begin; c < share.end; ++c) {
    const int other = column_at(columns_[static_cast<std::size_t>(c)] + around_it);
    if (other < 0) continue;
    for (int j = std::max(0, -along_it); j < std::min(rows_, rows_ - along_it); ++j) {
      const int row = (c - share.begin) * rows_ + j;
      share.at[static_cast<std::size_t>(row)][static_cast<std::size_t>(place)] = to.size();
      to.add(share.row + row, share.seen[static_cast<std::size_t>(other)] + j + along_it);
    }
  }
}

void ContentPad::read(int i, int j, const double* value) {
  Node& here = nodes_[static_cast<std::size_t>(i * rows_ + j)] = {};
  const auto k = static_cast<std::size_t>(i);
  here.z = row_z(j);
  here.cosine = grid_.mean * grid_.node_cos[k];
  here.sine = grid_.mean * grid_.node_sin[k];
  here.h = pad_.clearance - (X_ + here.z * tx_) * here.cosine - (Y_ + here.z * ty_) * here.sine;
  if (!value || hole_at(i, j) > 0) {
    here.p = held_pressure(i, j);
    if (!pad_.closed && i == (ahead_ > 0 ? 0 : grid_.n_theta)) here.empty = empty_at_edge_;
  } else if (*value >= 0.0) {
    here.p_q = bulk_modulus_ / here.h;
    here.p = here.p_q * *value;
    here.p_h = -here.p / here.h;
  } else {
    here.empty_q = -1.0 / here.h;
    here.empty = here.empty_q * *value;
    here.empty_h = -here.empty / here.h;
  }
}

void ContentPad::read(const JournalMotion& motion, std::span<const double> q) {
  coefficients(motion);
  for (int i = 0; i <= grid_.n_theta; ++i)
    for (int j = 0; j < rows_; ++j) {
      const int column = column_at(i);
      read(i, j, column < 0 ? nullptr : &q[static_cast<std::size_t>(column * rows_ + j)]);
    }
}

std::array<ContentPad::Side, 4> ContentPad::sides(int i, int j) const {
  const double v = share(j);
  const auto at_face = [&](const Faces& f, std::size_t face, double part, Side& s) {
    s.k = part * f.value[face];
    s.k_h = part * f.d_h[face];
    s.k_speed = part * f.d_speed[face];
  };
  std::array<Side, 4> out;
  for (const int step : {-1, 1}) {
    Side& s = out[step < 0 ? 0 : 1];
    const int face = wrap(step < 0 ? i - 1 : i);
    s.other = &node(i + step, j);
    s.state = column_at(i + step) >= 0;
    at_face(a_, around(face, j), 1.0, s);
    s.couette_h = 0.5 * step / grid_.dtheta;
    s.couette = s.couette_h * a_.h[around(face, j)];
    s.upstream = step == ahead_ ? &node(i, j) : s.other;
    s.cosine = grid_.face_cos[static_cast<std::size_t>(face)];
    s.sine = grid_.face_sin[static_cast<std::size_t>(face)];
    s.z = row_z(j);
  }
  for (const int step : {-1, 1}) {
    Side& s = out[step < 0 ? 2 : 3];
    const int face = step < 0 ? j : j + 1;
    if (face >= z_faces_) continue;  // the mid-plane of an aligned film
    at_face(b_, along(i, face), 1.0 / v, s);
    if (j + step >= 0 && j + step < rows_) {
      s.other = &node(i, j + step);
      s.state = true;
    }
    s.cosine = grid_.node_cos[static_cast<std::size_t>(i)];
    s.sine = grid_.node_sin[static_cast<std::size_t>(i)];
    s.z = row_z(face) - 0.5 * grid_.dz;
  }
  return out;
}

void ContentPad::add_thickness(double by, double cosine, double sine, double z, std::array<double, 4>& to) const {
  to[0] -= by * cosine;
  to[1] -= by * sine;
  if (!tilt_) return;
  to[2] -= by * z * cosine;
  to[3] -= by * z * sine;
}

// A node in a hole is no part of the film. Its state goes to zero as fast as pressures spread to the next node.
void ContentPad::row_in_hole(int i, int j, double value, double rate, std::size_t k, const PadShare& share, Need need,
                             StateResponse& response) const {
  response.residual[k] = rate + in_holes_ * value;
  if (need == Need::force) return;
  const std::array<std::size_t, places>& to = share.at[k - static_cast<std::size_t>(share.row)];
  const std::array<Side, 4> around_it = sides(i, j);
  for (std::size_t place = 0; place < around_it.size(); ++place)
    if (around_it[place].state) response.d_states[to[place]] = 0.0;
  response.d_states[to[4]] = in_holes_;
  response.d_rates[k] = 1.0;
  response.inputs.col(static_cast<Eigen::Index>(k)).setZero();
  response.d_speed[k] = 0.0;
}

void ContentPad::row(int i, int j, double rate, std::size_t k, const PadShare& share, Need need,
                     StateResponse& response) const {
  const Node& here = node(i, j);
  const std::array<Side, 4> around_it = sides(i, j);
  double g = rate + source_[at(i, j)] / PadEquations::share(j);
  for (const Side& s : around_it) {
    g += s.k * (here.p - (s.other ? s.other->p : 0.0));
    if (s.upstream) g -= speed_ * s.couette * s.upstream->empty;
  }
  response.residual[k] = g;
  if (need == Need::force) return;

  // By this state and its neighbours', and by the thickness: at faces, and through p and `empty` at the same nodes.
  std::array<double, 4> d_position{}, d_velocity{};
  double by_speed = 0.0, own_p = 0.0, own_empty = 0.0;
  const std::array<std::size_t, places>& to = share.at[k - static_cast<std::size_t>(share.row)];
  const auto through = [&](const Node& n, std::size_t place, double by_p, double by_empty) {
    response.d_states[to[place]] = by_p * n.p_q + by_empty * n.empty_q;
    add_thickness(by_p * n.p_h + by_empty * n.empty_h, n.cosine, n.sine, n.z, d_position);
  };
  for (std::size_t place = 0; place < around_it.size(); ++place) {
    const Side& s = around_it[place];
    const double jump = here.p - (s.other ? s.other->p : 0.0), empty = s.upstream ? s.upstream->empty : 0.0;
    by_speed += s.k_speed * jump - s.couette * empty;
    add_thickness(s.k_h * jump - speed_ * s.couette_h * empty, s.cosine, s.sine, s.z, d_position);
    const bool from_here = s.upstream == &here;
    own_p += s.k;
    if (from_here) own_empty -= speed_ * s.couette;
    if (s.state) through(*s.other, place, -s.k, from_here ? 0.0 : -speed_ * s.couette);
  }
  through(here, 4, own_p, own_empty);
  response.d_rates[k] = 1.0;

  // Wedge Omega/2 dh/dtheta and squeeze.
  const double half = 0.5 * speed_;
  for (std::size_t moment = 0; moment < (tilt_ ? 2U : 1U); ++moment) {
    const double lever = moment == 0 ? 1.0 : here.z;
    d_position[2 * moment] += half * lever * here.sine;
    d_position[2 * moment + 1] -= half * lever * here.cosine;
    d_velocity[2 * moment] -= lever * here.cosine;
    d_velocity[2 * moment + 1] -= lever * here.sine;
  }
  by_speed += 0.5 * ((X_ + here.z * tx_) * here.sine - (Y_ + here.z * ty_) * here.cosine);
  for (std::size_t port = 0; port < static_cast<std::size_t>(response.forces.rows()); ++port) {
    response.by_position(port)[k] = d_position[port];
    response.by_velocity(port)[k] = d_velocity[port];
  }
  response.d_speed[k] = by_speed;
}

// Force by the trapezoidal rule with exact means of cos and sin, as that of the film without states; grooves carry too.
void ContentPad::integrate(int i, int k, Need need, StateResponse& response) const {
  const double area = pad_.radius * grid_.dtheta * grid_.dz * grid_.mean * std::cos(0.5 * grid_.dtheta);
  const std::size_t components = tilt_ ? 4 : 2;
  const auto column = static_cast<std::size_t>(i);
  for (int j = 0; j < rows_; ++j) {
    const Node& here = node(i, j);
    const double times = -area * (whole_ ? 1.0 : 2.0 * PadEquations::share(j)), lever = tilt_ ? here.z : 0.0;
    const double x = times * grid_.node_cos[column], y = times * grid_.node_sin[column];
    const std::array<double, 4> weight = {x, y, lever * x, lever * y};
    std::array<double, 4> by_position{};
    if (need == Need::tangents) add_thickness(here.p_h, here.cosine, here.sine, here.z, by_position);
    for (std::size_t f = 0; f < components; ++f) {
      response.journal.force[f] += weight[f] * here.p;
      for (std::size_t d = 0; d < components; ++d) response.journal.d_position[f][d] += weight[f] * by_position[d];
      if (need == Need::tangents && k >= 0) response.of_force(f)[k + j] = weight[f] * here.p_q;
    }
  }
}

// A column and its neighbours, in a wall or not, are read before the rows of the column are taken.
void ContentPad::evaluate(const JournalMotion& motion, const PadShare& share, std::span<const double> q,
                          std::span<const double> rates, Need need, StateResponse& response) {
  if (share.begin == share.end) return;
  conductances(motion);
  response.journal.min_thickness = std::min(response.journal.min_thickness, h_min_);
  const auto value = [&](std::span<const double> of, int i, int j) {
    const int column = column_at(i);
    return column < 0 ? nullptr : &of[static_cast<std::size_t>(share.seen[static_cast<std::size_t>(column)] + j)];
  };
  const auto read_column = [&](int i) {
    for (int j = 0; j < rows_; ++j) read(i, j, value(q, i, j));
  };
  const auto column = [&](int c) { return columns_[static_cast<std::size_t>(c)]; };
  for (int c = share.begin; c < share.end; ++c) {
    const int i = column(c), before = wrap(i - 1), after = wrap(i + 1);
    if (c == share.begin || column(c - 1) != before) read_column(before);
    read_column(i);
    if (c + 1 == share.end || column(c + 1) != after) read_column(after);
  }
  for (int c = share.begin, k = share.row; c < share.end; ++c) {
    const int i = column(c);
    source(motion, i);
    integrate(i, k, need, response);
    for (int j = 0; j < rows_; ++j, ++k) {
      const double rate = *value(rates, i, j);
      if (hole_at(i, j) > 0)
        row_in_hole(i, j, *value(q, i, j), rate, static_cast<std::size_t>(k), share, need, response);
      else
        row(i, j, rate, static_cast<std::size_t>(k), share, need, response);
    }
  }
  if (share.begin > 0) return;
  // What is given in grooves counts once.
  for (int i = first_; i < grid_.n_theta; ++i)
    if (wall(i)) {
      read_column(i);
      integrate(i, -1, need, response);
    }
}

PadReport ContentPad::report(const JournalMotion& motion, std::span<const double> q) {
  read(motion, q);
  PadReport out;
  for (int i = 0; i <= grid_.n_theta; ++i)
    for (int j = 0; j <= grid_.n_z; ++j) {
      // The sides have p = 0 and the fill of what stands beside them; so have the edges of a pad.
      const int row = row_of(j), inside = std::clamp(row, 0, rows_ - 1);
      const Node& here = node(i, inside);
      out.pressure.push_back(row == inside ? here.p : 0.0);
      out.fill.push_back(1.0 - here.empty);
    }
  out.flows = flows([&](int i, int j) { return j < 0 || j >= rows_ ? 0.0 : node(i, j).p; },
                    [&](int i, int j) { return std::abs(speed_) * node(i, j).empty; });
  return out;
}

void ContentPad::resample(const JournalMotion& motion, ContentPad& other, std::span<const double> from,
                          std::span<double> to) {
  read(motion, to);  // for the thickness
  const PadReport there = other.report(motion, from);
  const auto place = [](double x, int cells) {
    const int cell = std::clamp(static_cast<int>(x * cells), 0, cells - 1);
    return std::pair{cell, x * cells - cell};
  };
  const auto columns = static_cast<std::size_t>(other.grid_.n_z + 1);
  for (const int i : columns_)
    for (int j = 0; j < rows_; ++j) {
      const auto [a, s] = place(static_cast<double>(i) / grid_.n_theta, other.grid_.n_theta);
      const auto [b, t] = place(static_cast<double>(j + 1) / grid_.n_z, other.grid_.n_z);
      const auto between = [&, a = a, b = b, s = s, t = t](const std::vector<double>& v) {
        const std::size_t first = static_cast<std::size_t>(a) * columns + static_cast<std::size_t>(b);
        return (1.0 - s) * ((1.0 - t) * v[first] + t * v[first + 1]) +
               s * ((1.0 - t) * v[first + columns] + t * v[first + columns + 1]);
      };
      const auto own = static_cast<std::size_t>(column_at(i) * rows_ + j);
      if (hole_at(i, j) > 0) {
        to[own] = 0.0;
        continue;
      }
      const double h = node(i, j).h, p = between(there.pressure);
      to[own] = p > 0.0 ? h * p / bulk_modulus_ : -h * (1.0 - between(there.fill));
    }
}

}  // namespace whirl::film
