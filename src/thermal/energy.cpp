#include "whirl/thermal/energy.hpp"

#include <algorithm>
#include <cstring>

#include "thermal/energy_lines.hpp"
#include "thermal/energy_terms.hpp"
#include "whirl/core/from_options.hpp"
#include "whirl/core/index.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::thermal {

using core::at;
using core::check;
using core::ReadArray;
using core::WriteArray;

namespace {

constexpr const char* prefix = "film_energy_";

}  // namespace

Energy::Energy(const Rows& rows, const Flow& flow, const EnergyModel& model, const std::vector<double>& thickness,
               Surroundings surroundings)
    : rows_(rows), gate_(rows.comm()), terms_(std::make_unique<EnergyTerms>(rows, flow, model)) {
  lines_ = std::make_unique<EnergyLines>(*terms_, core::plan::energy_sweeps());
  check(DMCreateGlobalVector(rows.cells(), rise_.put()));
  residual_ = core::duplicate(rise_.get());
  update(thickness, std::move(surroundings));
  PetscInt local = 0;
  check(VecGetLocalSize(rise_.get(), &local));
  jacobian_ = core::make_shell(rows.comm(), local, gate_, [this](Vec x, Vec y) {
    const ReadArray in(x);
    const WriteArray out(y);
    terms_->apply(in.data(), out.data());
  });
  make_solver();
}

Energy::~Energy() = default;

void Energy::make_solver() {
  check(SNESCreate(rows_.comm(), snes_.put()));
  SNES snes = snes_.get();
  check(SNESSetOptionsPrefix(snes, prefix));
  check(SNESSetFunction(snes, residual_.get(), form_residual, this));
  check(SNESSetJacobian(snes, jacobian_.get(), jacobian_.get(), form_jacobian, this));
  const bool linear = terms_->model().order == 1 && !terms_->laws().varied();
  // A linear equation is solved once as far as is asked for; steps of Newton's method need not be.
  check(SNESKSPSetUseEW(snes, linear ? PETSC_FALSE : PETSC_TRUE));
  KSP ksp = nullptr;
  PC pc = nullptr;
  check(SNESGetKSP(snes, &ksp));
  check(KSPSetType(ksp, KSPGMRES));
  check(KSPSetPCSide(ksp, PC_RIGHT));
  check(KSPGetPC(ksp, &pc));
  core::set_shell(pc, gate_, [this](Vec r, Vec x) {
    const ReadArray in(r);
    const WriteArray out(x);
    lines_->apply(in.data(), out.data());
  });
  core::set_from_options(snes, core::newton_types);
  PCType type = nullptr;
  check(PCGetType(pc, &type));
  if (std::strcmp(type, PCSHELL) == 0) return;
  if (std::strcmp(type, PCLU) == 0) check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  assembled_ = assemble();
  check(SNESSetJacobian(snes, jacobian_.get(), assembled_.get(), form_jacobian, this));
}

std::vector<double> Energy::half_layer(const Rows& rows, double conductivity, const std::vector<double>& thickness) {
  const Mesh& mesh = rows.mesh();
  std::vector<double> out(thickness.size());
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < mesh.nodes_around(); ++i) {
      const std::size_t node = at(rows.node(i, j));
      out[node] = 2 * mesh.across * conductivity * mesh.width(i) * mesh.depth(j) / thickness[node];
    }
  return out;
}

void Energy::update(const std::vector<double>& thickness, Surroundings surroundings) {
  terms_->update(thickness, std::move(surroundings));
  lines_->update();
}

void Energy::set_surroundings(Surroundings surroundings) {
  terms_->set_surroundings(std::move(surroundings));
  lines_->update();
}

PetscErrorCode Energy::form_residual(SNES snes, Vec x, Vec f, void* self) {
  Energy& e = *static_cast<Energy*>(self);
  const PetscErrorCode code = e.gate_.run([&] {
    const ReadArray in(x);
    const WriteArray out(f);
    e.terms_->residual(in.data(), out.data());
  });
  return e.gate_.domain_error() ? SNESSetFunctionDomainError(snes) : code;
}

PetscErrorCode Energy::form_jacobian(SNES, Vec x, Mat, Mat, void* self) {
  Energy& e = *static_cast<Energy*>(self);
  return e.gate_.run([&] {
    {
      const ReadArray in(x);
      e.terms_->linearise(in.data());
    }
    if (!e.assembled_) return;
    check(MatZeroEntries(e.assembled_.get()));
    e.terms_->fill(e.assembled_.get());
  });
}

EnergySolve Energy::solve(Vec temperature, double tolerance, double reduction) {
  const double ambient = terms_->surroundings().ambient;
  Vec x = rise_.get();
  const auto norm_at = [&] {
    {
      const ReadArray in(x);
      const WriteArray out(residual_.get());
      terms_->residual(in.data(), out.data());
    }
    return core::norm(residual_.get());
  };
  check(VecSet(x, 0));
  const double forcing = norm_at();
  check(VecCopy(temperature, x));
  check(VecShift(x, -ambient));
  const double start = norm_at(), target = std::max(tolerance * (forcing > 0 ? forcing : start), reduction * start);
  EnergySolve out;
  out.residual = out.before = start;
  out.scale = forcing > 0 ? forcing : start;
  out.converged = start <= target;
  if (out.converged) return out;
  check(SNESSetTolerances(snes_.get(), target, 0, 0, PETSC_DEFAULT, PETSC_DEFAULT));
  // No step is solved further than the whole equation has to be; one of first order all the way at once.
  KSP ksp = nullptr;
  check(SNESGetKSP(snes_.get(), &ksp));
  check(KSPSetTolerances(ksp, terms_->model().order == 1 && !terms_->laws().varied() ? 1e-14 : PETSC_DEFAULT,
                         0.5 * target, PETSC_DEFAULT, PETSC_DEFAULT));
  gate_.rethrow(SNESSolve(snes_.get(), nullptr, x));
  SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
  PetscInt newton = 0, krylov = 0;
  check(SNESGetConvergedReason(snes_.get(), &reason));
  check(SNESGetIterationNumber(snes_.get(), &newton));
  check(SNESGetLinearSolveIterations(snes_.get(), &krylov));
  check(SNESGetFunctionNorm(snes_.get(), &out.residual));
  out.newton = static_cast<int>(newton);
  out.krylov = static_cast<int>(krylov);
  out.converged = reason > 0;
  check(VecCopy(x, temperature));
  check(VecShift(temperature, ambient));
  return out;
}

void Energy::residual(Vec temperature, Vec out) {
  check(VecCopy(temperature, rise_.get()));
  check(VecShift(rise_.get(), -terms_->surroundings().ambient));
  const ReadArray in(rise_.get());
  const WriteArray into(out);
  terms_->residual(in.data(), into.data());
}

void Energy::linearise(Vec temperature) {
  check(VecCopy(temperature, rise_.get()));
  check(VecShift(rise_.get(), -terms_->surroundings().ambient));
  gate_.rethrow(form_jacobian(snes_.get(), rise_.get(), nullptr, nullptr, this));
}

core::Matrix Energy::assemble() const {
  PetscInt local = 0;
  check(VecGetLocalSize(rise_.get(), &local));
  core::Matrix out = core::make_matrix(rows_.comm(), local, std::vector<PetscInt>(at(local), 13));
  terms_->fill(out.get());
  return out;
}

void Energy::precondition(Vec r, Vec x) {
  const ReadArray in(r);
  const WriteArray out(x);
  lines_->apply(in.data(), out.data());
}

int Energy::sweeps() const {
  return lines_->sweeps();
}

std::vector<double> Energy::mixed(Vec temperature) {
  const ReadArray in(temperature);
  return terms_->grooves().means(rows_, in.data());
}

EnergyBudget Energy::budget(Vec temperature) {
  check(VecCopy(temperature, rise_.get()));
  check(VecShift(rise_.get(), -terms_->surroundings().ambient));
  const ReadArray in(rise_.get());
  return terms_->budget(in.data());
}

namespace {

// value(node, rise of its cell at a wall) of all nodes.
template <class Value>
std::vector<double> at_wall(const Rows& rows, Vec rise, bool journal, const Value& value) {
  const ReadArray in(rise);
  const int l = rows.mesh().across;
  std::vector<double> out(at(rows.count()) * at(rows.mesh().nodes_around()));
  for (std::size_t node = 0; node < out.size(); ++node) {
    const auto number = static_cast<PetscInt>(node);
    out[node] = value(number, in[number * l + (journal ? l - 1 : 0)]);
  }
  return out;
}

}  // namespace

std::vector<double> Energy::wall_factors(Vec temperature, bool journal) {
  check(VecCopy(temperature, rise_.get()));
  check(VecShift(rise_.get(), -terms_->surroundings().ambient));
  return at_wall(rows_, rise_.get(), journal,
                 [&](PetscInt node, double rise) { return terms_->wall_factor(journal, node, rise).value; });
}

std::vector<double> Energy::wall_heat(Vec temperature, bool journal) {
  check(VecCopy(temperature, rise_.get()));
  check(VecShift(rise_.get(), -terms_->surroundings().ambient));
  return at_wall(rows_, rise_.get(), journal,
                 [&](PetscInt node, double rise) { return terms_->wall_heat(journal, node, rise).value; });
}

}  // namespace whirl::thermal
