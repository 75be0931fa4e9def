#pragma once
// Transforms of many real records of one length, by FFTW.

#include <fftw3.h>

#include <complex>
#include <memory>
#include <type_traits>
#include <vector>

#include "whirl/core/error.hpp"

namespace whirl::transient {

using FourierPlan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, decltype(&fftw_destroy_plan)>;

/// Transforms of n real numbers, one after another: sum_j in_j exp(-2 pi i j k/n), k = 0 to n/2.
class RealTransform {
public:
  explicit RealTransform(std::size_t n)
      : in_(n),
        out_(n / 2 + 1),
        plan_(fftw_plan_dft_r2c_1d(static_cast<int>(n), in_.data(), reinterpret_cast<fftw_complex*>(out_.data()),
                                   FFTW_ESTIMATE),
              &fftw_destroy_plan) {
    core::require(plan_ != nullptr, "FFTW makes a plan for every length");
  }
  RealTransform(const RealTransform&) = delete;
  RealTransform& operator=(const RealTransform&) = delete;

  [[nodiscard]] std::vector<double>& in() { return in_; }
  [[nodiscard]] const std::vector<std::complex<double>>& run() {
    fftw_execute(plan_.get());
    return out_;
  }

private:
  std::vector<double> in_;
  std::vector<std::complex<double>> out_;
  FourierPlan plan_;
};

}  // namespace whirl::transient
