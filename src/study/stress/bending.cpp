#include "study/stress/bending.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;
using Ends = Eigen::Vector4cd;  // u1, s1, u2, s2 of x + i y

// x + i y of both planes at the ends of segment e.
Ends ends_of(const std::vector<Complex>& x, const std::vector<Complex>& y, std::size_t e, Complex i) {
  Ends out;
  for (Eigen::Index k = 0; k < 4; ++k) {
    const std::size_t at = 4 * (e + static_cast<std::size_t>(k / 2)) + 2 * static_cast<std::size_t>(k % 2);
    out(k) = x[at] + i * y[at + 1];
  }
  return out;
}

std::vector<Complex> complex_of(const ShaftShape& real, const ShaftShape& imaginary) {
  std::vector<Complex> out;
  for (std::size_t k = 0; k < real.size(); ++k) out.emplace_back(real[k], imaginary[k]);
  return out;
}

}  // namespace

double BendingAt::alternating() const {
  return (std::abs(still) + std::abs(backward)) / modulus;
}

double BendingAt::mean() const {
  return std::abs(forward) / modulus;
}

double BendingAt::largest() const {
  constexpr int samples = 720;  // 1e-5 of the moment lies between two of them
  double most = 0;
  for (int k = 0; k < samples; ++k) {
    const Complex turn = std::polar(1.0, 2 * std::numbers::pi * k / samples);
    most = std::max(most, std::abs(still + forward * turn + backward * std::conj(turn)));
  }
  return most / modulus;
}

std::vector<BendingAt> bending_of(const rotor::Options& shaft, const ShaftShape& still,
                                  const std::array<double, 2>& gravity, const std::array<ShaftShape, 2>& vibration,
                                  double speed) {
  rotor::Options beams = shaft;
  if (rotor::n_inner(beams.element) > 0) beams.element = rotor::BeamElement::timoshenko;  // the same at its nodes
  const std::vector<double> z = rotor::node_positions(shaft);
  const std::vector<Complex> rest(still.begin(), still.end());
  const std::vector<Complex> moving = complex_of(vibration[0], vibration[1]);
  const Complex i(0, 1), pull(gravity[0], gravity[1]);
  std::vector<BendingAt> out;
  for (std::size_t e = 0; e < shaft.segments.size(); ++e) {
    if (rotor::coupling_at(shaft, e)) continue;
    const rotor::ElementMatrices m = rotor::element_matrices(beams, e);
    const Ends at_rest = m.stiffness * ends_of(rest, rest, e, i) - pull * m.weight;
    Ends forward = Ends::Zero(), backward = Ends::Zero();
    if (!moving.empty()) {
      // x + i y = (X + i Y)/2 exp(i Omega t) + conj(X - i Y)/2 exp(-i Omega t). The gyroscopic matrix is twice that of
      // rotary inertia: with it forward motion at the speed has rotary inertia of the other sign, backward three times.
      const double square = speed * speed;
      forward = (m.stiffness - square * (m.translational_mass - m.rotary_mass)) * ends_of(moving, moving, e, i) / 2;
      backward =
          ((m.stiffness - square * (m.translational_mass + 3 * m.rotary_mass)) * ends_of(moving, moving, e, -i) / 2)
              .conjugate();
    }
    for (const bool right : {false, true}) {
      // What the rest of the shaft does to the left end is minus the moment there, to the right end the moment.
      const double sign = right ? 1 : -1;
      const Eigen::Index turn = right ? 3 : 1, push = right ? 2 : 0;
      const rotor::Segment s = rotor::section_at(shaft.segments[e], right ? 1 : 0);
      const bool own = s.outer_stiffness_diameter > 0;
      BendingAt b;
      b.node = static_cast<int>(e) + (right ? 2 : 1);
      b.z = z[e + (right ? 1 : 0)];
      b.outer = own ? s.outer_stiffness_diameter : s.outer_mass_diameter;
      const double inner = own ? s.inner_stiffness_diameter : s.inner_mass_diameter;
      b.modulus = std::numbers::pi * (std::pow(b.outer, 4) - std::pow(inner, 4)) / (32 * b.outer);
      b.still = sign * at_rest(turn);
      b.forward = sign * forward(turn);
      b.backward = sign * backward(turn);
      b.shear = -sign * at_rest(push);
      out.push_back(b);
    }
  }
  return out;
}

}  // namespace whirl::study
