#pragma once
// Published and independently computed whirl frequencies of simple rotors.

#include <array>

namespace whirl::reference::rotors {

// Friswell, Penny, Garvey & Lees, Dynamics of Rotating Machines (2010), examples 5.9.1 and 5.9.9, as reproduced in the
// public validation of ROSS (petrobras/ross): shaft 1.5 m x 50 mm, E = 211 GPa, G = 81.2 GPa, 7810 kg/m^3, six
// Timoshenko elements, discs 70 mm thick. Magnitudes in rad/s; 650.41 of example 5.9.1 is left out:
// it is the same at 0 and 4000 rpm and no bending mode (axial).
inline constexpr std::array friswell_591_rest{86.66, 86.66, 274.31, 274.31, 716.78};
inline constexpr std::array friswell_591_4000_rpm{85.39, 87.80, 251.78, 294.71, 600.18};
inline constexpr std::array friswell_599_rest{90.14, 90.14, 630.73, 630.73, 830.43, 830.43};
inline constexpr std::array friswell_599_4000_rpm{76.19, 103.91, 565.99, 634.23, 647.75, 1174.2};

// Uniform steel shaft 300 mm x 15 mm (E = 205 GPa, nu = 0.3, 7860 kg/m^3) on two isotropic springs of 1e7 N/m at its
// ends, without and with a disc (0.5 kg, Id = 7.81e-5, Ip = 1.56e-4 kg m^2) at 3/10 of its length. Independent
// reference computation for the trial rotor of a dissertation on aerostatic bearings (see its errata), signed: negative
// backward. Relative uncertainty 3.3e-7 at most.
inline constexpr std::array trial_rayleigh_rest{2023.5578, 7221.29493, 13428.4025, 19998.9819, 29554.1516};
inline constexpr std::array trial_rayleigh_spinning{-2010.29189, 2036.88383,  -7186.89211, 7255.66881, -13373.3502,
                                                    13483.7329,  -19869.7752, 20129.3856,  -29286.397, 29824.1055};
inline constexpr std::array trial_timoshenko_spinning{-2006.17578, 2032.5465,   -7141.81672, 7208.91935,  -13262.7436,
                                                      13369.2627,  -19673.9337, 19919.7336,  -28768.1367, 29261.7788};
inline constexpr std::array disc_timoshenko_spinning{-1190.0505, 1275.8877,   -5067.17887, 5773.74878,  -9966.48922,
                                                     13790.2212, -16788.8543, 17577.4723,  -21325.8216, 26591.766};
inline constexpr double trial_spin = 10000;  // rad/s

}  // namespace whirl::reference::rotors
