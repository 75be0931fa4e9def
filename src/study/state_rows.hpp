#pragma once
// States of which each rank has the rows that it holds of a plant, as those of a cycle.

#include <Eigen/Core>
#include <vector>

#include "whirl/core/petsc.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// A cycle, and what reads it: the scheme of its nodes, and the plant at its parameter.
struct CycleOrbit {
  solve::Cycle cycle;
  const solve::Scheme& scheme;
  system::Plant& system;
  /// The state at s in [0, 1].
  [[nodiscard]] Eigen::VectorXd at(double s) const { return cycle.at(scheme, s); }
};

/// What a plant shows of such states. Collective on its communicator.
class StateRows {
public:
  explicit StateRows(system::Plant& plant);
  /// Of the rows [local_size()] (SI): as Plant::shown(), Plant::film_thickness().
  [[nodiscard]] std::vector<system::PlaceState> shown(const Eigen::VectorXd& rows);
  [[nodiscard]] std::vector<double> film_thickness(const Eigen::VectorXd& rows);
  /// The rows as a vector of the plant, until the next ones come.
  [[nodiscard]] Vec vector(const Eigen::VectorXd& rows);

private:
  system::Plant& plant_;
  core::Vector x_;
};

/// The equilibrium x of a plant as a cycle of one node, whole on every rank, and back. Collective.
[[nodiscard]] solve::Cycle as_cycle(const system::Plant& plant, Vec x, double parameter, double period = 0);
[[nodiscard]] core::Vector state_in(const system::Plant& plant, const solve::Cycle& equilibrium);

/// All entries, on every rank, of a vector of which each rank of `comm` has its rows.
[[nodiscard]] std::vector<double> whole_of(MPI_Comm comm, const Eigen::VectorXd& rows);
/// The entries of x on this rank.
[[nodiscard]] Eigen::VectorXd rows_of(Vec x);
/// The sum over the ranks of `comm`.
[[nodiscard]] double sum_over(MPI_Comm comm, double here);

}  // namespace whirl::study
