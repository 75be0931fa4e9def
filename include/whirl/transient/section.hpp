#pragma once
// Poincare sections: where a motion crosses a surface in its states.

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
/// A crossing is seen by the sign of g at the ends of advance(), and located by the integrator itself: from the last
/// state known before it shorter steps are tried until g changes sign within a few units of rounding of the time (root
/// finding after Illinois). The point is thus as exact as the motion, whatever the scheme. Two crossings within one
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
  /// Collective. A crossing costs five to eight steps.
  void advance(double time, Tangents* carried);
  /// The motion goes on from another state.
  void forget() { last_.reset(); }

private:
  void locate(double from, double to, double low, double high);

  Integrator& integrator_;
  Height height_;
  Sense sense_;
  Found found_;
  std::optional<double> last_;  // g where the integrator stands
  core::Vector before_, after_, left_;
  double step_before_ = 0;
};

}  // namespace whirl::transient
