#include "whirl/transient/analysis/exponents.hpp"

#include <cmath>
#include <limits>

#include "whirl/core/error.hpp"

namespace whirl::transient {
namespace {

constexpr std::size_t batches = 8;
constexpr double student = 3.499;  // 99 %, seven degrees of freedom

}  // namespace

void Exponents::add(const std::vector<double>& growth, double duration) {
  core::require(static_cast<int>(growth.size()) == count_, "one growth per direction");
  growth_.insert(growth_.end(), growth.begin(), growth.end());
  durations_.push_back(duration);
}

std::vector<double> Exponents::values(std::size_t spans) const {
  const auto n = static_cast<std::size_t>(count_);
  std::vector<double> sum(n, 0.0);
  double time = 0;
  for (std::size_t i = 0; i < spans; ++i) {
    time += durations_[i];
    for (std::size_t k = 0; k < n; ++k) sum[k] += growth_[i * n + k];
  }
  for (double& s : sum) s /= time;
  return sum;
}

std::vector<double> Exponents::uncertainties() const {
  const auto n = static_cast<std::size_t>(count_);
  const std::size_t length = spans() / batches;
  if (length < 2) return std::vector<double>(n, std::numeric_limits<double>::infinity());
  std::vector<double> out;
  for (std::size_t k = 0; k < n; ++k) {
    double mean = 0, squares = 0;
    for (std::size_t b = 0; b < batches; ++b) {
      double growth = 0, time = 0;
      for (std::size_t i = b * length; i < (b + 1) * length; ++i) {
        growth += growth_[i * n + k];
        time += durations_[i];
      }
      const double value = growth / time;
      mean += value / batches;
      squares += value * value / batches;
    }
    const double variance = std::max(0.0, squares - mean * mean) * batches / (batches - 1);
    out.push_back(student * std::sqrt(variance / batches));
  }
  return out;
}

double kaplan_yorke_dimension(const std::vector<double>& exponents) {
  double sum = 0;
  for (std::size_t j = 0; j < exponents.size(); ++j) {
    if (sum + exponents[j] < 0) return static_cast<double>(j) + sum / -exponents[j];
    sum += exponents[j];
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace whirl::transient
