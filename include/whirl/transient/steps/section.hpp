#pragma once
// Poincare sections: where a motion crosses a surface in its states.

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "whirl/deck/description.hpp"
#include "whirl/transient/steps/integrator.hpp"

namespace whirl::transient {

/// Which crossings of a surface count.
enum class CrossingSense { rising, falling, both };
[[nodiscard]] std::span<const deck::Name<CrossingSense>> names(CrossingSense);

/// Goes along a motion and stops where a function g of the state vanishes.
///
/// A crossing is seen by the sign of g at the ends of advance(), and located by a twin of the integrator: shorter steps
/// from the last state before it enclose it in an eighth of a step, and g vanishes along the polynomial of degree four
/// through five states there. Two crossings within one advance() are not seen.
///
/// Steps of a scheme that goes its own pace cannot be repeated without their history. There a crossing is seen by the
/// sign of g at the ends of steps too, and g vanishes along the polynomial by which the integrator tells all states
/// between these ends, which is as exact as they are.
///
/// So the point is as exact as the motion, whatever the scheme, and the motion does not notice: no state, prediction or
/// factor of the integrator changes.
class Section {
public:
  /// g of the state where the integrator stands, the same on all ranks; collective.
  using Height = std::function<double()>;
  /// Called where the motion crosses, while the integrator stands there; `time` as the integrator's [s].
  using Found = std::function<void(double time)>;

  Section(Integrator& integrator, Height height, CrossingSense sense, Found found);

  /// The integrator goes on to `time`, through all the same steps as by Integrator::advance(time), and throws as that
  /// does. Collective. A crossing costs some seven short steps, or some ten evaluations of g.
  void advance(double time);
  /// The motion goes on from another state.
  void forget() { last_.reset(); }

private:
  static constexpr std::size_t nodes = 5;
  using At = std::function<double(double x)>;  // g where the integrator then stands
  void step_by_step(double time);
  [[nodiscard]] bool counts(double low, double high) const;
  void locate(double from, double to, double low, double high);
  double between(double x);  // g over the number of the node
  static double root(const At& at, double a, double b, bool below, double size);

  Integrator& integrator_;
  Height height_;
  CrossingSense sense_;
  Found found_;
  std::unique_ptr<Integrator> twin_;  // made at the first crossing
  std::optional<double> last_;        // g where the integrator stands
  core::Vector before_, after_;
  std::array<core::Vector, nodes> nodes_;  // states at equal times around a crossing
  double step_before_ = 0;
};

}  // namespace whirl::transient
