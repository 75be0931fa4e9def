#include "study/linear/responder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "study/bars/shaft_mesh.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/growth.hpp"
#include "study/linear/synchronous.hpp"
#include "whirl/film/sheet/thickness.hpp"
#include "whirl/rotor/divide.hpp"
#include "whirl/rotor/freedom.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

// The journal goes round `at` as the linear response says, whatever stands in its way. The bore of an elastic liner
// gives way; there the motion counts against the clearance.
double film_left(const system::Support& s, const system::JournalState& at, const NodeMotion& m,
                 const std::array<Complex, 2>& tilt) {
  const film::Facts film = film::facts(s.film);
  if (film.coefficients) return std::numeric_limits<double>::infinity();
  if (film.gives_way) return s.geometry.clearance - m.semi_major();
  double least = std::numeric_limits<double>::infinity();
  constexpr int samples = 90;
  for (int k = 0; k < samples; ++k) {
    const Complex turn = std::exp(Complex(0, 2 * std::numbers::pi * k / samples));
    least =
        std::min(least, film::minimum_thickness(
                            s.geometry, {at.position[0] + (m.x * turn).real(), at.position[1] + (m.y * turn).real(),
                                         at.tilt[0] + (tilt[0] * turn).real(), at.tilt[1] + (tilt[1] * turn).real()}));
  }
  return least;
}

}  // namespace

Responder::Responder(const Context& context, const Layout& layout, const UnbalanceResponseOptions& options,
                     std::vector<int> nodes, const FilmMesh& mesh)
    : system_(layout.space, on_mesh(system::train_of(context.machine, options.unbalance), mesh), options.range.from),
      walker_(system_),
      solver_(system_),
      nodes_(std::move(nodes)) {
  for (int& node : nodes_) node = rotor::node_after(context.machine.rotor, node, parts_of(mesh));
}

ResponseAtSpeed Responder::at(double speed) {
  Vec x = walker_.at(speed);
  const auto state = synchronous_response(system_, solver_, x, speed);
  std::vector<double> shaft[2];
  for (std::size_t part = 0; part < 2; ++part) shaft[part] = system_.shaft(state[part].data(), 0, false);
  ResponseAtSpeed r;
  r.speed = speed;
  for (std::size_t k = 0; k < shaft[0].size(); ++k)
    if (!rotor::is_slope(rotor::freedom_at(static_cast<int>(k))))
      r.largest = std::max(r.largest, std::hypot(shaft[0][k], shaft[1][k]));
  for (const int node : nodes_) {
    const auto k = static_cast<std::size_t>(4 * (node - 1));
    r.nodes.push_back({{shaft[0][k], shaft[1][k]}, {shaft[0][k + 1], shaft[1][k + 1]}});
  }
  const auto rest = system_.journals(system_.gather(x).data());
  for (int b = 0; b < system_.n_bearings(); ++b) {
    const auto value = [&](PetscInt coordinate) {
      const auto i = static_cast<std::size_t>(2 * coordinate);
      return Complex(state[0][i], state[1][i]);
    };
    Complex z[2];
    std::array<Complex, 2> tilt{};
    for (int d = 0; d < 2; ++d) {
      const PetscInt p = system_.pedestal(b, d);
      z[d] = value(system_.journal(b, d)) - (p >= 0 ? value(p) : 0.0);
      if (system_.ports(b) > 2) tilt[static_cast<std::size_t>(d)] = value(system_.journal(b, 2 + d));
    }
    r.bearings.push_back({z[0], z[1]});
    const auto k = static_cast<std::size_t>(b);
    r.films.push_back(film_left(system_.train().supports[k], rest[k], r.bearings[k], tilt));
  }
  return r;
}

SpectrumAt Responder::spectrum(double speed) {
  SpectrumAt out;
  (void)has_answer([&] {
    const solve::Stability found = equilibrium_stability(system_, walker_.at(speed));
    out = {growth_of(found).known_count(), found.values};
  });
  return out;
}

bool Responder::whole_spectra() const {
  return system_.size() <= spectral::EigenOptions{}.dense_below;
}

}  // namespace whirl::study
