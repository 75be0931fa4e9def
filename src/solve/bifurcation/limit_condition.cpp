// A curve of cycles that keep a quantity: a condition that no bifurcation is behind.

#include <utility>

#include "whirl/solve/bifurcation/condition.hpp"

namespace whirl::solve {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

class LimitCondition : public Condition {
public:
  LimitCondition(CycleProblem& problem, CycleQuantity quantity, double value, std::function<LinearPlace(double)> place)
      : problem_(problem), quantity_(std::move(quantity)), value_(value), place_(std::move(place)) {}

  VectorXd values(Vec u, const VectorXd&) override {
    return VectorXd::Constant(1, at(problem_.gather(u), place_(0)).value / value_ - 1);
  }
  // scatter() divides states, period and parameter by their units, and a gradient is to be multiplied by them.
  void derivatives(Vec u, const VectorXd&, MatrixXd& d_inner, std::vector<core::Vector>& gradients) override {
    d_inner.resize(1, 0);
    Cycle cycle = problem_.gather(u);
    const LinearPlace place = place_(0);
    const CycleQuantity::Value now = at(cycle, place);
    const double scale = problem_.parameter_scale(), change = 1e-5 * scale;
    const double by_parameter =
        (at(cycle, place_(change)).value - at(cycle, place_(-change)).value) / (2 * change * value_);
    if (now.by_nodes.size() > 0) {
      const VectorXd square = problem_.state_scale().cwiseAbs2() / value_;
      cycle.x = square.asDiagonal() * (place.a.transpose() * now.by_nodes);
    } else {
      cycle.x.setZero();
    }
    cycle.period = now.by_period / value_ * problem_.period_scale() * problem_.period_scale();
    cycle.parameter = by_parameter * scale * scale;
    gradients.clear();
    gradients.push_back(problem_.scatter(cycle));
  }
  void update() override {}
  std::vector<CodimensionTest> tests(Vec, const VectorXd&, Vec) override { return {}; }

private:
  [[nodiscard]] CycleQuantity::Value at(const Cycle& cycle, const LinearPlace& place) const {
    return quantity_.of(problem_.scheme(), place.path(cycle), place.speed);
  }

  CycleProblem& problem_;
  CycleQuantity quantity_;
  double value_;
  std::function<LinearPlace(double)> place_;
};

}  // namespace

Cycle LinearPlace::path(const Cycle& cycle) const {
  Cycle out{cycle.mesh, {}, cycle.period, cycle.parameter};
  if (a.size() > 0) out.x = (a * cycle.x).colwise() + b;
  return out;
}

std::unique_ptr<Condition> make_limit(CycleProblem& problem, CycleQuantity quantity, double value,
                                      std::function<LinearPlace(double change)> place) {
  return std::make_unique<LimitCondition>(problem, std::move(quantity), value, std::move(place));
}

}  // namespace whirl::solve
