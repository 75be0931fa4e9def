#include "film/gas/gas_bore.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "film/sheet/groove.hpp"

namespace whirl::film {
namespace {

using std::numbers::pi;

// Arcs of the bore. Those of lobes touch each other.
std::vector<Pad> arcs_of(const Geometry& g, const Gas& o) {
  if (!o.lobes) return make_pads(g);
  const double clearance = g.clearance / (1.0 - o.lobes->preload), rise = clearance - g.clearance;
  const double arc = 2.0 * pi / o.lobes->count;
  std::vector<Pad> out;
  for (int k = 0; k < o.lobes->count; ++k) {
    const double middle = o.lobes->angle + k * arc;
    out.push_back({g.radius, g.length, clearance, middle - 0.5 * arc, arc, -rise * std::cos(middle),
                   -rise * std::sin(middle), false});
  }
  return out;
}

// Grooves, and what lies between pads.
std::vector<Groove> held_by(const Geometry& g, const Gas& o, const std::vector<Pad>& arcs) {
  std::vector<Groove> out = o.grooves;
  if (g.type == Geometry::Bore::cylindrical) return out;
  const double width = 2.0 * pi / static_cast<double>(arcs.size()) - arcs.front().arc;
  for (const Pad& pad : arcs) out.push_back({pad.start - 0.5 * width, width, o.ambient});
  return out;
}

double start_of(const Geometry& g, const Gas& o, const std::vector<Pad>& arcs) {
  if (o.lobes || g.type != Geometry::Bore::cylindrical) return arcs.front().start;
  if (!o.orifices.empty()) return o.orifices.front().angle;
  return o.grooves.empty() ? 0.0 : o.grooves.front().angle;
}

}  // namespace

GasBore::GasBore(const Geometry& geometry, const Gas& options)
    : arcs_(arcs_of(geometry, options)), start_(start_of(geometry, options, arcs_)) {
  for (const Pad& arc : arcs_) least_.emplace_back(arc);
  const int n = options.cells[0];
  const double step = 2.0 * pi / n;
  // The mean over a cell by Simpson's rule on each side of its node, where two lobes may meet.
  for (int k = 0; k < 2 * n; ++k) gaps_.push_back(gap(start_ + 0.5 * k * step));
  for (int i = 0; i < n; ++i) {
    const double middle = start_ + i * step, quarters = gap(middle - 0.25 * step) + gap(middle + 0.25 * step);
    means_.push_back((at(2 * i - 1) + 4.0 * quarters + 2.0 * at(2 * i) + at(2 * i + 1)) / 12.0);
  }
  const std::vector<Groove> grooves = held_by(geometry, options, arcs_);
  held_ = grooves.empty() ? std::vector<bool>(static_cast<std::size_t>(n)) : grooved(n, grooves, start_);
  pressure_ = pressures_in_grooves(n, grooves, start_);
  for (double& p : pressure_)
    if (p == 0.0) p = options.ambient;
  any_held_ = !grooves.empty();
}

double GasBore::gap(double angle) const {
  const Pad* here = &arcs_.front();
  double nearest = 1e9;
  for (const Pad& arc : arcs_) {
    const double away = std::abs(std::remainder(angle - arc.start - 0.5 * arc.arc, 2.0 * pi));
    if (away >= nearest - 1e-12) continue;
    nearest = away;
    here = &arc;
  }
  return here->clearance + here->centre_x * std::cos(angle) + here->centre_y * std::sin(angle);
}

double GasBore::least(const std::array<double, 4>& p) const {
  double out = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < arcs_.size(); ++k)
    out = std::min(out, least_[k](p[0] - arcs_[k].centre_x, p[1] - arcs_[k].centre_y, p[2], p[3]));
  return out;
}

}  // namespace whirl::film
