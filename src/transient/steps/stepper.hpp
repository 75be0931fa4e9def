#pragma once
// One step of any scheme, and how a step that fails is tried again.

#include <petscvec.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "whirl/core/error.hpp"

namespace whirl::transient {

/// A step that was taken.
struct Taken {
  double length = 0;    ///< [s]; shorter than asked for where it had to be
  double proposed = 0;  ///< [s] the next one by the error control; `length` of a scheme without
  int rejected = 0;     ///< attempts before it
  std::string why{};    ///< the last of these was rejected; empty if none was
};

/// How steps find the times at which a state is wanted.
enum class Pace {
  to_the_end,  ///< they end at the end of a revolution and are interpolated between
  to_samples,  ///< they end at every time wanted: no interpolation
  by_itself    ///< by their own error control, as a history of several steps wants; interpolated everywhere
};

/// A scheme at work on the equations of one motion. All members are collective on the system's communicator.
class Stepper {
public:
  Stepper() = default;
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;
  virtual ~Stepper() = default;

  /// From `u` at `time` one step of at most `wanted` [s] on. Throws core::DomainError, core::NotConverged with the
  /// reason, and then leaves `u` as it was.
  [[nodiscard]] virtual Taken step(double time, double wanted, Vec u) = 0;
  /// u(time) within the last step, to the order that the scheme offers there; not of Pace::to_samples.
  virtual void interpolate(double time, Vec u);
  /// What follows depends on the state alone, not on steps before it.
  virtual void forget() = 0;
  /// The rates jump where the next step begins, for a force has a break there.
  virtual void pass_break() { forget(); }
  [[nodiscard]] virtual Pace pace() const { return Pace::to_the_end; }
};

inline void Stepper::interpolate(double /*time*/, Vec /*u*/) {
  throw core::Bug("a scheme without interpolation");
}

/// Each rejection divides the step by at least four where a film was left, by up to ten otherwise.
inline constexpr int max_rejections = 20;

/// The step that an estimated error, in tolerances, allows after one of `length`.
[[nodiscard]] inline double allowed_step(double length, double error, int order) {
  const double factor = error > 0 ? 0.9 * std::pow(error, -1.0 / order) : 10.0;
  return length * std::clamp(factor, 0.1, 10.0);
}

/// Takes attempt(h) -> std::optional<double>, the error in tolerances or nothing where Newton's method failed, until an
/// error is at most one. Steps that leave a film are cut to a quarter. An error that does not fall with the step is
/// that of the start, which does not obey the equations that hold no rates as well as the end does: the step is taken.
template <class Attempt>
Taken take_step(double wanted, int order, Attempt&& attempt) {
  double h = wanted;
  constexpr double of_the_start = 10;  // tolerances, at most
  double error_before = 0;
  std::string why;
  for (int rejected = 0; rejected <= max_rejections; ++rejected) {
    double next = h / 4;
    try {
      if (const std::optional<double> error = attempt(h)) {
        next = allowed_step(h, *error, order);
        if (*error <= 1) return {h, next, rejected, rejected > 0 ? why : ""};
        if (rejected > 1 && *error > 0.95 * error_before && *error < of_the_start) return {h, h, rejected, why};
        error_before = *error;
        if (rejected > 0) next /= 2;
        why = "the error of a step exceeds its tolerance however short the step";
      } else if (why.empty()) {
        why = "Newton's method does not converge in steps however short";
      }
    } catch (const core::DomainError& e) {
      if (rejected == max_rejections) throw;
      why = e.what();
    }
    h = std::min(next, 0.9 * h);
  }
  throw core::NotConverged(why);
}

}  // namespace whirl::transient
