#include "study/bars/unresolved.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "whirl/rotor/element.hpp"

namespace whirl::study {

namespace {

// The least over all beams of the shaft of what `of` says of one.
template <class F>
double least_of_beams(const rotor::Options& shaft, F&& of) {
  double least = std::numeric_limits<double>::infinity();
  if (shaft.type == rotor::Options::Type::rigid) return least;
  // Of a shaft without shear the sections have the shear stiffness of solid ones.
  const auto shear = shaft.shear == rotor::Shear::rigid ? rotor::Shear::cowper_solid : shaft.shear;
  for (std::size_t k = 0; k < shaft.segments.size(); ++k)
    if (!rotor::coupling_at(shaft, k))
      least = std::min(least, of(rotor::make_beam(shaft.segments[k], shaft.material, shear)));
  return least;
}

}  // namespace

double half_wave_limit(const rotor::Options& shaft) {
  return least_of_beams(shaft, [](const rotor::Beam& beam) {
    const double wave = std::numbers::pi / beam.length;
    return wave * wave * std::sqrt(beam.bending_stiffness / beam.mass_per_length);
  });
}

double shear_cut_off(const rotor::Options& shaft) {
  return least_of_beams(shaft, [](const rotor::Beam& beam) {
    const double shear = 12 * beam.bending_stiffness / (beam.shear_parameter * beam.length * beam.length);
    return std::sqrt(shear / beam.inertia_per_length);
  });
}

double resolved_to(const rotor::Options& shaft) {
  return std::min(half_wave_limit(shaft), shear_cut_off(shaft));
}

bool is_of_elements(std::complex<double> lambda, double resolved_to) {
  constexpr double little = 1e-6;
  return std::abs(lambda.imag()) > resolved_to && std::abs(lambda.real()) < little * std::abs(lambda);
}

}  // namespace whirl::study
