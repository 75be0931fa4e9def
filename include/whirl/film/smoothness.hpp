#pragma once
// How smooth the force of a film is: what error bars and normal forms may rely on.

#include <string_view>

#include "whirl/film/options.hpp"

namespace whirl::film {

/// How often the discrete force can be differentiated in the motion of the journal (and in the film's own states).
///
/// A film that cavitates on a mesh has a kink in one of its derivatives whenever the edge of the pressure passes a
/// node. Between two such passages it is smooth. The kinks shrink with the mesh, but a number that needs derivatives
/// beyond `derivatives` (a normal form needs three, an eigenvalue one and its slope in the parameter two) changes with
/// the place of the nodes: its error bar must say more than the difference of two meshes.
struct Smoothness {
  static constexpr int all = 100;  // a film in closed form
  int derivatives = all;           // of the force, that are continuous; 0: the force alone
  std::string_view reason;         // one clause, empty if all are continuous
  [[nodiscard]] bool smooth() const { return derivatives == all; }
};

/// That of the film described by the options, for every bore. Nothing is solved.
[[nodiscard]] Smoothness smoothness(const Options& options);

}  // namespace whirl::film
