#include "study/bars/reduction_error.hpp"

#include <limits>

#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/bifurcation/nearest_eigenvalues.hpp"

namespace whirl::study {

bool has_reduction_errors(const system::RotorSystem& system) {
  const rotor::Options& rotor = system.train().rotor;
  return rotor.type != rotor::Options::Type::rigid && rotor.reduction.type != rotor::Reduction::Type::none &&
         system.own_states() == 0 && rotor.loss_factor == 0;  // the whole shaft is searched without its loss
}

std::vector<std::complex<double>> reduction_errors(const system::RotorSystem& system, Vec x,
                                                   const std::vector<std::complex<double>>& values) {
  if (!has_reduction_errors(system) || values.empty()) return {};
  system::Train train = system.train();
  const std::vector<double> state = system.gather(x);
  std::vector<double> numbers(2 * values.size(), std::numeric_limits<double>::quiet_NaN());
  // Systems of one rank, for their structure: the first one computes for all.
  core::agree(system.comm(), [&] {
    if (core::rank_of(system.comm()) != 0) return;
    try {
      system::RotorSystem reduced(PETSC_COMM_SELF, train, system.speed());
      train.rotor.reduction = {};
      system::RotorSystem whole(PETSC_COMM_SELF, train, system.speed());
      problem::Films films;
      reduced.structure()->films(
          reduced.structure()->c() * Eigen::Map<const Eigen::VectorXd>(state.data(), reduced.size()), nullptr, nullptr,
          true, films);
      const Eigen::Map<const Eigen::ArrayXcd> starts(values.data(), static_cast<Eigen::Index>(values.size()));
      const Eigen::ArrayXcd errors = starts - solve::nearest_eigenvalues(whole, films.d_inputs, starts);
      for (std::size_t k = 0; k < values.size(); ++k) {
        numbers[2 * k] = errors(static_cast<Eigen::Index>(k)).real();
        numbers[2 * k + 1] = errors(static_cast<Eigen::Index>(k)).imag();
      }
    } catch (const core::NotConverged&) {
    }
  });
  core::share(system.comm(), numbers.data(), numbers.size());
  std::vector<std::complex<double>> out;
  for (std::size_t k = 0; k < values.size(); ++k) out.emplace_back(numbers[2 * k], numbers[2 * k + 1]);
  return out;
}

}  // namespace whirl::study
