// What the equations do not know: walls where a bore is open, and waves that a film's mesh does not resolve.

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "study/bars/mesh_wave.hpp"
#include "study/bars/open_bore.hpp"
#include "study/sense.hpp"
#include "support/half_rotor.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Complex = std::complex<double>;

namespace {

constexpr double deg = std::numbers::pi / 180, clearance = 1e-4;

system::Machine machine_with(std::vector<film::Geometry> bores) {
  system::Machine machine;
  machine.rotor.type = rotor::Options::Type::rigid;
  machine.rotor.mass = 1;
  machine.lubricants["oil"] = {0.01, 860};
  for (const film::Geometry& g : bores) {
    system::Bearing& b = machine.bearings.emplace_back();
    b.name = "B" + std::to_string(machine.bearings.size());
    b.node = 1;
    b.geometry = g;
    b.film = film::Reynolds{};
    b.lubricant = "oil";
  }
  return machine;
}

film::Geometry bore(film::Geometry::Bore type, double arc) {
  film::Geometry g{type, 0.05, 0.05, clearance, 0, 0, 0};
  g.arc = arc;
  return g;
}

std::vector<std::string> warned(const system::Machine& machine, std::size_t place, double x, double y,
                                const std::string& unit = "rpm") {
  study::OpenBores bores(machine);
  bores.see(place, x * clearance, y * clearance, 2800);
  bores.see(place, 0.3 * x * clearance, 0.3 * y * clearance, 3000);
  io::StudySummary summary;
  bores.warn(summary, unit);
  return summary.warnings;
}

}  // namespace

TEST(OpenBores, WarnsOfAJournalWhereNoPadIs) {
  using enum film::Geometry::Bore;
  const auto machine = machine_with({bore(partial_arc, 150 * deg), bore(lemon_bore, 80 * deg), bore(cylindrical, 0)});
  EXPECT_FALSE(study::OpenBores(machine).empty());
  // Above an arc below: 2.1 clearances from the centre.
  const auto above = warned(machine, 0, 0.1, 2.1);
  ASSERT_EQ(above.size(), 1U);
  for (const char* part : {"bearing B1", "2.10 clearances", "2800 rpm", "one pad of 150 deg"})
    EXPECT_NE(above[0].find(part), std::string::npos) << above[0];
  EXPECT_EQ(warned(machine, 0, 0.1, 2.1, "")[0].find("rpm"), std::string::npos);
  // Between two pads: 2.2 clearances to the side.
  const auto between = warned(machine, 1, -2.2, 0.2);
  ASSERT_EQ(between.size(), 1U);
  for (const char* part : {"bearing B2", "2.21 clearances", "two pads of 80 deg"})
    EXPECT_NE(between[0].find(part), std::string::npos) << between[0];
}

TEST(OpenBores, SaysNothingOfAJournalInItsBoreOrOverAPad) {
  using enum film::Geometry::Bore;
  const auto machine = machine_with({bore(partial_arc, 150 * deg), bore(lemon_bore, 80 * deg), bore(cylindrical, 0)});
  EXPECT_TRUE(warned(machine, 0, 0, 0.95).empty()) << "within a clearance";
  EXPECT_TRUE(warned(machine, 0, 0.3, -1.4).empty()) << "over the arc: that is contact";
  EXPECT_TRUE(warned(machine, 1, 0.2, 1.5).empty()) << "over the upper pad";
  EXPECT_TRUE(warned(machine, 2, 0, 2.5).empty()) << "a whole circle has a wall everywhere";
  EXPECT_TRUE(study::OpenBores(machine_with({bore(cylindrical, 0)})).empty());
  // A lemon bore of two nearly half circles leaves no gap worth the name.
  EXPECT_TRUE(study::OpenBores(machine_with({bore(lemon_bore, 150 * deg)})).empty());
}

TEST(UnusualMaterial, IsOneThatIsOffByAThousand) {
  system::Machine machine = machine_with({});
  const auto said = [&](double modulus, double shear) {
    machine.rotor.material.modulus = {{300, modulus}, {600, 0.8 * modulus}};
    machine.rotor.material.shear_modulus = shear;
    return study::unusual_material(machine);
  };
  machine.rotor.type = rotor::Options::Type::shaft;
  EXPECT_TRUE(said(206e9, 0).empty()) << "steel";
  EXPECT_TRUE(said(45e9, 17e9).empty()) << "magnesium";
  EXPECT_TRUE(said(600e9, 250e9).empty()) << "tungsten carbide";
  ASSERT_EQ(said(200e6, 79e6).size(), 2) << "one line of a table";
  EXPECT_EQ(said(200e6, 0).front(),
            "rotor.material: a modulus of 0.2 GPa is unusual (steel has about 206 GPa, aluminium 70 GPa): is its unit "
            "right?");
  EXPECT_NE(said(206e9, 79e12).front().find("shear modulus of 7.9e+04 GPa"), std::string::npos);
  machine.rotor.type = rotor::Options::Type::rigid;
  EXPECT_TRUE(said(200e6, 0).empty()) << "it has none";
}

TEST(NegativeDamping, CountsWithTheTable) {
  system::Machine machine = machine_with({bore(film::Geometry::Bore::cylindrical, 0)});
  const auto said = [&](double constant, std::vector<double> rows) {
    film::Linear film;
    system::Element seal;
    seal.name = "seal";
    film.damping = seal.damping = {500, 0, 0, constant};
    for (const double c : rows) {
      film.table.push_back({.c_yy = c});
      seal.table.push_back({.c_yy = c});
    }
    machine.bearings[0].film = film;
    machine.elements = {seal};
    return study::negative_damping(machine);
  };
  const auto line = [](const std::string& place, const std::string& value) {
    return place + ": negative damping (C_yy = " + value + " N s/m) feeds the vibration: is its sign right?";
  };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(said(100, {}), Lines{});
  EXPECT_EQ(said(-100, {}), (Lines{line("bearings.B1", "-100"), line("elements.seal", "-100")}));
  EXPECT_EQ(said(-100, {300, 400}), Lines{}) << "at no speed is it negative";
  EXPECT_EQ(said(-100, {300, 40}), (Lines{line("bearings.B1", "-60"), line("elements.seal", "-60")}));
  EXPECT_EQ(said(0, {-5, 40}), (Lines{line("bearings.B1", "-5"), line("elements.seal", "-5")}));
}

// Thicknesses as one wave of n cells around, and others at rest.
TEST(MeshWaves, AreToldByTheCellsInAWave) {
  for (const int cells : {12, 40, 240}) {
    film::CompliantShort film;
    film.compliance = 0.1;
    film.reference_speed = 160;
    film.cells = {cells, 4};
    system::Train train = test::half_rotor(film, 0);
    train.supports[0].name = "half";
    system::RotorSystem system(PETSC_COMM_SELF, train, 160);
    ASSERT_TRUE(study::may_have_mesh_waves(system));
    const auto found = [&](double n) {
      std::vector<Complex> shape(static_cast<std::size_t>(system.size()), 0);
      PetscInt first = 0;
      for (const problem::Field& f : system.fields())
        if (f.quantity == "thickness") first = f.begin;
      for (int k = 0; k < cells; ++k)
        shape[static_cast<std::size_t>(first + k)] = 1e-6 * std::polar(1.0, 2 * std::numbers::pi * k / n);
      return study::cells_per_wave(system, shape);
    };
    for (const double n : {2.0, 3.0}) {
      ASSERT_TRUE(found(n)) << cells;
      EXPECT_NEAR(*found(n), n, 0.06 * n) << cells;
    }
    EXPECT_EQ(found(7).has_value(), cells > 12) << "of few cells a third is as short as waves come";
    for (const double n : {9.0, static_cast<double>(cells)}) EXPECT_FALSE(found(n)) << n << " of " << cells;
    EXPECT_FALSE(study::cells_per_wave(system, std::vector<Complex>(static_cast<std::size_t>(system.size()), 0)));
  }
  system::RotorSystem rigid(PETSC_COMM_SELF, test::half_rotor(film::Short{}, 0), 160);
  EXPECT_FALSE(study::may_have_mesh_waves(rigid));
}

TEST(MeshWaves, AreSaidOnce) {
  study::MeshWaves waves;
  io::StudySummary summary;
  waves.warn(summary, "N");
  EXPECT_TRUE(summary.warnings.empty());
  waves.add(2.1, {{0.5, 711}});
  waves.add(1.9, {{0.2, 705}, {0.1, 551}});
  waves.add(1.8, {});
  waves.warn(summary, "N");
  ASSERT_EQ(summary.warnings.size(), 1U);
  for (const char* part :
       {"at 1.9 to 2.1 N", "up to 2 waves of the film's mesh (551 to 711 rad/s)", "differences: upwind"})
    EXPECT_NE(summary.warnings[0].find(part), std::string::npos) << summary.warnings[0];
}

// Without results: a bound from what is known of the film. With them: these.
TEST(FilmSense, NeedsNoSolution) {
  system::Machine machine =
      machine_with({bore(film::Geometry::Bore::cylindrical, 0), bore(film::Geometry::Bore::cylindrical, 0)});
  const auto said = [&](const study::AskedFilms& asked, double value = 0) {
    io::StudySummary summary;
    if (value > 0) summary.set("bearing.B1.reynolds_number", value, "1");
    warn_of_films(summary, system::train_of(machine), asked);
    return summary.warnings;
  };
  // rho Omega R c/mu of 860 x 2000 x 0.05 x 1e-4/0.01 is 860, and 41.1 sqrt(500) is 919.
  EXPECT_TRUE(said({2000, "", {}}).empty());
  ASSERT_EQ(said({3000, "", {}}).size(), 1U) << "one sentence of both";
  EXPECT_EQ(said({3000, "", {}})[0].find("bearings B1 (1290), B2 (1290): Reynolds number at 3000 rad/s"), 0U)
      << said({3000, "", {}})[0];
  EXPECT_EQ(said({3000, "B2", {}})[0].find("bearing B2 (1290): "), 0U);
  EXPECT_EQ(said({3000, "", {}}, 900)[0].find("bearing B2 (1290): "), 0U) << "what was computed counts";
  EXPECT_EQ(said({2000, "", {}}, 950)[0].find("bearing B1 (950): "), 0U);
  machine.bearings.pop_back();
  film::Reynolds turbulent;
  turbulent.turbulence = film::Turbulence::constantinescu;
  machine.bearings[0].film = turbulent;
  EXPECT_TRUE(said({3000, "", {}}).empty());
  // Of oil that is hot nobody knows how hot: the coldest is the most viscous.
  film::Thd hot;
  hot.viscosity = thermal::ViscosityOptions{};
  hot.viscosity->law = thermal::ConstantViscosity{0.005};
  machine.bearings[0].film = hot;
  EXPECT_EQ(said({2000, "", {}})[0].find("bearing B1 (1720): "), 0U);
  // mu/p sqrt(pi r T/2) of air is 0.067 um.
  film::Gas gas;
  machine.lubricants["oil"] = {18.46e-6, 1.2};
  machine.bearings[0].geometry->clearance = 5e-6;
  machine.bearings[0].film = gas;
  ASSERT_EQ(said({40, "", {}}).size(), 1U);
  EXPECT_NE(said({40, "", {}})[0].find("bearing B1 (0.01339): Knudsen number of a film as thick as the clearance"),
            std::string::npos)
      << said({40, "", {}})[0];
  EXPECT_NE(said({40, "", {1e-6}})[0].find("bearing B1 (0.06697): Knudsen number where the film is thinnest"),
            std::string::npos)
      << said({40, "", {1e-6}})[0];
  gas.slip = film::Gas::Slip::second;
  machine.bearings[0].film = gas;
  EXPECT_TRUE(said({40, "", {1e-6}}).empty());
}
