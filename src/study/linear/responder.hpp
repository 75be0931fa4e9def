#pragma once
// The linear response of a machine to its unbalance, at one speed after another.

#include <complex>
#include <vector>

#include "study/bars/film_mesh.hpp"
#include "study/common.hpp"
#include "study/linear/response_record.hpp"
#include "study/linear/unbalance_response.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"

namespace whirl::study {

/// What an eigenvalue problem says of the equilibrium at a speed.
struct SpectrumAt {
  int growing = -1;                          ///< as Growth::known_count()
  std::vector<std::complex<double>> values;  ///< all that were found [1/s], both of each pair; empty: none could be had
  void members(auto& archive) { archive(growing, values); }
};

/// All members are collective on the space of the layout.
class Responder {
public:
  /// `nodes` of the deck's shaft, of whatever mesh.
  Responder(const Context& context, const Layout& layout, const UnbalanceResponseOptions& options,
            std::vector<int> nodes, const FilmMesh& mesh = {});

  /// Throws core::NotConverged where there is no equilibrium, and at an undamped resonance.
  [[nodiscard]] ResponseAtSpeed at(double speed);
  [[nodiscard]] SpectrumAt spectrum(double speed);
  [[nodiscard]] system::ShownPlaces places() const { return system_.places(); }
  [[nodiscard]] Trail trail() { return walker_.trail(); }
  [[nodiscard]] PetscInt states() const { return system_.size(); }
  /// Whether a spectrum has all eigenvalues of the machine, not only those nearest to zero.
  [[nodiscard]] bool whole_spectra() const;

private:
  system::RotorSystem system_;
  Walker walker_;
  solve::FrequencyResolvent solver_;
  std::vector<int> nodes_;
};

}  // namespace whirl::study
