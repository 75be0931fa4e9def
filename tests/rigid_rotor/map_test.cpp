// bearing_map against van de Vrande (2001) sec. 4.3 and the thresholds of an independent computation.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

#include "whirl/core/petsc.hpp"
#include "whirl/io/hdf5.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/study/deck.hpp"

namespace {

using namespace whirl;
using std::numbers::pi;

struct Map {
  std::map<std::string, double> values;
  io::Group group;
};

Map run(const std::vector<std::string>& overrides) {
  const study::Deck deck =
      study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/inputs/rigid_rotor/bearing_map.yaml", overrides);
  const std::filesystem::path directory = std::filesystem::temp_directory_path() / "whirl_bearing_map";
  const bool first = core::rank_of(MPI_COMM_WORLD) == 0;
  if (first) {
    std::filesystem::remove_all(directory);
    std::filesystem::create_directories(directory);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_TRUE(study::run(MPI_COMM_WORLD, deck, {directory.string(), "test", {}, false}).empty());
  MPI_Barrier(MPI_COMM_WORLD);
  Map m;
  const io::Summary summary = io::Summary::read(directory / "summary.json");
  for (const auto& [name, q] : summary.studies.at(0).values) m.values[name] = q.value;
  m.group = io::read_hdf5(directory / "results.h5").group("studies").group("bearing_map");
  MPI_Barrier(MPI_COMM_WORLD);
  if (first) std::filesystem::remove_all(directory);
  return m;
}

}  // namespace

TEST(BearingMap, ShortBearing) {
  const Map m = run({});
  EXPECT_NEAR(m.values.at("threshold.nondimensional_speed"), 2.73526314, 1e-8);
  EXPECT_NEAR(m.values.at("threshold.speed"), 160 * 2.73526314, 2e-6);
  EXPECT_NEAR(m.values.at("threshold.eccentricity"), 0.112974, 1e-6);
  const auto& locus = m.group.group("locus");
  const auto &e = locus.reals("eccentricity"), &S = locus.reals("sommerfeld"), &gamma = locus.reals("attitude"),
             &k = locus.reals("k_xx"), &b = locus.reals("b_xy");
  ASSERT_EQ(e.size(), 95U);
  for (std::size_t i = 0; i < e.size(); ++i) {
    const double e2 = e[i] * e[i], q = 1 - e2, n = 16 * e2 + pi * pi * q;
    EXPECT_NEAR(S[i], e[i] * std::sqrt(n) / (2 * q * q), 1e-12 * S[i]);
    EXPECT_NEAR(gamma[i], std::atan(pi * std::sqrt(q) / (4 * e[i])), 1e-12);
    const double kxx = 2 * e[i] * (16 * e2 + pi * pi * (2 - e2)) / (q * q * n);
    EXPECT_NEAR(k[i], kxx, 1e-11 * kxx);
    const double bxy = -4 * e[i] * (pi * pi * (1 + 2 * e2) - 16 * e2) / (q * q * n);
    EXPECT_NEAR(b[i], bxy, 1e-10 * (1 + std::abs(bxy)));
  }
  const auto& map = m.group.group("impedance");
  const auto &axis = map.reals("across"), &along = map.reals("W_along"), &across = map.reals("W_across");
  const std::size_t n = axis.size(), middle = n / 2;  // along = 0: alpha = 90 deg
  ASSERT_NEAR(map.reals("along")[middle], 0, 1e-15);
  for (std::size_t j = 0; j < n; ++j) {
    const double q = 1 - axis[j] * axis[j], w = pi / std::pow(q, 1.5), v = 4 * axis[j] / (q * q);
    EXPECT_NEAR(along[middle * n + j], w, 1e-12 * w);
    EXPECT_NEAR(across[middle * n + j], v, 1e-12 * (w + std::abs(v)));
  }
  EXPECT_TRUE(std::isnan(along[0]));
}

TEST(BearingMap, OtherFilms) {
  const std::string left = "bearings.left.film.type=", right = "bearings.right.film.type=";
  const Map two = run({left + "long", right + "long", "rotor.load=2.56 N"});
  EXPECT_NEAR(two.values.at("nondimensional.load"), 2, 1e-12);
  EXPECT_NEAR(two.values.at("threshold.nondimensional_speed"), 1.97398006, 1e-8);
  EXPECT_NEAR(two.values.at("threshold.eccentricity"), 0.10724, 1e-5);
  const Map inlet = run({left + "long_inlet", right + "long_inlet", "rotor.load=2.56 N"});
  EXPECT_NEAR(inlet.values.at("threshold.nondimensional_speed"), 0.403868, 1e-6);
  // Errata B12 at L/D = 1.
  const Map finite = run({left + "finite_approximate", right + "finite_approximate"});
  const auto& locus = finite.group.group("locus");
  const auto &e = locus.reals("eccentricity"), &S = locus.reals("sommerfeld"), &gamma = locus.reals("attitude");
  for (std::size_t i = 0; i < e.size(); ++i) {
    const double e2 = e[i] * e[i], q = 1 - e2, A = 5 - 2 * e2, B = 8 - 5 * e2;
    EXPECT_NEAR(S[i], 3 * e[i] * std::sqrt(4 * B * B * e2 + pi * pi * A * A * q) / (A * B * q), 1e-12 * S[i]);
    EXPECT_NEAR(gamma[i], std::atan(pi * A * std::sqrt(q) / (2 * B * e[i])), 1e-12);
  }
}
