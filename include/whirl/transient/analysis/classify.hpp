#pragma once
// What kind of motion it is, and by which evidence.

#include <mpi.h>

#include <string>
#include <vector>

namespace whirl::transient {

enum class MotionKind { fixed_point, periodic, limit_cycle, quasi_periodic, chaotic, unsettled, driven };

/// What is known of a motion after its transient.
struct Evidence {
  bool forced = true;              ///< by the turning shaft; else the system does not depend on the angle
  bool driven = false;             ///< by external forces that change with time, whatever the shaft does
  double size = 0;                 ///< of the motion: root mean square distance of its states from their mean
  double rest = 1e-6;              ///< size below which nothing moves
  std::vector<double> returns;     ///< d_k, k = 1, 2, ...: see return_distances(); of an unforced motion on a section
  double return_tolerance = 1e-4;  ///< d_k below which the motion repeats itself after k revolutions
  std::vector<double> fading;      ///< d_k of the record's second half over that of its first; may be empty
  std::vector<double> course;      ///< see course_of_returns(); may be empty
  std::vector<double> exponents;   ///< Lyapunov exponents, the largest first; may be empty
  std::vector<double> uncertainties;  ///< of each
  std::string grows;  ///< what grows about the state of rest or the equilibrium, in words; empty: nothing, or unknown
};

struct Verdict {
  MotionKind kind = MotionKind::unsettled;
  int period = 0;      ///< revolutions after which a periodic motion repeats itself; returns of a limit cycle's section
  std::string name;    ///< fixed_point, period-1, period-2, ..., limit_cycle, quasi_periodic, chaotic, unsettled,
                       ///< driven
  std::string reason;  ///< in words
};

/// d_k = root mean square of |P_(i+k) - P_i| over all i, divided by `size`, for k = 1 to `longest`; P_i are the states
/// at the same shaft angle of successive revolutions, or on a section [points][entries of a state on this rank]. Empty
/// if there are too few points. Collective on `comm`, whose ranks share the states.
[[nodiscard]] std::vector<double> return_distances(const std::vector<std::vector<double>>& points, int longest,
                                                   double size, MPI_Comm comm = MPI_COMM_SELF);

/// d_k of the second half of the points over that of the first, for k = 1 to `longest`; empty if there are too few.
/// Collective on `comm`.
[[nodiscard]] std::vector<double> fading_of_returns(const std::vector<std::vector<double>>& points, int longest,
                                                    MPI_Comm comm = MPI_COMM_SELF);

/// Root mean square of |P_(i+1) - P_i| within each eighth of the record, one after the other; empty if an eighth has
/// fewer than two points. Collective on `comm`.
[[nodiscard]] std::vector<double> course_of_returns(const std::vector<std::vector<double>>& points,
                                                    MPI_Comm comm = MPI_COMM_SELF);

/// A forced motion is periodic if it returns and its largest exponent is not positive, chaotic if that is positive,
/// quasi-periodic if it is zero within its uncertainty and nothing returns. Without forcing the number of zero
/// exponents counts the frequencies, and a limit cycle returns to its section; where no section is known the exponents
/// decide. Whatever contradicts itself - no return although all deviations die out, a return
/// although they grow, a return after k revolutions while what keeps it from a shorter one dies out - is unsettled: not
/// enough revolutions, or an unstable orbit that the motion has not left yet. So is what does not return while the
/// distances between its successive points drift over the record, by more than 1 % and more than five standard errors
/// of a straight line through the logarithms of `course`: a spiral on its way into a cycle, or away from one, has zero
/// exponents within their bars for long.
/// A state of rest about which something grows is no fixed point: the motion has not left it yet. The
/// verdict of an unsettled motion also says what grows about the equilibrium.
/// A motion that external forces drive is `driven`: where it is at the same shaft angle says nothing of it, and its
/// exponents, if there are any, tell only whether it forgets where it began.
[[nodiscard]] Verdict classify(const Evidence& evidence);

}  // namespace whirl::transient
