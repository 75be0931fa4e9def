#pragma once
// The whole turbine-generator train as plain data, for tests below the deck.

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "support/turbine_train.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/system/train.hpp"

namespace whirl::test {

/// Five bearings on pedestals, no unbalance, gravity; `guyan` reduces to the 21 master nodes.
inline system::Train train(std::array<int, 2> cells, bool guyan) {
  system::Train t;
  t.rotor = train_rotor();
  if (guyan) {
    t.rotor.reduction.type = rotor::Reduction::Type::guyan;
    t.rotor.reduction.masters = train_masters();
  }
  for (auto& row : read_csv(train_folder + "bearings.csv")) {
    system::Support s;
    s.node = std::stoi(row["node"]);
    s.elevation = std::stod(row["elevation_m"]);
    s.geometry.type = row["type"] == "arc" ? film::Geometry::Bore::partial_arc : film::Geometry::Bore::lemon_bore;
    s.geometry.radius = std::stod(row["journal_radius_m"]);
    s.geometry.length = std::stod(row["length_m"]);
    s.geometry.clearance = std::stod(row["radial_clearance_cb_m"]);
    s.geometry.arc = std::stod(row["arc_deg"]) * std::numbers::pi / 180;
    s.geometry.preload = std::stod(row["preload"]);
    film::Reynolds film;
    film.cells = cells;
    film.cavitation = film::Reynolds::Cavitation::half_sommerfeld;  // as the source has it
    film.turbulence = film::Turbulence::constantinescu;
    s.film = film;
    s.lubricant = {std::stod(row["viscosity_Pa_s"]), std::stod(row["oil_density_kg_m3"])};
    t.supports.push_back(s);
  }
  std::size_t i = 0;
  for (auto& row : read_csv(train_folder + "pedestals.csv")) {
    auto& s = t.supports[i++];
    s.has_pedestal = true;
    s.mass = {std::stod(row["mass_x_kg"]), std::stod(row["mass_y_kg"])};
    s.stiffness = {std::stod(row["stiffness_x_N_m"]), std::stod(row["stiffness_y_N_m"])};
    s.damping = {std::stod(row["damping_x_N_s_m"]), std::stod(row["damping_y_N_s_m"])};
  }
  return t;
}

/// The reduced train in cylindrical bores of its clearances with liners of the given compliance B at 377 rad/s.
inline system::Train train_on_liners(std::array<int, 2> cells, double compliance) {
  system::Train t = train(cells, true);
  for (std::size_t i = 0; i < t.supports.size(); ++i) {
    system::Support& s = t.supports[i];
    s.name = "B" + std::to_string(i + 1);
    s.geometry = {
        film::Geometry::Bore::cylindrical, s.geometry.radius, s.geometry.length, s.geometry.clearance, 0, 0, 0};
    film::CompliantFinite film;
    film.compliance = compliance;
    film.reference_speed = 377;
    film.cells = cells;
    film.differences = film::Compliant::Differences::central;
    s.film = film;
  }
  return t;
}

/// Makes of a film on rigid pads one that holds its content.
inline void hold_content(film::Options& options) {
  auto& film = film::as<film::Reynolds>(options);
  film.cavitation = film::Reynolds::Cavitation::mass_conserving;
  film.states = film::Reynolds::States::dynamic;
}

/// The generator pair of a balance grade [mm/s]: half of M_GEN e_u at nodes 120 and 140, in antiphase.
inline void add_gen_pair(system::Train& t, double grade) {
  const double u = 0.5 * rotor::mass_between(t.rotor, 93, 160) * grade * 1e-3 / 377;
  t.unbalance = {{120, u, 0}, {140, u, std::numbers::pi}};
}

}  // namespace whirl::test
