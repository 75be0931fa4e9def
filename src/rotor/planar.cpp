#include "planar.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "inner.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {
namespace {

using core::check;

// A node couples with itself and its two neighbours; neighbours of the first and last owned node may be elsewhere.
core::Matrix make_chain_matrix(MPI_Comm comm, PetscInt local_nodes, PetscInt first, PetscInt nodes) {
  std::vector<PetscInt> here, elsewhere;
  for (PetscInt node = first; node < first + local_nodes; ++node) {
    PetscInt inside = 2, outside = 0;
    if (node > 0) (node > first ? inside : outside) += 2;
    if (node < nodes - 1) (node < first + local_nodes - 1 ? inside : outside) += 2;
    here.insert(here.end(), 2, inside);
    elsewhere.insert(elsewhere.end(), 2, outside);
  }
  core::Matrix m;
  check(MatCreateAIJ(comm, 2 * local_nodes, 2 * local_nodes, 2 * nodes, 2 * nodes, 0, here.data(), 0, elsewhere.data(),
                     m.put()));
  return m;
}

// The planar freedoms of a segment: of its two nodes, then its inner ones, which stand behind all nodes.
std::vector<PetscInt> freedoms_of(PetscInt node, PetscInt nodal, const std::vector<int>& inner) {
  std::vector<PetscInt> at{2 * node, 2 * node + 1, 2 * node + 2, 2 * node + 3};
  for (const int k : inner) at.push_back(nodal + k);
  return at;
}

// The planar freedoms that a disc moves with: of its node, then of the ends of its hub.
std::vector<PetscInt> freedoms_of(const Disc& disc) {
  if (disc.hub.empty()) return {2 * (disc.node - 1), 2 * (disc.node - 1) + 1};
  return {2 * (disc.node - 1), 2 * (disc.hub[0] - 1), 2 * (disc.hub[1] - 1)};
}

core::Matrix make_enriched_matrix(MPI_Comm comm, PetscInt local_nodes, PetscInt first, PetscInt nodes,
                                  PetscInt inner_here, const Inner& inner, const std::vector<Disc>& discs) {
  const PetscInt begin = 2 * first, local = 2 * local_nodes + inner_here;
  std::vector<std::set<PetscInt>> columns(static_cast<std::size_t>(local));
  for (PetscInt i = 0; i < local; ++i) columns[static_cast<std::size_t>(i)].insert(begin + i);
  const auto join = [&](const std::vector<PetscInt>& at) {
    for (const PetscInt row : at)
      if (row >= begin && row < begin + local)
        columns[static_cast<std::size_t>(row - begin)].insert(at.begin(), at.end());
  };
  for (PetscInt node = 0; node < nodes - 1; ++node)
    join(freedoms_of(node, 2 * nodes, inner.of(static_cast<std::size_t>(node))));
  for (const Disc& d : discs) join(freedoms_of(d));
  std::vector<PetscInt> here, elsewhere;
  for (const std::set<PetscInt>& c : columns) {
    const auto inside = std::distance(c.lower_bound(begin), c.lower_bound(begin + local));
    here.push_back(static_cast<PetscInt>(inside));
    elsewhere.push_back(static_cast<PetscInt>(c.size()) - here.back());
  }
  const PetscInt all = 2 * nodes + inner.count;
  core::Matrix m;
  check(MatCreateAIJ(comm, local, local, all, all, 0, here.data(), 0, elsewhere.data(), m.put()));
  return m;
}

void add_general(const Planar& p, const ElementMatrices& e, PetscInt node, PetscInt nodal,
                 const std::vector<int>& inner) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const std::vector<PetscInt> at = freedoms_of(node, nodal, inner);
  const auto n = static_cast<PetscInt>(at.size());
  const auto put = [&](const core::Matrix& m, const RowMajor& values) {
    check(MatSetValues(m.get(), n, at.data(), n, at.data(), values.data(), ADD_VALUES));
  };
  put(p.mass, e.translational_mass + e.rotary_mass);
  put(p.gyroscopic, 2 * e.rotary_mass);
  put(p.stiffness, e.stiffness);
  if (e.damping.size() > 0) put(p.damping, e.damping);
  check(VecSetValues(p.weight.get(), n, at.data(), e.weight.data(), ADD_VALUES));
}

// Displacement of the centre of mass u + offset t and tilt t of the disc, in planar freedoms; t is the slope of the
// section, or that of the line through the ends of the hub.
void add(const Planar& p, const Options& o, const Disc& given) {
  const Disc disc = resolved(given, o.material);
  const std::vector<PetscInt> at = freedoms_of(disc);
  const auto n = static_cast<PetscInt>(at.size());
  Eigen::VectorXd tilt = Eigen::VectorXd::Zero(n);
  if (disc.hub.empty()) {
    tilt(1) = 1;
  } else {
    const double length = hub_length(disc, o);
    tilt(1) = -1 / length;
    tilt(2) = 1 / length;
  }
  Eigen::VectorXd centre = disc.offset * tilt;
  centre(0) += 1;
  // Symmetric: rows or columns first is the same.
  const auto put = [&](const core::Matrix& m, const Eigen::MatrixXd& values) {
    check(MatSetValues(m.get(), n, at.data(), n, at.data(), values.data(), ADD_VALUES));
  };
  put(p.mass, disc.mass * centre * centre.transpose() + disc.diametral_inertia * tilt * tilt.transpose());
  put(p.gyroscopic, disc.polar_inertia * tilt * tilt.transpose());
  const Eigen::VectorXd weight = disc.mass * centre;
  check(VecSetValues(p.weight.get(), n, at.data(), weight.data(), ADD_VALUES));
}

void add(Mat m, const std::array<PetscInt, 4>& at, const Eigen::Matrix4d& values) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = values;
  check(MatSetValues(m, 4, at.data(), 4, at.data(), rows.data(), ADD_VALUES));
}

}  // namespace

Planar assemble_planar(MPI_Comm comm, const Options& o) {
  PetscInt local = PETSC_DECIDE, nodes = n_nodes(o), end = 0;
  check(PetscSplitOwnership(comm, &local, &nodes));
  MPI_Scan(&local, &end, 1, MPIU_INT, MPI_SUM, comm);
  const PetscInt first = end - local;

  Planar p;
  const Inner inner = inner_freedoms(o);
  const PetscInt inner_here = core::rank_of(comm) == core::size_of(comm) - 1 ? inner.count : 0;
  const bool chain =
      inner.count == 0 && std::all_of(o.discs.begin(), o.discs.end(), [](const Disc& d) { return d.hub.empty(); });
  const bool damped = std::any_of(o.couplings.begin(), o.couplings.end(),
                                  [](const Coupling& c) { return c.damping > 0 || c.tilt_damping > 0; });
  std::vector<core::Matrix*> all{&p.mass, &p.gyroscopic, &p.stiffness};
  if (damped) all.push_back(&p.damping);
  for (core::Matrix* m : all)
    *m = chain ? make_chain_matrix(comm, local, first, nodes)
               : make_enriched_matrix(comm, local, first, nodes, inner_here, inner, o.discs);
  p.weight = core::make_vector(comm, 2 * local + inner_here, 2 * nodes + inner.count);

  for (PetscInt node = first; node < end && node < nodes - 1; ++node) {
    const auto k = static_cast<std::size_t>(node);
    if (!inner.of_segment.empty() || tapered(o.segments[k]) || coupling_at(o, k)) {
      add_general(p, element_matrices(o, k), node, 2 * nodes, inner.of(k));
      continue;
    }
    const Beam beam = make_beam(o.segments[k], o.material, shear_of(o));
    const std::array<PetscInt, 4> at{2 * node, 2 * node + 1, 2 * node + 2, 2 * node + 3};
    const Eigen::Matrix4d rotary = rotary_mass(beam);
    add(p.mass.get(), at, translational_mass(beam) + rotary);
    add(p.gyroscopic.get(), at, 2 * rotary);
    add(p.stiffness.get(), at, stiffness(beam));
    const Eigen::Vector4d f = weight(beam);
    check(VecSetValues(p.weight.get(), 4, at.data(), f.data(), ADD_VALUES));
  }
  for (const Disc& disc : o.discs)
    if (disc.node > first && disc.node <= end) add(p, o, disc);
  for (const core::Matrix* m : all) {
    check(MatAssemblyBegin(m->get(), MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(m->get(), MAT_FINAL_ASSEMBLY));
  }
  check(VecAssemblyBegin(p.weight.get()));
  check(VecAssemblyEnd(p.weight.get()));
  return p;
}

core::Matrix doubled(Mat planar, const Pattern& t) {
  PetscInt rows = 0, columns = 0, row_begin = 0, row_end = 0, column_begin = 0, column_end = 0;
  check(MatGetLocalSize(planar, &rows, &columns));
  check(MatGetOwnershipRange(planar, &row_begin, &row_end));
  check(MatGetOwnershipRangeColumn(planar, &column_begin, &column_end));
  const std::array<std::array<double, 2>, 2> factor{{{t.xx, t.xy}, {t.yx, t.yy}}};

  std::vector<PetscInt> here, elsewhere;
  for (PetscInt i = row_begin; i < row_end; ++i) {
    PetscInt n = 0, inside = 0;
    const PetscInt* at = nullptr;
    check(MatGetRow(planar, i, &n, &at, nullptr));
    for (PetscInt k = 0; k < n; ++k) inside += at[k] >= column_begin && at[k] < column_end;
    for (const auto& f : factor) {
      const PetscInt per_entry = (f[0] != 0) + (f[1] != 0);
      here.push_back(per_entry * inside);
      elsewhere.push_back(per_entry * (n - inside));
    }
    check(MatRestoreRow(planar, i, &n, &at, nullptr));
  }

  MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(planar));
  core::Matrix m;
  check(MatCreateAIJ(comm, 2 * rows, 2 * columns, PETSC_DETERMINE, PETSC_DETERMINE, 0, here.data(), 0, elsewhere.data(),
                     m.put()));
  std::vector<PetscInt> at;
  std::vector<double> values;
  for (PetscInt i = row_begin; i < row_end; ++i) {
    PetscInt n = 0;
    const PetscInt* columns_of_row = nullptr;
    const PetscScalar* a = nullptr;
    check(MatGetRow(planar, i, &n, &columns_of_row, &a));
    for (PetscInt d = 0; d < 2; ++d) {
      at.clear();
      values.clear();
      for (PetscInt k = 0; k < n; ++k)
        for (PetscInt e = 0; e < 2; ++e)
          if (const double f = factor[static_cast<std::size_t>(d)][static_cast<std::size_t>(e)]; f != 0) {
            at.push_back(2 * columns_of_row[k] + e);
            values.push_back(f * a[k]);
          }
      const PetscInt row = 2 * i + d;
      check(MatSetValues(m.get(), 1, &row, static_cast<PetscInt>(at.size()), at.data(), values.data(), INSERT_VALUES));
    }
    check(MatRestoreRow(planar, i, &n, &columns_of_row, &a));
  }
  check(MatAssemblyBegin(m.get(), MAT_FINAL_ASSEMBLY));
  check(MatAssemblyEnd(m.get(), MAT_FINAL_ASSEMBLY));
  return m;
}

core::Vector doubled_vertical(Vec planar, double scale) {
  const core::ReadArray from(planar);
  core::Vector v =
      core::make_vector(PetscObjectComm(reinterpret_cast<PetscObject>(planar)), 2 * from.size(), PETSC_DETERMINE);
  const core::WriteArray to(v.get());
  for (PetscInt i = 0; i < from.size(); ++i) to[2 * i + 1] = scale * from[i];
  return v;
}

void make_direct(KSP ksp) {
  PC pc = nullptr;
  check(KSPSetType(ksp, KSPPREONLY));
  check(KSPGetPC(ksp, &pc));
  check(PCSetType(pc, PCLU));
  if (core::size_of(PetscObjectComm(reinterpret_cast<PetscObject>(ksp))) > 1)
    check(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
}

core::LinearSolver direct_solver(Mat matrix) {
  core::LinearSolver ksp;
  check(KSPCreate(PetscObjectComm(reinterpret_cast<PetscObject>(matrix)), ksp.put()));
  make_direct(ksp.get());
  check(KSPSetOperators(ksp.get(), matrix, matrix));
  check(KSPSetErrorIfNotConverged(ksp.get(), PETSC_TRUE));
  check(KSPSetOptionsPrefix(ksp.get(), "rotor_"));
  check(KSPSetFromOptions(ksp.get()));
  check(KSPSetUp(ksp.get()));
  return ksp;
}

}  // namespace whirl::rotor
