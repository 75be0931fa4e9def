#include "whirl/rotor/rotor.hpp"

#include <algorithm>

#include "planar.hpp"
#include "reduction.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {

using core::check;

namespace {

// A mass without stiffness in one plane, on the first rank. Zeros are stored too: they are in the pattern of the
// system.
Planar rigid_planar(MPI_Comm comm, double mass) {
  const PetscInt local = core::rank_of(comm) == 0 ? 1 : 0;
  const auto matrix = [&](double value) {
    core::Matrix m;
    check(MatCreateAIJ(comm, local, local, 1, 1, 1, nullptr, 0, nullptr, m.put()));
    if (local > 0) check(MatSetValue(m.get(), 0, 0, value, INSERT_VALUES));
    check(MatAssemblyBegin(m.get(), MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(m.get(), MAT_FINAL_ASSEMBLY));
    return m;
  };
  Planar p{matrix(mass), matrix(0), matrix(0), core::make_vector(comm, local, 1), {}};
  check(VecSet(p.weight.get(), mass));
  return p;
}

}  // namespace

Rotor::Rotor(MPI_Comm comm, const Options& options)
    : n_nodes_(rotor::n_nodes(options)),
      rigid_(options.type == Options::Type::rigid),
      reduced_(!rigid_ && options.reduction.type != Reduction::Type::none) {
  core::agree(comm, [&] { validate(options); });
  Planar planar = rigid_ ? rigid_planar(comm, options.mass) : assemble_planar(comm, options);
  if (reduced_) {
    masters_ = planar_masters(options.reduction);
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
    if (planar.damping) small.damping = project(planar.damping.get(), basis);
    planar = std::move(small);
  }
  matrices_.mass = doubled(planar.mass.get(), both_planes);
  matrices_.gyroscopic = doubled(planar.gyroscopic.get(), across_planes);
  matrices_.stiffness = doubled(planar.stiffness.get(), both_planes);
  check(MatDuplicate(matrices_.stiffness.get(), MAT_DO_NOT_COPY_VALUES, matrices_.damping.put()));
  if (!rigid_ && (options.internal_damping > 0 || options.loss_factor > 0 || planar.damping)) {
    internal_damping_ = options.internal_damping;
    matrices_.circulatory = doubled(planar.stiffness.get(), across_planes);
    check(MatScale(matrices_.circulatory.get(), internal_damping_));
  }
  if (planar.damping) {
    couplings_ = doubled(planar.damping.get(), both_planes);
    check(MatAXPY(matrices_.circulatory.get(), 1, doubled(planar.damping.get(), across_planes).get(),
                  SUBSET_NONZERO_PATTERN));
  }
  set_stiffness_damping(options.stiffness_damping);
  matrices_.gravity = doubled_vertical(planar.weight.get(), -1);
  check(VecGetSize(matrices_.gravity.get(), &size_));
}

void Rotor::set_stiffness_damping(double value) {
  check(MatCopy(matrices_.stiffness.get(), matrices_.damping.get(), SAME_NONZERO_PATTERN));
  check(MatScale(matrices_.damping.get(), value + internal_damping_));
  if (couplings_) check(MatAXPY(matrices_.damping.get(), 1, couplings_.get(), SUBSET_NONZERO_PATTERN));
}

PetscInt Rotor::coordinate(int node, Freedom freedom) const {
  core::require(node >= 1 && node <= n_nodes_, "a node of the rotor");
  if (rigid_) return is_slope(freedom) ? -1 : static_cast<PetscInt>(freedom);
  const int whole = full_coordinate(node, freedom);
  if (!reduced_) return whole;
  // A plane has every second freedom.
  const auto at = std::lower_bound(masters_.begin(), masters_.end(), whole / 2);
  if (at == masters_.end() || *at != whole / 2) return -1;
  return 2 * static_cast<PetscInt>(at - masters_.begin()) + whole % 2;
}

std::optional<Freedom> Rotor::freedom(PetscInt coordinate) const {
  const auto pair = static_cast<std::size_t>(coordinate / 2);
  if (!reduced_ && !rigid_ && coordinate >= freedoms_per_node * n_nodes_) return std::nullopt;
  if (reduced_ && pair >= masters_.size()) return std::nullopt;
  const int planar = reduced_ ? masters_[pair] : static_cast<int>(coordinate / 2);
  return freedom_at(2 * planar + static_cast<int>(coordinate % 2));
}

}  // namespace whirl::rotor
