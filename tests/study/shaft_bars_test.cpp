// Bars of the mesh of a shaft against closed forms, on meshes as coarse as two elements.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rotor/shafts.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "whirl/rotor/critical_speeds.hpp"
#include "whirl/rotor/divide.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/lines.hpp"

namespace whirl::study {
namespace {

using std::numbers::pi;

constexpr double length = 0.8, e = 2.1e11, density = 7850;
constexpr int meshes[] = {2, 4, 8};

// The bars cover the errors, and are no longer than `longest` times these.
void expect_covered(const std::vector<double>& found, const std::vector<double>& bars, const std::vector<double>& exact,
                    double longest) {
  ASSERT_EQ(found.size(), exact.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double error = std::abs(found[k] - exact[k]);
    EXPECT_LE(error, bars[k]) << k << " of " << found.size() << ": " << found[k] << ", right is " << exact[k];
    EXPECT_LE(bars[k], longest * error + 1e-6 * exact[k]) << k << ": " << found[k] << ", right is " << exact[k];
  }
}

// The k-th zero of a function that rises from one pole to the next, between lo and hi.
template <class F>
double zero_of(const F& f, double lo, double hi) {
  for (int i = 0; i < 200; ++i) {
    const double middle = (lo + hi) / 2;
    (f(middle) < 0 ? lo : hi) = middle;
  }
  return (lo + hi) / 2;
}

}  // namespace

// Free-free: k pi c/L; held at one end: (k - 1/2) pi c/L. All modes that the coarse mesh has, its highest among them.
TEST(ShaftBars, CoverWavesAlongTheShaft) {
  for (const rotor::Line line : {rotor::Line::torsion, rotor::Line::axial})
    for (const bool at_one_end : {false, true})
      for (const int n : meshes) {
        const rotor::Options shaft = test::uniform_shaft(length, 0.05, n, e, density, 0.02);
        const std::vector<int> held = at_one_end ? std::vector<int>{1} : std::vector<int>{};
        const auto on = [&](int parts) {
          return rotor::line_modes(rotor::divided(shaft, parts), line, held, n).frequencies;
        };
        std::vector<double> exact;
        const double c = std::sqrt((line == rotor::Line::axial ? e : e / 2.6) / density);
        for (int k = 1; k <= n; ++k) exact.push_back((at_one_end ? k - 0.5 : k) * pi * c / length);
        expect_covered(on(1), bars_of_shaft(on(1), shaft, rotor::line_order, on), exact, 4);
      }
}

// Pinned ends, Timoshenko (1922): E I b^4 - m w^2 - j (1 + E/(kappa G)) b^2 w^2 + m j/(kappa G A) w^4 = 0, b = k pi/L,
// with the mass m and the rotary inertia j per length.
TEST(ShaftBars, CoverBendingOnPins) {
  for (const rotor::BeamElement element :
       {rotor::BeamElement::rayleigh, rotor::BeamElement::timoshenko, rotor::BeamElement::timoshenko_linear})
    for (const int n : meshes) {
      rotor::Options shaft = test::uniform_shaft(length, 0.05, n, e, density);
      shaft.element = element;
      const double d = 0.05, nu = 0.3, area = pi * d * d / 4, inertia = pi * std::pow(d, 4) / 64;
      const double shear = 6 * (1 + nu) / (7 + 6 * nu) / (2 * (1 + nu)), m = density * area, j = density * inertia;
      std::vector<double> exact;
      for (int k = 1; k <= n; ++k) {
        const double b = k * pi / length, stiff = e * inertia * std::pow(b, 4);
        if (element == rotor::BeamElement::rayleigh) {
          exact.push_back(std::sqrt(stiff / (m + j * b * b)));
          continue;
        }
        const double first = m + j * (1 + 1 / shear) * b * b, second = m * j / (shear * e * area);
        exact.push_back(std::sqrt((first - std::sqrt(first * first - 4 * second * stiff)) / (2 * second)));
      }
      const auto on = [&](int parts) {
        return rotor::natural_frequencies(PETSC_COMM_SELF, rotor::divided(shaft, parts), {1, n * parts + 1}, n);
      };
      expect_covered(on(1), bars_of_shaft(on(1), shaft, order_of_shaft(element), on), exact, 8);
    }
}

// A shaft so slender that shear and rotary inertia do nothing: cosh(b L) cos(b L) = 1.
TEST(ShaftBars, CoverBendingOfAFreeShaft) {
  const double d = 8e-5;
  for (const int n : meshes) {
    const rotor::Options shaft = test::uniform_shaft(length, d, n, e, density);
    std::vector<double> exact;
    for (const double root : {4.730040745, 7.853204624, 10.99560784})
      exact.push_back(std::pow(root / length, 2) * std::sqrt(e / density) * d / 4);
    if (n == 2) exact.pop_back();
    const auto on = [&](int parts) {
      return rotor::natural_frequencies(PETSC_COMM_SELF, rotor::divided(shaft, parts), {},
                                        static_cast<int>(exact.size()));
    };
    expect_covered(on(1), bars_of_shaft(on(1), shaft, order_of_shaft(shaft.element), on), exact, 8);
  }
}

// The same shaft on equal springs k at its ends: E I b^3 (tan + tanh) = 2 k and E I b^3 (coth - cot) = 2 k of b L/2, by
// turns.
TEST(ShaftBars, CoverCriticalSpeedsOnSprings) {
  const double d = 8e-5, bending = e * pi * std::pow(d, 4) / 64;
  for (const double stiffness : {1.0, 100.0, 1e4})
    for (const int n : meshes) {
      const rotor::Options shaft = test::uniform_shaft(length, d, n, e, density);
      const double k = stiffness * bending / std::pow(length, 3);
      std::vector<double> exact;
      for (int i = 0; i < 3; ++i) {
        const auto f = [&](double half) {
          const double b = 2 * half / length;
          return bending * b * b * b *
                     (i % 2 == 0 ? std::tan(half) + std::tanh(half) : 1 / std::tanh(half) - 1 / std::tan(half)) -
                 2 * k;
        };
        // tan has poles at odd, cot at even multiples of pi/2.
        const double half = zero_of(f, std::max(i - 1, 0) * pi / 2 + 1e-12, (i + 1) * pi / 2 - 1e-12);
        exact.push_back(std::pow(2 * half / length, 2) * std::sqrt(e / density) * d / 4);
      }
      const auto on = [&](int parts) {
        const rotor::Options cut = rotor::divided(shaft, parts);
        return rotor::critical_speeds(cut, {{1}, {n * parts + 1}}, k, rotor::Whirl::forward, 3);
      };
      expect_covered(on(1), bars_of_shaft(on(1), shaft, order_of_shaft(shaft.element), on), exact, 8);
    }
}

}  // namespace whirl::study
