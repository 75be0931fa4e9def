#include "state_basis.hpp"

#include <fmt/core.h>
#include <slepceps.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "reduction.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/core/from_options.hpp"
#include "whirl/core/matrix_rows.hpp"
#include "whirl/core/symmetric.hpp"

namespace whirl::rotor {
namespace {

using core::check;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// The rows and columns of a matrix that are listed.
MatrixXd part(const MatrixXd& a, const std::vector<int>& rows, const std::vector<int>& columns) {
  MatrixXd out(static_cast<Index>(rows.size()), static_cast<Index>(columns.size()));
  for (Index j = 0; j < out.cols(); ++j)
    for (Index i = 0; i < out.rows(); ++i)
      out(i, j) = a(rows[static_cast<std::size_t>(i)], columns[static_cast<std::size_t>(j)]);
  return out;
}

// Both planes of a planar matrix, all of x before all of y.
MatrixXd both(const MatrixXd& a) {
  MatrixXd out = MatrixXd::Zero(2 * a.rows(), 2 * a.cols());
  out.topLeftCorner(a.rows(), a.cols()) = a;
  out.bottomRightCorner(a.rows(), a.cols()) = a;
  return out;
}

MatrixXd across(const MatrixXd& a) {
  MatrixXd out = MatrixXd::Zero(2 * a.rows(), 2 * a.cols());
  out.topRightCorner(a.rows(), a.cols()) = a;
  out.bottomLeftCorner(a.rows(), a.cols()) = -a;
  return out;
}

// The equations of the shaft in both planes.
struct Whole {
  MatrixXd mass, damping, gyroscopic, stiffness, circulatory;
};

// `d` is the damping of couplings.
Whole whole_of(const MatrixXd& m, const MatrixXd& g, const MatrixXd& k, const MatrixXd& d, const Options& o) {
  return {both(m), (o.stiffness_damping + o.internal_damping) * both(k) + both(d), across(g), both(k),
          o.internal_damping * across(k) + across(d)};
}

MatrixXd damping_of(const Planar& planar, Index n) {
  return planar.damping ? core::dense(planar.damping.get()) : MatrixXd(MatrixXd::Zero(n, n));
}

struct Mode {
  std::complex<double> s;
  VectorXcd shape;
};

// The `states` slowest eigenvalues of s^2 M + s C + K and the next one, one of each pair. With theta = omega/s and
// w = theta q these are the largest of theta q = w, theta w = -omega^2 K^-1 M q - omega K^-1 C w.
std::vector<Mode> slowest(const MatrixXd& m, const MatrixXd& c, const MatrixXd& k, Index states) {
  const Index n = m.rows();
  const core::DenseLu<double> lu(k);
  const MatrixXd inertia = lu.solve(m);
  const double omega = 1 / std::sqrt(inertia.trace());
  MatrixXd a = MatrixXd::Zero(2 * n, 2 * n);
  a.topRightCorner(n, n).setIdentity();
  a.bottomLeftCorner(n, n) = -omega * omega * inertia;
  a.bottomRightCorner(n, n) = -omega * lu.solve(c);
  core::Matrix operator_;
  check(MatCreateSeqDense(PETSC_COMM_SELF, static_cast<PetscInt>(2 * n), static_cast<PetscInt>(2 * n), a.data(),
                          operator_.put()));
  core::Handle<EPS, EPSDestroy> eps;
  check(EPSCreate(PETSC_COMM_SELF, eps.put()));
  check(EPSSetOperators(eps.get(), operator_.get(), nullptr));
  check(EPSSetProblemType(eps.get(), EPS_NHEP));
  check(EPSSetWhichEigenpairs(eps.get(), EPS_LARGEST_MAGNITUDE));
  check(EPSSetOptionsPrefix(eps.get(), "rotor_states_"));
  const auto wanted = static_cast<PetscInt>(std::min(states + 2, 2 * n));
  constexpr Index small = 400;  // a dense solver finds all of them in less than a second
  if (2 * n <= small || 2 * wanted > n)
    check(EPSSetType(eps.get(), EPSLAPACK));
  else
    check(EPSSetDimensions(eps.get(), wanted, 2 * wanted + 20, PETSC_DEFAULT));
  check(EPSSetTolerances(eps.get(), 1e-13, 1000));
  core::set_from_options(eps.get());
  check(EPSSolve(eps.get()));
  PetscInt converged = 0;
  check(EPSGetConverged(eps.get(), &converged));
  if (converged < wanted)
    throw core::NotConverged(
        fmt::format("only {} of {} modes of the shaft with its masters held converged", converged, wanted));
  core::Vector re, im;
  check(MatCreateVecs(operator_.get(), re.put(), im.put()));
  std::vector<Mode> out;
  for (PetscInt i = 0; i < wanted; ++i) {
    double theta_re = 0, theta_im = 0;
    check(EPSGetEigenpair(eps.get(), i, &theta_re, &theta_im, re.get(), im.get()));
    const core::ReadArray x(re.get()), y(im.get());
    VectorXcd shape(n);
    for (Index r = 0; r < n; ++r)
      shape(r) = {x[static_cast<PetscInt>(r)], theta_im == 0 ? 0.0 : y[static_cast<PetscInt>(r)]};
    std::complex<double> s = omega / std::complex<double>(theta_re, theta_im);
    if (theta_im != 0) ++i;  // its conjugate
    if (s.imag() < 0) s = std::conj(s), shape = shape.conjugate().eval();
    out.push_back({s, std::move(shape)});
  }
  return out;
}

// The mass of one, and a phase that is the same however the mode was found.
void normalise(VectorXcd& shape, const MatrixXd& mass) {
  std::complex<double> along = 0;
  for (Index i = 0; i < shape.size(); ++i) along += (1 + std::cos(static_cast<double>(i))) * shape(i);
  if (along != 0.0) shape *= std::conj(along) / std::abs(along);
  shape /= std::sqrt(std::abs(shape.dot((mass * shape).eval())));
}

// Rows (x, y) adjacent of rows with all of x first.
MatrixXd adjacent(const MatrixXd& a) {
  const Index n = a.rows() / 2;
  MatrixXd out(a.rows(), a.cols());
  for (Index i = 0; i < n; ++i) {
    out.row(2 * i) = a.row(i);
    out.row(2 * i + 1) = a.row(n + i);
  }
  return out;
}

MatrixXd apart(const MatrixXd& a) {
  const Index n = a.rows() / 2;
  MatrixXd out(a.rows(), a.cols());
  for (Index i = 0; i < n; ++i) {
    out.row(i) = a.row(2 * i);
    out.row(n + i) = a.row(2 * i + 1);
  }
  return out;
}

// Modes of the shaft with its masters held as columns of R and L.
struct HeldModes {
  MatrixXd displacement, velocity, left_displacement, left_velocity;
  ReductionQuality quality;
};

HeldModes held_modes(const Whole& a, double speed, Index states) {
  const MatrixXd c = a.damping + speed * a.gyroscopic, k = a.stiffness + speed * a.circulatory;
  const Index n = a.mass.rows();
  HeldModes out;
  for (MatrixXd* m : {&out.displacement, &out.velocity, &out.left_displacement, &out.left_velocity})
    m->resize(n, states);
  out.quality.neglected = std::numeric_limits<double>::infinity();
  const MatrixXd by_mass = core::solve_definite(a.mass, c.transpose(), "the mass of the shaft with its masters held");
  std::vector<bool> pair;  // of this column and the next
  Index at = 0;
  for (Mode& mode : slowest(a.mass, c, k, states)) {
    if (at == states) {
      out.quality.neglected = std::abs(mode.s);
      break;
    }
    const Index width = mode.s.imag() == 0 ? 1 : 2;
    if (at + width > states)
      throw core::InputError("rotor: the number of modes would part a pair of eigenvalues: one mode more, or fewer");
    normalise(mode.shape, a.mass);
    VectorXcd left = mode.shape;
    left.tail(n / 2) *= -1;
    const VectorXcd left_displacement = by_mass * left + mode.s * left;
    const VectorXcd velocity = mode.s * mode.shape;
    const auto put = [&](MatrixXd& to, const VectorXcd& from) {
      to.col(at) = from.real();
      if (width > 1) to.col(at + 1) = from.imag();
    };
    put(out.displacement, mode.shape);
    put(out.velocity, velocity);
    put(out.left_displacement, left_displacement);
    put(out.left_velocity, left);
    pair.push_back(width > 1);
    if (width > 1) pair.push_back(false);
    at += width;
    out.quality.retained = std::abs(mode.s);
  }
  core::require(at == states, "as many modes as were asked for");
  const MatrixXd product = out.left_velocity.transpose() * a.mass * out.velocity +
                           out.left_displacement.transpose() * a.mass * out.displacement;
  const core::DenseLu<double> biorthogonal(product);
  if (!(biorthogonal.rcond() > std::numeric_limits<double>::epsilon()))
    throw core::NotConverged("the modes of the shaft with its masters held have no left vectors");
  const MatrixXd factor = biorthogonal.inverse().transpose();
  out.left_velocity *= factor;
  out.left_displacement *= factor;
  for (Index i = 0; i < states; ++i)
    if (pair[static_cast<std::size_t>(i)])
      for (MatrixXd* m : {&out.left_velocity, &out.left_displacement}) m->col(i).swap(m->col(i + 1));
  return out;
}

}  // namespace

StateBasis state_basis(const Planar& planar, const Options& options) {
  const MatrixXd m = core::dense(planar.mass.get()), g = core::dense(planar.gyroscopic.get()),
                 k = core::dense(planar.stiffness.get());
  const double speed = options.reduction.speed;
  const std::vector<int> masters = planar_masters(options.reduction);
  std::vector<int> slaves;
  for (int i = 0; i < static_cast<int>(m.rows()); ++i)
    if (!std::binary_search(masters.begin(), masters.end(), i)) slaves.push_back(i);
  const auto n = static_cast<Index>(m.rows()), n_masters = static_cast<Index>(masters.size()),
             n_slaves = static_cast<Index>(slaves.size()), states = Index{4} * options.reduction.modes;
  const MatrixXd k_ss = part(k, slaves, slaves);

  // T of one plane.
  MatrixXd t = MatrixXd::Zero(n, n_masters);
  const MatrixXd carried = core::solve_definite(k_ss, part(k, slaves, masters), held_stiffness);
  for (Index i = 0; i < n_slaves; ++i) t.row(slaves[static_cast<std::size_t>(i)]) = -carried.row(i);
  for (Index j = 0; j < n_masters; ++j) t(masters[static_cast<std::size_t>(j)], j) = 1;
  const MatrixXd per_mass = t * core::solve_definite(t.transpose() * m * t, MatrixXd::Identity(n_masters, n_masters),
                                                     "the mass of the masters");

  const Whole held = whole_of(part(m, slaves, slaves), part(g, slaves, slaves), k_ss,
                              part(damping_of(planar, n), slaves, slaves), options);
  const HeldModes modes = held_modes(held, speed, states);

  StateBasis out;
  out.quality = modes.quality;
  const auto assembled = [&](const MatrixXd& of_masters, Index parity, const MatrixXd& of_modes) {
    MatrixXd rows = MatrixXd::Zero(2 * n, 4 * n_masters + states);
    for (Index j = 0; j < n_masters; ++j)
      for (Index plane = 0; plane < 2; ++plane)
        rows.block(plane * n, 2 * (2 * j + plane) + parity, n, 1) = of_masters.col(j);
    for (Index i = 0; i < n_slaves; ++i)
      for (Index plane = 0; plane < 2; ++plane)
        rows.row(plane * n + slaves[static_cast<std::size_t>(i)]).tail(states) = of_modes.row(plane * n_slaves + i);
    return adjacent(rows);
  };
  out.displacement = assembled(t, 0, modes.displacement);
  out.velocity = assembled(t, 1, modes.velocity);
  out.left_velocity = assembled(t, 0, modes.left_velocity);
  out.left_displacement = assembled(per_mass, 1, modes.left_displacement);

  // The shape of the slaves under their weight is added as it is, so that it loads no mode.
  const core::ReadArray w(planar.weight.get());
  VectorXd load = VectorXd::Zero(2 * n_slaves);
  for (Index i = 0; i < n_slaves; ++i) load(n_slaves + i) = -w[slaves[static_cast<std::size_t>(i)]];
  const VectorXd shape = core::DenseLu<double>(held.stiffness + speed * held.circulatory).solve(load);
  out.offset = VectorXd::Zero(2 * n);
  for (Index i = 0; i < n_slaves; ++i)
    for (Index plane = 0; plane < 2; ++plane)
      out.offset(2 * slaves[static_cast<std::size_t>(i)] + plane) = shape(plane * n_slaves + i);
  return out;
}

StateProjection project(const Planar& planar, const Options& options, const StateBasis& basis) {
  const MatrixXd m = core::dense(planar.mass.get());
  const Whole a = whole_of(m, core::dense(planar.gyroscopic.get()), core::dense(planar.stiffness.get()),
                           damping_of(planar, m.rows()), options);
  const MatrixXd q = apart(basis.displacement), v = apart(basis.velocity), left_q = apart(basis.left_displacement),
                 left_v = apart(basis.left_velocity);
  StateProjection out;
  out.rates = left_v.transpose() * (a.mass * v) + left_q.transpose() * (a.mass * q);
  out.at_rest = left_v.transpose() * (a.damping * v + a.stiffness * q) - left_q.transpose() * (a.mass * v);
  out.turning = left_v.transpose() * (a.gyroscopic * v + a.circulatory * q);
  const core::ReadArray w(planar.weight.get());
  VectorXd load = VectorXd::Zero(q.rows());
  for (Index i = 0; i < q.rows() / 2; ++i) load(q.rows() / 2 + i) = -w[static_cast<PetscInt>(i)];
  load -= (a.stiffness + options.reduction.speed * a.circulatory) * apart(basis.offset);
  out.gravity = left_v.transpose() * load;
  VectorXd turned(load.size());
  turned << -load.tail(load.size() / 2), load.head(load.size() / 2);
  out.across = left_v.transpose() * turned;
  return out;
}

}  // namespace whirl::rotor
