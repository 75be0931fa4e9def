#include "whirl/rotor/rotor.hpp"

#include <algorithm>

#include "planar.hpp"
#include "reduction.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

using core::check;

Rotor::Rotor(MPI_Comm comm, const Options& options)
    : n_nodes_(rotor::n_nodes(options)), reduced_(options.reduction.type != Reduction::Type::none) {
  core::agree(comm, [&] { validate(options); });
  Planar planar = assemble_planar(comm, options);
  if (reduced_) {
    masters_ = options.reduction.masters;
    std::sort(masters_.begin(), masters_.end());
    const PlanarBasis basis = planar_basis(planar, options.reduction);
    quality_ = basis.quality;
    core::Vector offset = core::duplicate(planar.weight.get());
    {
      const core::WriteArray to(offset.get());
      for (PetscInt i = 0; i < to.size(); ++i) to[i] = basis.offset(i);
    }
    matrices_.offset = doubled_vertical(offset.get(), -1);
    matrices_.basis = doubled(to_matrix(basis, comm).get(), both_planes);
    Planar small;
    small.mass = project(planar.mass.get(), basis);
    small.gyroscopic = project(planar.gyroscopic.get(), basis);
    small.stiffness = project(planar.stiffness.get(), basis);
    small.weight = project(planar.weight.get(), basis);
    planar = std::move(small);
  }
  matrices_.mass = doubled(planar.mass.get(), both_planes);
  matrices_.gyroscopic = doubled(planar.gyroscopic.get(), across_planes);
  matrices_.stiffness = doubled(planar.stiffness.get(), both_planes);
  check(MatDuplicate(matrices_.stiffness.get(), MAT_COPY_VALUES, matrices_.damping.put()));
  check(MatScale(matrices_.damping.get(), options.stiffness_damping));
  matrices_.gravity = doubled_vertical(planar.weight.get(), -1);
  check(VecGetSize(matrices_.gravity.get(), &size_));
}

PetscInt Rotor::coordinate(int node, int direction) const {
  core::require(node >= 1 && node <= n_nodes_ && direction >= 0 && direction < 4, "rotor coordinate out of range");
  if (!reduced_) return 4 * (node - 1) + direction;
  const auto at = std::lower_bound(masters_.begin(), masters_.end(), node);
  if (direction > 1 || at == masters_.end() || *at != node) return -1;
  return 2 * static_cast<PetscInt>(at - masters_.begin()) + direction;
}

}  // namespace whirl::rotor
