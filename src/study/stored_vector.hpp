#pragma once
// Vectors in checkpoints.

#include <string>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/io/record.hpp"

namespace whirl::study {

/// Puts v into `group`, in global order: where all ranks of the study share one machine (Layout::shared) as the rows of
/// this rank, else as a whole. Collective on v.
void put_vector(io::Group& group, const std::string& name, Vec v, bool shared, const std::string& description);
/// What put_vector() put into v, on whatever ranks. core::Error if it is of another size. Collective.
void take_vector(const io::Group& group, const std::string& name, Vec v);

/// The same of several vectors in the layout of `like`, of which each rank has its own entries: vectors that several
/// ranks have are shared.
void put_vectors(io::Group& group, const std::string& name, const std::vector<std::vector<double>>& vectors, Vec like,
                 bool shared, const std::string& description);
[[nodiscard]] std::vector<std::vector<double>> take_vectors(const io::Group& group, const std::string& name, Vec like);

/// This rank's entries.
[[nodiscard]] std::vector<double> entries_here(Vec v);

}  // namespace whirl::study
