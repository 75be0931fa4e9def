#pragma once
// Whirl of the trial rotor of a dissertation on aerostatic bearings, computed independently: trial_rotor.json.

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "source_dir.hpp"

namespace whirl::reference::trial_rotor {

/// The ten lowest whirl frequencies at one speed, rad/s by ascending modulus, signed: negative backward. At rest each
/// pair has no sign.
struct Case {
  std::string name;
  bool shear = false;  // Timoshenko, otherwise Rayleigh
  bool disc = false;
  double speed = 0;  // rad/s
  std::array<double, 10> frequency{}, uncertainty{};
};

/// Bearings of this damping [N s/m] keep the rotor with the disc from whirling up to this speed [rad/s].
struct Threshold {
  double bearing_damping = 0, speed = 0;
};

/// A speed [rad/s] of a shaft of ten elements of a kind: a threshold of whirl with bearings of this damping [N s/m], or
/// the first forward critical speed.
struct OfElement {
  std::string element;
  bool disc = false;
  double bearing_damping = 0, speed = 0;
};

struct Reference {
  std::vector<Case> cases;
  std::vector<Threshold> thresholds;
  std::vector<OfElement> other_thresholds, critical_speeds;
  double internal_damping = 0;  // s, of the thresholds
};

inline Reference read() {
  std::ifstream file(std::string(WHIRL_SOURCE_DIR) + "/tests/reference/rotor/trial_rotor.json");
  const nlohmann::json all = nlohmann::json::parse(file);
  Reference out;
  for (const nlohmann::json& c : all.at("cases"))
    out.cases.push_back(
        {c.at("name"), c.at("shear"), c.at("disc"), c.at("speed"), c.at("frequency"), c.at("uncertainty")});
  for (const nlohmann::json& t : all.at("thresholds"))
    out.thresholds.push_back({t.at("bearing_damping"), t.at("speed")});
  for (const nlohmann::json& t : all.at("other_thresholds"))
    out.other_thresholds.push_back({t.at("element"), t.at("disc"), t.at("bearing_damping"), t.at("speed")});
  for (const nlohmann::json& c : all.at("critical_speeds"))
    out.critical_speeds.push_back({c.at("element"), c.at("disc"), 0.0, c.at("speed")});
  out.internal_damping = all.at("internal_damping");
  return out;
}

}  // namespace whirl::reference::trial_rotor
