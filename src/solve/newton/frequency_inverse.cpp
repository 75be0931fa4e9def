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

FrequencyInverse::FrequencyInverse(problem::System& system, std::unique_ptr<problem::PartInverse> approximate)
    : system_(system), approximate_(std::move(approximate)), gate_(system.comm()) {}

void FrequencyInverse::set_at(Vec x, Vec rest, Complex lambda) {
  lambda_ = lambda;
  core::Vector rows = core::duplicate(x), columns = core::duplicate(x);
  system_.scales(columns.get(), rows.get());
  check(VecReciprocal(rows.get()));
  for (const bool rates : {false, true}) {
    core::require(system_.entries(0, x, rest, rates ? 0 : 1, rates ? 1 : 0, entries_),
                  "a system with inverses of its parts lists its entries");
    if (!a_) {
      auto layout =
          std::make_shared<const PortLayout>(system_.comm(), system_.local_size(), system_.fields(), entries_.places());
      a_ = std::make_unique<PortMatrix>(layout);
      b_ = std::make_unique<PortMatrix>(layout);
      whole_in_.setZero(layout->local());
      whole_out_.setZero(layout->local());
      hub_.setZero(layout->hub());
      by_a_.setZero(layout->parts());
      by_b_.setZero(layout->parts());
      shell_ = core::make_shell(system_.comm(), 2 * layout->parts(), gate_, [this](Vec v, Vec y) { multiply(v, y); });
      for (core::Vector* v : {&right_, &answer_})
        *v = core::make_vector(system_.comm(), 2 * layout->parts(), PETSC_DETERMINE);
      const core::KrylovOptions options{
          .prefix = "frequency_", .type = KSPFGMRES, .tolerance = 1e-12, .most = 300, .restart = 100};
      ksp_ = core::make_krylov(shell_.get(), gate_, options, [this](Vec r, Vec y) {
        const core::ReadArray ra(r);
        const core::WriteArray ya(y);
        approximate_->apply(ra.span(), ya.span());  // two columns
      });
    }
    PortMatrix& m = rates ? *b_ : *a_;
    m.take(entries_.values());
    m.scale(rows.get(), columns.get());
  }
  approximate_->set({0, x, rest}, 1, std::abs(lambda));
}

void FrequencyInverse::multiply(const PortMatrix& m, const double* in, double* out) {
  const PortLayout& layout = *m.layout();
  hub_.setZero();
  layout.give(in, hub_.data(), whole_in_.data());
  m.multiply(whole_in_.data(), whole_out_.data());
  layout.take(whole_out_.data(), out, hub_.data());
}

void FrequencyInverse::multiply(Vec x, Vec y) {
  const core::ReadArray xa(x);
  const core::WriteArray ya(y);
  const Index n = by_a_.size();
  Slice real(ya.data(), n), imaginary(ya.data() + n, n);
  multiply(*a_, xa.data(), by_a_.data());
  multiply(*b_, xa.data(), by_b_.data());
  real = by_a_ + lambda_.real() * by_b_;
  imaginary = lambda_.imag() * by_b_;
  multiply(*a_, xa.data() + n, by_a_.data());
  multiply(*b_, xa.data() + n, by_b_.data());
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
    iterations_ += taken;
    if (core::reason_of(ksp_.get()) < 0)
      core::agree(system_.comm(), [&] {
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

Eigen::MatrixXcd FrequencyInverse::rates_times(const Eigen::MatrixXcd& columns) {
  Eigen::MatrixXcd out(columns.rows(), columns.cols());
  for (Index c = 0; c < columns.cols(); ++c)
    for (const bool real : {true, false}) {
      if (real)
        by_a_ = columns.col(c).real();
      else
        by_a_ = columns.col(c).imag();
      multiply(*b_, by_a_.data(), by_b_.data());
      if (real)
        out.col(c).real() = by_b_;
      else
        out.col(c).imag() = by_b_;
    }
  return out;
}

}  // namespace whirl::solve
