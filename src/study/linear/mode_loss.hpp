#pragma once
// What the loss factor of a rotor makes of the modes of a machine.

#include <Eigen/SparseCore>
#include <vector>

#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// Solves (dF/dx + lambda dF/d(dx/dt) + i eta H) u = 0, H the rotor's K with the sense of hysteresis at the frequency
/// of the mode (RotorSystem::loss_at), for the eigenvalues that those of eta = 0 become. `modes` are these, at the
/// equilibrium x, by rising frequency; all of them vibrate. Newton's method of each by itself, eta raised by steps of
/// 0.05 at most; modes closer together than eta are parted first. The same on every rank. Collective; throws
/// core::NotConverged, core::InputError above 20,000 states.
[[nodiscard]] std::vector<spectral::Mode> with_loss(system::RotorSystem& system, Vec x,
                                                    std::vector<spectral::Mode> modes);

/// A square matrix that ranks share, whole on each of them. Collective.
[[nodiscard]] Eigen::SparseMatrix<double> whole_matrix(Mat shared);

}  // namespace whirl::study
