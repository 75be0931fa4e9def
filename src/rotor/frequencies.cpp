#include "whirl/rotor/frequencies.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "eigen.hpp"
#include "planar.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/hinges.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {
namespace {

using core::check;

// Order of magnitude of the lowest bending eigenvalue, from the mean of E I and of the mass.
double bending_scale(const Options& o) {
  double length = 0, bending = 0;
  for (const Segment& s : o.segments) {
    const Beam b = make_beam(section_at(s, 0.5), o.material, shear_of(o));
    length += b.length;
    bending += b.length * b.bending_stiffness;
  }
  return bending / (total_mass(o) * length * length * length * length);
}

// Motions of the shaft that strain nothing and leave the pinned nodes at rest, restricted to `free`.
std::vector<core::Vector> unstrained_motions(Vec layout, IS free, const Options& o, const std::vector<int>& pinned) {
  const Eigen::MatrixXd nodal = free_motions(o, pinned);
  std::vector<core::Vector> motions;
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(layout, &begin, &end));
  for (Eigen::Index m = 0; m < nodal.cols(); ++m) {
    core::Vector whole = core::duplicate(layout);
    {
      const core::WriteArray a(whole.get());
      // Inner freedoms stand behind the nodes and rest.
      for (PetscInt i = begin; i < end; ++i) a[i - begin] = i < nodal.rows() ? nodal(i, m) : 0.0;
    }
    Vec part = nullptr;
    check(VecGetSubVector(whole.get(), free, &part));
    core::Vector copy = core::duplicate(part);
    check(VecCopy(part, copy.get()));
    check(VecRestoreSubVector(whole.get(), free, &part));
    motions.push_back(std::move(copy));
  }
  return motions;
}

}  // namespace

std::vector<double> natural_frequencies(MPI_Comm comm, const Options& o, const std::vector<int>& pinned, int count) {
  core::agree(comm, [&] {
    validate(o);
    for (int node : pinned)
      if (node < 1 || node > n_nodes(o))
        throw core::InputError(fmt::format("rotor: pinned node {} is not in 1..{}", node, n_nodes(o)));
  });
  std::vector<int> held(pinned);
  std::sort(held.begin(), held.end());
  held.erase(std::unique(held.begin(), held.end()), held.end());

  const Planar planar = assemble_planar(comm, o);
  PetscInt begin = 0, end = 0;
  check(VecGetOwnershipRange(planar.weight.get(), &begin, &end));
  std::vector<PetscInt> kept;
  for (PetscInt i = begin; i < end; ++i)
    if (i % 2 == 1 || i >= 2 * n_nodes(o) || !std::binary_search(held.begin(), held.end(), static_cast<int>(i / 2) + 1))
      kept.push_back(i);
  core::IndexSet free;
  check(ISCreateGeneral(comm, static_cast<PetscInt>(kept.size()), kept.data(), PETSC_COPY_VALUES, free.put()));
  core::Matrix k, m;
  check(MatCreateSubMatrix(planar.stiffness.get(), free.get(), free.get(), MAT_INITIAL_MATRIX, k.put()));
  check(MatCreateSubMatrix(planar.mass.get(), free.get(), free.get(), MAT_INITIAL_MATRIX, m.put()));

  const std::vector<core::Vector> rigid = unstrained_motions(planar.weight.get(), free.get(), o, held);
  std::vector<Vec> raw;
  for (const core::Vector& r : rigid) raw.push_back(r.get());
  // What strains nothing makes K singular: a negative shift of the order of the first bending eigenvalue helps.
  const double shift = raw.empty() ? 0.0 : -bending_scale(o);
  std::vector<double> frequencies = lowest_eigenvalues(k.get(), m.get(), shift, count, raw);
  // Nearly none: a stiffness may be as small as rounding.
  for (double& f : frequencies) f = std::sqrt(std::max(f, 0.0));
  return frequencies;
}

}  // namespace whirl::rotor
