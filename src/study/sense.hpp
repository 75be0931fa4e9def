#pragma once
// Numbers of a machine and its films that are unusual: warnings with numbers, never refusals.

#include <string>
#include <utility>
#include <vector>

#include "whirl/film/contract/response.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/system/options.hpp"
#include "whirl/system/train.hpp"

namespace whirl::study {

/// What white metal bears. Mean: load over projected area, Pb and Sn alloys, ISO 7902-3. Film: compressive yield point
/// of tin-based alloys 1 to 3 at 100 degC, 18.3 to 21.7 MPa, ASTM B23.
inline constexpr double white_metal_load = 5e6, white_metal_pressure = 20e6;  // Pa

/// Reynolds number rho Omega R c/mu above which a film in a bore is not laminar: Taylor's vortices from 41.1 sqrt(R/c)
/// (Taylor 1923) on, turbulence at about 2000 (San Andres, Modern Lubrication Theory, notes 8).
[[nodiscard]] double laminar_limit(const film::Geometry& geometry);

/// Knudsen number up to which the film's law of slip holds: 0.01 without slip, 0.1 of first order (Burgdorfer 1959), 1
/// of second (Hsia and Domoto 1983).
[[nodiscard]] double slip_limit(const film::Gas& gas);

/// Lubricants whose viscosity or density is that of no fluid of their kind, a line each: a unit may be wrong.
[[nodiscard]] std::vector<std::string> unusual_lubricants(const system::Machine& machine);

/// Moduli of the shaft that are those of no solid it could be made of, a line each: a unit may be wrong.
[[nodiscard]] std::vector<std::string> unusual_material(const system::Machine& machine);

/// Linear bearings and elements whose direct damping is negative, a line each: they feed the whirl.
[[nodiscard]] std::vector<std::string> negative_damping(const system::Machine& machine);

/// Bearings whose journal the shaft lifts, with the negative load [N]: `load.NAME` of a static position, beyond its
/// bar, where the bearings together carry a weight that points down.
[[nodiscard]] std::vector<std::pair<std::string, io::Quantity>> lifted_journals(const io::StudySummary& summary);

/// The same of a shaft that two bearings alone hold, by the balance of its moments: a line each.
[[nodiscard]] std::vector<std::string> lifted_by_weight(const system::Machine& machine);

/// Warns of lifted_journals().
void warn_of_lifted(io::StudySummary& summary);

/// Puts specific load [Pa] and Reynolds number of a film with a bore, and the Knudsen number of one of gas, below
/// `head`.
void put_film_numbers(io::StudySummary& summary, const std::string& head, const system::Support& support,
                      const film::FilmReport& report, double load, double speed);

/// What a study asks of its films, beside the values in its summary.
struct AskedFilms {
  double speed = 0;                ///< highest one [rad/s]; 0: none
  std::string bearing;             ///< the one that it is about; empty: all
  std::vector<double> thinnest{};  ///< of each bearing of the machine [m]; empty, or not a number: not known
};

/// Warns of what the values of put_film_numbers() and `max_pressure` say, beyond their bars. Without these values the
/// Reynolds number is that of the least dense and most viscous state of the film, a bound from below, at the highest
/// speed; the Knudsen number is that at the thinnest place known, or of a film as thick as the clearance.
void warn_of_films(io::StudySummary& summary, const system::Train& train, const AskedFilms& asked);

/// Warns of a Reynolds number of a laminar film above laminar_limit(), for a film that is none of the machine's.
void warn_of_reynolds(io::StudySummary& summary, const std::string& bearing, const film::Geometry& geometry,
                      double reynolds, double speed);

}  // namespace whirl::study
