#include <algorithm>
#include <cmath>

#include "film_part.hpp"
#include "settling.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/direct_solver.hpp"
#include "whirl/core/error.hpp"
#include "whirl/system/rotor_system.hpp"

// Films that find their state by whole steps of Newton's method while the machine stays where it is.

namespace whirl::system {

using core::check;

bool RotorSystem::settles() const {
  return std::any_of(bearings_.begin(), bearings_.end(), [](const Bearing& b) { return b.part->settles(); });
}

void RotorSystem::settle(Vec x) {
  if (core::size_of(comm_) > 1) return settle_together(x);
  const std::vector<JournalState> journals = journals_of(gather_inputs(x));
  core::agree(comm_, [&] {
    const core::WriteArray xa(x);
    for (std::size_t i = 0; i < bearings_.size(); ++i) {
      const FilmPart* part = bearings_[i].part.get();
      if (!part->settles()) continue;
      const std::span<const double> present = part->of(xa.data());
      std::vector<double> states(present.begin(), present.end());
      film::relax(part->film(), motion(journals[i]), states);
      std::copy(states.begin(), states.end(), xa.data() + part->row());
    }
  });
}

RotorSystem::Settling& RotorSystem::settling() {
  if (settling_) return *settling_;
  settling_ = std::make_unique<Settling>();
  Settling& s = *settling_;
  const PetscInt machine = local_size() - own_here_;
  std::vector<PetscInt> count(static_cast<std::size_t>(local_size()), 1);
  for (const Bearing& b : bearings_)
    if (b.part->settles()) b.part->count_own_entries(count);
  count.erase(count.begin(), count.begin() + machine);
  s.matrix = core::make_matrix(comm_, own_here_, std::move(count));
  s.residual = core::make_vector(comm_, own_here_, PETSC_DETERMINE);
  s.step = core::duplicate(s.residual.get());
  s.rest = core::make_vector(comm_, local_size(), PETSC_DETERMINE);
  s.solver = core::make_direct_solver(comm_, "settle_");
  return s;
}

// All films at once, each found when its own step is small: as film::relax does with one film on one rank.
void RotorSystem::settle_together(Vec x) {
  constexpr int most_steps = 60;
  constexpr double enough = 1e-10;  // of the typical state
  Settling& s = settling();
  const PetscInt machine = local_size() - own_here_;
  PetscInt first = 0;
  check(MatGetOwnershipRange(s.matrix.get(), &first, nullptr));
  for (int k = 0; k < most_steps; ++k) {
    evaluate_films(x, s.rest.get(), film::Need::tangents);
    check(MatZeroEntries(s.matrix.get()));
    {
      const core::WriteArray r(s.residual.get());
      std::fill_n(r.data(), own_here_, 0.0);
      for (std::size_t i = 0; i < bearings_.size(); ++i) {
        const FilmPart* part = bearings_[i].part.get();
        if (part->rows() == 0) continue;
        const PetscInt row = part->row() - machine;
        if (!part->settles()) {
          for (PetscInt j = first + row; j < first + row + part->rows(); ++j)
            check(MatSetValue(s.matrix.get(), j, j, 1, ADD_VALUES));
          continue;
        }
        const film::StateResponse& own = part->response();
        std::copy(own.residual.begin(), own.residual.end(), r.data() + row);
        film::for_entries(part->share(), part->share().d_states, own.d_states, [&](int at, int column, double value) {
          check(MatSetValue(s.matrix.get(), first + row + at, part->first() + column, value, ADD_VALUES));
        });
      }
    }
    check(MatAssemblyBegin(s.matrix.get(), MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(s.matrix.get(), MAT_FINAL_ASSEMBLY));
    check(KSPSetOperators(s.solver.get(), s.matrix.get(), s.matrix.get()));
    check(KSPSolve(s.solver.get(), s.residual.get(), s.step.get()));
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    check(KSPGetConvergedReason(s.solver.get(), &reason));
    if (reason < 0) throw core::NotConverged("a film by itself is singular");

    std::vector<double> moved(bearings_.size(), 0.0);
    {
      const core::WriteArray xa(x);
      const core::ReadArray step(s.step.get());
      for (std::size_t i = 0; i < bearings_.size(); ++i) {
        const FilmPart* part = bearings_[i].part.get();
        if (!part->settles()) continue;
        for (const problem::Field& f : part->fields({}))
          for (PetscInt j = f.begin; j < f.end; ++j) {
            xa[j] -= step[j - machine];
            moved[i] += std::pow(step[j - machine] / f.scale, 2);
          }
      }
    }
    MPI_Allreduce(MPI_IN_PLACE, moved.data(), static_cast<int>(moved.size()), MPI_DOUBLE, MPI_SUM, comm_);
    bool all = true;
    for (std::size_t i = 0; i < bearings_.size(); ++i)
      if (const FilmPart* part = bearings_[i].part.get(); part->settles())
        all = all && std::sqrt(moved[i]) <= enough * std::sqrt(static_cast<double>(part->count()));
    if (all) return;
  }
  throw core::NotConverged("the films by themselves did not settle");
}

}  // namespace whirl::system
