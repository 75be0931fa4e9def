#pragma once
// Waves of a film's own mesh among the modes of a machine.

#include <optional>

#include "whirl/io/summary.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// How far a mode is a wave in the thickness of a compliant film that its mesh does not resolve.
///
/// A thin film carries its thickness around with half the surface speed. Differences on a mesh do not carry waves of
/// few cells at all (central ones of four cells, d omega/dk = 0), so that they stay where the film is thin and its
/// pressure below that of the ambient, and grow there: each mesh has others. Of the shape phi_k along the nodes around
///
///     r = sum |phi_(k+1) - phi_k|^2/sum |phi_k|^2 = 4 sin^2(pi/n)
///
/// for a wave of n cells. Below n = 8, r > 0.586, no scheme carries them as it should. A motion of the journal has n =
/// cells around, r < 0.02. Source: Trefethen (1982), SIAM Review 24, 113.
///
/// r; zero without such a film. The same on every rank. Collective.
[[nodiscard]] double roughness(system::Plant& system, const spectral::Mode& mode);

/// Cells a wave of the mode at the equilibrium x whose eigenvalue is nearest to i omega, if it is such a wave.
/// Collective.
[[nodiscard]] std::optional<double> mesh_wave_at(system::Plant& system, Vec x, double omega);

/// What a Hopf point that is one says of itself, in place of a criticality; its place means nothing for the machine.
void put_mesh_wave(io::Bifurcation& b, double cells);
/// Whether put_mesh_wave() was called, and a warning about it.
[[nodiscard]] bool is_mesh_wave(const io::Bifurcation& b);
void warn_of_mesh_wave(const io::Bifurcation& b, io::StudySummary& summary);

}  // namespace whirl::study
