#pragma once
// Small deviations from a motion: what Lyapunov exponents are made of.

#include <vector>

#include "whirl/core/petsc.hpp"

namespace whirl::transient {

/// `count` deviations delta u (states over their scales) that are carried along a motion, kept orthonormal.
class Tangents {
public:
  /// Orthonormal directions that depend on nothing but the number of the state, so that any number of ranks has the
  /// same. Collective on the communicator of `like`, which gives the layout; count <= size.
  Tangents(Vec like, int count);

  [[nodiscard]] int count() const { return static_cast<int>(columns_.size()); }
  [[nodiscard]] Vec column(int k) const { return columns_[static_cast<std::size_t>(k)].get(); }

  /// Y = Q R by modified Gram-Schmidt, twice; Y becomes Q. Returns log |R_kk|, the growth of each direction since the
  /// last time [count]. Collective.
  std::vector<double> orthonormalise();

  /// Directions of nothing but numbers need not obey equations that hold no rates, until an integrator has seen to it
  /// once. Those that were carried before, by this or another one, do.
  [[nodiscard]] bool are_new() const { return new_; }
  void were_carried() { new_ = false; }

private:
  bool new_ = true;
  std::vector<core::Vector> columns_;
};

}  // namespace whirl::transient
