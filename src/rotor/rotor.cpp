#include "whirl/rotor/rotor.hpp"

#include <algorithm>

#include "planar.hpp"
#include "reduction.hpp"
#include "state_basis.hpp"
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

// The matrix that the first rank has, with rows and columns here as told.
core::Matrix distributed(const Eigen::MatrixXd& first, PetscInt rows, PetscInt columns, MPI_Comm comm) {
  PetscInt shape[2] = {rows, columns}, end = 0;
  MPI_Allreduce(MPI_IN_PLACE, shape, 2, MPIU_INT, MPI_SUM, comm);
  MPI_Scan(&rows, &end, 1, MPIU_INT, MPI_SUM, comm);
  Eigen::MatrixXd all = core::rank_of(comm) == 0 ? first : Eigen::MatrixXd(shape[0], shape[1]);
  core::share(comm, all.data(), static_cast<std::size_t>(all.size()));
  return matrix_of(all.middleRows(end - rows, rows), columns, comm);
}

// The same of a square one, zeros too: matrices of varying shafts keep their pattern.
core::Matrix filled(const Eigen::MatrixXd& first, PetscInt local, MPI_Comm comm) {
  PetscInt n = 0, end = 0;
  MPI_Allreduce(&local, &n, 1, MPIU_INT, MPI_SUM, comm);
  MPI_Scan(&local, &end, 1, MPIU_INT, MPI_SUM, comm);
  Eigen::MatrixXd all = core::rank_of(comm) == 0 ? first : Eigen::MatrixXd(n, n);
  core::share(comm, all.data(), static_cast<std::size_t>(all.size()));
  core::Matrix out = core::make_matrix(comm, local, std::vector<PetscInt>(static_cast<std::size_t>(local), n));
  for (PetscInt i = end - local; i < end; ++i)
    for (PetscInt j = 0; j < n; ++j) check(MatSetValue(out.get(), i, j, all(i, j), INSERT_VALUES));
  check(MatAssemblyBegin(out.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(out.get(), MAT_FINAL_ASSEMBLY));
  return out;
}

core::Vector distributed(const Eigen::VectorXd& first, PetscInt local, MPI_Comm comm) {
  core::Vector out = core::make_vector(comm, local, PETSC_DETERMINE);
  PetscInt n = 0;
  check(VecGetSize(out.get(), &n));
  std::vector<double> all(static_cast<std::size_t>(n));
  if (core::rank_of(comm) == 0) Eigen::Map<Eigen::VectorXd>(all.data(), n) = first;
  core::share(comm, all.data(), all.size());
  core::fill(out.get(), all);
  return out;
}

}  // namespace

Rotor::Rotor(MPI_Comm comm, const Options& options)
    : n_nodes_(rotor::n_nodes(options)),
      rigid_(options.type == Options::Type::rigid),
      reduced_(!rigid_ && options.reduction.type != Reduction::Type::none) {
  core::agree(comm, [&] { validate(options); });
  if (!rigid_ && options.reduction.type == Reduction::Type::craig_bampton_state) {
    reduce_states(comm, options);
    return;
  }
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

// The first rank computes for all.
void Rotor::reduce_states(MPI_Comm comm, const Options& options) {
  masters_ = planar_masters(options.reduction);
  StateBasis basis;
  StateProjection small;
  PetscInt whole = 0;
  core::agree(comm, [&] {
    if (core::rank_of(comm) != 0) return;
    const Planar planar = assemble_planar(PETSC_COMM_SELF, options);
    basis = state_basis(planar, options);
    small = project(planar, options, basis);
    whole = static_cast<PetscInt>(basis.offset.size());
  });
  MPI_Bcast(&whole, 1, MPIU_INT, 0, comm);
  size_ = 2 * (static_cast<PetscInt>(masters_.size()) + options.reduction.modes);
  PetscInt pairs = PETSC_DECIDE, rows = PETSC_DECIDE, n = size_;
  check(PetscSplitOwnership(comm, &pairs, &n));
  check(PetscSplitOwnership(comm, &rows, &whole));
  states_.emplace();
  states_->rates = filled(small.rates, 2 * pairs, comm);
  states_->at_rest = filled(small.at_rest, 2 * pairs, comm);
  states_->turning = filled(small.turning, 2 * pairs, comm);
  states_->gravity = distributed(small.gravity, 2 * pairs, comm);
  states_->across = distributed(small.across, 2 * pairs, comm);
  states_->displacement = distributed(basis.displacement, rows, 2 * pairs, comm);
  states_->velocity = distributed(basis.velocity, rows, 2 * pairs, comm);
  states_->forces = distributed(basis.left_velocity, rows, 2 * pairs, comm);
  states_->offset = distributed(basis.offset, rows, comm);
  double quality[] = {basis.quality.retained, basis.quality.neglected};
  core::share(comm, quality, 2);
  quality_ = {quality[0], quality[1]};
}

core::Vector turned(Vec pairs) {
  core::Vector out = core::duplicate(pairs);
  const std::vector<double> from = core::gather(pairs);  // a rank may own half a pair
  PetscInt begin = 0;
  check(VecGetOwnershipRange(out.get(), &begin, nullptr));
  const core::WriteArray to(out.get());
  for (PetscInt i = 0; i < to.size(); ++i) {
    const auto at = static_cast<std::size_t>(begin + i);
    to[i] = at % 2 == 0 ? -from[at + 1] : from[at - 1];
  }
  return out;
}

core::Vector across(const Rotor& rotor) {
  if (!rotor.states()) return turned(rotor.matrices().gravity.get());
  core::Vector out = core::duplicate(rotor.states()->across.get());
  check(VecCopy(rotor.states()->across.get(), out.get()));
  return out;
}

void Rotor::set_stiffness_damping(double value) {
  core::require(!states_, "a rotor whose modes do not depend on its damping");
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
