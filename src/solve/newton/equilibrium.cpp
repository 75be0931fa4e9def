#include "whirl/solve/newton/equilibrium.hpp"

#include <petscksp.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solve/newton/anchored_hub.hpp"
#include "solve/newton/port_krylov.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::solve {

using core::check;

EquilibriumProblem::EquilibriumProblem(problem::System& system, double parameter_scale, double state_weight)
    : system_(system), parameter_scale_(parameter_scale) {
  weights_ = make_unknown();
  {
    const core::WriteArray w(weights_.get());
    for (PetscInt i = 0; i < system.local_size(); ++i) w[i] = state_weight / static_cast<double>(system.size());
    if (w.size() > system.local_size()) w[w.size() - 1] = 1;
  }
  x_ = core::make_vector(comm(), system.local_size(), PETSC_DETERMINE);
  rest_ = core::duplicate(x_.get());
  f_ = core::duplicate(x_.get());
  state_scale_ = core::duplicate(x_.get());
  residual_scale_ = core::duplicate(x_.get());
  row_scale_ = core::duplicate(x_.get());
  check(VecSet(rest_.get(), 0.0));
  renew(parameter_scale);
}

void EquilibriumProblem::renew(double parameter_scale) {
  parameter_scale_ = parameter_scale;
  system_.scales(state_scale_.get(), residual_scale_.get());
  check(VecCopy(residual_scale_.get(), row_scale_.get()));
  check(VecReciprocal(row_scale_.get()));
  if (rows_) set_scales();
  if (problem::BlockStructure* const structure = system_.structure(); structure && structure->own().empty()) {
    point_ = std::make_unique<problem::ScaledPoint>(system_, structure, true);
    refreshed_at_ = system_.parameter();
    if (!hub_on_ports_) hub_on_ports_ = std::make_unique<AnchoredHub>();
    scaled_.resize(point_->size());
    still_.setZero(point_->size());
    value_.resize(point_->size());
  }
  if (!given_up_) return;
  exact_.reset();
  given_up_ = false;
}

// Of the bordered matrix.
void EquilibriumProblem::set_scales() {
  for (const auto& [to, from] :
       {std::pair{rows_.get(), row_scale_.get()}, std::pair{columns_.get(), state_scale_.get()}}) {
    check(VecSet(to, 1));
    const core::ReadArray a(from);
    const core::WriteArray b(to);
    std::copy_n(a.data(), a.size(), b.data());
  }
}

EquilibriumProblem::~EquilibriumProblem() = default;

core::Vector EquilibriumProblem::make_unknown() const {
  const bool last = core::rank_of(comm()) == core::size_of(comm()) - 1;
  return core::make_vector(comm(), system_.local_size() + (last ? 1 : 0), PETSC_DETERMINE);
}

void EquilibriumProblem::to_state(Vec u, Vec x) const {
  const core::ReadArray ua(u), s(state_scale_.get());
  const core::WriteArray xa(x);
  for (PetscInt i = 0; i < xa.size(); ++i) xa[i] = ua[i] * s[i];
}

void EquilibriumProblem::from_state(Vec x, double parameter, Vec u) const {
  {
    const core::ReadArray xa(x), s(state_scale_.get());
    const core::WriteArray ua(u);
    for (PetscInt i = 0; i < xa.size(); ++i) ua[i] = xa[i] / s[i];
  }
  set_last_entry(comm(), u, parameter / parameter_scale_);
}

void EquilibriumProblem::prepare(Vec u) {
  const double parameter = last_entry(comm(), u) * parameter_scale_;
  core::agree(comm(), [&] { system_.set_parameter(parameter); });
  to_state(u, x_.get());
  if (!point_) return;
  if (parameter != refreshed_at_) {
    if (system_.parameter_is_speed())
      point_->refresh_speed();
    else
      point_->refresh();
    refreshed_at_ = parameter;
  }
  const core::ReadArray ua(u);
  std::copy_n(ua.data(), scaled_.size(), scaled_.data());
}

void EquilibriumProblem::equations_changed() {
  if (!point_) return;
  point_->refresh();
  refreshed_at_ = system_.parameter();
}

void EquilibriumProblem::residual(Vec u, Vec r) {
  prepare(u);
  if (point_) {
    const core::WriteArray ra(r);
    point_->residual(0, scaled_, still_, value_);
    std::copy_n(value_.data(), value_.size(), ra.data());
    return;
  }
  system_.residual(0, x_.get(), rest_.get(), f_.get());
  const core::ReadArray fa(f_.get()), s(residual_scale_.get());
  const core::WriteArray ra(r);
  for (PetscInt i = 0; i < fa.size(); ++i) ra[i] = fa[i] / s[i];
}

// Filled when it is asked for, and from then on with every linearisation.
Mat EquilibriumProblem::matrix() {
  if (bordered_ || !row_) return bordered_.get();
  if (on_ports_) assemble();
  PetscInt local = 0;
  check(VecGetLocalSize(rows_.get(), &local));
  bordered_ = entries_.matrix(comm(), local);
  fill_bordered();
  return bordered_.get();
}

void EquilibriumProblem::fill_bordered() {
  check(MatSetValuesCOO(bordered_.get(), entries_.values().data(), INSERT_VALUES));
  check(MatDiagonalScale(bordered_.get(), rows_.get(), columns_.get()));
}

bool EquilibriumProblem::settles() const {
  return system_.settles();
}

bool EquilibriumProblem::settle(Vec u) {
  if (!settles()) return false;
  try {
    prepare(u);
    system_.settle(x_.get());
  } catch (const core::DomainError&) {
    return false;
  } catch (const core::NotConverged&) {
    return false;
  }
  const core::ReadArray xa(x_.get()), s(state_scale_.get());
  const core::WriteArray ua(u);
  for (PetscInt i = 0; i < xa.size(); ++i) ua[i] = xa[i] / s[i];
  return true;
}

void EquilibriumProblem::list() {
  problem::Entries& out = entries_;
  problem::list_entries(system_, {0, x_.get(), rest_.get()}, 1, 0, jacobian_, out);
  // The border; entries of its row in the hub's columns belong to the rank that has this row.
  const bool last = core::rank_of(comm()) == core::size_of(comm()) - 1;
  const PetscInt n = system_.size();
  const problem::Field hub = system_.fields().front();
  PetscInt first = 0;
  check(VecGetOwnershipRange(row_.get(), &first, nullptr));
  const core::ReadArray row(row_.get()), dp(f_.get()), columns(columns_.get());
  std::vector<double> of_hub(hub_.size(), 0.0);
  for (std::size_t k = 0; k < hub_.size(); ++k)
    if (const PetscInt i = hub_[k] - first; i >= 0 && i < dp.size()) of_hub[k] = row[i] / columns[i];
  MPI_Allreduce(MPI_IN_PLACE, of_hub.data(), static_cast<int>(of_hub.size()), MPI_DOUBLE, MPI_SUM, comm());
  for (PetscInt i = 0; i < dp.size(); ++i) out.add(first + i, n, dp[i] * parameter_scale_);
  for (PetscInt i = 0; i < dp.size(); ++i)
    if (i < hub.begin || i >= hub.end) out.add(n, first + i, row[i] / columns[i]);
  if (!last) return;
  for (std::size_t k = 0; k < hub_.size(); ++k) out.add(n, hub_[k], of_hub[k]);
  out.add(n, n, row[row.size() - 1]);
}

void EquilibriumProblem::linearise(Vec u, Vec row) {
  prepare(u);
  if (!row_) {
    for (core::Vector* v : {&row_, &rows_, &columns_}) *v = make_unknown();
    set_scales();
    hub_ = problem::hub_numbers(system_);
  }
  check(VecCopy(row, row_.get()));
  on_ports_ = point_ && linearise_on_ports();
  if (!on_ports_ || bordered_) assemble();
}

bool EquilibriumProblem::linearise_on_ports() {
  point_->residual(0, scaled_, still_, value_, at_);
  point_->parameter_derivative(0, at_, value_);
  const core::ReadArray row(row_.get());
  return hub_on_ports_->set(point_->thin_blocks(), at_.films.d_inputs, value_ * parameter_scale_,
                            Eigen::Map<const Eigen::VectorXd>(row.data(), row.size()));
}

std::vector<double> EquilibriumProblem::anchor() const {
  if (!hub_on_ports_) return {};
  const Eigen::MatrixXd& tangents = hub_on_ports_->anchor();
  return {tangents.data(), tangents.data() + tangents.size()};
}

void EquilibriumProblem::take_anchor(const std::vector<double>& anchor) {
  if (!point_ || anchor.empty()) return;
  const problem::ThinBlocks& blocks = point_->thin_blocks();
  core::require(std::ssize(anchor) == blocks.b.cols() * blocks.c.rows(), "tangents of this machine");
  hub_on_ports_->set_anchor(Eigen::Map<const Eigen::MatrixXd>(anchor.data(), blocks.b.cols(), blocks.c.rows()));
}

void EquilibriumProblem::answer(Eigen::VectorXd (AnchoredHub::*by)(const Eigen::VectorXd&) const, Vec from,
                                Vec to) const {
  const core::ReadArray a(from);
  const Eigen::VectorXd found = (*hub_on_ports_.*by)(Eigen::Map<const Eigen::VectorXd>(a.data(), a.size()));
  std::copy_n(found.data(), found.size(), core::WriteArray(to).data());
}

void EquilibriumProblem::assemble() {
  system_.parameter_derivative(0, x_.get(), rest_.get(), f_.get());
  list();
  if (!blocks_) {
    PetscInt local = 0;
    check(VecGetLocalSize(row_.get(), &local));
    blocks_ = std::make_unique<PortMatrix>(
        std::make_shared<const PortLayout>(comm(), local, system_.fields(), entries_.places()));
  }
  if (bordered_) fill_bordered();
  blocks_->take(entries_.values());
  blocks_->scale(rows_.get(), columns_.get());
  factorised_ = exact_factorised_ = false;
  if (!ports_ && !exact_) {
    auto inverse = own_inverse(system_);
    std::unique_ptr<PortElimination>& elimination = inverse && inverse->exact() == nullptr ? ports_ : exact_;
    elimination = std::make_unique<PortElimination>(system_.fields(), std::move(inverse));
  }
  for (const PortElimination* elimination : {ports_.get(), exact_.get()})
    if (elimination && elimination->inverse()) elimination->inverse()->set({0, x_.get(), rest_.get()}, 1, 0);
}

// Elimination by the parts' own approximate inverses, with a Krylov method around that.
std::string EquilibriumProblem::solve_by_inverses(Vec rhs, Vec x) {
  constexpr double tolerance = 1e-12;
  try {
    if (!factorised_) ports_->factorise(*blocks_);
    factorised_ = true;
    if (!krylov_) krylov_ = std::make_unique<PortKrylov>(*blocks_->layout(), "equilibrium_");
    (void)krylov_->solve(*blocks_, *ports_, rhs, x, tolerance);
    return "";
  } catch (const core::DomainError& error) {  // these are agreed on
    return error.what();
  } catch (const core::NotConverged& error) {
    return error.what();
  }
}

// Transposes, parts without approximate inverses, and those whose inverses do not serve: where these have failed once
// on a matrix that is regular, they are not asked again.
void EquilibriumProblem::solve_by_parts(bool transposed, Vec rhs, Vec x) {
  const bool by_inverses = ports_ && !transposed && !exact_factorised_;
  if (by_inverses) {
    const std::string failure = solve_by_inverses(rhs, x);
    if (failure.empty()) return;
    if (system_.size() > core::plan::whole_states()) {
      check(VecSetInf(x));  // which ends Newton's method
      core::agree(comm(), [&] { throw core::DomainError(failure + "; " + core::plan::too_large(system_.size())); });
    }
  }
  if (!exact_) exact_ = std::make_unique<PortElimination>(system_.fields());
  if (!exact_factorised_) exact_->factorise(*blocks_);
  exact_factorised_ = true;
  if (transposed)
    exact_->solve_transposed(rhs, x);
  else
    exact_->solve(rhs, x);
  if (by_inverses && std::isfinite(core::norm(x))) {
    krylov_.reset();
    ports_.reset();
    given_up_ = true;
  }
}

// A singular matrix gives infinite answers, as those of MUMPS alone, which Newton's method and GMRES recognise.
void EquilibriumProblem::solve(bool transposed, Vec rhs, Vec x) {
  if (on_ports_) return answer(transposed ? &AnchoredHub::solve_transposed : &AnchoredHub::solve, rhs, x);
  try {
    solve_by_parts(transposed, rhs, x);
  } catch (const core::NotConverged&) {
    check(VecSetInf(x));
  }
}

void EquilibriumProblem::multiply(Vec v, Vec y) {
  if (on_ports_) return answer(&AnchoredHub::multiply, v, y);
  const core::ReadArray va(v);
  const core::WriteArray ya(y);
  blocks_->multiply(va.data(), ya.data());
}

void EquilibriumProblem::solve(Vec rhs, Vec x) {
  solve(false, rhs, x);
}

NewtonResult Equilibria::find(Vec x, const NewtonOptions& options) {
  const double parameter = system_.parameter(), unit = parameter != 0 ? std::abs(parameter) : 1.0;
  problem_.renew(unit);
  core::Vector u = problem_.make_unknown(), row = core::duplicate(u.get());
  problem_.from_state(x, parameter, u.get());
  parameter_row(problem_, row.get());
  const NewtonResult result = newton(problem_, u.get(), row.get(), parameter / unit, options);
  problem_.to_state(u.get(), x);
  system_.set_parameter(parameter);
  return result;
}

}  // namespace whirl::solve
