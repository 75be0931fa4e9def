#pragma once
// Where a machine rests without the elements that carry no static load.

#include <vector>

#include "whirl/system/rotor_system.hpp"

namespace whirl::system {

/// With F_0 the equations without such elements: x_rest(p) with F_0(0, x_rest, 0; p) = 0 without forcing, and
/// dx_rest/dp = -(dF_0/dx)^-1 dF_0/dp. The elements act on x - x_rest, so that F(0, x_rest, 0; p) = 0, and dF/dx there
/// has them. One static equilibrium for each value of the parameter, from the last one, and one linear solve for its
/// derivative where that is asked for. Made and asked on all ranks.
class RotorSystem::Rest {
public:
  explicit Rest(RotorSystem& system);
  [[nodiscard]] static bool needed(const Train& train);
  /// The train of the machine has changed from outside, its parameter or not.
  void follow_train();
  /// Finds the place at the machine's present parameter; false if it was known. Throws core::DomainError.
  bool find();
  /// The place, as a state of the machine; of rotor and pedestals whole on every rank [2 coordinates].
  [[nodiscard]] Vec state() const { return x_.get(); }
  [[nodiscard]] std::vector<double> hub() const { return without_->hub_states(x_.get()); }
  /// Its derivative by the parameter, likewise.
  [[nodiscard]] const std::vector<double>& hub_rate();

private:
  /// Norm of F_0 at the place.
  [[nodiscard]] double left_over();

  RotorSystem& system_;
  std::unique_ptr<RotorSystem> without_;
  core::Vector x_;
  bool near_ = false, found_ = false;
  double left_ = 0;  ///< of F_0 where the place was found; of linear machines
  std::vector<double> rate_;
};

}  // namespace whirl::system
