#pragma once
// Velocity across a film whose viscosity changes from layer to layer.

#include <vector>

namespace whirl::thermal {

/// u(s) = (dp/dx) pressure(s) + U drag(s) and tau(s) = (dp/dx) (s - neutral) + U pull, from the bush (s = 0, at rest)
/// to the journal (s = h, speed U): exact for the viscosity mu [Pa s, layers] that is constant in layers of equal
/// thickness.
struct Profile {
  explicit Profile(int layers)
      : pressure(at(layers) + 1), drag(at(layers) + 1), by_pressure(at(layers)), by_drag(at(layers)) {}
  void set(double h, const double* mu);

  /// pressure(h/2) and drag(h/2): a border of layers, or half of the middle layer, in which both are polynomials.
  struct Middle {
    double pressure, drag;  // m^2/(Pa s), -
  };
  [[nodiscard]] Middle middle() const;

  double layer = 0;                          // m, thickness of each
  double neutral = 0;                        // m
  double pull = 0;                           // Pa s/m
  std::vector<double> pressure, drag;        // m^2/(Pa s), - at the layers' borders [layers + 1]
  std::vector<double> by_pressure, by_drag;  // m^3/(Pa s), m: integrals over each layer [layers]

private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
};

}  // namespace whirl::thermal
