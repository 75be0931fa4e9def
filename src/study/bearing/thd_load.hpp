#pragma once
// The place of a journal where a film with heat carries a load.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "study/bearing/thd_at_speed.hpp"

namespace whirl::study {

/// Of the load, the force that may be left where the journal is.
inline constexpr double load_tolerance = 1e-6;

/// A film that is solved, and how many were to find the place of its journal.
struct SolvedFilm {
  std::unique_ptr<ThdAtSpeed> film;
  int films = 1;
  bool converged = false;  ///< its temperatures
};

/// Where a search begins: the place of the journal in clearances, else the place of a film of one temperature under the
/// load; the state of a film on the same mesh, empty: the ambient's temperature.
struct FilmStart {
  std::optional<std::array<double, 2>> place;
  std::vector<double> state;
};

/// The film at the place that the options give, or where its force and the options' load balance to 1e-6 of the load.
///
/// Two unknowns, the place, by Broyden's method (1965). The matrix it begins with is a difference quotient of the
/// film's force while its temperatures are held. A step leaves half of the smallest gap, and is halved while the force
/// that is left grows. Collective. Throws core::NotConverged, on all ranks, where no such place is found.
[[nodiscard]] SolvedFilm solve_film(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry,
                                    double speed, const FilmStart& start);

}  // namespace whirl::study
