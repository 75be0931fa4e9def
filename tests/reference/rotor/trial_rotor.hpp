#pragma once
// Whirl frequencies of the trial rotor of a dissertation on aerostatic bearings, computed independently.

#include <array>

namespace whirl::reference::trial_rotor {

/// The ten lowest at one speed, rad/s by ascending modulus, signed: negative backward. At rest each pair has no sign.
struct Case {
  const char* name;
  bool shear;    // Timoshenko, otherwise Rayleigh
  bool disc;     // 0.5 kg, Id = 7.81e-5, Ip = 1.56e-4 kg m^2, at 3/10 of the length
  double speed;  // rad/s
  std::array<double, 10> frequency, uncertainty;
};

// Uniform steel shaft 300 mm x 15 mm, E = 205 GPa, nu = 0.3, 7860 kg/m^3, on springs of 1e7 N/m at its ends.
inline constexpr std::array cases{
    Case{"rayleigh, plain, omega0=0",
         false,
         false,
         0,
         {2023.5578, 2023.5578, 7221.29493, 7221.29493, 13428.4025, 13428.4025, 19998.9819, 19998.9819, 29554.1516,
          29554.1516},
         {0.0004, 0.0004, 0.0014, 0.0014, 0.0027, 0.0027, 0.004, 0.004, 0.0096, 0.0096}},
    Case{"timoshenko, plain, omega0=0",
         true,
         false,
         0,
         {2019.33229, 2019.33229, 7175.38683, 7175.38683, 13315.8901, 13315.8901, 19796.3751, 19796.3751, 29014.2775,
          29014.2775},
         {0.0004, 0.0004, 0.0014, 0.0014, 0.0027, 0.0027, 0.004, 0.004, 0.0058, 0.0058}},
    Case{"rayleigh, plain, omega0=10000",
         false,
         false,
         10000,
         {-2010.29189, 2036.88383, -7186.89211, 7255.66881, -13373.3502, 13483.7329, -19869.7752, 20129.3856,
          -29286.397, 29824.1055},
         {0.0004, 0.00041, 0.0014, 0.0015, 0.0027, 0.0027, 0.004, 0.004, 0.0094, 0.0098}},
    Case{"timoshenko, plain, omega0=10000",
         true,
         false,
         10000,
         {-2006.17578, 2032.5465, -7141.81672, 7208.91935, -13262.7436, 13369.2627, -19673.9337, 19919.7336,
          -28768.1367, 29261.7788},
         {0.0004, 0.00041, 0.0014, 0.0014, 0.0027, 0.0027, 0.0039, 0.004, 0.0058, 0.0059}},
    Case{"rayleigh, disc_0.3L, omega0=0",
         false,
         true,
         0,
         {1238.62108, 1238.62108, 5539.66862, 5539.66862, 12185.4571, 12185.4571, 17413.8095, 17413.8095, 24008.0386,
          24008.0386},
         {0.00025, 0.00025, 0.0011, 0.0011, 0.0024, 0.0024, 0.0035, 0.0035, 0.0048, 0.0048}},
    Case{"timoshenko, disc_0.3L, omega0=0",
         true,
         true,
         0,
         {1235.55808, 1235.55808, 5499.24573, 5499.24573, 12110.8548, 12110.8548, 17179.7797, 17179.7797, 23734.2074,
          23734.2074},
         {0.00025, 0.00025, 0.0011, 0.0011, 0.0024, 0.0024, 0.0034, 0.0034, 0.0047, 0.0047}},
    Case{"rayleigh, disc_0.3L, omega0=10000",
         false,
         true,
         10000,
         {-1192.69174, 1279.38678, -5100.28908, 5820.50713, -10032.9772, 13916.7527, -17026.7233, 17811.4776,
          -21602.5663, 27054.7931},
         {0.00024, 0.00026, 0.001, 0.0012, 0.002, 0.0028, 0.0034, 0.0036, 0.0043, 0.0061}},
    Case{"timoshenko, disc_0.3L, omega0=10000",
         true,
         true,
         10000,
         {-1190.0505, 1275.8877, -5067.17887, 5773.74878, -9966.48922, 13790.2212, -16788.8543, 17577.4723, -21325.8216,
          26591.766},
         {0.00024, 0.00026, 0.001, 0.0012, 0.002, 0.0028, 0.0034, 0.0035, 0.0043, 0.0053}}};

/// Speeds in rad/s where internal damping of 1e-6 s makes the rotor with the disc whirl: 20 quasistatic Timoshenko
/// elements, bearings without damping and with 100 N s/m.
inline constexpr double internal_damping = 1e-6, threshold_undamped = 1240.8435, threshold_damped = 2195.3511;
inline constexpr double damped_bearing = 100;

}  // namespace whirl::reference::trial_rotor
