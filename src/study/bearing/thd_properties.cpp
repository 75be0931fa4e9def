#include "study/bearing/thd_properties.hpp"

namespace whirl::study {
namespace {

// m, what a wall of radius R does to the clearance: R a (T - T_0) where it grows freely.
double grown(const thermal::WallOptions& wall, double radius, double temperature) {
  return wall.growth ? radius * wall.expansion * (temperature - wall.reference.value_or(wall.ambient)) : 0;
}

}  // namespace

void put_properties(io::Group& group, const ThdOptions& options, const thermal::Fluid& fluid,
                    const film::Geometry& geometry) {
  if (options.temperatures.empty()) return;
  std::vector<double> temperature, clearance, viscosity, density, conductivity, capacity, prandtl, ratio;
  for (const deck::Quantity& given : options.temperatures) {
    const double t = given.value;
    temperature.push_back(t);
    clearance.push_back(geometry.clearance + grown(options.bush, geometry.radius, t) -
                        grown(options.journal, geometry.radius, t));
    viscosity.push_back(thermal::viscosity(fluid.viscosity, t).value);
    density.push_back(fluid.rho(options.ambient.pressure, t));
    conductivity.push_back(fluid.k(t));
    capacity.push_back(fluid.c(t));
    prandtl.push_back(fluid.prandtl(t));
    ratio.push_back(fluid.c(t) / (fluid.c(t) - fluid.gas_constant));
  }
  io::Group& table = group.child("properties");
  table.put("temperature", temperature, "K", "of fluid, bush and journal");
  table.put("clearance", clearance, "m", "that bush and journal leave");
  table.put("viscosity", viscosity, "Pa s", "dynamic");
  table.put("density", density, "kg/m^3", "at the pressure of the ambient");
  table.put("conductivity", conductivity, "W/(m K)", "of the fluid");
  table.put("heat_capacity", capacity, "J/(kg K)", "of the fluid at constant pressure");
  table.put("prandtl", prandtl, "1", "viscosity times heat capacity over conductivity");
  if (fluid.gas) table.put("heat_ratio", ratio, "1", "ratio of specific heats");
}

}  // namespace whirl::study
