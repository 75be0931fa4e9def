#include "transient/steps/explicit_steps.hpp"

#include "whirl/core/local_part.hpp"

namespace whirl::transient {

Taken AdamsMoultonSteps::step(double time, double wanted, Vec u) {
  core::get(u, start_);
  if (before_ == 0) equations_.rate(time, start_, rate_);
  const Taken taken = take_step(wanted, 1, [&](double h) -> std::optional<double> {
    const double w = before_ > 0 ? h / before_ : 0;
    end_ = start_ + h * (1 + w / 2) * rate_;
    if (w > 0) end_ -= h * w / 2 * rate_before_;
    equations_.rate(time + h, end_, rate_there_);
    end_ = start_ + h / 2 * (rate_ + rate_there_);
    equations_.rate(time + h, end_, rate_there_);
    return 0.0;
  });
  rate_before_ = rate_;
  rate_ = rate_there_;
  core::put(end_, u);
  before_ = taken.length;
  return {taken.length, taken.length, taken.rejected, taken.why};
}

Taken ClassicalSteps::step(double time, double wanted, Vec u) {
  core::get(u, start_);
  slopes_.resize(start_.size(), tableau_.stages());
  const Taken taken = take_step(wanted, 1, [&](double h) -> std::optional<double> {
    for (Eigen::Index i = 0; i < tableau_.stages(); ++i) {
      value_ = start_ + h * (slopes_.leftCols(i) * tableau_.a.row(i).head(i).transpose());
      equations_.rate(time + h * tableau_.c(i), value_, rate_);
      slopes_.col(i) = rate_;
    }
    value_ = start_ + h * (slopes_ * tableau_.b);
    return 0.0;
  });
  core::put(value_, u);
  return {taken.length, taken.length, taken.rejected, taken.why};
}

}  // namespace whirl::transient
