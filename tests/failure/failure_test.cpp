// Decks that must be refused with a stated message. The first lines of each say what is expected:
// `# expect: LINE:COLUMN: message` (or another place), `# set: PATH=VALUE` for overrides.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "source_dir.hpp"
#include "whirl/study/deck.hpp"

namespace {

using namespace whirl;
namespace fs = std::filesystem;

const std::string folder = std::string(WHIRL_SOURCE_DIR) + "/tests/failure";

struct Case {
  std::string expect;
  std::vector<std::string> overrides;
};

Case header_of(const fs::path& path) {
  const std::map<std::string, std::string> bare{{"empty", "1:1: the deck is empty"},
                                                {"binary", "1:1: the file is not UTF-8 text"},
                                                {"latin", "1:1: the file is not UTF-8 text"}};
  if (const auto it = bare.find(path.stem().string()); it != bare.end()) return {it->second, {}};
  Case c;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line) && line.starts_with("#");) {
    if (line.starts_with("# expect: ")) c.expect = line.substr(10);
    if (line.starts_with("# set: ")) c.overrides.push_back(line.substr(7));
  }
  return c;
}

std::string with_folder(std::string text) {
  if (const auto at = text.find("FOLDER"); at != std::string::npos) text.replace(at, 6, folder);
  return text;
}

}  // namespace

TEST(WrongDecks, AreRefusedWithTheStatedMessage) {
  int n = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    ++n;
    SCOPED_TRACE(entry.path().filename().string());
    const Case c = header_of(entry.path());
    ASSERT_FALSE(c.expect.empty());
    std::string expected = with_folder(c.expect);
    if (expected[0] >= '0' && expected[0] <= '9') expected = entry.path().string() + ":" + expected;
    if (expected.starts_with("base/")) expected = folder + "/" + expected;
    try {
      (void)study::load(MPI_COMM_WORLD, entry.path().string(), c.overrides);
      ADD_FAILURE() << "the deck was accepted";
    } catch (const core::InputError& e) {
      const std::string first = std::string(e.what()).substr(0, std::string(e.what()).find('\n'));
      if (expected.ends_with(": "))
        EXPECT_TRUE(first.starts_with(expected)) << first;
      else
        EXPECT_EQ(first, expected);
      EXPECT_EQ(e.exit(), core::Exit::input);
      EXPECT_TRUE(e.agreed());
    }
  }
  EXPECT_GE(n, 30);
}

TEST(WrongDecks, TheRigThatTheySpoilIsRight) {
  EXPECT_NO_THROW((void)study::load(MPI_COMM_WORLD, folder + "/base/rig.yaml", {}));
}

TEST(WrongDecks, LargeDecksAreRefused) {
  const fs::path path = fs::temp_directory_path() / "whirl_large_deck.yaml";
  {
    std::ofstream out(path);
    for (int i = 0; i < 40000; ++i) out << "# a line that says nothing at all\n";
  }
  EXPECT_THROW((void)study::load(MPI_COMM_WORLD, path.string(), {}), core::InputError);
}

TEST(WrongDecks, AllProblemsOfADeckAreToldAtOnce) {
  try {
    (void)study::load(MPI_COMM_WORLD, folder + "/base/rig.yaml",
                      {"gravity=9.81", "bearings.B1.node=0", "bearings.B2.geometry.clearance=1 s"});
    FAIL();
  } catch (const core::InputError& e) {
    const std::string all = e.what();
    EXPECT_EQ(std::count(all.begin(), all.end(), '\n'), 2) << all;
  }
}

// Words of the field for an option of another name. A hint never changes the quantity: it says how one becomes the
// other.
TEST(WrongDecks, WordsOfTheFieldAreUnderstood) {
  const std::string disc = "rotor.discs.1={node: 3, mass: 100 kg, ", film = "bearings.B1.film={type: linear, ",
                    geometry = "bearings.B1.geometry={type: cylindrical, length: 50 mm, ",
                    segment = "rotor.segments.1={rotor: A, length: 0.2 m, outer_mass_diameter: 100 mm, ";
  const std::pair<std::string, const char*> cases[] = {
      {"rotor.discs.1={node: 3, weight: 100 kg}",
       "'weight' (did you mean 'mass'? It is the weight divided by 9.81 m/s^2)"},
      {"rotor.discs.1={node: 3, weight: 981 N}", "(did you mean 'mass'? It is the weight divided by 9.81 m/s^2)"},
      {disc + "Ip: 1 kg m^2}", "(did you mean 'polar_inertia'?)"},
      {disc + "J_p: 1 kg m^2}", "(did you mean 'polar_inertia'?)"},
      {disc + "It: 1 kg m^2}", "(did you mean 'diametral_inertia'?)"},
      {disc + "Id: 1 kg m^2}", "(did you mean 'diametral_inertia'?)"},
      {disc + "transverse-inertia: 1 kg m^2}", "(did you mean 'diametral_inertia'?)"},
      {disc + "ID: 20 mm}", "(did you mean 'inner_diameter'?)"},
      {disc + "radius: 200 mm}", "(did you mean 'outer_diameter'? It is twice the radius)"},
      {disc + "position: 400 mm}", "(did you mean 'node'? It is the number of a node)"},
      {"rotor.segments.1={rotor: A, span: 0.2 m, outer_mass_diameter: 100 mm}", "(did you mean 'length'?)"},
      {segment + "OD: 100 mm}", "(did you mean 'outer_diameter'?)"},
      {"rotor.material={E: 210 GPa}", "(did you mean 'modulus'?)"},
      {"rotor.material={modulus: 210 GPa, nu: 0.3}", "(did you mean 'poisson'?)"},
      {geometry + "radius: 50 mm, radial_clearance: 100 um}", "(did you mean 'clearance'?)"},
      {geometry + "radius: 50 mm, Cd: 200 um}", "'clearance'? It is the radial clearance, half of the diametral one)"},
      {geometry + "D: 100 mm, clearance: 100 um}", "(did you mean 'diameter'?)"},
      {"lubricants.oil={mu: 20 mPa s, density: 860 kg/m^3}", "(did you mean 'viscosity'?)"},
      {"lubricants.oil={kinematic_viscosity: 20 mm^2/s, density: 860 kg/m^3}",
       "'viscosity'? It is the kinematic viscosity times the density)"},
      {"lubricants.oil.viscosity=46 cSt",
       "(a kinematic viscosity: its product with the density is the viscosity, mPa s = cSt x density / (1000 kg/m^3))"},
      {"lubricants.oil.viscosity=46 cst", "unknown unit 'cst' (did you mean 'cSt'?)"},
      {film + "k: 1e8 N/m, damping: 1e5 N s/m}", "(did you mean 'stiffness'?)"},
      {film + "stiffness: 1e8 N/m, damping_coefficient: 1e5 N s/m}", "(did you mean 'damping'?)"},
      {film + "stiffness: 1e8 N/m, c: 1e5 N s/m}", "(did you mean 'damping'?)"},
      {"operating_speed=3000 rpm", "(did you mean 'service_speed'?)"},
      {"service_speed=50 min^-1", "(a frequency is not a speed: 1 Hz is 60 rpm)"},
      {"rotor.discs.1.mass=981 N", "(a weight is not a mass: a mass of 1 kg weighs 9.81 N)"},
      {"studies=[{static: {frequency: 50 Hz}}]", "(did you mean 'speed'? It is in rpm: 1 Hz is 60 rpm)"},
      {"studies=[{modes: {range: {start: 100 rpm, end: 200 rpm}}}]", "unknown key 'start' (did you mean 'from'?)"},
      {"shaft={}", "(did you mean 'rotor'?)"},
      // A colon or its space that is missing.
      {"rotor.discs.1={node: 3, mass:100 kg}", "'mass:100 kg' (did you mean 'mass: 100 kg'?)"},
      {"rotor.discs.1={node: 3, mass 100 kg}", "'mass 100 kg' (did you mean 'mass: 100 kg'?)"},
      // Another quantity is not meant.
      {disc + "Ip: 1 m}", "unknown key 'Ip'; valid keys are"},
  };
  for (const auto& [change, words] : cases) {
    try {
      (void)study::load(MPI_COMM_WORLD, folder + "/base/rig.yaml", {change});
      ADD_FAILURE() << change << " was accepted";
    } catch (const core::InputError& e) {
      EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << change << "\n" << e.what();
    }
  }
}
