#include "study/linear/mode_reduction.hpp"

#include <algorithm>
#include <cmath>

#include "study/bars/reduction_error.hpp"
#include "study/bars/summary_bars.hpp"

namespace whirl::study {

ModeReduction::ModeReduction(const system::RotorSystem& system, Walker& walker,
                             const std::vector<SampledModes>& sampled) {
  if (!has_reduction_errors(system)) return;
  for (const SampledModes& at : sampled) {
    if (at.speed <= 0) continue;  // systems turn
    std::vector<std::complex<double>> values;
    for (const spectral::ModePoint& m : at.modes) values.push_back(m.lambda);
    auto errors = answer_of([&] { return reduction_errors(system, walker.at(at.speed), values); });
    if (!errors.empty()) of_[at.speed] = std::move(errors);
  }
}

void ModeReduction::put(io::StudySummary& summary, double speed, std::size_t k) {
  const auto found = of_.find(speed);
  if (found == of_.end()) return;
  const std::complex<double> error = found->second[k];
  summary.modes.back().more["real_reduction_error"] = error.real();
  summary.modes.back().more["imag_reduction_error"] = error.imag();
  if (!std::isnan(largest_))
    largest_ = std::isfinite(std::abs(error)) ? std::max(largest_, std::abs(error)) : std::abs(error);
  summary.set("reduction.largest_error", largest_, "rad/s");
}

}  // namespace whirl::study
