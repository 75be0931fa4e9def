// Linear response to unbalance against closed forms.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <complex>

#include "rigid_rotor/run_deck.hpp"

namespace {

using namespace whirl;
using Complex = std::complex<double>;

// A film with states of its own answers a harmonic motion with its coefficients at that frequency, which `static`
// reports for the frequency of rotation: (K + i Omega C - m Omega^2) z = m e Omega^2 (1, -i).
TEST(LinearResponse, OfFilmsWithOwnStatesFollowsFromTheirCoefficients) {
  study::Deck deck =
      study::load(MPI_COMM_WORLD, std::string(WHIRL_SOURCE_DIR) + "/tests/rigid_rotor/liner_response.yaml", {});
  const auto studies = test::run_deck(deck, "liner_response");
  auto rest = test::values_of(studies.at(0)), response = test::values_of(studies.at(1));
  const double speed = 400, mass = 1, eccentricity = 1e-6;
  Eigen::Matrix2cd a = -mass * speed * speed * Eigen::Matrix2cd::Identity();
  const std::string axis[] = {"x", "y"};
  for (const std::string bearing : {"left", "right"})
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) {
        const std::string head = "bearing." + bearing + ".", which = axis[i] + axis[j];
        a(i, j) += Complex(rest.at(head + "K." + which), speed * rest.at(head + "C." + which));
      }
  const Eigen::Vector2cd force = mass * eccentricity * speed * speed * Eigen::Vector2cd(1, Complex(0, -1)),
                         z = a.lu().solve(force);
  for (int i = 0; i < 2; ++i)
    EXPECT_NEAR(response.at("operating.bearing.left." + axis[i]), std::abs(z(i)), 1e-6 * std::abs(z(i)));
}

}  // namespace
