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

/// Which rows of a state the ranks have that store one.
struct SharedRows {
  Vec like = nullptr;             ///< a vector of the ranks that store; null: every rank has the whole state
  MPI_Comm time = MPI_COMM_SELF;  ///< ranks that have equal rows, of which the first one has those of `like`
  SharedRows() = default;
  SharedRows(Vec all) : like(all) {}  // NOLINT(google-explicit-constructor): a layout of its own
  SharedRows(Vec of_first, MPI_Comm equal) : like(of_first), time(equal) {}
};

/// The same of several vectors side by side, columns [rows here x k], as the array [row][column]. They are
/// shared as `like` says. Collective.
void put_columns(io::Group& group, const std::string& name, const Eigen::MatrixXd& columns, const SharedRows& like,
                 const std::string& unit, const std::string& description);
/// Of what put_columns() put, on whatever ranks, the rows of this rank; all of columns that are not shared. Collective.
[[nodiscard]] Eigen::MatrixXd take_columns(const io::Group& group, const std::string& name, const SharedRows& like);

/// This rank's entries.
[[nodiscard]] std::vector<double> entries_here(Vec v);

}  // namespace whirl::study
