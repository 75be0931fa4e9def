#pragma once
// What the reduction of the shaft did to the modes of a machine.

#include <complex>
#include <map>
#include <vector>

#include "study/common.hpp"
#include "study/linear/mode_bars.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// Errors of the reduction at the speeds that have bars; nothing where the shaft is whole.
class ModeReduction {
public:
  /// The modes at some speeds, whose equilibria the walker finds again. Collective.
  ModeReduction(const system::RotorSystem& system, Walker& walker, const std::vector<SampledModes>& sampled);
  /// "real_reduction_error" and "imag_reduction_error" [rad/s] of the mode that was added last, number k at its speed,
  /// and "reduction.largest_error" [rad/s], the largest modulus so far, not a number once
  /// an error is unknown.
  void put(io::StudySummary& summary, double speed, std::size_t k);

private:
  std::map<double, std::vector<std::complex<double>>> of_;
  double largest_ = 0;
};

}  // namespace whirl::study
