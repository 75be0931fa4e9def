#include "whirl/transient/section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "whirl/core/error.hpp"

namespace whirl::transient {

using core::check;

std::span<const deck::Name<Sense>> names(Sense) {
  static constexpr deck::Name<Sense> table[] = {
      {Sense::rising, "rising", "where the combination grows through its value"},
      {Sense::falling, "falling", "where it falls through it"},
      {Sense::both, "both", "wherever it passes it"}};
  return table;
}

Section::Section(Integrator& integrator, Height height, Sense sense, Found found)
    : integrator_(integrator),
      height_(std::move(height)),
      sense_(sense),
      found_(std::move(found)),
      before_(core::duplicate(integrator.scaled())),
      after_(core::duplicate(integrator.scaled())),
      left_(core::duplicate(integrator.scaled())) {}

void Section::advance(double time, Tangents* carried) {
  if (!last_) last_ = height_();
  const double from = integrator_.time(), low = *last_;
  step_before_ = integrator_.step();
  check(VecCopy(integrator_.scaled(), before_.get()));
  integrator_.advance(time);
  const double high = height_();
  last_ = high;
  // A point on the surface belongs to the side it came to, so that it counts once.
  const bool rises = low < 0 && high >= 0, falls = low >= 0 && high < 0;
  if (!(rises && sense_ != Sense::falling) && !(falls && sense_ != Sense::rising)) return;
  const double step = integrator_.step();
  check(VecCopy(integrator_.scaled(), after_.get()));
  integrator_.carry(nullptr);
  locate(from, time, low, high);
  check(VecCopy(after_.get(), integrator_.scaled()));
  integrator_.restart(time, step);
  integrator_.carry(carried);
}

// Regula falsi that halves the value of an end which stays (Dowell and Jarratt 1971). The states at the left end are
// kept, so that each try is one step from there.
void Section::locate(double from, double to, double low, double high) {
  double a = from, b = to, left = low, right = high;
  int stayed = 0;  // which end did not move last: -1 the left one
  check(VecCopy(before_.get(), left_.get()));
  const double smallest = 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(from), std::abs(to));
  const double level = 1e-14 * std::max(std::abs(low), std::abs(high));
  constexpr int most = 60;
  double t = a;
  for (int k = 0; k < most; ++k) {
    t = std::min(std::max(b - right * (b - a) / (right - left), a + smallest), b);
    check(VecCopy(left_.get(), integrator_.scaled()));
    integrator_.restart(a, step_before_);
    integrator_.advance(t);
    const double at = height_();
    if (std::abs(at) <= level || b - a <= 2 * smallest) break;
    if ((at < 0) == (low < 0)) {
      a = t;
      left = at;
      check(VecCopy(integrator_.scaled(), left_.get()));
      if (stayed > 0) right /= 2;
      stayed = 1;
    } else {
      b = t;
      right = at;
      if (stayed < 0) left /= 2;
      stayed = -1;
    }
  }
  found_(t);
}

}  // namespace whirl::transient
