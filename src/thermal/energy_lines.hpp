#pragma once
// The preconditioner of the energy equation.

#include <vector>

#include "thermal/energy_terms.hpp"

namespace whirl::thermal {

/// Line Gauss-Seidel on the first-order operator, an M-matrix: the equations of each column of cells across the film
/// are solved together (Thomas), columns are swept in the direction of the flow around the film and to and fro along
/// it. Between sweeps ranks exchange what they have. A fixed linear map of r to x.
class EnergyLines {
public:
  /// `terms` outlive this. `sweeps` 0: two, or four where flow around the film reverses somewhere.
  EnergyLines(const EnergyTerms& terms, int sweeps);
  /// Factors the columns anew. Collective.
  void update();
  /// x [r, n, l] from r. Collective.
  void apply(const double* r, double* x);
  [[nodiscard]] int sweeps() const { return sweeps_; }

private:
  void factor(int i, int j);
  void column(int i, int j, const double* r, double* x);
  void sweep(bool up, bool right, const double* r, double* x);

  const EnergyTerms& terms_;
  int wanted_, sweeps_ = 2;
  bool forward_ = true;  // most of the flow goes to larger i
  Halo halo_;
  std::vector<double> inverse_;  // (W/K)^-1 [r, n, l], of the pivots
  std::vector<double> rhs_, lower_, upper_;
};

}  // namespace whirl::thermal
