#include "whirl/solve/bifurcation/harmonic_cycle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "solve/newton/shifted_system.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"

namespace whirl::solve {
namespace {

using core::check;
using Complex = std::complex<double>;

constexpr int sweeps = 2;  // of defect correction for the answers to omega and the parameter

std::vector<double> copy_of(Vec v) {
  const core::ReadArray a(v);
  return {a.data(), a.data() + a.size()};
}

void put(const std::vector<double>& from, Vec to) {
  const core::WriteArray a(to);
  std::copy(from.begin(), from.end(), a.data());
}

}  // namespace

ComplexVector critical_vector(problem::System& system, Vec x, double omega) {
  ShiftedSystem shifted(system);
  shifted.linearise(x);
  return critical_vectors(shifted, omega).q;
}

HarmonicCycle::HarmonicCycle(problem::System& system, Vec x, double omega, ComplexVector q, int harmonics,
                             double parameter_scale)
    : system_(system),
      omega_(omega),
      q_(std::move(q)),
      harmonics_(harmonics),
      parameter_scale_(parameter_scale),
      tangents_(samples()) {
  core::require(core::size_of(system.comm()) == 1, "a harmonic balance holds its system as a whole");
  x_ = core::duplicate(x);
  rate_ = core::duplicate(x);
  f_ = core::duplicate(x);
  core::Vector state = core::duplicate(x), rows = core::duplicate(x);
  system.scales(state.get(), rows.get());
  state_scale_ = copy_of(state.get());
  residual_scale_ = copy_of(rows.get());
  for (const Complex& e : q_) square_ += std::norm(e);
  weights_ = make_unknown();
  check(VecSet(weights_.get(), 1.0));
  for (int k = 0; k <= harmonics; ++k) {
    auto& block = blocks_.emplace_back(std::make_unique<ShiftedSystem>(system));
    block->linearise(x);
    if (k == 1)
      block->factorise(omega, critical_vectors(*block, omega).p, q_);
    else
      block->factorise(k * omega);
  }
  birth_.assign(unknowns(), 0.0);
  const core::ReadArray rest(x);
  for (std::size_t i = 0; i < n(); ++i) birth_[i] = rest[static_cast<PetscInt>(i)] / state_scale_[i];
  birth_[unknowns() - 2] = 1;
  birth_[unknowns() - 1] = system.parameter() / parameter_scale;
}

HarmonicCycle::~HarmonicCycle() = default;

core::Vector HarmonicCycle::make_unknown() const {
  return core::make_vector(comm(), static_cast<PetscInt>(unknowns()), PETSC_DETERMINE);
}

void HarmonicCycle::set_parameter(double scaled) {
  system_.set_parameter(scaled * parameter_scale_);
}

// A coefficient a_k = re + i im stands as n real and n imaginary parts behind a_0.
void HarmonicCycle::motion_at(const double* u, std::size_t sample, Vec x, Vec rate) const {
  const core::WriteArray xa(x), ra(rate);
  for (std::size_t i = 0; i < n(); ++i) {
    xa[static_cast<PetscInt>(i)] = u[i];
    ra[static_cast<PetscInt>(i)] = 0;
  }
  for (int k = 1; k <= harmonics_; ++k) {
    const double angle = 2 * std::numbers::pi * k * static_cast<double>(sample) / static_cast<double>(samples()),
                 c = std::cos(angle), s = std::sin(angle), rate_of = k * omega_now_;
    const double *re = u + (2 * static_cast<std::size_t>(k) - 1) * n(), *im = re + n();
    for (std::size_t i = 0; i < n(); ++i) {
      xa[static_cast<PetscInt>(i)] += c * re[i] - s * im[i];
      ra[static_cast<PetscInt>(i)] -= rate_of * (s * re[i] + c * im[i]);
    }
  }
  for (std::size_t i = 0; i < n(); ++i) {
    xa[static_cast<PetscInt>(i)] *= state_scale_[i];
    ra[static_cast<PetscInt>(i)] *= state_scale_[i];
  }
}

// Adds one sample of F to the balance.
void HarmonicCycle::project(std::size_t sample, Vec f, double* r) const {
  const core::ReadArray fa(f);
  const auto count = static_cast<double>(samples());
  for (int k = 0; k <= harmonics_; ++k) {
    const double angle = 2 * std::numbers::pi * k * static_cast<double>(sample) / count,
                 c = (k == 0 ? 1 : 2) * std::cos(angle) / count, s = 2 * std::sin(angle) / count;
    double* re = r + (k == 0 ? 0 : (2 * static_cast<std::size_t>(k) - 1) * n());
    for (std::size_t i = 0; i < n(); ++i) {
      const double value = fa[static_cast<PetscInt>(i)] / residual_scale_[i];
      re[i] += c * value;
      if (k > 0) re[n() + i] -= s * value;
    }
  }
}

void HarmonicCycle::residual(Vec u, Vec r) {
  const core::ReadArray ua(u);
  const std::size_t m = unknowns();
  std::vector<double> sum(m, 0.0);
  core::agree(comm(), [&] { set_parameter(ua[static_cast<PetscInt>(m - 1)]); });
  omega_now_ = ua[static_cast<PetscInt>(m - 2)] * omega_;
  for (std::size_t j = 0; j < samples(); ++j) {
    motion_at(ua.data(), j, x_.get(), rate_.get());
    system_.residual(0, x_.get(), rate_.get(), f_.get());
    project(j, f_.get(), sum.data());
  }
  // Im q^* a_1
  for (std::size_t i = 0; i < n(); ++i)
    sum[m - 2] += q_[i].real() * ua[static_cast<PetscInt>(2 * n() + i)] / square_ -
                  q_[i].imag() * ua[static_cast<PetscInt>(n() + i)] / square_;
  const core::WriteArray ra(r);
  std::copy(sum.begin(), sum.end() - 1, ra.data());
}

void HarmonicCycle::linearise(Vec u, Vec row) {
  const std::vector<double> at = copy_of(u);
  const std::size_t m = unknowns();
  row_ = copy_of(row);
  core::agree(comm(), [&] { set_parameter(at[m - 1]); });
  omega_now_ = at[m - 2] * omega_;
  columns_.assign(2, std::vector<double>(m, 0.0));
  for (std::size_t j = 0; j < samples(); ++j) {
    Sample& s = tangents_[j];
    if (!s.by_state) {
      s.by_state = system_.make_jacobian();
      s.by_rate = system_.make_jacobian();
    }
    motion_at(at.data(), j, x_.get(), rate_.get());
    system_.jacobian(0, x_.get(), rate_.get(), 1, 0, s.by_state.get());
    system_.jacobian(0, x_.get(), rate_.get(), 0, 1, s.by_rate.get());
    system_.parameter_derivative(0, x_.get(), rate_.get(), f_.get());
    check(VecScale(f_.get(), parameter_scale_));
    project(j, f_.get(), columns_[1].data());
    // The rate is in proportion to omega.
    check(VecScale(rate_.get(), 1 / at[m - 2]));
    check(MatMult(s.by_rate.get(), rate_.get(), f_.get()));
    project(j, f_.get(), columns_[0].data());
  }
  // What a change of omega or of the parameter calls for, so that nothing is left but in the direction beyond A_1. The
  // second sweep sees how the moved rest changes the first harmonic.
  core::Vector v = core::duplicate(u), y = core::duplicate(u);
  for (std::size_t c = 0; c < 2; ++c) {
    std::vector<double>& answer = answers_[c];
    answer.assign(m, 0.0);
    answer[m - 2 + c] = 1;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      put(answer, v.get());
      multiply(v.get(), y.get());
      std::vector<double> left = copy_of(y.get()), change(m, 0.0);
      balance(left.data(), change.data(), beyond_[c]);
      for (std::size_t i = 0; i < m; ++i) answer[i] -= change[i];
    }
  }
}

void HarmonicCycle::multiply(Vec v, Vec y) {
  const std::vector<double> in = copy_of(v);
  const std::size_t m = unknowns();
  std::vector<double> out(m, 0.0);
  core::Vector part = core::duplicate(f_.get());
  for (std::size_t j = 0; j < samples(); ++j) {
    motion_at(in.data(), j, x_.get(), rate_.get());
    check(MatMult(tangents_[j].by_state.get(), x_.get(), f_.get()));
    check(MatMult(tangents_[j].by_rate.get(), rate_.get(), part.get()));
    check(VecAXPY(f_.get(), 1, part.get()));
    project(j, f_.get(), out.data());
  }
  for (std::size_t i = 0; i + 2 < m; ++i) out[i] += columns_[0][i] * in[m - 2] + columns_[1][i] * in[m - 1];
  out[m - 2] = out[m - 1] = 0;
  for (std::size_t i = 0; i < n(); ++i)
    out[m - 2] += (q_[i].real() * in[2 * n() + i] - q_[i].imag() * in[n() + i]) / square_;
  for (std::size_t i = 0; i < m; ++i) out[m - 1] += row_[i] * in[i];
  put(out, y);
}

// Each harmonic by its own matrix; the first one by [A_1 b; q^* 0], so that the amplitude and phase of x are those of
// the last two entries of rhs. omega and parameter stay.
void HarmonicCycle::balance(const double* rhs, double* x, Complex& beyond) {
  ComplexVector b(n()), z;
  for (int k = 0; k <= harmonics_; ++k) {
    const std::size_t first = k == 0 ? 0 : (2 * static_cast<std::size_t>(k) - 1) * n();
    for (std::size_t i = 0; i < n(); ++i) b[i] = {rhs[first + i], k == 0 ? 0 : rhs[first + n() + i]};
    Complex corner = k == 1 ? Complex(rhs[unknowns() - 1], rhs[unknowns() - 2]) * square_ : 0;
    blocks_[static_cast<std::size_t>(k)]->solve(b, z, corner);
    if (k == 1) beyond = corner;
    for (std::size_t i = 0; i < n(); ++i) {
      x[first + i] = z[i].real();
      if (k > 0) x[first + n() + i] = z[i].imag();
    }
  }
}

void HarmonicCycle::solve(Vec rhs, Vec x) {
  const std::vector<double> in = copy_of(rhs);
  const std::size_t m = unknowns();
  std::vector<double> out(m, 0.0);
  Complex beyond = 0;
  balance(in.data(), out.data(), beyond);
  // beyond_[0] d_omega + beyond_[1] d_parameter = beyond, two real equations
  const double a = beyond_[0].real(), b = beyond_[1].real(), c = beyond_[0].imag(), d = beyond_[1].imag(),
               determinant = a * d - b * c;
  if (determinant == 0 || !std::isfinite(determinant))
    throw core::NotConverged("the critical eigenvalue does not move with the parameter");
  const double change[2] = {(d * beyond.real() - b * beyond.imag()) / determinant,
                            (a * beyond.imag() - c * beyond.real()) / determinant};
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t i = 0; i < m; ++i) out[i] += change[k] * answers_[k][i];
  put(out, x);
}

void HarmonicCycle::amplitude_row(Vec row) const {
  check(VecSet(row, 0.0));
  const core::WriteArray a(row);
  for (std::size_t i = 0; i < n(); ++i) {
    a[static_cast<PetscInt>(n() + i)] = q_[i].real() / square_;
    a[static_cast<PetscInt>(2 * n() + i)] = q_[i].imag() / square_;
  }
}

std::array<double, 2> HarmonicCycle::at_amplitude(double amplitude, const NewtonOptions& options) {
  const std::size_t m = unknowns();
  std::vector<double> guess = birth_;
  if (last_.empty()) {
    for (std::size_t i = 0; i < n(); ++i) {
      guess[n() + i] = amplitude * q_[i].real();
      guess[2 * n() + i] = amplitude * q_[i].imag();
    }
  } else {
    // Near its birth a_1 is in proportion to the amplitude, all else to its square.
    const double by = amplitude / last_amplitude_;
    for (std::size_t i = 0; i < m; ++i) guess[i] += (i >= n() && i < 3 * n() ? by : by * by) * (last_[i] - birth_[i]);
  }
  core::Vector u = make_unknown(), row = core::duplicate(u.get());
  put(guess, u.get());
  amplitude_row(row.get());
  const NewtonResult result = newton(*this, u.get(), row.get(), amplitude, options);
  if (!result.converged) throw core::NotConverged("no cycle of this amplitude: " + result.reason);
  last_ = copy_of(u.get());
  last_amplitude_ = amplitude;
  return {last_[m - 1] * parameter_scale_, last_[m - 2] * omega_};
}

}  // namespace whirl::solve
