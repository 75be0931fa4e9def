#pragma once
// Stiffness and damping of one film at one speed, as a checkpoint keeps them.

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "study/bearing/dynamic_coefficients.hpp"
#include "study/bearing/enforced_motion.hpp"
#include "study/bearing/film_at_rest.hpp"
#include "study/pieces.hpp"
#include "whirl/film/use/coefficients.hpp"

namespace whirl::study {

/// A journal at rest at one speed, and its coefficients at all frequencies; or why there are none.
struct AtSpeed {
  JournalPlace place;
  double thickness = io::no_value;
  std::vector<film::PortCoefficients> coefficients;
  std::vector<std::vector<EnforcedAt>> enforced;  ///< [frequency][amplitude]; none without amplitudes
  /// Of the film at the centre itself, at the first frequency, where it is another one than beside the centre.
  std::optional<film::PortCoefficients> centre;
  std::string reason;            ///< empty: there are coefficients
  std::optional<Capacity> most;  ///< of a film that does not carry the load
  [[nodiscard]] bool found() const { return reason.empty(); }
  /// Of the journal, in clearances.
  [[nodiscard]] double eccentricity(double clearance) const {
    return std::hypot(place.motion.position[0], place.motion.position[1]) / clearance;
  }
  /// As many coefficients that are not numbers.
  void fill(std::size_t ports, std::size_t frequencies, std::size_t amplitudes);
  void members(auto& archive) {
    archive(place.motion.position, place.motion.speed, place.states, place.force, thickness);
    archive(coefficients, enforced, centre, reason, most);
  }
};
void members(auto& archive, film::PortCoefficients& c) {
  archive(c.ports, c.stiffness, c.damping);
}

/// At `speed` rad/s, sought from `last`, if there is one. Throws as rest_at() and FilmAtRest::carry() do.
///
/// At the centre, eccentricity 0, a film that ruptures carries nothing and is whole; beside it, however near, half of
/// it is ruptured, and so K_xy and B_xx are half as large. What a small load finds is the limit from beside: where both
/// differ, the coefficients are those at an eccentricity of 1e-6 along the attitude, and `centre` has the other ones.
[[nodiscard]] AtSpeed coefficients_at(film::Film& film, const DynamicCoefficientsOptions& options,
                                      const system::Support& support, double speed, const JournalPlace* last);

/// What is to be said where a film has `centre`.
[[nodiscard]] std::string of_the_centre(const AtSpeed& at);

/// The piece of that name: what `compute` returns, or why it does not.
[[nodiscard]] AtSpeed at_speed(Pieces& pieces, const std::string& name, double speed,
                               const std::function<AtSpeed()>& compute);

}  // namespace whirl::study
