#include "study/bars/open_bore.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace whirl::study {

OpenBores::OpenBores(const system::Machine& machine) {
  if (!system::is_rotor(machine)) return;
  using Type = film::Geometry::Bore;
  constexpr double pi = std::numbers::pi, open = pi / 2;
  for (const system::Support& s : system::train_of(machine).supports) {
    const film::Geometry& g = s.geometry;
    const bool two = g.type == Type::lemon_bore;
    const double gap = two ? pi - g.arc : 2 * pi - g.arc;
    const bool has_pads = g.clearance > 0 && g.type != Type::cylindrical && g.arc > 0;
    bores_.push_back({s.name, g.clearance, has_pads && gap > open ? g.arc : 0.0, two, 0, 0});
  }
}

bool OpenBores::empty() const {
  return std::none_of(bores_.begin(), bores_.end(), [](const Bore& b) { return b.arc > 0; });
}

// The lower pad's middle is at -90 degrees, that of the upper one opposite.
void OpenBores::see(std::size_t place, double x, double y, double at) {
  if (place >= bores_.size() || bores_[place].arc == 0) return;
  Bore& b = bores_[place];
  const double e = std::hypot(x, y) / b.clearance;
  if (!(e > std::max(1.0, b.farthest))) return;
  const double from_lower = std::atan2(std::abs(x), -y), from_upper = std::numbers::pi - from_lower;
  if (std::min(from_lower, b.two ? from_upper : from_lower) < b.arc / 2) return;
  b.farthest = e;
  b.at = at;
}

void OpenBores::warn(io::StudySummary& summary, const std::string& unit) const {
  for (const Bore& b : bores_)
    if (b.farthest > 1)
      summary.warnings.push_back(
          fmt::format("the journal of bearing {} moves up to {:.2f} clearances from the centre{}, outside its bore, "
                      "where {} of {:.3g} deg leave{} it open: the equations have no wall there",
                      b.name, b.farthest, unit.empty() ? "" : fmt::format(" (at {:.6g} {})", b.at, unit),
                      b.two ? "two pads" : "one pad", b.arc * 180 / std::numbers::pi, b.two ? "" : "s"));
}

}  // namespace whirl::study
