#include "film/heat/one_layer_pad.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "film/algebra/pack.hpp"
#include "film/fluid/mobility.hpp"
#include "film/heat/thd_pad_flow.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

using Eight = Pack::Vector;  // neighbours in an array

Eight load(const double* from) {
  return Pack::load(from).v;
}
void store(double* to, const Eight& value) {
  std::memcpy(to, &value, sizeof value);
}

}  // namespace

OneLayerPad::Array::Array(std::ptrdiff_t nodes, std::ptrdiff_t column, double value)
    : values_(static_cast<std::size_t>(nodes + 2 * (column + kLanes)), value), front_(column + kLanes) {}

OneLayerPad::OneLayerPad(const Pad& pad, const Thd& options, const Lubricant& lubricant)
    : ThdPad<1, 1>(pad, options, lubricant), count_(nodes()), column_(rows_) {
  for (Array* a :
       {&cosine_, &sine_, &z_, &area_, &over_area_, &inner_, &p_, &rate_, &mu_t_, &out_, &gone_, &rows_p_, &rows_t_})
    *a = Array(count_, column_, 0.0);
  for (Array* a : {&h_, &over_h_, &mu_}) *a = Array(count_, column_, 1.0);
  t_ = Array(count_, column_, options.feed);
  for (Faces* f : {&around_faces_, &along_faces_}) {
    for (Array* a : {&f->width, &f->half, &f->cosine, &f->sine, &f->z, &f->resisting, &f->sheared})
      *a = Array(count_, column_, 0.0);
    for (Array* a : {&f->h, &f->mu, &f->reynolds}) *a = Array(count_, column_, 1.0);
    for (Through* t : {&f->flow, &f->heat})
      for (Array* a : {&t->value, &t->by_p, &t->by_h, &t->by_u, &t->by_mu}) *a = Array(count_, column_, 0.0);
  }
  for (Row* row : {&flow_row_, &warm_row_}) {
    for (auto* group : {&row->by_p, &row->by_t})
      for (Array& a : *group) a = Array(count_, column_, 0.0);
    for (Array& a : row->by_position) a = Array(count_, column_, 0.0);
    row->by_speed = row->by_rate = Array(count_, column_, 0.0);
  }
  around_faces_.around = true;
  around_faces_.to = column_;
  along_faces_.to = 1;
  around_faces_.over_step = 1.0 / (pad.radius * grid_.dtheta);
  along_faces_.over_step = 1.0 / grid_.dz;
  for (std::ptrdiff_t n = 0; n < count_; ++n) {
    const Node& here = nodes_[static_cast<std::size_t>(n)];
    cosine_[n] = here.cosine;
    sine_[n] = here.sine;
    z_[n] = here.z;
    area_[n] = here.area;
    over_area_[n] = here.over_area;
    inner_[n] = here.edge ? 0.0 : 1.0;
  }
  for (const Face& face : faces_) {
    Faces& to = face.around ? around_faces_ : along_faces_;
    to.width[face.from] = face.width;
    to.half[face.from] = 0.5 * face.step * face.width;
    to.cosine[face.from] = face.cosine;
    to.sine[face.from] = face.sine;
    to.z[face.from] = face.z;
  }
}

void OneLayerPad::read(const JournalMotion& motion, std::span<const double> states) {
  const bool tilt = options_.tilt;
  const double X = motion.position[0] - pad_.centre_x, Y = motion.position[1] - pad_.centre_y;
  const double tx = tilt ? motion.position[2] : 0.0, ty = tilt ? motion.position[3] : 0.0;
  const double vtx = tilt ? motion.velocity[2] : 0.0, vty = tilt ? motion.velocity[3] : 0.0;
  const double vx = motion.velocity[0], vy = motion.velocity[1];
  speed_ = motion.speed;
  surface_ = speed_ * pad_.radius;
  h_min_ = least_(X, Y, tx, ty);
  require_thickness(h_min_);
  for (std::ptrdiff_t n = 0; n < count_; ++n) {
    const double* const value = &states[2 * static_cast<std::size_t>(n)];
    nodes_[static_cast<std::size_t>(n)].value = value;
    p_[n] = value[0];
    t_[n] = value[1];
    const thermal::Valued mu = viscosity_at(value[1]);
    mu_[n] = mu.value;
    mu_t_[n] = 0.5 * mu.slope;
  }
  for (std::ptrdiff_t n = 0; n < count_; n += kLanes) {
    const Eight c = load(cosine_.at(n)), s = load(sine_.at(n)), z = load(z_.at(n));
    const Eight h = pad_.clearance - (X + z * tx) * c - (Y + z * ty) * s;
    store(h_.at(n), h);
    store(over_h_.at(n), 1.0 / h);
    store(rate_.at(n), -(vx + z * vtx) * c - (vy + z * vty) * s);
  }
  for (Faces* f : {&around_faces_, &along_faces_})
    for (std::ptrdiff_t n = 0; n < count_; n += kLanes) {
      const Eight c = load(f->cosine.at(n)), s = load(f->sine.at(n)), z = load(f->z.at(n));
      store(f->h.at(n), pad_.clearance - (X + z * tx) * c - (Y + z * ty) * s);
      store(f->mu.at(n), 0.5 * (load(mu_.at(n)) + load(mu_.at(n + f->to))));
    }
}

void OneLayerPad::turbulence(Faces& f, const Resistance& resistance) const {
  if (!turbulent_) {
    for (Array* a : {&f.resisting, &f.sheared}) std::fill_n(a->at(0), count_, 0.0);
    return;
  }
  const double scale = lubricant_.density * std::abs(surface_);
  for (std::ptrdiff_t n = 0; n < count_; n += kLanes)
    store(f.reynolds.at(n), scale * load(f.h.at(n)) / load(f.mu.at(n)));
  const int count = static_cast<int>(count_);
  powers(resistance.factor, resistance.exponent, count, f.reynolds.at(0), f.resisting.at(0));
  if (f.around) powers(couette_.factor, couette_.exponent, count, f.reynolds.at(0), f.sheared.at(0));
}

// With P = c h^3/(12 mu): q = u h/2 - P g, and the dissipation of an area s u^2 mu/h + P g^2.
void OneLayerPad::flow(Faces& f) {
  const double u = f.surface;
  for (std::ptrdiff_t n = 0; n < count_; n += kLanes) {
    const Eight h = load(f.h.at(n)), mu = load(f.mu.at(n)), over_mu = 1.0 / mu;
    const Eight g = (load(p_.at(n + f.to)) - load(p_.at(n))) * f.over_step;
    const Eight P = (h * h * h) * over_mu / (12.0 + load(f.resisting.at(n))), by_pressure = P * g;
    const Eight shear = (1.0 + load(f.sheared.at(n))) * (u * u) * mu / h;
    store(f.flow.value.at(n), load(f.width.at(n)) * (0.5 * u * h - by_pressure));
    store(f.heat.value.at(n), load(f.half.at(n)) * (shear + by_pressure * g));
  }
}

// A loop of its own: rounded as they are, flows do not depend on whether derivatives are asked for.
void OneLayerPad::slopes(Faces& f, const Resistance& resistance) {
  const double u = f.surface, over_surface = turbulent_ ? 1.0 / surface_ : 0.0;
  for (std::ptrdiff_t n = 0; n < count_; n += kLanes) {
    const Eight h = load(f.h.at(n)), mu = load(f.mu.at(n)), width = load(f.width.at(n)), half = load(f.half.at(n));
    const Eight g = (load(p_.at(n + f.to)) - load(p_.at(n))) * f.over_step;
    const Eight resisting = load(f.resisting.at(n)), sheared = load(f.sheared.at(n)), over_k = 1.0 / (12.0 + resisting);
    const Eight over_mu = 1.0 / mu, over_h = 1.0 / h;
    const Eight P = (h * h * h) * over_mu * over_k, by_pressure = P * g, heated = by_pressure * g;
    const Eight laminar = u * u * mu * over_h, shear = (1.0 + sheared) * laminar;
    const Eight c_re = -resistance.exponent * resisting * over_k;  // of ln c by ln Re
    const Eight q_re = -c_re * by_pressure, d_re = couette_.exponent * sheared * laminar + c_re * heated;
    store(f.flow.by_p.at(n), -f.over_step * width * P);
    store(f.heat.by_p.at(n), (2.0 * f.over_step) * half * by_pressure);
    store(f.flow.by_h.at(n), width * (0.5 * u + (q_re - 3.0 * by_pressure) * over_h));
    store(f.heat.by_h.at(n), half * over_h * (d_re + 3.0 * heated - shear));
    store(f.flow.by_mu.at(n), width * over_mu * (by_pressure - q_re));
    store(f.heat.by_mu.at(n), half * over_mu * (shear - heated - d_re));
    const Eight sliding = f.around ? h : Eight{};
    store(f.flow.by_u.at(n), width * (0.5 * sliding + q_re * over_surface));
    store(f.heat.by_u.at(n), half * (2.0 * u * mu * over_h * (1.0 + sheared) + d_re * over_surface));
  }
}

// Row 0: the flow out of the volume per area, or the pressure of an edge; row 1: the temperature's.
void OneLayerPad::balance(std::span<const double> rates, std::size_t first, StateResponse& response) {
  const double conducts = conduction_(0, 0), of_walls = walls_(0), feed = options_.feed;
  const Faces &around = around_faces_, &along = along_faces_;
  for (std::ptrdiff_t n = 0; n < count_; n += kLanes) {
    const Eight t = load(t_.at(n)), inner = load(inner_.at(n)), over_area = load(over_area_.at(n)),
                over_h = load(over_h_.at(n)), none{};
    Eight out = load(area_.at(n)) * load(rate_.at(n)), advected = none;
    const auto side = [&](Eight q, Eight other) {
      out += q;
      advected += (q < 0.0 ? q : none) * (other - t);
    };
    side(-load(around.flow.value.at(n - column_)), load(t_.at(n - column_)));
    side(load(around.flow.value.at(n)), load(t_.at(n + column_)));
    side(-load(along.flow.value.at(n - 1)), load(t_.at(n - 1)));
    side(load(along.flow.value.at(n)), load(t_.at(n + 1)));
    const Eight edge = 1.0 - inner;
    advected += edge * (out > 0.0 ? -out : none) * (feed - t);
    const Eight heat = load(around.heat.value.at(n - column_)) + load(around.heat.value.at(n)) +
                       load(along.heat.value.at(n - 1)) + load(along.heat.value.at(n));
    const Eight through = over_area * over_h * (advected - over_rho_c_ * heat),
                conducted = diffusivity_ * over_h * over_h * (conducts * t - of_walls);
    store(out_.at(n), out);
    store(rows_p_.at(n), inner * out * over_area + edge * hold_ * load(p_.at(n)));
    store(rows_t_.at(n), through + conducted);
    store(gone_.at(n), -over_h * (through + 2.0 * conducted));
  }
  double* const residual = &response.residual[first];
  for (std::ptrdiff_t n = 0; n < count_; ++n) {
    residual[2 * n] = rows_p_[n];
    residual[2 * n + 1] = rates[static_cast<std::size_t>(2 * n + 1)] + rows_t_[n];
  }
}

// Derivatives of both rows. Row 0 is the sum of the flows, times 1/A; in row 1 those that enter bring what is warmer or
// colder beyond the face.
void OneLayerPad::derive() {
  const double conducts = conduction_(0, 0), feed = options_.feed;
  const std::size_t ports = options_.tilt ? 4 : 2;
  for (std::ptrdiff_t n = 0; n < count_; n += kLanes) {
    const Eight t = load(t_.at(n)), inner = load(inner_.at(n)), edge = 1.0 - inner, over_area = load(over_area_.at(n)),
                over_h = load(over_h_.at(n)), out = load(out_.at(n)), mu_t = load(mu_t_.at(n)), none{};
    const Eight over_volume = over_area * over_h, heats = -over_volume * over_rho_c_;
    const Eight enters = edge * over_volume * (out > 0.0 ? t - feed : none);  // K/m^3, by any flow out, on an edge
    const Eight of_flow = inner * over_area;
    Eight p_own = edge * hold_, pt_own = none, tp_own = none,
          t_own = diffusivity_ * over_h * over_h * conducts + edge * over_volume * (out > 0.0 ? out : none);
    Eight p_speed = none, t_speed = none;
    std::array<Eight, 4> p_position{}, t_position{};
    const auto move = [&](Eight p, Eight w, Eight cosine, Eight sine, Eight z) {
      p_position[0] -= cosine * p, p_position[1] -= sine * p;
      t_position[0] -= cosine * w, t_position[1] -= sine * w;
      if (ports == 2) return;
      p_position[2] -= z * cosine * p, p_position[3] -= z * sine * p;
      t_position[2] -= z * cosine * w, t_position[3] -= z * sine * w;
    };
    const auto side = [&](std::size_t number, const Faces& f, std::ptrdiff_t face, std::ptrdiff_t other, double sign) {
      const Eight q = sign * load(f.flow.value.at(face)), beyond = load(t_.at(other)) - t;
      const Eight p_q = sign * of_flow, t_q = sign * (enters + over_volume * (q < 0.0 ? beyond : none));
      const auto warm = [&](const Array& by_flow, const Array& by_heat) {
        return t_q * load(by_flow.at(face)) + heats * load(by_heat.at(face));
      };
      const Eight p_p = p_q * sign * load(f.flow.by_p.at(face)), t_p = sign * warm(f.flow.by_p, f.heat.by_p);
      const Eight p_mu = p_q * load(f.flow.by_mu.at(face)), t_mu = warm(f.flow.by_mu, f.heat.by_mu);
      const Eight mu_other = load(mu_t_.at(other)), brought = over_volume * (q < 0.0 ? q : none);
      p_own -= p_p;
      tp_own -= t_p;
      pt_own += p_mu * mu_t;
      t_own += t_mu * mu_t - brought;
      store(flow_row_.by_p[number].at(n), p_p);
      store(warm_row_.by_p[number].at(n), t_p);
      store(flow_row_.by_t[number].at(n), p_mu * mu_other);
      store(warm_row_.by_t[number].at(n), t_mu * mu_other + brought);
      move(p_q * load(f.flow.by_h.at(face)), warm(f.flow.by_h, f.heat.by_h), load(f.cosine.at(face)),
           load(f.sine.at(face)), load(f.z.at(face)));
      p_speed += p_q * load(f.flow.by_u.at(face));
      t_speed += warm(f.flow.by_u, f.heat.by_u);
    };
    side(1, around_faces_, n - column_, n - column_, -1.0);
    side(2, around_faces_, n, n + column_, 1.0);
    side(3, along_faces_, n - 1, n - 1, -1.0);
    side(4, along_faces_, n, n + 1, 1.0);
    move(none, load(gone_.at(n)), load(cosine_.at(n)), load(sine_.at(n)), load(z_.at(n)));
    store(flow_row_.by_p[0].at(n), p_own);
    store(flow_row_.by_t[0].at(n), pt_own);
    store(warm_row_.by_p[0].at(n), tp_own);
    store(warm_row_.by_t[0].at(n), t_own);
    for (std::size_t port = 0; port < ports; ++port) {
      store(flow_row_.by_position[port].at(n), p_position[port]);
      store(warm_row_.by_position[port].at(n), t_position[port]);
    }
    store(flow_row_.by_speed.at(n), pad_.radius * p_speed);
    store(warm_row_.by_speed.at(n), pad_.radius * t_speed);
    store(flow_row_.by_rate.at(n), inner);
    store(warm_row_.by_rate.at(n), enters * load(area_.at(n)));
  }
}

// In the order of the places: node by node its own block, then those of the neighbours that there are.
void OneLayerPad::write(std::size_t first, std::size_t at, StateResponse& response) const {
  double* to = &response.d_states[at];
  for (std::ptrdiff_t n = 0; n < count_; ++n) {
    const auto& sides = sides_[static_cast<std::size_t>(n)];
    for (std::size_t k = 0; k < 5; ++k) {
      if (k > 0 && sides[k - 1].face < 0) continue;
      to[0] = *flow_row_.by_p[k].at(n);
      to[1] = *flow_row_.by_t[k].at(n);
      to[2] = *warm_row_.by_p[k].at(n);
      to[3] = *warm_row_.by_t[k].at(n);
      to += 4;
    }
  }
  const auto interleave = [&](const Array& flow, const Array& warm, double* rows) {
    double* const out = rows + first;
    for (std::ptrdiff_t n = 0; n < count_; ++n) {
      out[2 * n] = *flow.at(n);
      out[2 * n + 1] = *warm.at(n);
    }
  };
  for (std::size_t port = 0; port < static_cast<std::size_t>(response.forces.rows()); ++port) {
    interleave(flow_row_.by_position[port], warm_row_.by_position[port], response.by_position(port));
    double* const out = response.by_velocity(port) + first;
    const Array& direction = port % 2 == 0 ? cosine_ : sine_;
    for (std::ptrdiff_t n = 0; n < count_; ++n) {
      const double by = -*direction.at(n) * (port < 2 ? 1.0 : *z_.at(n));
      out[2 * n] = by * *flow_row_.by_rate.at(n);
      out[2 * n + 1] = by * *warm_row_.by_rate.at(n);
    }
  }
  interleave(flow_row_.by_speed, warm_row_.by_speed, response.d_speed.data());
}

void OneLayerPad::evaluate(const JournalMotion& motion, std::span<const double> states, std::span<const double> rates,
                           Need need, std::size_t first, std::size_t& at, std::size_t& at_rates,
                           StateResponse& response) {
  read(motion, states);
  response.journal.min_thickness = std::min(response.journal.min_thickness, h_min_);
  turbulent_ = options_.turbulence != Turbulence::laminar && surface_ != 0.0;
  around_faces_.surface = surface_;
  turbulence(around_faces_, resistance_around_);
  turbulence(along_faces_, resistance_along_);
  for (Faces* f : {&around_faces_, &along_faces_}) flow(*f);
  balance(rates, first, response);
  if (need == Need::tangents) {
    slopes(around_faces_, resistance_around_);
    slopes(along_faces_, resistance_along_);
    derive();
    write(first, at, response);
    std::fill_n(&response.d_rates[at_rates], count_, 1.0);
  }
  at += entries();
  at_rates += static_cast<std::size_t>(count_);
  integrate(need, first, response);
}

}  // namespace whirl::film
