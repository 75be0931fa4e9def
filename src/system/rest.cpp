#include "rest.hpp"

#include <petscksp.h>

#include <algorithm>
#include <utility>

#include "system/start.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

using core::check;

namespace {

Train without(Train train) {
  train.unbalance.clear();
  std::erase_if(train.elements, [](const Element& e) { return !carries_static_load(e); });
  return train;
}

bool is_linear(const Train& train) {
  return std::all_of(train.supports.begin(), train.supports.end(),
                     [](const Support& s) { return film::facts(s.film).coefficients; });
}

}  // namespace

bool RotorSystem::Rest::needed(const Train& train) {
  return !std::all_of(train.elements.begin(), train.elements.end(), carries_static_load);
}

RotorSystem::Rest::Rest(RotorSystem& system) : system_(system) {
  const Varying& varying = system.varying_;
  if (varying.train)
    without_ = std::make_unique<RotorSystem>(
        system.comm_,
        Varying{[at = varying.train](double p) { return without(at(p)); }, varying.value, varying.magnitude},
        system.speed_);
  else
    without_ = std::make_unique<RotorSystem>(system.comm_, without(system.train_), system.speed_);
  without_->set_forcing(false);
}

void RotorSystem::Rest::follow_train() {
  without_->set_train(without(system_.train_));
  found_ = false;
}

double RotorSystem::Rest::left_over() {
  core::Vector still = core::duplicate(x_.get()), f = core::duplicate(x_.get());
  check(VecSet(still.get(), 0.0));
  without_->residual(0, x_.get(), still.get(), f.get());
  return core::norm(f.get());
}

bool RotorSystem::Rest::find() {
  if (found_ && without_->parameter() == system_.parameter()) return false;
  const bool linear = is_linear(system_.train_);
  const bool known = std::exchange(found_, false);  // true again at the end
  rate_.clear();
  without_->set_parameter(system_.parameter());
  // Supports that do not know the speed hold the machine at one place: a run-up asks at every stage of every step.
  constexpr double rounding = 4;
  if (known && linear && left_over() <= rounding * left_) {
    found_ = true;
    return false;
  }
  core::Vector x;
  try {
    const RestFinder* finder = system_.train_.rest;
    if (linear) {
      x = static_guess(*without_);
    } else {
      core::require(finder != nullptr, "a machine whose elements carry no static load knows how to find its rest");
      x = near_ ? core::duplicate(x_.get()) : core::make_vector(system_.comm_, without_->local_size(), PETSC_DETERMINE);
      if (near_) check(VecCopy(x_.get(), x.get()));
      finder->find(*without_, x.get(), near_);
      without_->set_forcing(false);
    }
  } catch (const core::NotConverged& error) {
    throw core::DomainError(
        std::string("the static equilibrium, about which elements act that carry no static load, was not found: ") +
        error.what());
  }
  x_ = std::move(x);
  found_ = near_ = true;
  if (linear) left_ = left_over();
  return true;
}

const std::vector<double>& RotorSystem::Rest::hub_rate() {
  if (!rate_.empty()) return rate_;
  core::Vector rest = core::duplicate(x_.get()), f = core::duplicate(x_.get()), dx = core::duplicate(x_.get());
  check(VecSet(rest.get(), 0.0));
  without_->parameter_derivative(0, x_.get(), rest.get(), f.get());
  if (core::norm(f.get()) == 0) return rate_ = std::vector<double>(static_cast<std::size_t>(2 * system_.n_), 0.0);
  const core::Matrix j = without_->make_jacobian();
  without_->jacobian(0, x_.get(), rest.get(), 1, 0, j.get());
  const core::LinearSolver ksp = core::make_direct_solver(system_.comm_, "rest_");
  check(KSPSetOperators(ksp.get(), j.get(), j.get()));
  check(KSPSetErrorIfNotConverged(ksp.get(), PETSC_TRUE));
  check(KSPSolve(ksp.get(), f.get(), dx.get()));
  check(VecScale(dx.get(), -1));
  rate_ = without_->hub_states(dx.get());
  return rate_;
}

}  // namespace whirl::system
