#pragma once
// The fluid and the clearance of a film over the temperature.

#include "study/bearing/thd_study.hpp"
#include "whirl/io/record.hpp"

namespace whirl::study {

/// Puts the table `properties` into `group`: for each of the options' `temperatures` viscosity Pa s, density kg/m^3 at
/// the pressure of the ambient, conductivity W/(m K), heat capacity J/(kg K), Prandtl number, of a gas the ratio of
/// specific heats c/(c - r), and the clearance m that bush and journal leave when both have this temperature
/// throughout. A part without `growth` keeps its size. Nothing without temperatures. Source: Skarolek (2011) fig. 1.9.
void put_properties(io::Group& group, const ThdOptions& options, const thermal::Fluid& fluid,
                    const film::Geometry& geometry);

}  // namespace whirl::study
