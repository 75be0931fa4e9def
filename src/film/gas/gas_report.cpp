// Where the search for the pressure of a film of gas starts, and what it reports.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "film/gas/gas_film.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

using std::numbers::pi;

// Between plates p^2 is harmonic. A row of n orifices is a slit, whose p^2 falls linearly to both ends, and the field
// of n points less their mean, -K m ln|1 - exp(-2 pi (|z| + i x)/s)| with s = 2 pi R/n, K = 12 mu r T/(pi h^3).
void GasFilm::unloaded(const JournalMotion& motion_given, std::span<double> states) const {
  const JournalMotion motion = seen(motion_given);
  const double length = geometry_.length, warmth = options_.gas_constant * options_.temperature;
  const double mesh = 0.25 * std::exp(-std::numbers::egamma) * std::hypot(dx_, dz_);
  const double around = 2.0 * pi * geometry_.radius, outside = options_.ambient * options_.ambient;
  const std::vector<OrificeRow>& rows = options_.orifices;
  // p^2 along the line per mass flow of all orifices of a row at z = at, times K.
  const auto slit = [&](double z, double at) {
    return 2.0 * pi / around * (std::min(z, at) + 0.5 * length) * (0.5 * length - std::max(z, at)) / length;
  };
  std::fill(states.begin(), states.end(), options_.ambient);
  std::vector<double> mass(rows.size());
  std::vector<std::array<double, 2>> behind(rows.size());
  std::vector<std::size_t> first(rows.size(), 0);  // feed of each row
  for (std::size_t r = 1; r < rows.size(); ++r) first[r] = first[r - 1] + static_cast<std::size_t>(rows[r - 1].count);
  for (int i = 0; i < lines_; ++i) {
    const double h = std::max(thickness(motion, 2 * i, 0.5 * (inner_ - 1)), 0.05 * geometry_.clearance);
    const double K = 12.0 * viscosity_ * warmth / (pi * h * h * h);
    std::fill(mass.begin(), mass.end(), 0.0);
    const int sweeps = rows.size() > 1 ? 6 : 1;
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (std::size_t r = 0; r < rows.size(); ++r) {
        const OrificeRow& row = rows[r];
        double others = outside;
        for (std::size_t o = 0; o < rows.size(); ++o)
          if (o != r) others += K * mass[o] * rows[o].count * slit(row.z, rows[o].z);
        const GasFeed& f = feeds_[first[r]];
        const double spread = std::max(0.0, std::log(around / (row.count * 2.0 * pi * f.rim())));
        behind[r] = f.steady(others, K * (row.count * slit(row.z, row.z) + spread), h);
        mass[r] = f.into_film(behind[r], h).mass;
      }
    for (int j = 0; j < inner_ && (!rows.empty() || bore_.held(i)); ++j) {
      double square = outside;
      for (std::size_t r = 0; r < rows.size(); ++r) {
        const double turn = angle(i) - rows[r].angle, pitch = around / rows[r].count;
        const double away = std::abs(z(j) - rows[r].z) / pitch;
        const double decay = std::exp(-2.0 * pi * away);
        const double distance2 = 1.0 - 2.0 * decay * std::cos(rows[r].count * turn) + decay * decay;
        const double least = 2.0 * pi * std::max(mesh, feeds_[first[r]].pocket_rim()) / pitch;
        square +=
            K * mass[r] * (rows[r].count * slit(z(j), rows[r].z) - 0.5 * std::log(std::max(distance2, least * least)));
      }
      states[at(i, j)] = bore_.held(i) ? bore_.pressure(i) : std::sqrt(std::max(square, 0.25 * outside));
    }
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (std::size_t k = first[r]; k < first[r] + static_cast<std::size_t>(rows[r].count); ++k)
        if (feeds_[k].line() == i)
          for (int n = 0; n < feeds_[k].unknowns(); ++n)
            states[nodes_ + unknown(k, n)] = behind[r][static_cast<std::size_t>(n)];
  }
}

// Linear between nodes.
void GasFilm::resample(const JournalMotion& /*motion*/, const Film& other, std::span<const double> from,
                       std::span<double> to) const {
  const auto* mesh = dynamic_cast<const GasFilm*>(&other);
  core::require(mesh != nullptr && from.size() == mesh->states() && mesh->unknowns_ == unknowns_,
                "states of another film of gas");
  for (int i = 0; i < lines_; ++i) {
    double line = (angle(i) - mesh->bore_.start()) / mesh->dtheta_;
    line -= mesh->lines_ * std::floor(line / mesh->lines_);
    const int l = static_cast<int>(line) % mesh->lines_, l_next = (l + 1) % mesh->lines_;
    const double u = line - std::floor(line);
    for (int j = 0; j < inner_; ++j) {
      const double place = (z(j) + 0.5 * geometry_.length) / mesh->dz_ - 1.0;
      const int m = static_cast<int>(std::floor(place));
      const double v = place - m;
      const auto p = [&](int a, int b) { return mesh->pressure(from, a, b); };
      to[at(i, j)] =
          (1.0 - u) * ((1.0 - v) * p(l, m) + v * p(l, m + 1)) + u * ((1.0 - v) * p(l_next, m) + v * p(l_next, m + 1));
    }
  }
  std::copy(from.begin() + static_cast<std::ptrdiff_t>(mesh->nodes_), from.end(),
            to.begin() + static_cast<std::ptrdiff_t>(nodes_));
}

// Volumes are those of the gas at the pressure outside. Torque by (3.30), which is that of the shear at the journal,
// less what slip takes of it; none in grooves.
FilmReport GasFilm::summary(const JournalMotion& motion_given, std::span<const double> states) {
  const JournalMotion motion = seen(motion_given);
  FilmReport out;
  out.min_thickness = least_thickness(motion, states);
  out.max_pressure = *std::max_element(states.begin(), states.begin() + static_cast<std::ptrdiff_t>(nodes_ + flows_));
  const double warmth = options_.gas_constant * options_.temperature, to_volume = warmth / options_.ambient;
  out.mass_flow = 0.0;
  for (std::size_t k = 0; k < feeds_.size(); ++k) {
    const double mass = feeds_[k].into_film(unknowns_of(k, &states[nodes_]), thickness(motion, feeds_[k])).mass;
    out.mass_flow += mass;
    out.hole_flows.push_back(mass * to_volume);
  }
  out.mean_temperature = out.max_temperature = options_.temperature;
  out.imbalance = out.mass_flow * to_volume + from_grooves(motion, states);
  const double slips = drive_.first / 6.0;
  double torque = 0.0;
  for (int i = 0; i < lines_; ++i) {
    const int after = (i + 1) % lines_, before = (i + lines_ - 1) % lines_;
    const bool groove = bore_.held(i), deep = groove && bore_.held(after);
    const double film = groove ? 1.0 - 0.5 * (bore_.held(after) + bore_.held(before)) : 1.0;
    for (int j = -1; j <= inner_; ++j) {
      const double width = j < 0 || j == inner_ ? 0.5 * dz_ : dz_, h = thickness(motion, 2 * i, j);
      const double p = pressure(states, i, j), rise = deep ? 0.0 : pressure(states, after, j) - p;
      const double shear = viscosity_ * geometry_.radius * motion.speed / (h + slips / p);
      torque += geometry_.radius * width * (film * shear * dx_ + 0.5 * thickness(motion, 2 * i + 1, j) * rise);
    }
    for (const int end : {-1, inner_ - 1}) {
      const double h = thickness(motion, 2 * i, end + 0.5);
      const double rise = drive_.rise(h, pressure(states, i, end), pressure(states, i, end + 1)).value;
      const double q = groove ? 0.0 : rise / (24.0 * viscosity_ * dz_) * dx_ / options_.ambient;
      out.side_flow += end < 0 ? q : -q;
    }
    for (int j = 0; j < inner_ && !groove; ++j) {
      const double grows = -mean_ * ((motion.velocity[0] + z(j) * motion.velocity[2]) * std::cos(angle(i)) +
                                     (motion.velocity[1] + z(j) * motion.velocity[3]) * std::sin(angle(i)));
      out.imbalance -= states[at(i, j)] * grows * dx_ * dz_ / options_.ambient;
    }
  }
  out.imbalance -= out.side_flow;
  out.inlet_flow = out.outlet_flow = 0.0;
  out.power_loss = torque * motion.speed;
  out.drag_torque = torque;
  return out;
}

// Volume that the lines of nodes in grooves give to those beside them; what feeds give there leaves through the groove.
double GasFilm::from_grooves(const JournalMotion& motion, std::span<const double> states) const {
  double out = 0.0;
  for (int i = 0; i < lines_ && bore_.any_held(); ++i) {
    const int next = (i + 1) % lines_;
    if (bore_.held(i) == bore_.held(next)) continue;
    for (int j = 0; j < inner_; ++j) {
      const double h = thickness(motion, 2 * i + 1, j), low = pressure(states, i, j), high = pressure(states, next, j);
      const double q = 0.25 * geometry_.radius * motion.speed * h * (low + high) -
                       drive_.rise(h, low, high).value / (24.0 * viscosity_ * dx_);
      out += (bore_.held(i) ? q : -q) * dz_ / options_.ambient;
    }
  }
  const double to_volume = options_.gas_constant * options_.temperature / options_.ambient;
  for (std::size_t k = 0; k < feeds_.size(); ++k)
    for (const GasFeed::Part& a : feeds_[k].parts())
      if (bore_.held(a.node / inner_))
        out -= a.weight * to_volume *
               feeds_[k].into_film(unknowns_of(k, &states[nodes_]), thickness(motion, feeds_[k])).mass;
  return out;
}

std::vector<NodalField> GasFilm::fields(const JournalMotion& motion_given, std::span<const double> states) {
  const JournalMotion motion = seen(motion_given);
  const auto around = static_cast<std::size_t>(lines_ + 1), along = static_cast<std::size_t>(inner_ + 2);
  NodalField theta{0, "theta", "rad", {around}, {}}, axis{0, "z", "m", {along}, {}};
  NodalField p{0, "pressure", "Pa", {around, along}, {}}, h{0, "thickness", "m", {around, along}, {}};
  for (int j = -1; j <= inner_; ++j) axis.values.push_back(z(j));
  for (int i = 0; i <= lines_; ++i) {
    theta.values.push_back(angle(i));
    for (int j = -1; j <= inner_; ++j) {
      p.values.push_back(pressure(states, i % lines_, j));
      h.values.push_back(thickness(motion, 2 * i, j));
    }
  }
  return {std::move(theta), std::move(axis), std::move(p), std::move(h)};
}

}  // namespace whirl::film
