#pragma once
// How gyroscopic moments couple the real modes of a shaft at rest.

#include <Eigen/Core>
#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::rotor {

/// Real modes of one plane and what the other plane's motion in them does.
struct GyroscopicCoupling {
  Eigen::VectorXd frequencies;  ///< rad/s, ascending; rigid motions of a free shaft are zero up to rounding
  Eigen::MatrixXd matrix;       ///< V^T G V [-] of mass-normalised modes V, symmetric: G acts across the planes
};

/// All modes of the unreduced shaft at rest with springs of `support` [N/m] at `nodes` (1-based); 0: the free shaft.
/// Dense. Not collective; throws core::InputError. Skarolek (2011), (2.66), figures 2.9 and 2.10.
[[nodiscard]] GyroscopicCoupling gyroscopic_coupling(const Options& options, const std::vector<int>& nodes,
                                                     double support);

}  // namespace whirl::rotor
