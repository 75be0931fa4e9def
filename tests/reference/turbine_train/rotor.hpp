#pragma once
// Reference values of the rotor of the turbine-generator train.
//
// Provenance: an independent reference computation (another program, by other authors, not linked to this one) on the
// tables of inputs/turbine_train with the conventions of the errata of Gavalas (2022): consistent Timoshenko elements,
// E(T) linear per element, g = 9.81 m/s^2. `within` is the uncertainty stated with each value.

#include <array>

namespace whirl::reference::train {

inline constexpr double total_mass = 42165.661, total_mass_within = 0.01;            // kg
inline constexpr std::array span_masses{2798.401, 10844.748, 27558.803, 875.76633};  // kg, bearings 1-2, ...
inline constexpr double span_masses_within = 0.01;
inline constexpr double generator_slenderness = 13.00486, generator_slenderness_within = 1e-5;
inline constexpr double generator_span = 8.33358, total_length = 17.09362, length_within = 1e-6;  // m
// Planar bending frequencies at standstill, rad/s, relative uncertainty 1e-6.
inline constexpr std::array free_free{51.369265, 123.08498, 220.0676,  348.01767,
                                      639.94396, 779.33038, 973.44763, 1279.5432};
inline constexpr std::array pinned{119.87758, 316.66985, 428.18727, 617.3117,
                                   884.96599, 1173.7199, 1320.514,  1626.9819};  // displacement held at the bearings
// Rigid supports: at the tabulated elevations, and all at one height. N.
inline constexpr std::array reactions{13227.515, 44924.674, 215866.79, 129636.87, 9989.2862};
inline constexpr double reactions_within = 1.0;
inline constexpr std::array reactions_level{13441.225, 28362.325, 234952.89, 150540.24, -13651.549};
inline constexpr double reactions_level_within = 2.0;
inline constexpr std::array moment_nodes{43, 100, 167};
inline constexpr std::array moments{-6.0923103, 10.054514, 8818.1424};  // N m, sagging positive
inline constexpr double moments_within = 5.0;
// Elevations from zero moment at nodes 43 and 100 and 10 kN on bearing 5, m (tables of the train, rounded to 1 um).
inline constexpr std::array elevations{110e-6, 0.0, 0.0, 4214e-6, 6675e-6};
inline constexpr double elevations_within = 2e-6;

}  // namespace whirl::reference::train
