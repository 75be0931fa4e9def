// A solid and the film beside it: the terms of their common matrix.
#include "thermal/solid_parts.hpp"
#include "whirl/core/agree.hpp"

namespace whirl::thermal {

using core::check;

void Solid::join(const std::vector<double>& film) {
  core::agree(comm_, [&] { core::require(film.size() == wall_.size(), "a conductance for each column of the film"); });
  const core::Vector sum = core::duplicate(diagonal_.get());
  check(VecCopy(diagonal_.get(), sum.get()));
  {
    const core::WriteArray d(sum.get());
    for (std::size_t c = 0; c < wall_.size(); ++c) {
      joined_[c] = film[c] > 0 ? 1 / (1 / film[c] + resistance_[c]) : 0;
      if (!held(wall_[c])) d[local(wall_[c])] += joined_[c];
    }
  }
  check(MatDiagonalSet(matrix_.get(), sum.get(), INSERT_VALUES));
}

void Solid::load(const std::vector<double>& film, Vec rhs) const {
  check(VecCopy(supply_.get(), rhs));
  const core::WriteArray b(rhs);
  for (std::size_t c = 0; c < wall_.size(); ++c)
    if (!held(wall_[c])) b[local(wall_[c])] += joined_[c] * film[c];
}

HeatCoupling Solid::couple(PetscInt cells, const std::vector<PetscInt>& film_cell) const {
  core::agree(comm_, [&] { core::require(film_cell.size() == wall_.size(), "a cell of the film for each column"); });
  // Columns, rows and the cells beside them lie on one rank.
  std::vector<PetscInt> of_solid(static_cast<std::size_t>(count()) + 1, 0),
      of_film(static_cast<std::size_t>(cells) + 1, 0);
  PetscInt first = 0;
  MPI_Exscan(&cells, &first, 1, MPIU_INT, MPI_SUM, comm_);
  if (core::rank_of(comm_) == 0) first = 0;
  for (std::size_t c = 0; c < wall_.size(); ++c) {
    ++of_solid[static_cast<std::size_t>(local(wall_[c]))];
    ++of_film[static_cast<std::size_t>(film_cell[c] - first)];
  }
  HeatCoupling out;
  check(MatCreateAIJ(comm_, count(), cells, PETSC_DETERMINE, PETSC_DETERMINE, 0, of_solid.data(), 0, nullptr,
                     out.solid_film.put()));
  check(MatCreateAIJ(comm_, cells, count(), PETSC_DETERMINE, PETSC_DETERMINE, 0, of_film.data(), 0, nullptr,
                     out.film_solid.put()));
  update(out, film_cell);
  return out;
}

void Solid::update(HeatCoupling& coupling, const std::vector<PetscInt>& film_cell) const {
  for (std::size_t c = 0; c < wall_.size(); ++c) {
    const double into = held(wall_[c]) ? 0 : -joined_[c];
    check(MatSetValue(coupling.solid_film.get(), wall_[c], film_cell[c], into, INSERT_VALUES));
    check(MatSetValue(coupling.film_solid.get(), film_cell[c], wall_[c], -joined_[c], INSERT_VALUES));
  }
  for (Mat m : {coupling.solid_film.get(), coupling.film_solid.get()}) {
    check(MatAssemblyBegin(m, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(m, MAT_FINAL_ASSEMBLY));
  }
}

}  // namespace whirl::thermal
