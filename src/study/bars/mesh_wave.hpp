#pragma once
// Waves of a film's own mesh among the motions of a machine: the one place that tells them apart.

#include <array>
#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// Whether a film of the system has a thickness on a mesh as states. Otherwise there are no such waves.
[[nodiscard]] bool may_have_mesh_waves(const system::Plant& system);

/// Cells in a wave of a mode's shape [size of the system, whole on every rank], where its mesh does not resolve it;
/// nothing of a motion of the machine.
///
/// A thin film carries its thickness around with half the surface speed. Differences on a mesh do not carry waves of
/// few cells at all (central ones of four cells, d omega/dk = 0), so that they stay where the film is thin and its
/// pressure below that of the ambient, and grow there: each mesh has others. Of the shape phi_k along the nodes around
///
///     r = sum |phi_(k+1) - phi_k|^2/sum |phi_k|^2 = 4 sin^2(pi/n)
///
/// for a wave of n cells. Below n = 8 no scheme carries them as it should; of fewer than 24 cells around, below a third
/// of these. A motion of the journal has n = cells around. Each field of a film may be in a scale of its own.
/// Source: Trefethen (1982), SIAM Review 24, 113. Collective, the same on every rank.
[[nodiscard]] std::optional<double> cells_per_wave(system::Plant& system,
                                                   const std::vector<std::complex<double>>& shape);

/// Waves of the mesh that were left out of what a study says of the machine, over a parameter.
class MeshWaves {
public:
  /// `waves` [rad/s], imag > 0, at one value of the parameter; a frequency of zero is not known.
  void add(double parameter, const std::vector<std::complex<double>>& waves);
  /// Says how many there are, where, and what helps, if there are any. Without `where`, as "at 3600 rpm", the place is
  /// the range of the parameter in `unit`.
  void warn(io::StudySummary& summary, const std::string& unit, const std::string& where = {}) const;

private:
  std::array<double, 2> at_{}, frequencies_{};  // from, to; the slowest and the fastest [rad/s]
  std::size_t most_ = 0;
};

}  // namespace whirl::study
