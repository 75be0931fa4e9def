// What a film on rigid pads says of itself.
#include "film/sheet/report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace whirl::film {
namespace {

double thickness(const Pad& pad, const Reynolds& options, const JournalMotion& motion, double theta, double z) {
  const double tx = options.tilt ? motion.position[2] : 0.0, ty = options.tilt ? motion.position[3] : 0.0;
  return pad.clearance - (motion.position[0] + z * tx - pad.centre_x) * std::cos(theta) -
         (motion.position[1] + z * ty - pad.centre_y) * std::sin(theta);
}

}  // namespace

// Side flow through both ends, h^3/(mu k_z) p_z with one-sided slopes of second order; friction torque of the journal
// from the shear mu U/h tau_c + (h/2) p_theta/R with tau_c = 1 + 0.0012 Re^0.94 in turbulence (Constantinescu's Couette
// factor).
// A film that conserves its mass counts the flows of its own equations.
// What enters is Couette flow U h/2 less the pressure's own around the pad, at its first edge in the direction of
// rotation.
FilmReport summarise(const std::vector<Pad>& pads, const Reynolds& options, const Lubricant& lubricant,
                     const JournalMotion& motion, const std::vector<PadReport>& reports) {
  FilmReport result;
  Flows total;
  bool known = true;
  result.inlet_flow = 0.0;
  result.min_thickness = std::numeric_limits<double>::infinity();
  const Resistance along = resistance_along(options.turbulence), around = resistance_around(options.turbulence);
  const double mu = lubricant.viscosity;
  for (std::size_t n = 0; n < pads.size(); ++n) {
    const Pad& pad = pads[n];
    const double X = motion.position[0] - pad.centre_x, Y = motion.position[1] - pad.centre_y;
    const double tx = options.tilt ? motion.position[2] : 0.0, ty = options.tilt ? motion.position[3] : 0.0;
    result.min_thickness = std::min(result.min_thickness, LeastThickness(pad)(X, Y, tx, ty));
    const Grid grid(pad, options.cells);
    const auto columns = static_cast<std::size_t>(grid.n_z + 1);
    const std::vector<double>&p = reports[n].pressure, &fill = reports[n].fill;
    const double U = motion.speed * pad.radius;
    double shear = 0.0;
    for (int i = 0; i <= grid.n_theta; ++i) {
      const double theta = pad.start + i * grid.dtheta;
      const double* row = &p[static_cast<std::size_t>(i) * columns];
      const double share = pad.radius * grid.dtheta * (i == 0 || i == grid.n_theta ? 0.5 : 1.0);
      for (int j = 0; j <= grid.n_z; ++j) {
        const double h = thickness(pad, options, motion, theta, j * grid.dz - 0.5 * pad.length);
        const double Re = lubricant.density * std::abs(U) * h / mu;
        const bool side = j == 0 || j == grid.n_z;
        if (side) {
          const double first = row[j == 0 ? 1 : grid.n_z - 1], second = row[j == 0 ? 2 : grid.n_z - 2];
          result.side_flow +=
              share * h * h * h / (mu * film::evaluate(along, Re)) * (4.0 * first - second) / (2.0 * grid.dz);
        }
        if (!pad.closed && i == (U >= 0.0 ? 0 : grid.n_theta)) {
          const auto p_at = [&](int steps) {
            return p[static_cast<std::size_t>(i == 0 ? steps : i - steps) * columns + static_cast<std::size_t>(j)];
          };
          const double rise = (4.0 * p_at(1) - p_at(2)) / (2.0 * grid.dtheta * pad.radius);
          result.inlet_flow += grid.dz * (side ? 0.5 : 1.0) *
                               (0.5 * std::abs(U) * h - h * h * h / (mu * film::evaluate(around, Re)) * rise);
        }
        const double area = share * grid.dz * (side ? 0.5 : 1.0);
        const double couette = couette_factor(options.turbulence, Re);
        double slope = 0.0;
        if (pad.closed || (i > 0 && i < grid.n_theta)) {
          const auto at = [&](int line) {
            return p[static_cast<std::size_t>(line) * columns + static_cast<std::size_t>(j)];
          };
          slope = (at(i == grid.n_theta ? 1 : i + 1) - at(i == 0 ? grid.n_theta - 1 : i - 1)) / (2.0 * grid.dtheta);
        }
        // Where the gap is not full, streamers of that share cross it.
        const double covered =
            fill.empty() ? 1.0 : fill[static_cast<std::size_t>(i) * columns + static_cast<std::size_t>(j)];
        shear += area * (covered * mu * U / h * couette + 0.5 * h * slope / pad.radius);
        result.max_pressure = std::max(result.max_pressure, row[j]);
      }
    }
    result.power_loss += shear * U;
    if (const std::optional<Flows>& flows = reports[n].flows) {
      total.enters += flows->enters;
      total.leaves += flows->leaves;
      total.sides += flows->sides;
      result.hole_flows.resize(flows->holes.size(), 0.0);
      for (std::size_t k = 0; k < flows->holes.size(); ++k) result.hole_flows[k] += flows->holes[k];
      total.squeezed += flows->squeezed;
    } else {
      known = false;
    }
    if (pad.closed) result.inlet_flow = std::numeric_limits<double>::quiet_NaN();
  }
  if (known) {
    result.outlet_flow = total.leaves;
    result.imbalance = total.enters - total.leaves - total.sides - total.squeezed;
    for (const double flow : result.hole_flows) result.imbalance += flow;
  } else {
    result.hole_flows.clear();
  }
  if (options.cavitation == Reynolds::Cavitation::mass_conserving) {
    result.inlet_flow = total.enters;
    result.side_flow = total.sides;
  }
  return result;
}

std::vector<NodalField> fields_of(const std::vector<Pad>& pads, const Reynolds& options, const JournalMotion& motion,
                                  double turn, std::vector<PadReport> reports) {
  std::vector<NodalField> all;
  for (std::size_t n = 0; n < pads.size(); ++n) {
    const Pad& pad = pads[n];
    const Grid grid(pad, options.cells);
    const auto rows = static_cast<std::size_t>(grid.n_theta + 1), columns = static_cast<std::size_t>(grid.n_z + 1);
    const int index = static_cast<int>(n);
    NodalField theta{index, "theta", "rad", {rows}, {}}, z{index, "z", "m", {columns}, {}};
    NodalField pressure{index, "pressure", "Pa", {rows, columns}, std::move(reports[n].pressure)};
    NodalField h{index, "thickness", "m", {rows, columns}, {}};
    for (int i = 0; i <= grid.n_theta; ++i) theta.values.push_back(pad.start + i * grid.dtheta);
    for (int j = 0; j <= grid.n_z; ++j) z.values.push_back(j * grid.dz - 0.5 * pad.length);
    for (double t : theta.values) {
      for (double at : z.values) h.values.push_back(thickness(pad, options, motion, t, at));
    }
    for (double& t : theta.values) t += turn;
    for (NodalField* f : {&theta, &z, &pressure, &h}) all.push_back(std::move(*f));
    if (std::vector<double>& fill = reports[n].fill; !fill.empty())
      all.push_back({index, "fill", "1", {rows, columns}, std::move(fill)});
  }
  return all;
}

}  // namespace whirl::film
