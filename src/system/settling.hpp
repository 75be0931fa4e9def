#pragma once
// What films that settle are solved with.

#include <memory>
#include <vector>

#include "film_comms.hpp"

namespace whirl::system {

/// The films that settle, of which this rank has rows.
struct RotorSystem::Settling {
  struct Film {
    std::size_t bearing;
    std::unique_ptr<film::StateInverse> inverse;
    std::vector<double> step;
  };
  std::shared_ptr<const FilmComms> comms;  // outlives the inverses
  std::vector<Film> films;
  core::Vector rest;
};

}  // namespace whirl::system
