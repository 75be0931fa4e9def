#pragma once
// Records of a rotor under two random forces, and the linear transfer functions beside them.

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "study/bars/film_limit.hpp"
#include "study/growth.hpp"
#include "study/layout.hpp"
#include "study/linear/transfer_points.hpp"
#include "study/motion/linearity.hpp"
#include "whirl/system/rotor_system.hpp"
#include "whirl/transient/analysis/estimators.hpp"
#include "whirl/transient/steps/force.hpp"

namespace whirl::study {

/// What one level of excitation left.
struct LinearityRecord {
  static constexpr int signals = 4;     ///< F_x, F_y, x, y
  double peak = 0;                      ///< largest distance from the mean [m]
  std::array<double, 2> mean{}, rms{};  ///< of the displacement from the equilibrium; about its mean [m]
  std::array<double, 2> force{};        ///< root mean squares [N]
  double steps = 0;                     ///< in time
  std::vector<double> excerpt;          ///< beginning of the record, [sample][signal]
  transient::SpectralMatrix spectra;    ///< of the signals
  void members(auto& archive) {
    archive(peak, mean, rms, force, steps, excerpt);
    archive(spectra.resolution, spectra.samples, spectra.averages, spectra.segments);
    std::size_t lines = spectra.lines.size();
    archive(lines);
    spectra.lines.resize(lines, Eigen::MatrixXcd(signals, signals));
    for (Eigen::MatrixXcd& m : spectra.lines)
      for (Eigen::Index i = 0; i < m.size(); ++i) archive(m.data()[i]);
  }
};

/// The rotor, its equilibrium and the place that is excited and watched. All members are collective on the ranks that
/// share one machine.
class LinearityRunner {
public:
  LinearityRunner(const Context& context, const Layout& layout, const LinearityOptions& options);

  /// The record at a level [N]; `say` gets the share that is done. Throws core::DomainError where a film is left.
  [[nodiscard]] LinearityRecord record(double level, const std::function<void(double)>& say);
  /// Displacement i by force j about the equilibrium at `frequency` [Hz]: re, im of xx, xy, yx, yy [m/N].
  [[nodiscard]] std::vector<double> linear(double frequency);
  /// What grows about the equilibrium, if that could be computed.
  [[nodiscard]] std::optional<Growth> growing() { return growth_at(system_, rest_.get()); }
  [[nodiscard]] int node() const { return node_; }

private:
  /// Displacements of the place in x and y.
  [[nodiscard]] std::array<double, 2> watched(Vec x) const;

  const LinearityOptions& options_;
  int node_;
  system::RotorSystem system_;
  core::Vector rest_, x_;
  std::array<std::vector<double>, 2> columns_;  // of unit forces on the coordinates
  FilmLimit films_;
  TransferMatrix response_;
};

/// The noise of force d (0 x, 1 y) at a level.
[[nodiscard]] transient::Random noise_of(const LinearityOptions& options, double level, int d);
/// Samples of forces and displacements a second.
[[nodiscard]] inline double rate_of(const LinearityOptions& options) {
  return options.cutoff * options.oversampling;
}
/// Tables, values and warnings; `linear` [line][8] at lines 1, 2, ... of the spectra.
void put_linearity(const Context& context, const LinearityOptions& options, const std::vector<LinearityRecord>& records,
                   const std::vector<std::vector<double>>& linear, int node);

}  // namespace whirl::study
