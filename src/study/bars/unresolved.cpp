#include "study/bars/unresolved.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "whirl/rotor/element.hpp"

namespace whirl::study {

double resolved_to(const rotor::Options& shaft) {
  double lowest = std::numeric_limits<double>::infinity();
  if (shaft.type == rotor::Options::Type::rigid) return lowest;
  // Beams without shear are none above the border of those with it either.
  const auto shear = shaft.shear == rotor::Shear::rigid ? rotor::Shear::cowper_solid : shaft.shear;
  for (std::size_t k = 0; k < shaft.segments.size(); ++k) {
    if (rotor::coupling_at(shaft, k)) continue;
    const rotor::Beam beam = rotor::make_beam(shaft.segments[k], shaft.material, shear);
    const double wave = std::numbers::pi / beam.length;
    lowest = std::min(lowest, wave * wave * std::sqrt(beam.bending_stiffness / beam.mass_per_length));
    const double shear_stiffness = 12 * beam.bending_stiffness / (beam.shear_parameter * beam.length * beam.length);
    lowest = std::min(lowest, std::sqrt(shear_stiffness / beam.inertia_per_length));
  }
  return lowest;
}

bool is_of_elements(std::complex<double> lambda, double resolved_to) {
  constexpr double little = 1e-6;
  return std::abs(lambda.imag()) > resolved_to && lambda.real() < little * std::abs(lambda);
}

}  // namespace whirl::study
