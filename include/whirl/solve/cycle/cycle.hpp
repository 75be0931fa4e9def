#pragma once
// A periodic solution as data.

#include <mpi.h>

#include <Eigen/Core>
#include <vector>

#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::solve {

/// A periodic solution x(s), s = t/T in [0, 1], by its values at the nodes of a collocation mesh. Each rank has the
/// rows of the states that it holds of the system, problem::System::local_size(): all of them where every rank holds a
/// whole system. What follows is done row by row, without other ranks.
///
/// Column i m + l - 1 of `x` [n x N m] (SI) is node l = 1..m of interval i; the start of interval i is the end of
/// interval i - 1.
struct Cycle {
  std::vector<double> mesh;  ///< 0 = s_0 < ... < s_N = 1
  Eigen::MatrixXd x;
  double period = 0;     ///< T [s]
  double parameter = 0;  ///< SI

  [[nodiscard]] Eigen::Index intervals() const { return static_cast<Eigen::Index>(mesh.size()) - 1; }
  /// State at s in [0, 1].
  [[nodiscard]] Eigen::VectorXd at(const Scheme& scheme, double s) const;
  /// The same solution on another mesh [n x N' m].
  [[nodiscard]] Cycle on(const Scheme& scheme, const std::vector<double>& new_mesh) const;
};

[[nodiscard]] std::vector<double> uniform_mesh(int intervals);
/// Every interval split in `parts` equal ones.
[[nodiscard]] std::vector<double> refined(const std::vector<double>& mesh, int parts);
/// Every interval split in two.
[[nodiscard]] std::vector<double> doubled(const std::vector<double>& mesh);

/// The scheme of through(): degree 5 on equidistant nodes.
[[nodiscard]] const Scheme& quintic();
/// The cycle given by its states at the points of a mesh (degree 1) as one of quintic(): in each interval the
/// polynomial through the six nearest points (all, if there are fewer), which errs by O(h^6).
[[nodiscard]] Cycle through(const Cycle& points);

/// Estimated local error of each interval, as a fraction of the largest scaled deviation from the mean (at least 1e-6,
/// so that rounding in a resting state is no error): |h^(m+1) x^(m+1)|/(2^(m+1) (m+1)!) by the jump of the m-th
/// derivative between neighbours (de Boor 1973; Ascher, Mattheij and Russell 1995, 9.3). `scale` [n_local] divides the
/// states, the rows of which are those of the ranks of `comm`; all get the same answer. Collective on `comm`.
[[nodiscard]] std::vector<double> interval_errors(const Scheme& scheme, const Cycle& cycle,
                                                  const Eigen::VectorXd& scale, MPI_Comm comm = MPI_COMM_SELF);

/// A mesh whose intervals are split or merged by factors of two until their estimated errors stand between tolerance/8
/// and tolerance; lengths stay powers of two of 1/base, so that few distinct lengths occur and each is factorised once.
/// Where more than `max_intervals` would be needed the tolerance is doubled until they suffice (but for `base` itself).
/// `scale` and `comm` as of interval_errors().
[[nodiscard]] std::vector<double> adapted_mesh(const Scheme& scheme, const Cycle& cycle, const Eigen::VectorXd& scale,
                                               double tolerance, int base, int max_intervals,
                                               MPI_Comm comm = MPI_COMM_SELF);

}  // namespace whirl::solve
