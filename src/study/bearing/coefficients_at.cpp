#include "study/bearing/coefficients_at.hpp"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "study/bearing/held_film.hpp"

namespace whirl::study {
namespace {

constexpr double beside = 1e-6;  // clearances

}  // namespace

void AtSpeed::fill(std::size_t ports, std::size_t frequencies, std::size_t amplitudes) {
  film::PortCoefficients none;
  none.ports = ports;
  for (auto* of : {&none.stiffness, &none.damping})
    for (auto& row : *of) row.fill(io::no_value);
  coefficients.assign(frequencies, none);
  EnforcedAt lost;
  lost.coefficients = none;
  lost.tail.fill(io::no_value);
  lost.distortion.fill(io::no_value);
  lost.lost.fill(reason);
  lost.apart = io::no_value;
  enforced.clear();
  if (amplitudes > 0) enforced.assign(frequencies, std::vector<EnforcedAt>(amplitudes, lost));
}

AtSpeed coefficients_at(film::Film& film, const DynamicCoefficientsOptions& options, const system::Support& support,
                        double speed, const JournalPlace* last) {
  const double c = support.geometry.clearance;
  film::JournalMotion motion;
  motion.speed = speed;
  const bool loaded = !options.load.values.empty();
  const double e = options.eccentricity.value_or(0.0), angle = options.attitude.value_or(0.0);
  const auto at = [&](double eccentricity) {
    motion.position = {eccentricity * c * std::cos(angle), eccentricity * c * std::sin(angle), 0, 0};
  };
  if (loaded) {
    FilmAtRest carrier(support, speed);
    // Where the film does not come to rest at the last place, the search begins by itself.
    if (last) (void)has_answer([&] { carrier.hold({last->motion.position[0], last->motion.position[1]}); });
    carrier.carry(load_along(options.load));
    motion = carrier.motion();
  } else {
    at(e);
  }
  AtSpeed now;
  now.place = rest_at(film, motion, last ? last->states : std::vector<double>());
  const auto first = [&](const JournalPlace& place) {
    return film::FrequencyCoefficients(film, place.motion, place.states).at(options.all_frequencies().front() * speed);
  };
  if (!loaded && e == 0) {
    at(beside);
    JournalPlace there;
    std::optional<film::PortCoefficients> near;
    if (has_answer([&] {
          there = rest_at(film, motion, now.place.states);
          near = first(there);
        })) {
      constexpr double same = 0.01;
      if (const film::PortCoefficients own = first(now.place); difference(own, *near, 2) > same) {
        now.centre = own;
        now.place = std::move(there);
      }
    }
  }
  now.thickness = film.least_thickness(now.place.motion, now.place.states);
  film::FrequencyCoefficients by_frequency(film, now.place.motion, now.place.states);
  for (const double ratio : options.all_frequencies()) {
    const double omega = ratio * speed;
    now.coefficients.push_back(by_frequency.at(omega));
    if (!options.amplitudes.empty())
      now.enforced.push_back(
          enforced_at(film, support.geometry, now.place, omega, options.amplitudes, now.coefficients.back()));
  }
  return now;
}

std::string of_the_centre(const AtSpeed& at) {
  const film::PortCoefficients &c = *at.centre, &near = at.coefficients.front();
  return fmt::format(
      "at the centre the film is whole, beside it a part is ruptured: the coefficients are those of a small load, at "
      "an "
      "eccentricity of {:.0e}, with k_xy = {:.5g} N/m and damping xx = {:.5g} N s/m; at the centre itself these are "
      "{:.5g} and {:.5g}",
      beside, near.stiffness[0][1], near.damping[0][0], c.stiffness[0][1], c.damping[0][0]);
}

AtSpeed at_speed(Pieces& pieces, const std::string& name, double speed, const std::function<AtSpeed()>& compute) {
  return pieces.value(name, [&] {
    AtSpeed out;
    WithoutFilm none = agreed_film(MPI_COMM_SELF, [&] { out = compute(); });
    if (!none.reason.empty()) {
      out = {};
      out.place.motion.position.fill(io::no_value);
      out.reason = std::move(none.reason);
      out.most = none.most;
    }
    out.place.motion.speed = speed;
    return out;
  });
}

}  // namespace whirl::study
