// The decks in inputs/: read as intended, resolved to themselves, described by the schema; every option is documented.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>

#include "source_dir.hpp"
#include "study/cycle/cycle_branch.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "support/turbine_train.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"
#include "whirl/study/deck.hpp"

namespace {

using namespace whirl;
using Json = nlohmann::json;
namespace fs = std::filesystem;

const std::string inputs = std::string(WHIRL_SOURCE_DIR) + "/inputs";

std::vector<std::string> all_decks() {
  std::vector<std::string> decks;
  for (const auto& e : fs::recursive_directory_iterator(inputs))
    if (e.path().extension() == ".yaml") decks.push_back(e.path().string());
  std::sort(decks.begin(), decks.end());
  return decks;
}

study::Deck load(const std::string& path, const std::vector<std::string>& overrides = {}) {
  return study::load(MPI_COMM_WORLD, path, overrides);
}

// Compiled once: every value of every deck is held against the patterns of its option.
const std::regex& pattern(const std::string& text) {
  static std::map<std::string, std::regex> all;
  const auto found = all.find(text);
  return found != all.end() ? found->second : all.emplace(text, text).first->second;
}

Json json_of(const deck::Node& n) {
  return Json::parse(deck::to_json(n));
}

// The part of JSON Schema that ours uses. Empty if `value` is valid, otherwise where it is not.
std::string invalid(const Json& schema, const Json& value, const std::string& path) {
  if (schema.contains("if"))
    return invalid(invalid(schema["if"], value, path).empty() ? schema["then"] : schema["else"], value, path);
  for (const char* some : {"anyOf", "oneOf"}) {
    if (!schema.contains(some)) continue;
    int n = 0;
    std::string last;
    for (const Json& s : schema[some]) {
      const std::string at = invalid(s, value, path);
      at.empty() ? void(++n) : void(last = at);
    }
    if (n == 0 || (n > 1 && some[0] == 'o')) return n == 0 ? last : path + " matches several";
  }
  if (schema.contains("const") && schema["const"] != value) return path + " is not " + schema["const"].dump();
  if (schema.contains("enum") && std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end())
    return path + " is not one of the enum";
  if (schema.contains("type")) {
    const Json types = schema["type"].is_array() ? schema["type"] : Json::array({schema["type"]});
    bool fits = false;
    for (const Json& t : types)
      fits = fits || (t == "object" && value.is_object()) || (t == "array" && value.is_array()) ||
             (t == "string" && value.is_string()) || (t == "number" && value.is_number()) ||
             (t == "integer" && value.is_number_integer()) || (t == "boolean" && value.is_boolean()) ||
             (t == "null" && value.is_null());
    if (!fits) return path + " is not of type " + schema["type"].dump() + ": " + value.dump();
  }
  if (schema.contains("pattern") && value.is_string() &&
      !std::regex_search(value.get<std::string>(), pattern(schema["pattern"].get<std::string>())))
    return path + " does not match the pattern: " + value.dump();
  if (value.is_number()) {
    if (schema.contains("minimum") && value < schema["minimum"]) return path + " is too small";
    if (schema.contains("exclusiveMinimum") && value <= schema["exclusiveMinimum"]) return path + " is too small";
    if (schema.contains("maximum") && value > schema["maximum"]) return path + " is too large";
  }
  if (schema.contains("required") && value.is_object())
    for (const Json& r : schema["required"])
      if (!value.contains(r.get<std::string>())) return path + " lacks " + r.dump();
  if (value.is_object())
    for (const auto& [key, v] : value.items()) {
      const bool known = schema.contains("properties") && schema["properties"].contains(key);
      std::string at;
      if (known)
        at = invalid(schema["properties"][key], v, path + "." + key);
      else if (schema.contains("additionalProperties"))
        at = schema["additionalProperties"].is_object() ? invalid(schema["additionalProperties"], v, path + "." + key)
                                                        : path + " has no " + key;
      if (!at.empty()) return at;
    }
  if (value.is_array() && schema.contains("items"))
    for (const Json& v : value)
      if (const std::string at = invalid(schema["items"], v, path + "[]"); !at.empty()) return at;
  return {};
}

}  // namespace

TEST(Documented, EveryOptionHasAText) {
  EXPECT_EQ(deck::undocumented(deck::structure_of<study::Deck>()), std::vector<std::string>());
  for (const auto& k : study::kinds()) EXPECT_GT(k.text.size(), 10U) << k.name;
}

TEST(InputDecks, ResolveToThemselves) {
  const auto decks = all_decks();
  ASSERT_GE(decks.size(), 6U);
  for (const std::string& path : decks) {
    const std::string resolved = study::resolved_text(load(path));
    const deck::Files files(MPI_COMM_WORLD);
    deck::Problems problems;
    const auto again = deck::read<study::Deck>(deck::parse_yaml(resolved, "resolved.yaml"), files, problems);
    EXPECT_NO_THROW(problems.raise()) << path;
    EXPECT_EQ(study::resolved_text(again), resolved) << path;
  }
}

TEST(InputDecks, FollowTheSchema) {
  const Json schema = Json::parse(deck::schema_text(deck::structure_of<study::Deck>(), "deck"));
  const deck::Files files(MPI_COMM_WORLD);
  for (const std::string& path : all_decks()) {
    EXPECT_EQ(invalid(schema, json_of(deck::parse_yaml(files.read_text(path), path)), "deck"), "") << path;
    // Whole decks too: merged with their bases, and resolved.
    EXPECT_EQ(invalid(schema, json_of(deck::load(path, {}, files)), "deck"), "") << path;
    EXPECT_EQ(invalid(schema, json_of(deck::parse_yaml(study::resolved_text(load(path)), path)), "deck"), "") << path;
  }
  const std::string train = inputs + "/turbine_train/train.yaml";
  for (const char* wrong :
       {"gravty=1 m/s^2", "gravity=9.81", "bearings.B1.geometry.type=round", "bearings.B1.geometry.preload=0.5",
        "bearings.B1.node=1.5", "studies=[{statics: {}}]", "rotor.reduction={type: guyan}"})
    EXPECT_NE(invalid(schema, json_of(deck::load(train, {wrong}, files)), "deck"), "") << wrong;
}

TEST(TurbineTrain, IsTheMachineOfTheTables) {
  const study::Deck d = load(inputs + "/turbine_train/train.yaml");
  const system::Machine& m = d.machine;
  const rotor::Options r = test::train_rotor();
  ASSERT_EQ(m.rotor.segments.size(), r.segments.size());
  for (std::size_t i = 0; i < r.segments.size(); ++i) {
    const rotor::Segment &a = m.rotor.segments[i], &b = r.segments[i];
    EXPECT_EQ(a.rotor, b.rotor);
    EXPECT_EQ(a.length, b.length);
    EXPECT_EQ(a.outer_mass_diameter, b.outer_mass_diameter);
    EXPECT_EQ(a.inner_stiffness_diameter, b.inner_stiffness_diameter);
    EXPECT_EQ(a.added_mass, b.added_mass);
    EXPECT_NEAR(a.temperature, b.temperature, 1e-12);
  }
  ASSERT_EQ(m.rotor.material.modulus.size(), r.material.modulus.size());
  for (std::size_t i = 0; i < r.material.modulus.size(); ++i)
    EXPECT_EQ(m.rotor.material.modulus[i].second, r.material.modulus[i].second);
  EXPECT_EQ(m.rotor.material.density, 7850);
  EXPECT_EQ(m.rotor.stiffness_damping, 1e-5);

  const auto bearings = test::read_csv(test::train_folder + "bearings.csv");
  const auto pedestals = test::read_csv(test::train_folder + "pedestals.csv");
  const system::Train t = system::train_of(m, {"gen_pair"});
  ASSERT_EQ(t.supports.size(), bearings.size());
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    auto row = bearings[i], stand = pedestals[i];
    const system::Support& s = t.supports[i];
    auto same = [](double x, const std::string& cell) {
      EXPECT_NEAR(x, std::stod(cell), 1e-14 * std::abs(std::stod(cell)));
    };
    EXPECT_EQ(m.bearings[i].name, "B" + row["bearing"]);
    EXPECT_EQ(s.geometry.type == film::Geometry::Bore::lemon_bore, row["type"] == "lemon");
    EXPECT_EQ(s.node, std::stoi(row["node"]));
    same(s.elevation, row["elevation_m"]);
    same(s.geometry.radius, row["journal_radius_m"]);
    same(s.geometry.length, row["length_m"]);
    same(s.geometry.clearance, row["radial_clearance_cb_m"]);
    same(s.geometry.arc * 180 / std::numbers::pi, row["arc_deg"]);
    same(s.geometry.preload, row["preload"]);
    same(s.geometry.offset, row["offset_m"]);
    same(s.lubricant.viscosity, row["viscosity_Pa_s"]);
    same(s.lubricant.density, row["oil_density_kg_m3"]);
    ASSERT_TRUE(s.has_pedestal);
    same(s.mass[0], stand["mass_x_kg"]);
    same(s.mass[1], stand["mass_y_kg"]);
    same(s.stiffness[0], stand["stiffness_x_N_m"]);
    same(s.stiffness[1], stand["stiffness_y_N_m"]);
    same(s.damping[0], stand["damping_x_N_s_m"]);
    same(s.damping[1], stand["damping_y_N_s_m"]);
  }
  // Half of M_GEN e_u in each plane, M_GEN between bearings 3 and 4: the tabulated span mass times 2.5 mm/s / 377
  // rad/s.
  for (const auto& [rotor, first] : std::map<std::string, std::size_t>{{"GEN", 2}, {"HP", 0}, {"IPLP", 1}, {"SR", 3}}) {
    const auto p = system::enclosing_supports(m, rotor);
    ASSERT_TRUE(p.has_value());
    EXPECT_EQ(*p, (std::array{m.bearings[first].node, m.bearings[first + 1].node})) << rotor;
  }
  ASSERT_EQ(t.unbalance.size(), 2U);
  EXPECT_EQ(t.unbalance[0].node, 120);
  EXPECT_EQ(t.unbalance[0].amount, t.unbalance[1].amount);
  EXPECT_NEAR(t.unbalance[1].phase, std::numbers::pi, 1e-15);
  const system::Train heavy = system::train_of(m, {"gen_pair_g63"});
  EXPECT_NEAR(heavy.unbalance[0].amount / t.unbalance[0].amount, 6.3 / 2.5, 1e-14);
}

TEST(TurbineTrain, MastersAreThoseOfTheTable) {
  const study::Deck d = load(inputs + "/turbine_train/unbalance.yaml");
  EXPECT_EQ(d.machine.rotor.reduction.type, rotor::Reduction::Type::guyan);
  EXPECT_EQ(d.machine.rotor.reduction.masters, test::train_masters());
  ASSERT_EQ(d.studies.size(), 2U);
  const auto& cycles = dynamic_cast<const study::CycleBranch&>(*d.studies[1]);
  EXPECT_EQ(cycles.name(), "G6.3");
  EXPECT_EQ(cycles.given().parameter.range.unit, "rpm");
  EXPECT_NEAR(cycles.given().parameter.range.to, 200 * std::numbers::pi, 1e-11);
}

TEST(TurbineTrain, OverridesReachCellsBearingsAndStudies) {
  const study::Deck d = load(inputs + "/turbine_train/balanced.yaml",
                             {"rotor.segments.3.length=81 mm", "bearings.B2.geometry.clearance=264 um",
                              "studies.1.equilibrium_branch.range.to=9000 rpm"});
  EXPECT_EQ(d.machine.rotor.segments[2].length, 0.081);
  EXPECT_EQ(d.machine.bearings[1].geometry->clearance, 2.64e-4);
  EXPECT_EQ(film::facts(d.machine.bearings[1].film).cells[0], 120);
  EXPECT_NEAR(dynamic_cast<const study::EquilibriumBranch&>(*d.studies[0]).given().parameter.range.to,
              300 * std::numbers::pi, 1e-11);
}

TEST(TurbineTrain, OverridesKnowDiametersAndBalanceGrades) {
  const std::string train = inputs + "/turbine_train/train.yaml";
  const study::Deck as_given = load(train), d = load(train, {"bearings.*.geometry.diameter=x1.1",
                                                             "unbalance.*.grade=x2", "unbalance.gen_pair.grade=-20 %"});
  for (std::size_t b = 0; b < d.machine.bearings.size(); ++b)
    EXPECT_NEAR(d.machine.bearings[b].geometry->radius, 1.1 * as_given.machine.bearings[b].geometry->radius, 1e-15);
  EXPECT_EQ(d.machine.unbalance[0].grade->velocity, 4e-3);
  EXPECT_EQ(d.machine.unbalance[1].grade->velocity, 12.6e-3);
  try {
    (void)load(train, {"unbalance.gen_pair.grade=by +1 mm/s"});
    ADD_FAILURE() << "an offset of a grade";
  } catch (const core::InputError& e) {
    EXPECT_STREQ(
        e.what(),
        "--set unbalance.gen_pair.grade=by +1 mm/s: 'unbalance.gen_pair.grade': 'G2.5' takes a factor (x2, +20 %) or "
        "a new value, not the offset '+1 mm/s'");
  }
}

TEST(Parameter, ContinuableOptionsCanBeVaried) {
  const study::Deck d = load(inputs + "/turbine_train/train.yaml");
  const std::string path = "bearings.B2.geometry.clearance";
  EXPECT_EQ(study::parameter_unit(d.machine, "speed"), "rad/s");
  EXPECT_EQ(study::parameter_unit(d.machine, path), "m");
  EXPECT_EQ(study::with_parameter(d.machine, path, 3e-4).bearings[1].geometry->clearance, 3e-4);
  EXPECT_EQ(study::with_parameter(d.machine, "unbalance.gen_pair.grade", 5e-3).unbalance[0].grade->velocity, 5e-3);
  EXPECT_EQ(study::with_parameter(d.machine, "lubricants.hot_vg46.viscosity", 8e-3).lubricants.at("hot_vg46").viscosity,
            8e-3);
  EXPECT_THROW((void)study::with_parameter(d.machine, path, -1e-4), core::DomainError);
  EXPECT_THROW((void)study::parameter_unit(d.machine, "bearings.B2.geometry.radius"), core::InputError);
  EXPECT_THROW((void)study::parameter_unit(d.machine, "rotor.segments.1.length"), core::InputError);
  EXPECT_THROW((void)study::parameter_unit(d.machine, "bearings.B2.node"), core::InputError);
}
