#include "whirl/solve/bifurcation/augmented_problem.hpp"

#include <cmath>
#include <limits>

#include "whirl/core/agree.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

AugmentedProblem::AugmentedProblem(ExtendedProblem& branch, Condition& condition, Vec along,
                                   std::optional<SecondParameter> second)
    : branch_(branch), condition_(condition), second_(std::move(second)), inner_size_(condition.start().size()) {
  lay_out(along);
}

void AugmentedProblem::lay_out(Vec along) {
  row_ = core::duplicate(along);
  unit_ = core::duplicate(along);
  weighted_row(branch_, along, row_.get());
  parameter_row(branch_, unit_.get());
  weights_ = make_unknown();
  // Inner unknowns have no part in the arclength: they follow from u.
  join(branch_.weights(), VectorXd::Zero(inner_size_), 1, weights_.get());
  at_.reset();
  u_ = core::duplicate(along);
}

bool AugmentedProblem::adapt(core::Vector& whole, core::Vector& tangent) {
  core::Vector u = core::duplicate(u_.get()), t = core::duplicate(u_.get());
  VectorXd inner, inner_slope;
  double q = 0, q_slope = 0;
  split(whole.get(), u.get(), inner, q);
  split(tangent.get(), t.get(), inner_slope, q_slope);
  if (!branch_.adapt(u, t)) return false;
  lay_out(any_tangent(branch_, u.get()).get());
  whole = make_unknown();
  tangent = make_unknown();
  join(u.get(), inner, q, whole.get());
  join(t.get(), inner_slope, q_slope, tangent.get());
  return true;
}

core::Vector AugmentedProblem::make_unknown() const {
  PetscInt local = 0;
  check(VecGetLocalSize(branch_.weights(), &local));
  const bool last = core::rank_of(comm()) == core::size_of(comm()) - 1;
  return core::make_vector(comm(), local + (last ? static_cast<PetscInt>(inner_size_) + 1 : 0), PETSC_DETERMINE);
}

void AugmentedProblem::split(Vec whole, Vec u, VectorXd& inner, double& q) const {
  const core::ReadArray w(whole);
  const core::WriteArray a(u);
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = w[i];
  VectorXd rest(inner_size_ + 1);
  const int last = core::size_of(comm()) - 1;
  if (core::rank_of(comm()) == last)
    for (Index k = 0; k <= inner_size_; ++k) rest(k) = w[static_cast<PetscInt>(w.size() - inner_size_ - 1 + k)];
  MPI_Bcast(rest.data(), static_cast<int>(rest.size()), MPI_DOUBLE, last, comm());
  inner = rest.head(inner_size_);
  q = rest(inner_size_);
}

void AugmentedProblem::join(Vec u, const VectorXd& inner, double q, Vec whole) const {
  const core::ReadArray a(u);
  const core::WriteArray w(whole);
  for (PetscInt i = 0; i < a.size(); ++i) w[i] = a[i];
  if (w.size() == a.size()) return;
  for (Index k = 0; k < inner_size_; ++k) w[static_cast<PetscInt>(a.size() + k)] = inner(k);
  w[w.size() - 1] = q;
}

core::Vector AugmentedProblem::branch_part(Vec whole) const {
  core::Vector u = core::duplicate(branch_.weights());
  VectorXd inner;
  double q = 0;
  split(whole, u.get(), inner, q);
  return u;
}

double AugmentedProblem::first_parameter(Vec whole) const {
  return last_entry(comm(), branch_part(whole).get());
}

VectorXd AugmentedProblem::inner(Vec whole) const {
  core::Vector u = core::duplicate(branch_.weights());
  VectorXd z;
  double q = 0;
  split(whole, u.get(), z, q);
  return z;
}

void AugmentedProblem::set_second(double q) {
  core::agree(comm(), [&] { second_->set(q * second_->scale); });
  branch_.equations_changed();
}

// The branch problem linearised at U, and g there; nothing to do if that is the present state.
void AugmentedProblem::evaluate(Vec whole) {
  PetscBool same = PETSC_FALSE;
  if (at_) check(VecEqual(at_.get(), whole, &same));
  if (same) return;
  at_.reset();
  split(whole, u_.get(), inner_, q_);
  if (second_ && (!q_set_ || set_q_ != q_)) {
    q_set_ = false;
    set_second(q_);
    set_q_ = q_;
    q_set_ = true;
  }
  branch_.linearise(u_.get(), row_.get());
  g_ = condition_.values(u_.get(), inner_);
  at_ = copy(whole);
}

void AugmentedProblem::residual(Vec whole, Vec r) {
  evaluate(whole);
  core::Vector own = core::duplicate(u_.get());
  branch_.residual(u_.get(), own.get());
  set_last_entry(comm(), own.get(), g_(0));
  join(own.get(), g_.tail(inner_size_), 0, r);
}

void AugmentedProblem::linearise(Vec whole, Vec row) {
  evaluate(whole);
  condition_.derivatives(u_.get(), inner_, g_inner_, gradients_);
  const Index k = inner_size_ + 1;
  g_q_ = VectorXd::Zero(k);
  for (core::Vector* v : {&by_q_, &tangent_, &response_}) {
    *v = core::duplicate(u_.get());
    check(VecSet(v->get(), 0.0));
  }
  if (second_) {
    q_set_ = false;  // until the differences are done
    core::Vector here = std::move(at_);
    const double h = std::cbrt(std::numeric_limits<double>::epsilon()) * std::max(1.0, std::abs(q_));
    core::Vector r = core::duplicate(u_.get());
    for (const double sign : {1.0, -1.0}) {
      set_second(q_ + sign * h);
      branch_.residual(u_.get(), r.get());
      check(VecAXPY(by_q_.get(), sign / (2 * h), r.get()));
      branch_.linearise(u_.get(), row_.get());
      g_q_ += sign / (2 * h) * condition_.values(u_.get(), inner_);
    }
    set_last_entry(comm(), by_q_.get(), 0);
    set_second(q_);
    branch_.linearise(u_.get(), row_.get());
    g_ = condition_.values(u_.get(), inner_);
    q_set_ = true;
    at_ = std::move(here);
  }
  (void)solve_linear(branch_, unit_.get(), tangent_.get(), "tangent_");
  if (second_) {
    const core::Vector rhs = copy(by_q_.get());
    check(VecScale(rhs.get(), -1));
    (void)solve_linear(branch_, rhs.get(), response_.get(), "tangent_");
  }
  added_ = copy(row);
  // Rows g and the added one on tangent, z and q.
  small_.resize(k + 1, k + 1);
  core::Vector part = core::duplicate(u_.get());
  VectorXd added_inner;
  double added_q = 0;
  split(row, part.get(), added_inner, added_q);
  for (Index i = 0; i < k; ++i) {
    Vec gradient = gradients_[static_cast<std::size_t>(i)].get();
    small_(i, 0) = dot(gradient, tangent_.get());
    small_(i, k) = g_q_(i) + dot(gradient, response_.get());
  }
  small_(k, 0) = dot(part.get(), tangent_.get());
  small_(k, k) = added_q + dot(part.get(), response_.get());
  small_.block(0, 1, k, inner_size_) = g_inner_;
  small_.block(k, 1, 1, inner_size_) = added_inner.transpose();
}

void AugmentedProblem::multiply(Vec v, Vec y) {
  core::Vector u = core::duplicate(u_.get()), r = core::duplicate(u_.get());
  VectorXd inner;
  double q = 0;
  split(v, u.get(), inner, q);
  branch_.multiply(u.get(), r.get());
  check(VecAXPY(r.get(), q, by_q_.get()));
  VectorXd g = g_inner_ * inner + g_q_ * q;
  for (Index i = 0; i <= inner_size_; ++i) g(i) += dot(gradients_[static_cast<std::size_t>(i)].get(), u.get());
  set_last_entry(comm(), r.get(), g(0));
  join(r.get(), g.tail(inner_size_), dot(added_.get(), v), y);
}

void AugmentedProblem::solve(Vec rhs, Vec x) {
  core::Vector r = core::duplicate(u_.get()), u = core::duplicate(u_.get());
  VectorXd inner;
  double last = 0;
  split(rhs, r.get(), inner, last);
  const Index k = inner_size_ + 1;
  VectorXd small(k + 1);
  small << last_entry(comm(), r.get()), inner, last;
  set_last_entry(comm(), r.get(), 0);
  branch_.solve(r.get(), u.get());
  for (Index i = 0; i < k; ++i) small(i) -= dot(gradients_[static_cast<std::size_t>(i)].get(), u.get());
  core::Vector whole = make_unknown();
  join(u.get(), VectorXd::Zero(inner_size_), 0, whole.get());
  small(k) -= dot(added_.get(), whole.get());
  small = core::DenseLu<double>(small_).solve(small);
  check(VecAXPY(u.get(), small(0), tangent_.get()));
  check(VecAXPY(u.get(), small(k), response_.get()));
  join(u.get(), small.segment(1, inner_size_), small(k), x);
}

// Borders change g alone: the branch problem stays as it is linearised.
void AugmentedProblem::prime(Vec whole) {
  evaluate(whole);
  for (int pass = 0; pass < 4; ++pass) {
    condition_.update();
    g_ = condition_.values(u_.get(), inner_);
  }
}

void AugmentedProblem::update() {
  condition_.update();
  const double length = std::sqrt(solve::inner(branch_, tangent_.get(), tangent_.get()));
  weighted_row(branch_, tangent_.get(), row_.get());
  check(VecScale(row_.get(), 1 / length));
  at_.reset();
}

std::vector<CodimensionTest> AugmentedProblem::tests() {
  return condition_.tests(u_.get(), inner_, tangent_.get());
}

std::optional<Refined> locate(ExtendedProblem& branch, Condition& condition, Vec u, Vec along,
                              const NewtonOptions& options, VectorXd* inner) try {
  AugmentedProblem problem(branch, condition, along);
  core::Vector whole = problem.make_unknown(), row = core::duplicate(whole.get());
  problem.join(u, condition.start(), 0, whole.get());
  problem.prime(whole.get());
  parameter_row(problem, row.get());
  if (!newton(problem, whole.get(), row.get(), 0, options).converged) return std::nullopt;
  // One step more, which costs little and tells what Newton's method had left.
  core::Vector r = core::duplicate(whole.get()), step = core::duplicate(whole.get());
  problem.residual(whole.get(), r.get());
  set_last_entry(branch.comm(), r.get(), 0);
  problem.linearise(whole.get(), row.get());
  (void)solve_linear(problem, r.get(), step.get(), "tangent_");
  check(VecAXPY(whole.get(), -1, step.get()));
  Refined out;
  out.u = core::duplicate(u);
  VectorXd z;
  double q = 0;
  problem.split(whole.get(), out.u.get(), z, q);
  if (inner) *inner = z;
  out.parameter = last_entry(branch.comm(), out.u.get());
  out.error = std::abs(problem.first_parameter(step.get()));
  // Of a fold: g is the parameter's share in the tangent K^-1 e, along which it changes like that.
  out.quadratic = dot(problem.gradients().front().get(), problem.tangent()) /
                  solve::inner(branch, problem.tangent(), problem.tangent());
  return out;
} catch (const core::DomainError&) {
  return std::nullopt;
} catch (const core::NotConverged&) {
  return std::nullopt;
}

core::Vector any_tangent(ExtendedProblem& branch, Vec u) {
  core::Vector row = core::duplicate(u), rhs = core::duplicate(u), tangent = core::duplicate(u);
  PetscInt begin = 0;
  check(VecGetOwnershipRange(u, &begin, nullptr));
  {
    const core::WriteArray a(row.get());
    for (PetscInt i = 0; i < a.size(); ++i) a[i] = std::sin(1.0 + static_cast<double>(begin + i));
  }
  check(VecPointwiseMult(row.get(), row.get(), branch.weights()));
  set_last_entry(branch.comm(), row.get(), 1);
  parameter_row(branch, rhs.get());
  branch.linearise(u, row.get());
  (void)solve_linear(branch, rhs.get(), tangent.get(), "tangent_");
  check(VecScale(tangent.get(), 1 / std::sqrt(solve::inner(branch, tangent.get(), tangent.get()))));
  return tangent;
}

std::unique_ptr<Condition> condition_of(problem::System& system, EquilibriumProblem& problem, Event event,
                                        std::complex<double> critical) {
  switch (event) {
    case Event::fold:
      return make_fold(problem, problem);
    case Event::hopf:
      return make_hopf(system, problem, std::abs(critical.imag()));
    default:
      return nullptr;
  }
}

namespace {

std::optional<Refined> refine_here(PeriodicProblem& problem, const LocatedEvent& event, Vec u, Vec tangent,
                                   const NewtonOptions& options) try {
  core::Vector row = core::duplicate(u);
  weighted_row(problem, tangent, row.get());
  problem.linearise(u, row.get());
  const auto condition = problem.condition(event.event, event.critical);
  if (!condition) return std::nullopt;
  VectorXd inner;
  auto found = locate(problem, *condition, u, tangent, options, &inner);
  if (!found) return found;
  found->critical = event.event == Event::cyclic_fold ? 1 : -1;
  if (event.event == Event::neimark_sacker) {
    if (!(std::abs(inner(0)) < 1)) return std::nullopt;  // two real multipliers of product one
    found->critical = {inner(0), std::sqrt(1 - inner(0) * inner(0))};
  }
  return found;
} catch (const core::DomainError&) {
  return std::nullopt;
} catch (const core::NotConverged&) {
  return std::nullopt;
}

}  // namespace

std::optional<Refined> refine(PeriodicProblem& problem, const LocatedEvent& event, Vec u, Vec tangent,
                              const NewtonOptions& options) {
  if (!options.replay_log) return refine_here(problem, event, u, tangent, options);
  const std::vector<double> question{core::norm(u), static_cast<double>(event.event), event.critical.real(),
                                     event.critical.imag()};
  const auto answer = options.replay_log->ask("refine", question, [&](const ReplayLog::Answer&) {
    const auto r = refine_here(problem, event, u, tangent, options);
    if (!r) return ReplayLog::Answer{};
    return ReplayLog::Answer{{r->parameter, r->error, r->quadratic, r->critical.real(), r->critical.imag()},
                             {},
                             {ReplayLog::keep(options.replay_log, r->u.get())}};
  });
  if (answer.numbers.empty()) return std::nullopt;
  const std::vector<double>& facts = answer.numbers;
  Refined r{core::duplicate(u), facts[0], facts[1], facts[2], {facts[3], facts[4]}};
  ReplayLog::give(answer.vectors.at(0), r.u.get());
  return r;
}

std::optional<Refined> refine(problem::System& system, EquilibriumProblem& problem, const LocatedEvent& event, Vec u,
                              Vec tangent, const NewtonOptions& options) {
  const auto condition = condition_of(system, problem, event.event, event.critical);
  if (!condition) return std::nullopt;
  VectorXd inner;
  auto found = locate(problem, *condition, u, tangent, options, &inner);
  if (found && event.event == Event::hopf) found->critical = {0, std::abs(inner(0))};
  return found;
}

}  // namespace whirl::solve
