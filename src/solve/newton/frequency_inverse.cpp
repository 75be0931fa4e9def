#include "solve/newton/frequency_inverse.hpp"

#include <fmt/format.h>
#include <petscksp.h>

#include <utility>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/shell.hpp"

namespace whirl::solve {

using core::check;
using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::VectorXd;
using ConstMap = Eigen::Map<const VectorXd>;
using Slice = Eigen::Map<VectorXd>;

FrequencyInverse::FrequencyInverse(MPI_Comm comm, std::unique_ptr<problem::PartInverse> approximate)
    : approximate_(std::move(approximate)), gate_(comm) {}

void FrequencyInverse::set_at(const PortMatrix& a, const PortMatrix& b, const problem::Point& at, Complex lambda) {
  lambda_ = lambda;
  a_ = &a;
  b_ = &b;
  if (!ksp_) {
    const MPI_Comm comm = a.layout()->comm();
    const PetscInt parts = a.layout()->parts();
    by_a_.setZero(parts);
    by_b_.setZero(parts);
    shell_ = core::make_shell(comm, 2 * parts, gate_, [this](Vec v, Vec y) { multiply(v, y); });
    for (core::Vector* v : {&right_, &answer_}) *v = core::make_vector(comm, 2 * parts, PETSC_DETERMINE);
    const core::KrylovOptions options{
        .prefix = "frequency_", .type = KSPFGMRES, .tolerance = 1e-12, .most = 300, .restart = 100};
    ksp_ = core::make_krylov(shell_.get(), gate_, options, [this](Vec r, Vec y) {
      const core::ReadArray ra(r);
      const core::WriteArray ya(y);
      approximate_->apply(ra.span(), ya.span());  // two columns
    });
  }
  approximate_->set(at, 1, std::abs(lambda));
}

void FrequencyInverse::multiply(Vec x, Vec y) {
  const core::ReadArray xa(x);
  const core::WriteArray ya(y);
  const Index n = by_a_.size();
  Slice real(ya.data(), n), imaginary(ya.data() + n, n);
  a_->multiply_parts(xa.data(), by_a_.data());
  b_->multiply_parts(xa.data(), by_b_.data());
  real = by_a_ + lambda_.real() * by_b_;
  imaginary = lambda_.imag() * by_b_;
  a_->multiply_parts(xa.data() + n, by_a_.data());
  b_->multiply_parts(xa.data() + n, by_b_.data());
  real -= lambda_.imag() * by_b_;
  imaginary += by_a_ + lambda_.real() * by_b_;
}

void FrequencyInverse::apply_at(const Complex* r, Complex* y, std::ptrdiff_t rows, int columns) {
  const Index n = by_a_.size();
  for (int c = 0; c < columns; ++c) {
    {
      const core::WriteArray to(right_.get());
      const Eigen::Map<const Eigen::VectorXcd> from(r + c * rows, n);
      Slice(to.data(), n) = from.real();
      Slice(to.data() + n, n) = from.imag();
    }
    gate_.rethrow(KSPSolve(ksp_.get(), right_.get(), answer_.get()));
    PetscInt taken = 0;
    check(KSPGetIterationNumber(ksp_.get(), &taken));
    if (core::reason_of(ksp_.get()) < 0)
      core::agree(a_->layout()->comm(), [&] {
        throw core::NotConverged(
            fmt::format("the equations of the films at {:.4g} + {:.4g}i 1/s were not solved in {} "
                        "iterations (-frequency_ksp_max_it, -frequency_ksp_rtol)",
                        lambda_.real(), lambda_.imag(), taken));
      });
    const core::ReadArray from(answer_.get());
    Eigen::Map<Eigen::VectorXcd> to(y + c * rows, n);
    to.real() = ConstMap(from.data(), n);
    to.imag() = ConstMap(from.data() + n, n);
  }
}

}  // namespace whirl::solve
