// Mesh and matrix of conduction in a solid.
#include "whirl/thermal/solid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "thermal/solid_parts.hpp"
#include "whirl/core/agree.hpp"

namespace whirl::thermal {

using core::check;

Solid::Solid(const Rows& film, Cylinder shape, const Material& material, const Surfaces& surfaces, std::string prefix)
    : film_(film.mesh()),
      comm_(film.comm()),
      shape_(std::move(shape)),
      material_(material),
      surfaces_(surfaces),
      prefix_(std::move(prefix)),
      film_begin_(film.begin()),
      film_end_(film.end()) {
  const Surface& free = shape_.outside ? surfaces_.inner : surfaces_.outer;
  core::agree(comm_, [&] {
    if (shape_.axisymmetric() && free.kind == Surface::Kind::prescribed)
      throw core::InputError("the free surface of a rotating journal cannot have a prescribed temperature");
  });
  begin_ = film.begin() == 0 ? 0 : film.begin() + shape_.film_row;
  end_ = film.end() == film_.nodes_along() ? shape_.rows() : film.end() + shape_.film_row;
  place_walls();
  assemble();
  assemble_reactions();
}

void Solid::place_walls() {
  const int k = shape_.wall_layer();
  const double ratio = std::abs(std::log(shape_.centre(k) / shape_.wall_radius()));
  for (int j = film_begin_; j < film_end_; ++j)
    for (int i = 0; i < film_.nodes_around(); ++i) {
      wall_.push_back(cell(k, shape_.axisymmetric() ? 0 : i, j + shape_.film_row));
      const double angle = film_.width(i) / film_.radius;
      resistance_.push_back(ratio / (material_.conductivity * angle * film_.depth(j)));
    }
  joined_.assign(wall_.size(), 0.0);
}

// m^2 of the face at the wall that the film wets.
double Solid::covered(int i, int q) const {
  const int j = q - shape_.film_row;
  if (j < 0 || j >= film_.nodes_along()) return 0;
  if (shape_.axisymmetric()) return film_.radius * film_.extent * film_.depth(j);
  return i < film_.nodes_around() ? film_.width(i) * film_.depth(j) : 0;
}

const Surface* Solid::prescribed_end(int q) const {
  const auto of = [](const Surface& s) { return s.kind == Surface::Kind::prescribed ? &s : nullptr; };
  if (q == 0 && of(surfaces_.begin)) return &surfaces_.begin;
  return q == shape_.rows() - 1 ? of(surfaces_.end) : nullptr;
}

bool Solid::held(PetscInt cell) const {
  return prescribed_end(static_cast<int>(cell / row_cells())) != nullptr;
}

void Solid::assemble() {
  const PetscInt n = count();
  std::vector<PetscInt> here(static_cast<std::size_t>(n) + 1, 1), there(static_cast<std::size_t>(n) + 1, 0);
  each_cell(*this, [&](int k, int i, int q) {
    if (prescribed_end(q)) return;
    const auto at = static_cast<std::size_t>(local(cell(k, i, q)));
    each_neighbour(k, i, q, [&](int, int, int other, double) {
      if (!prescribed_end(other)) ++(other < begin_ || other >= end_ ? there : here)[at];
    });
  });
  check(MatCreate(comm_, matrix_.put()));
  check(MatSetSizes(matrix_.get(), n, n, PETSC_DETERMINE, PETSC_DETERMINE));
  check(MatSetType(matrix_.get(), MATAIJ));
  check(MatSeqAIJSetPreallocation(matrix_.get(), 0, here.data()));
  check(MatMPIAIJSetPreallocation(matrix_.get(), 0, here.data(), 0, there.data()));
  check(MatSetOption(matrix_.get(), MAT_SPD, PETSC_TRUE));
  supply_ = core::make_vector(comm_, n, PETSC_DETERMINE);
  diagonal_ = core::make_vector(comm_, n, PETSC_DETERMINE);
  int grounded = 0;
  {
    const core::WriteArray supply(supply_.get()), diagonal(diagonal_.get());
    std::vector<PetscInt> columns;
    std::vector<double> values;
    each_cell(*this, [&](int k, int i, int q) {
      const PetscInt row = cell(k, i, q);
      const Surface* const end = prescribed_end(q);
      columns.assign(1, row);
      values.assign(1, 0.0);
      double in = 0;
      each_neighbour(k, i, q, [&](int k2, int i2, int q2, double g) {
        values[0] += g;
        const Surface* const beside = prescribed_end(q2);
        if (end) return;
        if (beside) in += g * beside->temperature;
        if (beside) return;
        columns.push_back(cell(k2, i2, q2));
        values.push_back(-g);
      });
      if (!end)
        each_surface(k, i, q, [&](const Exposed& s) {
          values[0] += s.conductance;
          in += s.conductance * s.temperature;
          grounded = 1;
        });
      if (end) grounded = 1;
      supply[local(row)] = end ? values[0] * end->temperature : in;
      diagonal[local(row)] = values[0];
      check(MatSetValues(matrix_.get(), 1, &row, static_cast<PetscInt>(columns.size()), columns.data(), values.data(),
                         INSERT_VALUES));
    });
  }
  check(MatAssemblyBegin(matrix_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(matrix_.get(), MAT_FINAL_ASSEMBLY));
  MPI_Allreduce(MPI_IN_PLACE, &grounded, 1, MPI_INT, MPI_MAX, comm_);
  grounded_ = grounded != 0;
}

// What flows into cells of prescribed temperature from their neighbours leaves through the end.
void Solid::assemble_reactions() {
  if (surfaces_.begin.kind != Surface::Kind::prescribed && surfaces_.end.kind != Surface::Kind::prescribed) return;
  PetscInt rows = 0;
  each_cell(*this, [&](int, int, int q) { rows += prescribed_end(q) != nullptr; });
  check(MatCreateAIJ(comm_, rows, count(), PETSC_DETERMINE, PETSC_DETERMINE, 7, nullptr, 7, nullptr, reactions_.put()));
  check(MatSetOption(reactions_.get(), MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  PetscInt row = 0;
  check(MatGetOwnershipRange(reactions_.get(), &row, nullptr));
  each_cell(*this, [&](int k, int i, int q) {
    if (!prescribed_end(q)) return;
    each_neighbour(k, i, q, [&](int k2, int i2, int q2, double g) {
      const PetscInt columns[] = {cell(k2, i2, q2), cell(k, i, q)};
      const double values[] = {g, -g};
      check(MatSetValues(reactions_.get(), 1, &row, 2, columns, values, ADD_VALUES));
    });
    ++row;
  });
  check(MatAssemblyBegin(reactions_.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(reactions_.get(), MAT_FINAL_ASSEMBLY));
}

core::Vector Solid::capacity() const {
  core::Vector out = core::duplicate(supply_.get());
  const core::WriteArray a(out.get());
  each_cell(*this, [&](int k, int i, int q) {
    a[local(cell(k, i, q))] = material_.density * material_.heat_capacity * shape_.volume(k, i, q);
  });
  return out;
}

core::Vector Solid::temperature(double value) const {
  core::Vector out = core::duplicate(supply_.get());
  check(VecSet(out.get(), value));
  return out;
}

}  // namespace whirl::thermal
