#pragma once
// Inputs and outputs of transfer functions on the states of a machine.

#include <complex>
#include <string>
#include <vector>

#include "study/linear/frequency_response.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// "node.7.x" or "bearing.left.y"; of an output other than a displacement with its quantity behind.
[[nodiscard]] std::string label(const TransferInput& input);
[[nodiscard]] std::string label(const TransferOutput& output);
/// "m/N", "1/(N m)", "m/(N s^2)" ...
[[nodiscard]] std::string unit_of(const TransferOutput& output, const TransferInput& input);
/// The displacement along an input.
[[nodiscard]] TransferOutput output_of(const TransferInput& input);

/// What `amount` of force [N] or moment [N m] on a freedom of a node is on the coordinates of the rotor, through T^T
/// where it is reduced, whole on every rank. Collective.
[[nodiscard]] std::vector<double> load_on(const rotor::Rotor& rotor, int node, rotor::Freedom freedom,
                                          double amount = 1);

/// A transfer matrix at one frequency [output][input], all of an output behind each other.
struct Transfer {
  std::vector<std::complex<double>> values;
  /// What rounding may leave of each: 1e-12 of the largest motion of its kind, a displacement or a slope, that the
  /// input makes anywhere in the machine. A smaller value is no answer.
  std::vector<double> rounding;
  void members(auto& archive) { archive(values, rounding); }
};

/// Per frequency: a matrix, and what rounding leaves of one.
using Matrices = std::vector<std::vector<std::complex<double>>>;
using Roundings = std::vector<std::vector<double>>;

/// Largest difference over the frequencies, relative to the matrix of the whole machine there, and where it is.
/// Frequencies without an answer do not count.
struct Difference {
  double relative = 0, frequency = 0;
};
[[nodiscard]] Difference difference(const Matrices& whole, const Roundings& rounding, const Matrices& other,
                                    const std::vector<double>& frequencies);

/// The transfer matrix of one machine from inputs to outputs about an equilibrium. All members are collective on the
/// system's communicator.
class TransferMatrix {
public:
  TransferMatrix(system::RotorSystem& system, const std::vector<TransferInput>& inputs,
                 const std::vector<TransferOutput>& outputs);
  /// Takes the derivatives at the equilibrium x and the system's speed.
  void linearise(Vec x);
  /// G(i omega), the same on all ranks. Throws core::NotConverged (solve::singular_at_frequency) at an undamped
  /// resonance.
  [[nodiscard]] Transfer at(double omega);

private:
  /// With what a loss factor of the rotor is at this frequency.
  void linearise_with_loss(double omega);
  [[nodiscard]] std::vector<double> load(const TransferInput& input) const;
  core::Vector x_;  // where it is linearised
  system::RotorSystem& system_;
  solve::FrequencyResolvent solver_;
  std::vector<TransferOutput> outputs_;
  std::vector<std::vector<std::complex<double>>> loads_;  // per input, this rank's rows
};

}  // namespace whirl::study
