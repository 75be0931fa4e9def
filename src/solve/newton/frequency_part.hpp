#pragma once
// What a resolvent at a complex frequency holds of a part.

#include "whirl/core/pencil_lu.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"

namespace whirl::solve {

struct FrequencyResolvent::Coupled {
  using Factors = core::PencilLu<Complex>;
  PetscInt first = 0, count = 0;       // its local rows
  PetscInt offset = 0, states = 0;     // its states on lower ranks, and on all
  bool alone = false;                  // on one rank
  std::vector<Factors::Place> places;  // of its own equations in A_i, counted by its states, on this rank
  std::vector<std::size_t> entries;    // of these, in the list
  std::vector<double> at_rest, rates;  // their values, rows scaled
  Eigen::MatrixXd g0, g1, f0, f1;      // G_i and F_i^T likewise [local x ports], [local x forces]
  std::unique_ptr<Factors> factors;    // of D_r A_i, with the rows scaled and the states in SI
  bool factorised = false;
  core::Matrix a, b;       // A_i = a + lambda b, scaled, where it is wanted as a matrix
  Eigen::MatrixXcd x, dx;  // A_i^-1 G_i where it was evaluated last, with the border, and its derivative

  // b times complex columns.
  [[nodiscard]] Eigen::MatrixXcd rates_times(const Eigen::MatrixXcd& columns) const;
};

}  // namespace whirl::solve
