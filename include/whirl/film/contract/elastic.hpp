#pragma once
// Films of a full bore with an elastic liner, which gives way: their thickness is the state.
// Source: van de Vrande (2001) secs. 4.2-4.4 and 6.2 with the errata kept by this project.

#include <array>
#include <optional>
#include <vector>

#include "whirl/film/contract/bore.hpp"
#include "whirl/film/contract/facts.hpp"

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::film {

/// A thin elastic layer on a rigid bore, in plane strain: U = k p, k = d (1 + nu)(1 - 2 nu)/(E (1 - nu)), nu not close
/// to 1/2. Source: van de Vrande (2001), sec. 4.2, after Higginson (1966).
struct Liner {
  double thickness = 0.0;  // m, d
  double modulus = 0.0;    // Pa, E
  double poisson = 0.0;    // -, nu
  friend bool operator==(const Liner&, const Liner&) = default;
};

/// Contact of rough surfaces: the asperities carry p_c = K E' F(h/sigma), F(x) = 4.4086e-5 (4 - x)^6.804 below x = 4,
/// none above. Source: Greenwood and Tripp (1971), with F fitted by Hu et al. (1994).
struct Contact {
  double roughness = 0.0;  // m, sigma: standard deviation of the heights of both surfaces
  double pressure = 0.0;   // Pa, K E'
  friend bool operator==(const Contact&, const Contact&) = default;
};

/// What all of them have. The liner is given, or B = 6 mu Omega_0 U R^2/(p c^3) with the speed Omega_0 that scales it.
struct Compliant {
  enum class Quadrature { sub_cell, simpson };
  enum class Differences { central, upwind, third_order };
  States states = States::dynamic;      // condensed: the liner gives way as the pressure of the moment asks
  std::array<int, 2> cells = {60, 16};  // -, around x along; a short or long film has no mesh along
  std::optional<Liner> liner;
  std::optional<double> compliance;               // -, B
  double reference_speed = 0.0;                   // rad/s, Omega_0 of B
  double liner_damping = 0.0;                     // s, tau: p = (p of the deflection at rest) + tau dU/dt/k
  std::optional<double> rubber_thickness;         // m, of a liner that stiffens as it is compressed
  std::optional<Contact> contact;                 // absent: a film that touches is an error
  std::vector<Groove> grooves;                    // at pressure zero
  Quadrature quadrature = Quadrature::sub_cell;   // of the force
  Differences differences = Differences::upwind;  // of dh/dtheta
  friend bool operator==(const Compliant&, const Compliant&) = default;
};

struct CompliantShort : Compliant {
  static constexpr std::string_view key = "compliant_short",
                                    text = "short film on an elastic liner, thickness as state";
  friend bool operator==(const CompliantShort&, const CompliantShort&) = default;
};
struct CompliantLong : Compliant {
  static constexpr std::string_view key = "compliant_long",
                                    text =
                                        "film without side flow on an elastic liner, thickness as state, pressure "
                                        "zero at the top (90 deg)";
  friend bool operator==(const CompliantLong&, const CompliantLong&) = default;
};
struct CompliantFinite : Compliant {
  static constexpr std::string_view key = "compliant_finite",
                                    text = "two-dimensional film on an elastic liner, thickness on a mesh as states";
  friend bool operator==(const CompliantFinite&, const CompliantFinite&) = default;
};

void describe(deck::Description<Compliant>& d);
void refine(Compliant& options, const std::array<double, 2>& factor);

void describe(deck::Description<CompliantShort>& d);
[[nodiscard]] Facts facts_of(const CompliantShort& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const CompliantShort& options,
                                         const Lubricant& lubricant);

void describe(deck::Description<CompliantLong>& d);
[[nodiscard]] Facts facts_of(const CompliantLong& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const CompliantLong& options,
                                         const Lubricant& lubricant);

void describe(deck::Description<CompliantFinite>& d);
[[nodiscard]] Facts facts_of(const CompliantFinite& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const CompliantFinite& options,
                                         const Lubricant& lubricant);

}  // namespace whirl::film
