// A film with its journal held, or where it carries a load.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "film/gas_cases.hpp"
#include "study/bearing/film_at_rest.hpp"
#include "study/bearing/gas_point.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

using namespace whirl;
using study::FilmAtRest;

namespace {

system::Support aerostatic(double supply) {
  system::Support s;
  s.geometry = film::testing::spindle();
  s.film = film::testing::aerostatic(1, supply, {48, 16});
  s.lubricant = film::testing::air();
  return s;
}

system::Support oil(bool compliant) {
  system::Support s;
  s.geometry = {film::Geometry::Bore::cylindrical, 0.05, 0.05, 100e-6, 0, 0, 0};
  s.lubricant = {0.02, 870};
  if (!compliant) {
    s.film = film::Short{};
    return s;
  }
  film::CompliantShort film;
  film.compliance = 0.01;
  film.reference_speed = 300;
  s.film = film;
  return s;
}

void balances(const system::Support& s, double speed, const FilmAtRest::Pair& load) {
  FilmAtRest film(s, speed);
  film.carry(load);
  EXPECT_NEAR(film.force()[0], -load[0], 1e-8 * std::hypot(load[0], load[1]));
  EXPECT_NEAR(film.force()[1], -load[1], 1e-8 * std::hypot(load[0], load[1]));
}

TEST(FilmAtRest, CarriesALoadInAnyDirection) {
  for (const double angle : {-1.5, 0.4, 2.8}) {
    balances(aerostatic(6e5), 2000, {49 * std::cos(angle), 49 * std::sin(angle)});
    for (const bool compliant : {false, true})
      balances(oil(compliant), 300, {2000 * std::cos(angle), 2000 * std::sin(angle)});
  }
}

// Ocvirk's half film: load and attitude of a short bearing are known in closed form at every eccentricity.
TEST(FilmAtRest, OfAShortBearing) {
  const system::Support s = oil(false);
  const double c = s.geometry.clearance, length = s.geometry.length, speed = 300;
  for (const double e : {0.1, 0.5, 0.9}) {
    const double q = 1 - e * e;
    const double unit = s.lubricant.viscosity * speed * s.geometry.radius * std::pow(length, 3) / (4 * c * c);
    const double load = unit * e / (q * q) * std::sqrt(16 * e * e + std::numbers::pi * std::numbers::pi * q);
    FilmAtRest film(s, speed);
    film.carry({0, -load});
    const auto [x, y] = film.place();
    EXPECT_NEAR(std::hypot(x, y) / c, e, 1e-7);
    EXPECT_NEAR(std::atan2(x, -y), std::atan(std::numbers::pi * std::sqrt(q) / (4 * e)), 1e-7);
  }
}

// The film with its states, held where the condensed one found the load.
TEST(FilmAtRest, ComesToRestWithItsStates) {
  const system::Support s = aerostatic(6e5);
  FilmAtRest film(s, 2000);
  film.carry({0, -49.05});
  const auto whole = film::make_film(s.geometry, s.film, s.lubricant);
  const study::JournalPlace at = study::rest_at(*whole, film.motion(), {});
  EXPECT_EQ(at.states.size(), whole->states());
  EXPECT_NEAR(at.force[0], 0, 1e-7);
  EXPECT_NEAR(at.force[1], 49.05, 1e-7);
}

TEST(FilmAtRest, KnowsTheMostThatAFilmCarries) {
  FilmAtRest film(aerostatic(3e5), 0);
  const study::Capacity most = film.capacity({0, -49});
  EXPECT_FALSE(most.rises);
  EXPECT_GT(most.load, 25);
  EXPECT_LT(most.load, 35);
  film.carry({0, -0.98 * most.load});
  EXPECT_NEAR(film.force()[1], 0.98 * most.load, 1e-6);
  try {
    film.carry({0, -1.05 * most.load});
    FAIL() << "there is no such place";
  } catch (const study::NoPlace& error) {
    EXPECT_NE(std::string(error.what()).find("no equilibrium"), std::string::npos) << error.what();
    EXPECT_NEAR(error.most.load, most.load, 1e-3 * most.load);
    EXPECT_EQ(error.speed, 0);
  }
  // A film of oil carries the more the closer to the wall.
  EXPECT_TRUE(FilmAtRest(oil(false), 300).capacity({0, -1}).rises);
}

// At the edge of what a film carries one rank may find a place and another one none.
TEST(FilmAtRest, OneRankWithoutAPlaceSpeaksForAll) {
  const int last = core::size_of(MPI_COMM_WORLD) - 1, rank = core::rank_of(MPI_COMM_WORLD);
  int done = 0;
  const auto none = study::agreed_place(MPI_COMM_WORLD, [&] {
    if (rank == last) throw study::NoPlace("no equilibrium", 300, {30.5, 0.8, true});
    ++done;
  });
  EXPECT_EQ(done, rank == last ? 0 : 1);
  ASSERT_TRUE(none.has_value());
  EXPECT_STREQ(none->what(), "no equilibrium");
  EXPECT_EQ(none->speed, 300);
  EXPECT_EQ(none->most.load, 30.5);
  EXPECT_EQ(none->most.eccentricity, 0.8);
  EXPECT_TRUE(none->most.rises);
  EXPECT_FALSE(study::agreed_place(MPI_COMM_WORLD, [] {}).has_value());
  // What is graver goes first, on all ranks.
  EXPECT_THROW((void)study::agreed_place(MPI_COMM_WORLD,
                                         [&] {
                                           if (rank == last) throw core::InputError("a mesh too coarse");
                                           throw study::NoPlace("no equilibrium", 300, {});
                                         }),
               core::InputError);
}

TEST(GasPoint, MeanFreePathOfAir) {
  // 18.46 uPa s, 300 K, 101325 Pa: 67 nm.
  film::Gas gas;
  EXPECT_NEAR(study::mean_free_path(gas, 1.846e-5, 101325), 66.97e-9, 0.02e-9);
  EXPECT_NEAR(study::mean_free_path(gas, 1.846e-5, 2 * 101325.0), 33.48e-9, 0.01e-9);
}

TEST(GasPoint, ReportsAttitudeWithTheRotation) {
  const study::GasPoint p = study::gas_at(aerostatic(5e5), 1000, {10e-6, 0});
  EXPECT_NEAR(p.eccentricity, 0.5, 1e-12);
  EXPECT_GT(p.attitude, 0);
  EXPECT_LT(p.attitude, 0.3);
  EXPECT_NEAR(p.report.power_loss, p.report.drag_torque * 1000, 1e-12);
  EXPECT_NEAR(study::gas_at(aerostatic(5e5), 0, {10e-6, 0}).attitude, 0, 1e-9);
}

}  // namespace
