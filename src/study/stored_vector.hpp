#pragma once
// Vectors in checkpoints.

#include <Eigen/Core>
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

/// The same of several vectors side by side, columns [rows here x k], as the array [row][column]. `like` is one of
/// which this rank has these rows, and they are shared; null: every rank has the same whole columns. Collective.
void put_columns(io::Group& group, const std::string& name, const Eigen::MatrixXd& columns, Vec like,
                 const std::string& unit, const std::string& description);
/// Of what put_columns() put, on whatever ranks, the rows that this rank has of `like`; null: all of columns that are
/// not shared.
[[nodiscard]] Eigen::MatrixXd take_columns(const io::Group& group, const std::string& name, Vec like);

/// This rank's entries.
[[nodiscard]] std::vector<double> entries_here(Vec v);

}  // namespace whirl::study
