#pragma once
// The bore of a film of gas on a mesh around it.

#include <array>
#include <vector>

#include "film/sheet/pad.hpp"
#include "whirl/film/contract/gas.hpp"

namespace whirl::film {

/// A round or lobed bore, or pads with the pressure of the ends between them. Lines of nodes stand at start + i 2 pi/n.
class GasBore {
public:
  /// Throws core::InputError where grooves leave nothing.
  GasBore(const Geometry& geometry, const Gas& options);
  /// Of line 0: an edge of a pad or the joint of two lobes, else the first orifice, else the first groove.
  [[nodiscard]] double start() const { return start_; }
  /// Gap [m] about a journal in the middle, whose motion adds to it.
  [[nodiscard]] double gap(double angle) const;
  /// The same `half` halves of an interval from line 0.
  [[nodiscard]] double at(int half) const {
    const int n = static_cast<int>(gaps_.size());
    return gaps_[static_cast<std::size_t>((half % n + n) % n)];
  }
  /// Its mean over the cell of a line.
  [[nodiscard]] double mean(int line) const { return means_[static_cast<std::size_t>(line)]; }
  /// Whether a line lies in a groove or between pads, and the pressure [Pa] there.
  [[nodiscard]] bool held(int line) const { return held_[static_cast<std::size_t>(line)]; }
  [[nodiscard]] double pressure(int line) const { return pressure_[static_cast<std::size_t>(line)]; }
  [[nodiscard]] bool any_held() const { return any_held_; }
  /// Least thickness [m] with the journal at `position`, exactly.
  [[nodiscard]] double least(const std::array<double, 4>& position) const;

private:
  std::vector<Pad> arcs_;
  std::vector<LeastThickness> least_;
  double start_;
  bool any_held_ = false;
  std::vector<double> gaps_, means_, pressure_;
  std::vector<bool> held_;
};

}  // namespace whirl::film
