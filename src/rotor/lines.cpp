#include "whirl/rotor/lines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/core/symmetric.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {
namespace {

// Of one section: stiffness [N m^2 or N] and inertia [kg m or kg/m] per length.
struct Section {
  double stiffness, inertia;
};

Section section_of(const Segment& s, const Material& m, Line line) {
  const Beam b = make_beam(s, m, Shear::rigid);
  const double e = modulus(m, s.temperature), g = m.shear_modulus > 0 ? m.shear_modulus : e / (2 * (1 + m.poisson));
  if (line == Line::torsion) return {2 * g / e * b.bending_stiffness, 2 * b.inertia_per_length};
  const bool own = s.outer_stiffness_diameter > 0;
  const double outer = own ? s.outer_stiffness_diameter : s.outer_mass_diameter,
               inner = own ? s.inner_stiffness_diameter : s.inner_mass_diameter;
  return {e * std::acos(-1.0) / 4 * (outer * outer - inner * inner), b.mass_per_length};
}

struct Chain {
  Eigen::MatrixXd stiffness, inertia;
};

Chain chain_of(const Options& o, Line line) {
  const Eigen::Index n = n_nodes(o);
  Chain c{Eigen::MatrixXd::Zero(n, n), Eigen::MatrixXd::Zero(n, n)};
  const Eigen::Matrix2d spring{{1, -1}, {-1, 1}};
  // Gauss-Legendre on (0, 1), exact for the fourth power of a diameter.
  constexpr std::array<std::array<double, 2>, 3> gauss{
      {{0.1127016653792583, 5.0 / 18}, {0.5, 4.0 / 9}, {0.8872983346207417, 5.0 / 18}}};
  for (Eigen::Index k = 0; k + 1 < n; ++k) {
    const auto e = static_cast<std::size_t>(k);
    const Segment& s = o.segments[e];
    auto stiffness = c.stiffness.block<2, 2>(k, k);
    auto inertia = c.inertia.block<2, 2>(k, k);
    if (const Coupling* coupling = coupling_at(o, e)) {
      const double own = line == Line::torsion ? coupling->torsional_stiffness : coupling->axial_stiffness;
      if (!(own > 0))
        throw core::InputError(fmt::format("the coupling of segment {} has no '{}'", coupling->segment,
                                           line == Line::torsion ? "torsional_stiffness" : "axial_stiffness"));
      stiffness += own * spring;
      inertia += s.length / 2 * section_of(s, o.material, line).inertia * Eigen::Matrix2d::Identity();
      continue;
    }
    for (const auto& [place, share] : gauss) {
      const Section at = section_of(section_at(s, place), o.material, line);
      const Eigen::Vector2d shape(1 - place, place);
      stiffness += share * at.stiffness / s.length * spring;
      inertia += share * s.length * at.inertia * shape * shape.transpose();
    }
  }
  for (const Disc& given : o.discs) {
    const Disc d = resolved(given, o.material);
    c.inertia(d.node - 1, d.node - 1) += line == Line::torsion ? d.polar_inertia : d.mass;
  }
  return c;
}

}  // namespace

LineModes line_modes(const Options& o, Line line, const std::vector<int>& held, int count) {
  validate(o);
  if (o.type == Options::Type::rigid) throw core::InputError("a rigid rotor has neither torsion nor axial motion");
  std::vector<Eigen::Index> free;
  for (const int node : held)
    if (node < 1 || node > n_nodes(o))
      throw core::InputError(fmt::format("rotor: held node {} is not in 1..{}", node, n_nodes(o)));
  for (int node = 1; node <= n_nodes(o); ++node)
    if (std::find(held.begin(), held.end(), node) == held.end()) free.push_back(node - 1);
  LineModes out;
  if (free.empty()) return out;
  const Chain c = chain_of(o, line);
  const auto pairs = core::symmetric_pairs(c.stiffness(free, free), c.inertia(free, free),
                                           "modes of torsion or axial motion: the inertia");
  // Held nowhere, the shaft turns or slides as a whole: its one mode that does not vibrate is left out.
  for (Eigen::Index k = held.empty() ? 1 : 0;
       k < pairs.values.size() && static_cast<int>(out.frequencies.size()) < count; ++k) {
    out.frequencies.push_back(std::sqrt(pairs.values(k)));
    Eigen::VectorXd shape = Eigen::VectorXd::Zero(n_nodes(o));
    shape(free) = pairs.vectors.col(k);
    Eigen::Index largest = 0;
    shape.cwiseAbs().maxCoeff(&largest);
    shape /= shape(largest);
    out.shapes.emplace_back(shape.begin(), shape.end());
  }
  return out;
}

}  // namespace whirl::rotor
