// The temperature of a solid by itself, and the heat that passes its surfaces.
#include <petscksp.h>

#include <algorithm>
#include <array>
#include <limits>

#include "thermal/solid_parts.hpp"
#include "whirl/core/agree.hpp"

namespace whirl::thermal {

using core::check;

void Solid::prepare_solver() {
  if (solver_) return;
  check(KSPCreate(comm_, solver_.put()));
  KSP ksp = solver_.get();
  check(KSPSetOptionsPrefix(ksp, prefix_.c_str()));
  check(KSPSetType(ksp, KSPCG));
  check(KSPSetNormType(ksp, KSP_NORM_UNPRECONDITIONED));
  check(KSPSetTolerances(ksp, 1e-10, PETSC_DEFAULT, PETSC_DEFAULT, 500));
  check(KSPSetInitialGuessNonzero(ksp, PETSC_TRUE));
  PC pc = nullptr;
  check(KSPGetPC(ksp, &pc));
  use_multigrid(pc);
  check(KSPSetFromOptions(ksp));
}

int Solid::solve(Vec rhs, Vec temperature, double reduction) {
  double film = 0;
  for (const double g : joined_) film += g;
  MPI_Allreduce(MPI_IN_PLACE, &film, 1, MPI_DOUBLE, MPI_SUM, comm_);
  core::agree(comm_, [&] {
    if (film <= 0 && !grounded_)
      throw core::NotConverged("the temperature of a solid is not determined: no film and no surface takes its heat");
  });
  prepare_solver();
  KSP ksp = solver_.get();
  check(KSPSetOperators(ksp, matrix_.get(), matrix_.get()));
  // A residual is a sum of eight terms as large as the diagonal's: no solver gets below their rounding.
  const core::Vector scale = core::duplicate(rhs);
  check(MatGetDiagonal(matrix_.get(), scale.get()));
  check(VecPointwiseMult(scale.get(), scale.get(), temperature));
  double rtol = 0, dtol = 0;
  PetscInt most = 0;
  check(KSPGetTolerances(ksp, &rtol, nullptr, &dtol, &most));
  check(KSPSetTolerances(ksp, std::max(rtol, reduction),
                         8 * std::numeric_limits<double>::epsilon() * core::norm(scale.get()), dtol, most));
  check(KSPConvergedDefaultSetUIRNorm(ksp));
  check(KSPSolve(ksp, rhs, temperature));
  check(KSPSetTolerances(ksp, rtol, PETSC_DEFAULT, dtol, most));
  KSPConvergedReason why{};
  PetscInt iterations = 0;
  check(KSPGetConvergedReason(ksp, &why));
  check(KSPGetIterationNumber(ksp, &iterations));
  core::agree(comm_, [&] {
    if (why < 0)
      throw core::NotConverged(std::string("the temperature of a solid was not found: ") + KSPConvergedReasons[why]);
  });
  return static_cast<int>(iterations);
}

std::vector<double> Solid::wall_heat(Vec temperature, const std::vector<double>& film) const {
  const core::ReadArray t(temperature);
  std::vector<double> out(wall_.size());
  for (std::size_t c = 0; c < out.size(); ++c) out[c] = joined_[c] * (film[c] - t[local(wall_[c])]);
  return out;
}

std::vector<double> Solid::wall_temperature(Vec temperature, const std::vector<double>& film) const {
  std::vector<double> out = wall_heat(temperature, film);
  const core::ReadArray t(temperature);
  for (std::size_t c = 0; c < out.size(); ++c) out[c] = t[local(wall_[c])] + resistance_[c] * out[c];
  return out;
}

Heats Solid::heats(Vec temperature, const std::vector<double>& film) const {
  Heats out;
  const std::vector<double> wall = wall_heat(temperature, film);
  core::Vector reaction;
  if (reactions_) {
    check(MatCreateVecs(reactions_.get(), nullptr, reaction.put()));
    check(MatMult(reactions_.get(), temperature, reaction.get()));
    const core::ReadArray in(reaction.get());
    PetscInt row = 0;
    each_cell(*this, [&](int, int, int q) {
      if (prescribed_end(q)) (prescribed_end(q) == &surfaces_.begin ? out.begin : out.end) += in[row++];
    });
  }
  const core::ReadArray t(temperature);
  each_cell(*this, [&](int k, int i, int q) {
    const Surface* const end = prescribed_end(q);
    each_surface(k, i, q, [&](const Exposed& s) {
      const double heat = s.conductance * (t[local(cell(k, i, q))] - s.temperature);
      out.*s.to += heat;
      // What leaves a cell of prescribed temperature otherwise does not leave through the end.
      if (end) (end == &surfaces_.begin ? out.begin : out.end) -= heat;
    });
  });
  for (std::size_t c = 0; c < wall.size(); ++c) {
    out.wall += wall[c];
    if (const Surface* end = prescribed_end(static_cast<int>(wall_[c] / row_cells())))
      (end == &surfaces_.begin ? out.begin : out.end) += wall[c];
  }
  std::array<double, 5> sums{out.wall, out.inner, out.outer, out.begin, out.end};
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 5, MPI_DOUBLE, MPI_SUM, comm_);
  return {sums[0], sums[1], sums[2], sums[3], sums[4]};
}

std::vector<double> Solid::growth(Vec temperature, double reference) const {
  const core::ReadArray t(temperature);
  std::vector<double> out;
  for (int j = film_begin_; j < film_end_; ++j) {
    double rise = 0, area = 0;
    for (int i = 0; i < shape_.columns(); ++i)
      for (int k = 0; k < shape_.layers(); ++k) {
        const double share = shape_.sector(k) * shape_.angle(i);
        rise += share * (t[local(cell(k, i, j + shape_.film_row))] - reference);
        area += share;
      }
    out.push_back(material_.expansion * shape_.wall_radius() * rise / area);
  }
  return out;
}

}  // namespace whirl::thermal
