#pragma once
// The place of a journal at rest where the film of one bearing carries a load.

#include <array>
#include <vector>

#include "whirl/film/film.hpp"

namespace whirl::study {

/// Of the load, the force that may be left where the journal is.
inline constexpr double place_tolerance = 1e-9;

/// A journal at rest and the film that has come to rest with it.
struct JournalPlace {
  film::JournalMotion motion;
  std::vector<double> states;     ///< of the film, if it has any
  std::array<double, 2> force{};  ///< of the film on the journal [N]
};

/// The film at rest at the place and speed of `motion`, from `states`. Throws core::DomainError or core::NotConverged.
[[nodiscard]] JournalPlace rest_at(film::Film& film, const film::JournalMotion& motion, std::vector<double> states);

/// The place where the film balances `load` [N] at the speed of `start`, sought from there by Newton's method with the
/// film's static stiffness, and, where that fails, along loads that rise from nothing. Throws core::NotConverged with
/// the largest of these that was carried, in words that name the capacity. Not collective.
[[nodiscard]] JournalPlace carry(film::Film& film, double clearance, const std::array<double, 2>& load,
                                 const JournalPlace& start);

}  // namespace whirl::study
