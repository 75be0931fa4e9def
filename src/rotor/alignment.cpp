#include "whirl/rotor/alignment.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <set>

#include "planar.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/hinges.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {
namespace {

using core::check;
using core::InputError;

// Inner freedoms change nothing that is at rest: nodes move as the beam does, exactly, under forces at nodes and
// weight.
Options of_statics(Options o) {
  if (n_inner(o.element) > 0) o.element = BeamElement::timoshenko;
  return o;
}

// The shaft on rigid supports, factorised once: K with the rows and columns of the supports replaced by the identity.
class Supported {
public:
  Supported(MPI_Comm comm, const Options& o, const std::vector<RigidSupport>& supports)
      : options_(o), planar_(assemble_planar(comm, of_statics(o))) {
    for (const RigidSupport& s : supports) nodes_.push_back(s.node);
    std::vector<PetscInt> rows;
    for (int node : nodes_) rows.push_back(2 * (node - 1));
    check(MatDuplicate(planar_.stiffness.get(), MAT_COPY_VALUES, held_.put()));
    check(MatZeroRowsColumns(held_.get(), core::rank_of(comm) == 0 ? static_cast<PetscInt>(rows.size()) : 0,
                             rows.data(), 1.0, nullptr, nullptr));
    solver_ = direct_solver(held_.get());
    x_ = core::duplicate(planar_.weight.get());
    f_ = core::duplicate(x_.get());
  }

  // Block form with f free and s supported: K_ff u_f = f_f - K_fs u_s, reactions K_sf u_f + K_ss u_s - f_s.
  RigidStatic solve(const std::vector<double>& elevations, double gravity) {
    check(VecSet(x_.get(), 0));
    set_supports(x_.get(), elevations);
    check(MatMult(planar_.stiffness.get(), x_.get(), f_.get()));
    check(VecAYPX(f_.get(), -1, gravity_load(gravity).get()));
    set_supports(f_.get(), elevations);
    check(KSPSolve(solver_.get(), f_.get(), x_.get()));

    RigidStatic r;
    {
      const std::vector<double> u = core::gather(x_.get());
      for (std::size_t i = 0; i < u.size(); i += 2) {
        r.deflection.push_back(u[i]);
        r.slope.push_back(u[i + 1]);
      }
    }
    check(MatMult(planar_.stiffness.get(), x_.get(), f_.get()));
    check(VecAXPY(f_.get(), -1, gravity_load(gravity).get()));
    const std::vector<double> unbalanced = core::gather(f_.get());
    for (int node : nodes_) r.reactions.push_back(unbalanced[static_cast<std::size_t>(2 * (node - 1))]);
    r.moment = moments(r, gravity);
    return r;
  }

private:
  void set_supports(Vec v, const std::vector<double>& values) {
    PetscInt begin = 0, end = 0;
    check(VecGetOwnershipRange(v, &begin, &end));
    const core::WriteArray a(v);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const PetscInt row = 2 * (nodes_[i] - 1);
      if (row >= begin && row < end) a[row - begin] = values[i];
    }
  }

  core::Vector gravity_load(double gravity) const {
    core::Vector load = core::duplicate(planar_.weight.get());
    check(VecCopy(planar_.weight.get(), load.get()));
    check(VecScale(load.get(), -gravity));
    return load;
  }

  // End moments of the elements, K_e u_e - f_e: the one at the right end is the sagging moment, at the left its
  // negative.
  std::vector<double> moments(const RigidStatic& r, double gravity) const {
    std::vector<double> m;
    for (std::size_t e = 0; e < options_.segments.size(); ++e) {
      const ElementMatrices element = element_matrices(of_statics(options_), e);
      const Eigen::Matrix4d k = element.stiffness;
      const Eigen::Vector4d w = element.weight;
      const Eigen::Vector4d u(r.deflection[e], r.slope[e], r.deflection[e + 1], r.slope[e + 1]);
      const Eigen::Vector4d ends = k * u + gravity * w;
      if (e == 0) m.push_back(-ends(1));
      m.push_back(ends(3));
    }
    return m;
  }

  const Options& options_;
  Planar planar_;
  std::vector<int> nodes_;
  core::Matrix held_;
  core::LinearSolver solver_;
  core::Vector x_, f_;
};

void validate(const Options& o, const std::vector<RigidSupport>& supports) {
  rotor::validate(o);
  std::set<int> seen;
  for (const RigidSupport& s : supports) {
    if (s.node < 1 || s.node > n_nodes(o))
      throw InputError(fmt::format("alignment: support node {} is not in 1..{}", s.node, n_nodes(o)));
    if (!seen.insert(s.node).second) throw InputError(fmt::format("alignment: two supports at node {}", s.node));
  }
  if (supports.size() < 2) throw InputError("alignment: rigid supports must be at least two");
  if (const auto loose = loose_part(o, std::vector<int>(seen.begin(), seen.end())))
    throw InputError("alignment: " + words(*loose, o, "on rigid supports"));
}

void validate(const Options& o, const std::vector<RigidSupport>& supports, const AlignmentRule& rule) {
  validate(o, supports);
  auto in_list = [&](int s) {
    if (s < 1 || s > static_cast<int>(supports.size()))
      throw InputError(fmt::format("alignment: support {} is not in 1..{}", s, supports.size()));
  };
  for (int s : rule.adjustable) in_list(s);
  for (int s : rule.loaded) in_list(s);
  for (int node : rule.zero_moment_nodes)
    if (node < 1 || node > n_nodes(o))
      throw InputError(fmt::format("alignment: moment node {} is not in 1..{}", node, n_nodes(o)));
  if (rule.loads.size() != rule.loaded.size()) throw InputError("alignment: each loaded support needs one load");
  if (rule.adjustable.size() != rule.zero_moment_nodes.size() + rule.loaded.size())
    throw InputError(fmt::format("alignment: {} elevations are sought from {} conditions", rule.adjustable.size(),
                                 rule.zero_moment_nodes.size() + rule.loaded.size()));
}

// The left side of the conditions "= 0" and "= load".
Eigen::VectorXd conditions(const RigidStatic& r, const AlignmentRule& rule) {
  Eigen::VectorXd c(static_cast<Eigen::Index>(rule.adjustable.size()));
  Eigen::Index i = 0;
  for (int node : rule.zero_moment_nodes) c(i++) = r.moment[static_cast<std::size_t>(node - 1)];
  for (int s : rule.loaded) c(i++) = r.reactions[static_cast<std::size_t>(s - 1)];
  return c;
}

}  // namespace

RigidStatic rigid_static(MPI_Comm comm, const Options& options, const std::vector<RigidSupport>& supports,
                         double gravity) {
  core::agree(comm, [&] { validate(options, supports); });
  std::vector<double> elevations;
  for (const RigidSupport& s : supports) elevations.push_back(s.elevation);
  return Supported(comm, options, supports).solve(elevations, gravity);
}

std::vector<double> align(MPI_Comm comm, const Options& options, const std::vector<RigidSupport>& supports,
                          const AlignmentRule& rule, double gravity) {
  core::agree(comm, [&] { validate(options, supports, rule); });
  std::vector<double> elevations;
  for (const RigidSupport& s : supports) elevations.push_back(s.elevation);
  for (int s : rule.adjustable) elevations[static_cast<std::size_t>(s - 1)] = 0;
  const Eigen::Index n = static_cast<Eigen::Index>(rule.adjustable.size());
  if (n == 0) return elevations;

  Supported shaft(comm, options, supports);
  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(n);
  wanted.tail(static_cast<Eigen::Index>(rule.loads.size())) =
      Eigen::Map<const Eigen::VectorXd>(rule.loads.data(), static_cast<Eigen::Index>(rule.loads.size()));
  wanted -= conditions(shaft.solve(elevations, gravity), rule);

  Eigen::MatrixXd influence(n, n);  // of one metre of elevation
  for (Eigen::Index j = 0; j < n; ++j) {
    std::vector<double> unit(supports.size(), 0.0);
    unit[static_cast<std::size_t>(rule.adjustable[static_cast<std::size_t>(j)] - 1)] = 1;
    influence.col(j) = conditions(shaft.solve(unit, 0), rule);
  }
  // Lifting and tilting the whole shaft by one metre changes no load and no moment: what it changes is rounding.
  const std::vector<double> z = node_positions(options);
  std::vector<double> lift(supports.size(), 1.0), tilt;
  for (const RigidSupport& at : supports) tilt.push_back(z[static_cast<std::size_t>(at.node - 1)] / z.back());
  const Eigen::VectorXd rounding =
      conditions(shaft.solve(lift, 0), rule).cwiseAbs().cwiseMax(conditions(shaft.solve(tilt, 0), rule).cwiseAbs());
  // Moments and loads have different sizes: rows are scaled before the rank is judged.
  for (Eigen::Index i = 0; i < n; ++i) {
    const double size = influence.row(i).cwiseAbs().maxCoeff();
    if (size <= 1e3 * rounding(i)) {
      influence.row(i).setZero();
      continue;
    }
    influence.row(i) /= size;
    wanted(i) /= size;
  }
  Eigen::FullPivLU<Eigen::MatrixXd> lu(influence);
  lu.setThreshold(1e-9);
  if (!lu.isInvertible())
    core::agree(comm, [] { throw InputError("alignment: the conditions do not determine the elevations"); });
  const Eigen::VectorXd solution = lu.solve(wanted);
  for (Eigen::Index j = 0; j < n; ++j)
    elevations[static_cast<std::size_t>(rule.adjustable[static_cast<std::size_t>(j)] - 1)] = solution(j);
  return elevations;
}

}  // namespace whirl::rotor
