// Reynolds' equation pad by pad: chooses the solver of each pad, adds the pads up, and reports fields.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "film/kinds.hpp"
#include "film/mobility.hpp"
#include "film/pad.hpp"
#include "film/turning_frame.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {
namespace {

void demand(bool condition, const char* what) {
  if (!condition) throw core::InputError(std::string("film: ") + what);
}

void check(const Geometry& g, const Options& o, const Lubricant& l) {
  demand(g.radius > 0.0 && g.length > 0.0 && g.clearance > 0.0, "radius, length and clearance must be positive");
  const double limit = (g.type == Geometry::Bore::lemon_bore ? 1.0 : 2.0) * std::numbers::pi;
  const bool closed = g.type == Geometry::Bore::cylindrical;
  demand(closed || (g.arc > 0.0 && g.arc <= limit), "the arc must be positive and its pads must not overlap");
  demand(closed || o.grooves.empty(), "only a cylindrical bore has grooves");
  demand(o.inlet.type == Inlet::Type::free || (closed && o.grooves.empty()),
         "only a cylindrical bore without grooves has an inlet");
  demand(o.cavitation != Options::Cavitation::mass_conserving || !closed || !o.grooves.empty() ||
             o.inlet.type != Inlet::Type::free,
         "a film that conserves its mass must be fed: a cylindrical bore needs 'grooves' or an 'inlet'");
  demand(o.edge_fill == 1.0 || !closed || o.inlet.type != Inlet::Type::free,
         "'edge_fill' is of the edges of pads and inlets: a groove is full");
  demand(g.preload < 1.0, "the preload must be below 1");
  demand(g.type == Geometry::Bore::lemon_bore || g.offset == 0.0, "only a lemon bore has an offset");
  demand(o.cells[0] >= 3 && o.cells[1] >= 2, "at least 3 x 2 cells per pad");
  demand(l.viscosity > 0.0, "the viscosity must be positive");
  demand(l.density >= 0.0 && (l.density > 0.0 || o.turbulence == Options::Turbulence::laminar),
         "a turbulent film needs a positive density");
}

class ReynoldsFilm final : public Model {
public:
  ReynoldsFilm(const Geometry& geometry, const Options& options, const Lubricant& lubricant)
      : options_(options), lubricant_(lubricant), pads_(make_pads(geometry, options.inlet)) {
    const bool modal = !options.tilt && (options.cavitation == Options::Cavitation::half_sommerfeld ||
                                         options.cavitation == Options::Cavitation::none);
    for (const Pad& pad : pads_) {
      solvers_.push_back(modal && !pad.closed ? make_modal_pad(pad, options, lubricant)
                                              : make_banded_pad(pad, options, lubricant));
    }
  }

  void evaluate(const Motion& motion, Need need, Response& response) override {
    response = {};
    response.min_thickness = std::numeric_limits<double>::infinity();
    if (turns()) {
      const TurningFrame frame(motion, pads_.front().clearance);
      solvers_.front()->add(frame.motion(), need, response);
      return frame.turn_back(need, response);
    }
    for (auto& solver : solvers_) solver->add(motion, need, response);
  }

  Summary summary(const Motion& motion) override;
  std::vector<Field> fields(const Motion& motion) override;

private:
  [[nodiscard]] bool turns() const { return options_.inlet.type == Inlet::Type::maximum_gap; }
  // The motion seen by the pads.
  [[nodiscard]] Motion seen(const Motion& motion) const {
    return turns() ? TurningFrame(motion, pads_.front().clearance).motion() : motion;
  }
  double thickness(const Pad& pad, const Motion& motion, double theta, double z) const {
    const double tx = options_.tilt ? motion.position[2] : 0.0, ty = options_.tilt ? motion.position[3] : 0.0;
    return pad.clearance - (motion.position[0] + z * tx - pad.centre_x) * std::cos(theta) -
           (motion.position[1] + z * ty - pad.centre_y) * std::sin(theta);
  }

  Options options_;
  Lubricant lubricant_;
  std::vector<Pad> pads_;
  std::vector<std::unique_ptr<PadSolver>> solvers_;
};

// Side flow through both ends, h^3/(mu k_z) p_z with one-sided slopes of second order; friction torque of the journal
// from the shear mu U/h tau_c + (h/2) p_theta/R with tau_c = 1 + 0.0012 Re^0.94 in turbulence (Constantinescu's Couette
// factor).
// A film that conserves its mass counts the flows of its own equations.
// What enters is Couette flow U h/2 less the pressure's own around the pad, at its first edge in the direction of
// rotation.
Summary ReynoldsFilm::summary(const Motion& given) {
  const Motion motion = seen(given);
  Summary result;
  Flows total;
  bool known = true;
  result.inlet_flow = 0.0;
  result.min_thickness = std::numeric_limits<double>::infinity();
  const Resistance along = resistance_along(options_.turbulence), around = resistance_around(options_.turbulence);
  const bool laminar = options_.turbulence == Options::Turbulence::laminar;
  const double mu = lubricant_.viscosity;
  for (std::size_t n = 0; n < pads_.size(); ++n) {
    const Pad& pad = pads_[n];
    const double X = motion.position[0] - pad.centre_x, Y = motion.position[1] - pad.centre_y;
    const double tx = options_.tilt ? motion.position[2] : 0.0, ty = options_.tilt ? motion.position[3] : 0.0;
    result.min_thickness = std::min(result.min_thickness, LeastThickness(pad)(X, Y, tx, ty));
    const Grid grid(pad, options_.cells);
    const auto columns = static_cast<std::size_t>(grid.n_z + 1);
    const std::vector<double> p = solvers_[n]->pressure(motion), fill = solvers_[n]->fill(motion);
    const double U = motion.speed * pad.radius;
    double shear = 0.0;
    for (int i = 0; i <= grid.n_theta; ++i) {
      const double theta = pad.start + i * grid.dtheta;
      const double* row = &p[static_cast<std::size_t>(i) * columns];
      const double share = pad.radius * grid.dtheta * (i == 0 || i == grid.n_theta ? 0.5 : 1.0);
      for (int j = 0; j <= grid.n_z; ++j) {
        const double h = thickness(pad, motion, theta, j * grid.dz - 0.5 * pad.length);
        const double Re = lubricant_.density * std::abs(U) * h / mu;
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
        const double couette = laminar ? 1.0 : 1.0 + 0.0012 * std::pow(Re, 0.94);
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
    if (const std::optional<Flows> flows = solvers_[n]->flows(motion)) {
      total.enters += flows->enters;
      total.leaves += flows->leaves;
      total.sides += flows->sides;
      total.squeezed += flows->squeezed;
    } else {
      known = false;
    }
    if (pad.closed) result.inlet_flow = std::numeric_limits<double>::quiet_NaN();
  }
  if (known) {
    result.outlet_flow = total.leaves;
    result.imbalance = total.enters - total.leaves - total.sides - total.squeezed;
  }
  if (options_.cavitation == Options::Cavitation::mass_conserving) {
    result.inlet_flow = total.enters;
    result.side_flow = total.sides;
  }
  return result;
}

std::vector<Field> ReynoldsFilm::fields(const Motion& given) {
  const Motion motion = seen(given);
  const double turn = turns() ? TurningFrame(given, pads_.front().clearance).angle() : 0.0;
  std::vector<Field> all;
  for (std::size_t n = 0; n < pads_.size(); ++n) {
    const Pad& pad = pads_[n];
    const Grid grid(pad, options_.cells);
    const auto rows = static_cast<std::size_t>(grid.n_theta + 1), columns = static_cast<std::size_t>(grid.n_z + 1);
    const int index = static_cast<int>(n);
    Field theta{index, "theta", "rad", {rows}, {}}, z{index, "z", "m", {columns}, {}};
    Field pressure{index, "pressure", "Pa", {rows, columns}, solvers_[n]->pressure(motion)};
    Field h{index, "thickness", "m", {rows, columns}, {}};
    for (int i = 0; i <= grid.n_theta; ++i) theta.values.push_back(pad.start + i * grid.dtheta);
    for (int j = 0; j <= grid.n_z; ++j) z.values.push_back(j * grid.dz - 0.5 * pad.length);
    for (double t : theta.values) {
      for (double at : z.values) h.values.push_back(thickness(pad, motion, t, at));
    }
    for (double& t : theta.values) t += turn;
    for (Field* f : {&theta, &z, &pressure, &h}) all.push_back(std::move(*f));
    if (std::vector<double> fill = solvers_[n]->fill(motion); !fill.empty())
      all.push_back({index, "fill", "1", {rows, columns}, std::move(fill)});
  }
  return all;
}

}  // namespace

std::unique_ptr<Model> make_reynolds(const Geometry& geometry, const Options& options, const Lubricant& lubricant) {
  check(geometry, options, lubricant);
  return std::make_unique<ReynoldsFilm>(geometry, options, lubricant);
}

}  // namespace whirl::film
