#include "thermal/thd_coarse.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "whirl/core/index.hpp"
#include "whirl/core/plan.hpp"

namespace whirl::thermal {

using core::at;
using core::check;

namespace {

constexpr int least_around = 12, least_along = 6, least_layers = 3;
// The node, or the next behind it, in the mesh with half of the intervals.
int coarse_node(int node) {
  return (node + 1) / 2;
}

// Rows [from, to) of all ranks' rows of `width` values. Collective.
std::vector<double> fetch(const Rows& rows, const std::vector<double>& own, std::size_t width, int from, int to) {
  using Places = core::Handle<IS, ISDestroy>;
  using Scatter = core::Handle<VecScatter, VecScatterDestroy>;
  core::Vector all, here;
  check(
      VecCreateMPIWithArray(rows.comm(), 1, static_cast<PetscInt>(own.size()), PETSC_DETERMINE, own.data(), all.put()));
  std::vector<double> out(width * at(to - from));
  check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, static_cast<PetscInt>(out.size()), out.data(), here.put()));
  Places places;
  check(ISCreateStride(PETSC_COMM_SELF, static_cast<PetscInt>(out.size()),
                       static_cast<PetscInt>(width) * static_cast<PetscInt>(from), 1, places.put()));
  Scatter scatter;
  check(VecScatterCreate(all.get(), places.get(), here.get(), nullptr, scatter.put()));
  check(VecScatterBegin(scatter.get(), all.get(), here.get(), INSERT_VALUES, SCATTER_FORWARD));
  check(VecScatterEnd(scatter.get(), all.get(), here.get(), INSERT_VALUES, SCATTER_FORWARD));
  return out;
}

// The interval in which a node of another mesh lies, and how far along it.
struct Place {
  int before = 0, behind = 0;
  double share = 0;  // of `behind`
};
Place place(int node, int intervals, int of, bool closed) {
  const double x = static_cast<double>(node) * intervals / of;
  Place out;
  out.before = std::min(static_cast<int>(x), intervals - 1);
  out.share = x - out.before;
  out.behind = closed ? (out.before + 1) % intervals : out.before + 1;
  return out;
}

}  // namespace

std::optional<Mesh> coarser(const Mesh& mesh, const FilmFlowOptions& flow, int ranks) {
  Mesh out = mesh;
  out.around = mesh.around / 2;
  out.along = mesh.along / 2;
  out.across = std::max((mesh.across + 1) / 2, std::min(mesh.across, least_layers));
  if (out.around < least_around || out.along < least_along) return {};
  if (ranks > 1 && out.nodes_along() < 2 * ranks) return {};
  std::set<std::pair<int, int>> taken;
  for (const Orifice& o : flow.orifices)
    if (coarse_node(o.j) >= out.along ||
        !taken.insert({coarse_node(o.i) % out.nodes_around(), coarse_node(o.j)}).second)
      return {};
  for (const Feed& f : flow.feeds)
    if (coarse_node(f.first_around) > f.last_around / 2 || coarse_node(f.first_along) > f.last_along / 2) return {};
  return out;
}

ThdSetup coarser(const ThdSetup& setup, const Rows& fine, const Rows& coarse) {
  ThdSetup out = setup;
  out.tolerance = std::max(setup.tolerance, 1e-5);
  for (WallOptions* wall : {&out.bush, &out.journal})
    wall->layers = std::max(wall->layers / 2, std::min(wall->layers, 4));
  if (!setup.supply.empty()) out.supply = interpolate(fine, coarse, setup.supply, 1);
  // A coarse mesh is no more than a start: its grooves, of fewer nodes than those that are mixed, stay as they are fed.
  out.mixed.clear();
  for (Orifice& o : out.flow.orifices) {
    o.i = coarse_node(o.i) % coarse.mesh().nodes_around();
    o.j = coarse_node(o.j);
    if (!out.supply.empty() && o.j >= coarse.begin() && o.j < coarse.end())
      out.supply[at(coarse.node(o.i, o.j))] = o.temperature;
  }
  for (Feed& f : out.flow.feeds)
    f = {coarse_node(f.first_around), f.last_around / 2, coarse_node(f.first_along), f.last_along / 2, f.pressure};
  return out;
}

std::vector<double> interpolate(const Rows& from, const Rows& to, const std::vector<double>& values, int width) {
  const Mesh &a = from.mesh(), &b = to.mesh();
  const std::size_t row = at(a.nodes_around()) * at(width);
  const int first = place(to.begin(), a.along, b.along, false).before,
            last = place(to.end() - 1, a.along, b.along, false).behind;
  const std::vector<double> near = fetch(from, values, row, first, last + 1);
  std::vector<double> out;
  out.reserve(at(to.count()) * at(b.nodes_around()) * at(width));
  for (int j = to.begin(); j < to.end(); ++j) {
    const Place q = place(j, a.along, b.along, false);
    const double *low = &near[at(q.before - first) * row], *high = &near[at(q.behind - first) * row];
    for (int i = 0; i < b.nodes_around(); ++i) {
      const Place p = place(i, a.around, b.around, a.closed);
      const std::size_t s = at(p.before) * at(width), t = at(p.behind) * at(width);
      for (std::size_t k = 0; k < at(width); ++k)
        out.push_back((1 - q.share) * ((1 - p.share) * low[s + k] + p.share * low[t + k]) +
                      q.share * ((1 - p.share) * high[s + k] + p.share * high[t + k]));
    }
  }
  return out;
}

std::vector<double> interpolate_state(const Rows& from, const Rows& to, const std::vector<double>& state) {
  const int l = from.mesh().across, layers = to.mesh().across;
  const int others = static_cast<int>(state.size() / (at(from.count()) * at(from.mesh().nodes_around()))) - l;
  const std::vector<double> near = interpolate(from, to, state, l + others);
  const std::size_t nodes = near.size() / at(l + others);
  std::vector<double> out;
  out.reserve(nodes * at(layers + others));
  for (std::size_t c = 0; c < nodes; ++c) {
    const double* column = &near[c * at(l + others)];
    for (int k = 0; k < layers; ++k) {
      const double x = std::clamp((k + 0.5) * l / layers - 0.5, 0.0, l - 1.0);
      const int before = std::min(static_cast<int>(x), std::max(l - 2, 0)), behind = std::min(before + 1, l - 1);
      out.push_back(column[before] + (x - before) * (column[behind] - column[before]));
    }
    out.insert(out.end(), column + l, column + l + others);
  }
  return out;
}

std::optional<std::vector<double>> coarse_start(const Rows& rows, const ThdSetup& setup,
                                                const std::vector<double>& thickness) {
  const Mesh& mesh = rows.mesh();
  const double cells = static_cast<double>(mesh.nodes_around()) * mesh.nodes_along() * mesh.across;
  if (!core::plan::starts_coarse(cells, setup.coarse_start)) return {};
  const std::optional<Mesh> other = coarser(mesh, setup.flow, core::size_of(rows.comm()));
  if (!other) return {};
  try {
    const Rows coarse(*other, rows.comm());
    ThdSolver thd(coarse, coarser(setup, rows, coarse), interpolate(rows, coarse, thickness, 1));
    (void)thd.solve();
    return interpolate_state(coarse, rows, thd.state());
  } catch (const core::NotConverged&) {  // on all ranks; the mesh that is wanted may find it
    return {};
  }
}

}  // namespace whirl::thermal
