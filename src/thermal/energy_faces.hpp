#pragma once
// All faces between cells of a film, visited column by column.

#include "thermal/energy_terms.hpp"
#include "thermal/limiter.hpp"
#include "whirl/core/index.hpp"

namespace whirl::thermal {

/// What the flow through a face meets: the temperature upstream, the step before it and the step over the face, K.
struct Steps {
  double upstream, a, b;
};
inline Steps steps(const Faces& f, int k) {
  const bool right = f.flow[k] > 0;
  const double u = right ? f.left[k] : f.right[k], d = right ? f.right[k] : f.left[k];
  const double uu = right ? f.far_left[k] : f.far_right[k];
  return {u, u - uu, d - u};
}

/// Conduction is added to the carried `flux` W [count], which then leaves the left cells for the right ones.
inline void scatter(const Faces& f, double* __restrict flux) {
  const double g = f.conductance;
  if (f.mixing)
    for (int k = 0; k < f.count; ++k) flux[k] -= g * f.mixing[k] * (f.right[k] - f.left[k]);
  else
    for (int k = 0; k < f.count; ++k) flux[k] -= g * (f.right[k] - f.left[k]);
  if (f.out_left)
    for (int k = 0; k < f.count; ++k) f.out_left[k] += flux[k];
  if (f.out_right)
    for (int k = 0; k < f.count; ++k) f.out_right[k] -= flux[k];
}

/// Calls visit(Faces) for all columns of faces, with the temperatures that the halo holds; `given` as in boundaries.
/// `out` [r, n, l] is set to zero before its cells are visited; it may be null.
template <class Visit>
void EnergyTerms::each_faces(double given, double* out, const Visit& visit) {
  const Mesh& mesh = rows_.mesh();
  const int n = mesh.nodes_around(), l = mesh.across, last_row = mesh.along;
  const std::size_t row_cells = core::at(n) * core::at(l);
  const auto row_out = [&](int j) {
    return out && j >= rows_.begin() && j < rows_.end() ? out + core::at(j - rows_.begin()) * row_cells : nullptr;
  };
  for (int j = rows_.begin(); j <= rows_.end(); ++j) {
    const double* row = halo_.row(j);
    double* y = row_out(j);
    if (y) std::fill_n(y, row_cells, 0.0);
    if (j > 0 && j <= last_row) {
      const double *before = halo_.row(j - 2), *left = halo_.row(j - 1), *behind = halo_.row(j + 1);
      double* y_left = row_out(j - 1);
      for (int i = 0; i < n; ++i) {
        const std::size_t here = core::at(i) * core::at(l), first = core::at(rows_.cell(0, i, j));
        const double* far_left =
            before ? before + here : beyond(Direction::along, false, i, j - 1, left + here, given, before_);
        const double* far_right =
            behind ? behind + here : beyond(Direction::along, true, i, j, row + here, given, behind_);
        visit(Faces{Direction::along, i, j, l, first, flow_.along.data() + first, along_[first / core::at(l)], nullptr,
                    far_left, left + here, row + here, far_right, y_left ? y_left + here : nullptr,
                    y ? y + here : nullptr});
      }
    }
    if (j == rows_.end()) break;
    for (int i = mesh.closed ? 0 : 1; i < n; ++i) {
      const int left = (i + n - 1) % n, before = (i + n - 2) % n, behind = (i + 1) % n;
      const auto column = [&](int of) { return row + core::at(of) * core::at(l); };
      const std::size_t first = core::at(rows_.cell(0, left, j));
      const double* far_left =
          mesh.closed || i > 1 ? column(before) : beyond(Direction::around, false, 0, j, column(left), given, before_);
      const double* far_right =
          mesh.closed || i + 1 < n ? column(behind) : beyond(Direction::around, true, i, j, column(i), given, behind_);
      visit(Faces{Direction::around, i, j, l, first, flow_.around.data() + first, around_[first / core::at(l)], nullptr,
                  far_left, column(left), column(i), far_right, y ? y + core::at(left) * core::at(l) : nullptr,
                  y ? y + core::at(i) * core::at(l) : nullptr});
    }
    for (int i = 0; i < n; ++i) {
      const PetscInt node = rows_.node(i, j);
      const double* column = row + core::at(i) * core::at(l);
      const Surroundings& s = surroundings_;
      const double bush = wall_share(s.bush, node), journal = wall_share(s.journal, node);
      double* line = line_.data();
      std::copy_n(column, l, line + 1);
      line[0] = (1 - 2 * bush) * column[0] + 2 * bush * given * rise_of_wall(s.bush, node);
      line[l + 1] = (1 - 2 * journal) * column[l - 1] + 2 * journal * given * rise_of_wall(s.journal, node);
      const std::size_t first = core::at(node) * core::at(l + 1) + 1;
      double* here = y ? y + core::at(i) * core::at(l) : nullptr;
      visit(Faces{Direction::across, i, j, l - 1, first, flow_.across.data() + first, across_[core::at(node)],
                  mixing(node) ? mixing(node) + 1 : nullptr, line, line + 1, line + 2, line + 3, here,
                  here ? here + 1 : nullptr});
    }
  }
}

}  // namespace whirl::thermal
