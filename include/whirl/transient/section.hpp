#pragma once
// Poincare sections: where a motion crosses a surface in its states.

#include <array>
#include <functional>
#include <optional>
#include <span>

#include "whirl/deck/description.hpp"
#include "whirl/transient/integrator.hpp"

namespace whirl::transient {

/// Which crossings of a surface count.
enum class Sense { rising, falling, both };
[[nodiscard]] std::span<const deck::Name<Sense>> names(Sense);

/// Goes along a motion and stops where a function g of the state vanishes.
///
/// A crossing is seen by the sign of g at the ends of advance(), and located by the integrator itself: shorter steps
/// from the last state before it enclose it in an eighth of a step, and g vanishes along the polynomial of degree four
/// through five states there. The point is thus as exact as the motion, whatever the scheme. Two crossings within one
/// advance() are not seen.
class Section {
public:
  /// g of the state where the integrator stands, the same on all ranks; collective.
  using Height = std::function<double()>;
  /// Called where the motion crosses, while the integrator stands there; `time` as the integrator's [s].
  using Found = std::function<void(double time)>;

  Section(Integrator& integrator, Height height, Sense sense, Found found);

  /// The integrator goes on to `time`, and through all the same steps as without a section. `carried` are the
  /// deviations that it carries, which the search leaves alone; null: none. Throws as Integrator::advance().
  /// Collective. A crossing costs some seven short steps.
  void advance(double time, Tangents* carried);
  /// The motion goes on from another state.
  void forget() { last_.reset(); }

private:
  static constexpr std::size_t nodes = 5;
  void locate(double from, double to, double low, double high);
  double at(double x);  // g between the nodes; the integrator stands there
  double root(bool below, double size);

  Integrator& integrator_;
  Height height_;
  Sense sense_;
  Found found_;
  std::optional<double> last_;  // g where the integrator stands
  core::Vector before_, after_;
  std::array<core::Vector, nodes> nodes_;  // states at equal times around a crossing
  double step_before_ = 0;
};

}  // namespace whirl::transient
