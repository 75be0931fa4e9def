#include "transient/steps/adams_moulton.hpp"

namespace whirl::transient {

using core::check;

AdamsMoultonSteps::AdamsMoultonSteps(Equations& equations) : equations_(equations) {
  for (core::Vector* v : {&rate_, &rate_before_, &predicted_, &rate_there_, &end_}) *v = equations.make_state();
}

Taken AdamsMoultonSteps::step(double time, double wanted, Vec u) {
  if (before_ == 0) equations_.rate(time, u, rate_.get());
  const Taken taken = take_step(wanted, 1, [&](double h) -> std::optional<double> {
    const double w = before_ > 0 ? h / before_ : 0;
    check(VecWAXPY(predicted_.get(), h * (1 + w / 2), rate_.get(), u));
    if (w > 0) check(VecAXPY(predicted_.get(), -h * w / 2, rate_before_.get()));
    equations_.rate(time + h, predicted_.get(), rate_there_.get());
    check(VecWAXPY(end_.get(), h / 2, rate_.get(), u));
    check(VecAXPY(end_.get(), h / 2, rate_there_.get()));
    equations_.rate(time + h, end_.get(), rate_there_.get());
    return 0.0;
  });
  check(VecCopy(rate_.get(), rate_before_.get()));
  check(VecCopy(rate_there_.get(), rate_.get()));
  check(VecCopy(end_.get(), u));
  before_ = taken.length;
  return {taken.length, taken.length, taken.rejected, taken.why};
}

}  // namespace whirl::transient
