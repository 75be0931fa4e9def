#pragma once
// What the refinement of cycles and of equilibria share.

#include <string>
#include <vector>

#include "study/convergence/mesh_convergence.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "study/located.hpp"
#include "whirl/io/table.hpp"

namespace whirl::study {

/// The branch of equilibria of that name in the deck; null if there is none.
[[nodiscard]] const EquilibriumBranch* equilibria_called(const Context& context, const std::string& name);

/// Rows of one bifurcation on one mesh.
[[nodiscard]] io::Table convergence_table(const std::string& unit);

/// The study for a branch of equilibria, `all` its bifurcations and `chosen` which of them, 1-based.
[[nodiscard]] StudyResult converge(Context& context, const MeshConvergenceOptions& options,
                                   const EquilibriumBranchOptions& branch, const std::vector<Located>& all,
                                   const std::vector<int>& chosen);

/// Tables and status of either.
[[nodiscard]] StudyResult finish_convergence(Context& context, const MeshConvergenceOptions& options,
                                             const io::Table& rows, const Parameter& parameter,
                                             const std::string& trouble);

}  // namespace whirl::study
