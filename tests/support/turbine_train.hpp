#pragma once
// The turbine-generator train of inputs/turbine_train as plain options, read without the deck room.

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "source_dir.hpp"
#include "whirl/rotor/alignment.hpp"
#include "whirl/rotor/options.hpp"

namespace whirl::test {

/// Rows of a CSV file as header -> cell.
inline std::vector<std::map<std::string, std::string>> read_csv(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  auto cells = [](const std::string& line) {
    std::vector<std::string> out;
    std::istringstream words(line);
    for (std::string cell; std::getline(words, cell, ',');) out.push_back(cell);
    return out;
  };
  std::string line;
  std::getline(file, line);
  const std::vector<std::string> header = cells(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> values = cells(line);
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < header.size() && i < values.size(); ++i) row[header[i]] = values[i];
    rows.push_back(row);
  }
  return rows;
}

inline const std::string train_folder = std::string(WHIRL_SOURCE_DIR) + "/inputs/turbine_train/";

/// The rotor, not reduced. `segments` is the file in the folder of the train.
inline rotor::Options train_rotor(const std::string& segments = "segments.csv") {
  rotor::Options o;
  o.material.density = 7850;
  o.material.poisson = 0.3;
  o.stiffness_damping = 1e-5;
  for (auto& row : read_csv(train_folder + "steel_modulus.csv"))
    o.material.modulus.emplace_back(std::stod(row["temperature [degC]"]) + 273.15, std::stod(row["modulus [Pa]"]));
  for (auto& row : read_csv(train_folder + segments)) {
    rotor::Segment s;
    s.rotor = row["rotor"];
    s.part = row["part"];
    s.length = std::stod(row["length [m]"]);
    s.outer_mass_diameter = std::stod(row["outer_mass_diameter [m]"]);
    s.inner_mass_diameter = std::stod(row["inner_mass_diameter [m]"]);
    s.outer_stiffness_diameter = std::stod(row["outer_stiffness_diameter [m]"]);
    s.inner_stiffness_diameter = std::stod(row["inner_stiffness_diameter [m]"]);
    s.added_mass = std::stod(row["added_mass [kg]"]);
    s.added_mass_inner_diameter = std::stod(row["added_mass_inner_diameter [m]"]);
    s.added_mass_outer_diameter = std::stod(row["added_mass_outer_diameter [m]"]);
    s.temperature = std::stod(row["temperature [degC]"]) + 273.15;
    o.segments.push_back(s);
  }
  return o;
}

/// Bearing nodes with their tabulated elevations.
inline std::vector<rotor::RigidSupport> train_supports() {
  std::vector<rotor::RigidSupport> supports;
  for (auto& row : read_csv(train_folder + "bearings.csv"))
    supports.push_back({std::stoi(row["node"]), std::stod(row["elevation_m"])});
  return supports;
}

/// The 21 master nodes of the Guyan reduction.
inline std::vector<int> train_masters() {
  std::vector<int> nodes;
  for (auto& row : read_csv(train_folder + "master_nodes.csv")) nodes.push_back(std::stoi(row["node"]));
  return nodes;
}

}  // namespace whirl::test
