#pragma once
// Round supply holes on the mesh of a pad.

#include <optional>
#include <string>
#include <vector>

#include "film/sheet/pad.hpp"
#include "whirl/film/contract/reynolds.hpp"

namespace whirl::film {

/// Nodes under the holes of a pad, and the faces that the rims cut.
///
/// Nodes within a rim hold the pressure of the hole. A face between a node outside and one within has the resistance of
/// the way to the rim alone, a face between two holes that of the way between their rims: its conductance is divided by
/// the part t of the step that lies outside. So the pressure is of second order, the matrix stays symmetric, and what
/// flows out of a hole is what flows through these faces. Source: Gibou, Fedkiw, Cheng and Kang (2002), sec. 2.2, for a
/// rim that does not move.
class HoleMesh {
public:
  struct Cut {
    int i = 0, j = 0;     ///< face between the columns i and i + 1, or between the rows j - 1 and j
    double longer = 1.0;  ///< 1/t
  };

  HoleMesh() = default;
  /// Of the holes on this pad, over its whole length: rows 0 .. n_z - 2. Throws core::InputError if the mesh has no
  /// node within one of them.
  HoleMesh(const Pad& pad, const Grid& grid, const std::vector<Hole>& holes);
  [[nodiscard]] bool empty() const { return nodes_.empty(); }
  /// Number of the hole at a node, from one; 0: none.
  [[nodiscard]] int at(int i, int j) const { return nodes_[static_cast<std::size_t>(i * rows_ + j)]; }
  /// Whether one of these columns [n_theta] has a node of a hole.
  [[nodiscard]] bool meets(const std::vector<bool>& columns) const;
  /// Each face once.
  [[nodiscard]] const std::vector<Cut>& around() const { return around_; }
  [[nodiscard]] const std::vector<Cut>& along() const { return along_; }

private:
  int rows_ = 0;
  std::vector<int> nodes_;  // [n_theta + 1][rows], empty without holes
  std::vector<Cut> around_, along_;
};

/// The first hole that cannot be where it is, and why: its rim leaves the pad, meets a groove (as wide as it is, or as
/// the mesh makes it) or another hole, or holds no node of the mesh.
struct MisplacedHole {
  std::size_t hole = 0;
  std::string reason;
};
[[nodiscard]] std::optional<MisplacedHole> misplaced_hole(const Reynolds& options, const Geometry& geometry);

}  // namespace whirl::film
