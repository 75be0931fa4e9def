#pragma once
// The same bifurcation of equilibria on other meshes.

#include <array>
#include <memory>
#include <optional>

#include "study/equilibrium/equilibrium_event.hpp"

namespace whirl::study {

/// A plant with other cells or elements, at the parameter of the bifurcation there, its equilibrium x (SI) and what was
/// found.
struct Elsewhere {
  std::unique_ptr<system::Plant> system;
  core::Vector x;
  std::optional<solve::Refined> found;
};

/// By Newton's method from the resampled equilibrium, from nearer places where it does not arrive, and of films whose
/// tangents jump by the sign of the real part alone: to a hundredth of what the place differs by, not nearer than 1e-6
/// of the parameter; `error` is the width that is left. Nothing if it cannot be had. Collective; throws
/// core::NotConverged or core::DomainError.
[[nodiscard]] std::optional<Elsewhere> located_on(const EquilibriumEvent& at, const std::array<double, 2>& film_cells);
/// The same on the shaft of shorter elements, from the equilibrium there at the same parameter: of a Hopf point.
[[nodiscard]] std::optional<Elsewhere> located_on_cut_shaft(const EquilibriumEvent& at);

}  // namespace whirl::study
