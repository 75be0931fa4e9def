#include "whirl/thermal/lumped.hpp"

#include <fmt/core.h>

#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::thermal {

double wall_coefficient(double conductivity, double clearance, double prandtl) {
  if (!(prandtl >= least_lumped_prandtl))
    throw core::DomainError(
        fmt::format("the heat balance of a film of one temperature holds for Prandtl numbers above {}, here it is "
                    "{:.3g}: heat reaches across the whole film",
                    least_lumped_prandtl, prandtl));
  return 1.5 * conductivity / clearance * std::cbrt(prandtl);
}

double lumped_balance(const Fluid& fluid, double clearance, const std::array<LumpedWall, 2>& walls,
                      const LumpedFilm& film, double temperature) {
  double out = fluid.c(temperature) * film.mass * (film.inlet - temperature) + film.heat;
  for (const LumpedWall& wall : walls)
    if (wall.area > 0)
      out += wall.area * wall_coefficient(fluid.k(temperature), clearance, fluid.prandtl(temperature)) *
             (wall.temperature - temperature);
  return out;
}

double lumped_temperature(const Fluid& fluid, double clearance, const std::array<LumpedWall, 2>& walls,
                          const std::function<LumpedFilm(double)>& film, double start) {
  constexpr double far = 500, enough = 1e-7;
  constexpr int most = 60;
  const auto balance = [&](double t) { return lumped_balance(fluid, clearance, walls, film(t), t); };
  double low = start, f_low = balance(low), high = low, f_high = f_low;
  for (double step = 5; f_high > 0; step *= 2) {
    low = high;
    f_low = f_high;
    high = start + step;
    if (step > far) throw core::NotConverged("no temperature of the film was found at which its heat is in balance");
    f_high = balance(high);
  }
  // Regula falsi (Illinois): an end that stays twice counts half, so that both come to the root.
  int stays = 0;  // 1: the upper end stayed the last time, -1: the lower one
  for (int k = 0; k < most && high - low > enough; ++k) {
    const double t = (low * f_high - high * f_low) / (f_high - f_low), f = balance(t);
    if (std::abs(t - (f > 0 ? low : high)) < enough / 2) return t;
    if (f > 0) {
      if (stays == 1) f_high /= 2;
      low = t;
      f_low = f;
      stays = 1;
    } else {
      if (stays == -1) f_low /= 2;
      high = t;
      f_high = f;
      stays = -1;
    }
  }
  return f_low <= 0 ? low : (low + high) / 2;
}

}  // namespace whirl::thermal
