#include "whirl/solve/bifurcation/harmonic_cycle.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "solve/bifurcation/critical_vectors.hpp"
#include "solve/newton/local_part.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr int sweeps = 2;  // of defect correction for the answers to omega and the parameter

}  // namespace

VectorXcd critical_vector(problem::System& system, Vec x, double omega) {
  FrequencyResolvent shifted(system);
  shifted.linearise(x);
  return critical_vectors(shifted, omega).q;
}

HarmonicCycle::HarmonicCycle(problem::System& system, Vec x, double omega, VectorXcd q, int harmonics,
                             double parameter_scale)
    : system_(system),
      omega_(omega),
      q_(std::move(q)),
      harmonics_(harmonics),
      parameter_scale_(parameter_scale),
      square_(q_.squaredNorm()),
      tangents_(static_cast<std::size_t>(samples())) {
  core::require(core::size_of(system.comm()) == 1, "a harmonic balance holds its system as a whole");
  x_ = core::duplicate(x);
  rate_ = core::duplicate(x);
  f_ = core::duplicate(x);
  system.scales(x_.get(), f_.get());
  state_scale_ = get(x_.get());
  residual_scale_ = get(f_.get());
  weights_ = make_unknown();
  check(VecSet(weights_.get(), 1.0));
  for (int k = 0; k <= harmonics; ++k) {
    auto& block = blocks_.emplace_back(std::make_unique<FrequencyResolvent>(system));
    block->linearise(x);
    if (k == 1)
      block->factorise({0, omega}, critical_vectors(*block, omega).p, q_);
    else
      block->factorise({0, k * omega});
  }
  birth_ = VectorXd::Zero(unknowns());
  birth_.head(n()) = get(x).cwiseQuotient(state_scale_);
  birth_.tail(2) << 1, system.parameter() / parameter_scale;
}

HarmonicCycle::~HarmonicCycle() = default;

core::Vector HarmonicCycle::make_unknown() const {
  return core::make_vector(comm(), static_cast<PetscInt>(unknowns()), PETSC_DETERMINE);
}

void HarmonicCycle::set_parameter(double scaled) {
  core::agree(comm(), [&] { system_.set_parameter(scaled * parameter_scale_); });
}

// Im q^* a_1/|q|^2
double HarmonicCycle::phase(const VectorXd& u) const {
  return (q_.real().dot(u.segment(2 * n(), n())) - q_.imag().dot(u.segment(n(), n()))) / square_;
}

// A coefficient a_k = re + i im stands as n real and n imaginary parts behind a_0.
void HarmonicCycle::motion_at(const VectorXd& u, Index sample, Vec x, Vec rate) const {
  VectorXd value = u.head(n()), slope = VectorXd::Zero(n());
  for (int k = 1; k <= harmonics_; ++k) {
    const double angle = 2 * std::numbers::pi * k * static_cast<double>(sample) / static_cast<double>(samples()),
                 c = std::cos(angle), s = std::sin(angle);
    const auto re = u.segment((2 * k - 1) * n(), n()), im = u.segment(2 * k * n(), n());
    value += c * re - s * im;
    slope -= k * omega_now_ * (s * re + c * im);
  }
  put(value.cwiseProduct(state_scale_), x);
  put(slope.cwiseProduct(state_scale_), rate);
}

// Adds one sample of F to the balance.
void HarmonicCycle::project(Index sample, Vec f, Eigen::Ref<VectorXd> r) const {
  const VectorXd value = get(f).cwiseQuotient(residual_scale_);
  const auto count = static_cast<double>(samples());
  r.head(n()) += value / count;
  for (int k = 1; k <= harmonics_; ++k) {
    const double angle = 2 * std::numbers::pi * k * static_cast<double>(sample) / count;
    r.segment((2 * k - 1) * n(), n()) += 2 * std::cos(angle) / count * value;
    r.segment(2 * k * n(), n()) -= 2 * std::sin(angle) / count * value;
  }
}

void HarmonicCycle::residual(Vec u, Vec r) {
  const VectorXd at = get(u);
  const Index m = unknowns();
  VectorXd sum = VectorXd::Zero(m);
  set_parameter(at(m - 1));
  omega_now_ = at(m - 2) * omega_;
  for (Index j = 0; j < samples(); ++j) {
    motion_at(at, j, x_.get(), rate_.get());
    system_.residual(0, x_.get(), rate_.get(), f_.get());
    project(j, f_.get(), sum);
  }
  sum(m - 2) = phase(at);
  put(sum.head(m - 1), r);
}

void HarmonicCycle::linearise(Vec u, Vec row) {
  const VectorXd at = get(u);
  const Index m = unknowns();
  row_ = get(row);
  set_parameter(at(m - 1));
  omega_now_ = at(m - 2) * omega_;
  columns_.setZero(m, 2);
  for (Index j = 0; j < samples(); ++j) {
    Sample& s = tangents_[static_cast<std::size_t>(j)];
    if (!s.by_state) {
      s.by_state = system_.make_jacobian();
      s.by_rate = system_.make_jacobian();
    }
    motion_at(at, j, x_.get(), rate_.get());
    system_.jacobian(0, x_.get(), rate_.get(), 1, 0, s.by_state.get());
    system_.jacobian(0, x_.get(), rate_.get(), 0, 1, s.by_rate.get());
    system_.parameter_derivative(0, x_.get(), rate_.get(), f_.get());
    check(VecScale(f_.get(), parameter_scale_));
    project(j, f_.get(), columns_.col(1));
    // The rate is in proportion to omega.
    check(VecScale(rate_.get(), 1 / at(m - 2)));
    check(MatMult(s.by_rate.get(), rate_.get(), f_.get()));
    project(j, f_.get(), columns_.col(0));
  }
  // What a change of omega or of the parameter calls for, so that nothing is left but in the direction beyond A_1. The
  // second sweep sees how the moved rest changes the first harmonic.
  core::Vector v = core::duplicate(u), y = core::duplicate(u);
  answers_.setZero(m, 2);
  for (Index c = 0; c < 2; ++c) {
    answers_(m - 2 + c, c) = 1;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      put(answers_.col(c), v.get());
      multiply(v.get(), y.get());
      answers_.col(c) -= balance(get(y.get()), beyond_[static_cast<std::size_t>(c)]);
    }
  }
}

void HarmonicCycle::multiply(Vec v, Vec y) {
  const VectorXd in = get(v);
  const Index m = unknowns();
  VectorXd out = VectorXd::Zero(m);
  core::Vector part = core::duplicate(f_.get());
  for (Index j = 0; j < samples(); ++j) {
    const Sample& s = tangents_[static_cast<std::size_t>(j)];
    motion_at(in, j, x_.get(), rate_.get());
    check(MatMult(s.by_rate.get(), rate_.get(), part.get()));
    check(MatMultAdd(s.by_state.get(), x_.get(), part.get(), f_.get()));
    project(j, f_.get(), out);
  }
  out += columns_ * in.tail(2);
  out.tail(2) << phase(in), row_.dot(in);
  put(out, y);
}

// Each harmonic by its own matrix; the first one by [A_1 b; q^* 0], so that the amplitude and phase of the answer are
// those of the last two entries of rhs. omega and parameter stay.
VectorXd HarmonicCycle::balance(const VectorXd& rhs, Complex& beyond) {
  const Index m = unknowns();
  VectorXd x = VectorXd::Zero(m);
  for (int k = 0; k <= harmonics_; ++k) {
    const Index first = k == 0 ? 0 : (2 * k - 1) * n();
    VectorXcd b = VectorXcd::Zero(n() + (k == 1 ? 1 : 0));
    b.head(n()).real() = rhs.segment(first, n());
    if (k > 0) b.head(n()).imag() = rhs.segment(first + n(), n());
    if (k == 1) b(n()) = Complex(rhs(m - 1), rhs(m - 2)) * square_;
    const VectorXcd z = blocks_[static_cast<std::size_t>(k)]->solve(b);
    if (k == 1) beyond = z(n());
    x.segment(first, n()) = z.head(n()).real();
    if (k > 0) x.segment(first + n(), n()) = z.head(n()).imag();
  }
  return x;
}

void HarmonicCycle::solve(Vec rhs, Vec x) {
  Complex beyond = 0;
  const VectorXd out = balance(get(rhs), beyond);
  // beyond_[0] d_omega + beyond_[1] d_parameter = beyond, two real equations
  Eigen::Matrix2d both;
  both << beyond_[0].real(), beyond_[1].real(), beyond_[0].imag(), beyond_[1].imag();
  const double determinant = both.determinant();
  if (determinant == 0 || !std::isfinite(determinant))
    throw core::NotConverged("the critical eigenvalue does not move with the parameter");
  put(out + answers_ * (both.inverse() * Eigen::Vector2d(beyond.real(), beyond.imag())), x);
}

void HarmonicCycle::amplitude_row(Vec row) const {
  VectorXd out = VectorXd::Zero(unknowns());
  out.segment(n(), n()) = q_.real() / square_;
  out.segment(2 * n(), n()) = q_.imag() / square_;
  put(out, row);
}

std::array<double, 2> HarmonicCycle::at_amplitude(double amplitude, const NewtonOptions& options) {
  VectorXd guess = birth_;
  if (last_.size() == 0) {
    guess.segment(n(), n()) = amplitude * q_.real();
    guess.segment(2 * n(), n()) = amplitude * q_.imag();
  } else {
    // Near its birth a_1 is in proportion to the amplitude, all else to its square.
    const double by = amplitude / last_amplitude_;
    VectorXd change = by * by * (last_ - birth_);
    change.segment(n(), 2 * n()) /= by;
    guess += change;
  }
  core::Vector u = make_unknown(), row = core::duplicate(u.get());
  put(guess, u.get());
  amplitude_row(row.get());
  const NewtonResult result = newton(*this, u.get(), row.get(), amplitude, options);
  if (!result.converged) throw core::NotConverged("no cycle of this amplitude: " + result.reason);
  last_ = get(u.get());
  last_amplitude_ = amplitude;
  return {last_(unknowns() - 1) * parameter_scale_, last_(unknowns() - 2) * omega_};
}

}  // namespace whirl::solve
