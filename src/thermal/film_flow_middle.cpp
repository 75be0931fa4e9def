// How fast the fluid moves half-way between bush and journal.
#include "thermal/film_flow_work.hpp"
#include "thermal/profile.hpp"
#include "thermal/row_halo.hpp"

namespace whirl::thermal {
namespace {

// At a node between two faces their mean; at an end the line through its two nearest faces, `beside` and `beyond`.
double at_end(double beside, double beyond) {
  return 1.5 * beside - 0.5 * beyond;
}

}  // namespace

FilmFlow::Velocity FilmFlow::middle() const {
  Work& w = *w_;
  const Mesh& mesh = w.mesh;
  const Rows& rows = w.rows;
  const int n = w.n, begin = rows.begin(), end = rows.end(), last = mesh.along;
  const auto at = [](std::ptrdiff_t k) { return static_cast<std::size_t>(k); };
  const std::vector<double> p = with_halo(rows, w.pressure, at(n));
  Profile profile(mesh.across);
  const auto through = [&](std::size_t a, std::size_t b, double step, double surface, const Resistance& law) {
    w.face(a, b, profile);
    const double dense = w.options.fluid.gas ? 0.5 * (p[a] + p[b]) : 1.0;
    const double less = w.turbulent ? w.resist(law, w.reynolds(a, b) * dense).value : 1.0;
    const Profile::Middle middle = profile.middle();
    return middle.pressure * (p[b] - p[a]) / step / less + middle.drag * surface;
  };
  Velocity out{std::vector<double>(w.pressure.size()), std::vector<double>(w.pressure.size())};
  const double surface = w.options.speed * mesh.radius;
  std::vector<double> face(at(mesh.closed ? n : n - 1));
  for (int q = begin; q < end; ++q) {
    for (std::size_t i = 0; i < face.size(); ++i)
      face[i] = through(w.halo(static_cast<int>(i), q), w.halo(static_cast<int>(i + 1) % n, q), mesh.dx(), surface,
                        w.law_around);
    for (int i = 0; i < n; ++i) {
      double& v = out.around[at(rows.node(i, q))];
      if (mesh.closed || (i > 0 && i < n - 1))
        v = 0.5 * (face[at((i + n - 1) % n)] + face[at(i)]);
      else if (face.size() > 1)
        v = i == 0 ? at_end(face[0], face[1]) : at_end(face[at(n - 2)], face[at(n - 3)]);
      else
        v = face[0];
    }
  }
  for (int q = begin; q < end; ++q)
    for (int i = 0; i < n; ++i) {
      // The face between row r and the one behind it; two or more rows are on each rank, and one beside these is known.
      const auto behind = [&](int r) { return through(w.halo(i, r), w.halo(i, r + 1), mesh.dz(), 0, w.law_along); };
      double& v = out.along[at(rows.node(i, q))];
      if (q > 0 && q < last)
        v = 0.5 * (behind(q - 1) + behind(q));
      else if (last > 1)
        v = q == 0 ? at_end(behind(0), behind(1)) : at_end(behind(last - 1), behind(last - 2));
      else
        v = behind(0);
    }
  return out;
}

}  // namespace whirl::thermal
