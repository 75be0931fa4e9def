#include "whirl/transient/steps/section.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"

namespace whirl::transient {

using core::check;

std::span<const deck::Name<CrossingSense>> names(CrossingSense) {
  static constexpr deck::Name<CrossingSense> table[] = {
      {CrossingSense::rising, "rising", "where the combination grows through its value"},
      {CrossingSense::falling, "falling", "where it falls through it"},
      {CrossingSense::both, "both", "wherever it passes it"}};
  return table;
}

Section::Section(Integrator& integrator, Height height, CrossingSense sense, Found found)
    : integrator_(integrator),
      height_(std::move(height)),
      sense_(sense),
      found_(std::move(found)),
      before_(core::duplicate(integrator.scaled())),
      after_(core::duplicate(integrator.scaled())) {
  for (core::Vector& n : nodes_) n = core::duplicate(integrator.scaled());
}

// A point on the surface belongs to the side it came to, so that it counts once.
bool Section::counts(double low, double high) const {
  const bool rises = low < 0 && high >= 0, falls = low >= 0 && high < 0;
  return (rises && sense_ != CrossingSense::falling) || (falls && sense_ != CrossingSense::rising);
}

void Section::advance(double time) {
  if (!last_) last_ = height_();
  if (integrator_.goes_its_own_pace()) return step_by_step(time);
  const double from = integrator_.time(), low = *last_;
  step_before_ = integrator_.step();
  check(VecCopy(integrator_.scaled(), before_.get()));
  integrator_.advance(time);
  const double high = height_();
  last_ = high;
  if (!counts(low, high)) return;
  check(VecCopy(integrator_.scaled(), after_.get()));
  locate(from, time, low, high);
  check(VecCopy(after_.get(), integrator_.scaled()));
}

void Section::step_by_step(double time) {
  while (integrator_.time() < time) {
    const double from = integrator_.time(), low = *last_;
    integrator_.advance_within_step(time);
    const double to = integrator_.time(), high = height_();
    last_ = high;
    if (!counts(low, high)) continue;
    const auto at = [this](double t) {
      integrator_.advance(t);
      return height_();
    };
    found_(root(at, from, to, low < 0, std::max(std::abs(low), std::abs(high))));
    integrator_.advance(to);
  }
}

// The bracket shrinks to an eighth of a step by false position, each try a step from its left end; states at five times
// in it make a polynomial of degree four, whose error is far below that of a step, and the root is that of g along it.
// Shorter steps would not do: rates by differences of the states lose what the steps are shorter.
void Section::locate(double from, double to, double low, double high) {
  const bool below = low < 0;
  double a = from, b = to, left = low, right = high;
  const double width = std::min(to - from, step_before_) / 8;
  bool left_moved = false;
  check(VecCopy(before_.get(), nodes_[0].get()));
  if (!twin_) twin_ = integrator_.twin();
  const auto go = [&](double start, Vec state, double time) {
    check(VecCopy(state, twin_->scaled()));
    twin_->restart(start, step_before_);
    twin_->advance(time);
    check(VecCopy(twin_->scaled(), integrator_.scaled()));
  };
  constexpr int most = 60;
  for (int k = 0; k < most && b - a > 1.001 * width; ++k) {
    // Beside the estimate, on the side where the bracket is wide still.
    const double estimate = b - right * (b - a) / (right - left) + (left_moved ? 0.5 : -0.5) * width;
    const double t = std::min(std::max(estimate, a + width / 2), b - width / 4);
    go(a, nodes_[0].get(), t);
    const double at = height_();
    left_moved = (at < 0) == below;
    (left_moved ? a : b) = t;
    (left_moved ? left : right) = at;
    if (left_moved) check(VecCopy(integrator_.scaled(), nodes_[0].get()));
  }
  const double spacing = (b - a) / (nodes - 1);
  for (std::size_t k = 1; k < nodes; ++k) {
    go(a + static_cast<double>(k - 1) * spacing, nodes_[k - 1].get(), a + static_cast<double>(k) * spacing);
    check(VecCopy(integrator_.scaled(), nodes_[k].get()));
  }
  const auto at = [this](double x) { return between(x); };
  found_(a + spacing * root(at, 0, nodes - 1, below, std::max(std::abs(low), std::abs(high))));
}

double Section::between(double x) {
  check(VecSet(integrator_.scaled(), 0));
  for (std::size_t k = 0; k < nodes; ++k) {
    double weight = 1;
    for (std::size_t j = 0; j < nodes; ++j)
      if (j != k) weight *= (x - static_cast<double>(j)) / (static_cast<double>(k) - static_cast<double>(j));
    check(VecAXPY(integrator_.scaled(), weight, nodes_[k].get()));
  }
  return height_();
}

// False position that halves the value of an end which stays (Dowell and Jarratt 1971).
double Section::root(const At& at, double a, double b, bool below, double size) {
  double right = at(b), left = at(a);
  // The last step may have gone another way than the one that told the side, by its error.
  if ((left < 0) != below) return a;
  if ((right < 0) == below) {
    (void)at(b);
    return b;
  }
  const double level = 1e-14 * size;
  int stayed = 0;
  double x = b;
  constexpr int most = 60;
  for (int k = 0; k < most; ++k) {
    x = b - right * (b - a) / (right - left);
    const double value = at(x);
    if (std::abs(value) <= level || !(a < x && x < b)) break;
    const bool here = (value < 0) == below;
    (here ? a : b) = x;
    (here ? left : right) = value;
    if (here && stayed > 0) right /= 2;
    if (!here && stayed < 0) left /= 2;
    stayed = here ? 1 : -1;
  }
  return x;
}

}  // namespace whirl::transient
