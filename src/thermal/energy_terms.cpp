#include "thermal/energy_terms.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "thermal/energy_faces.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/index.hpp"

namespace whirl::thermal {

using core::at;

EnergyTerms::EnergyTerms(const Rows& rows, const Flow& flow, const EnergyModel& model)
    : rows_(rows),
      flow_(flow),
      model_(model),
      laws_(model),
      halo_(rows, at(rows.mesh().nodes_around()) * at(rows.mesh().across), 2) {
  const std::size_t l = at(rows.mesh().across);
  flux_.resize(l);
  line_.resize(l + 2);
  before_.resize(l);
  behind_.resize(l);
}

void EnergyTerms::set_surroundings(Surroundings surroundings) {
  const std::size_t nodes = at(rows_.count()) * at(rows_.mesh().nodes_around());
  core::agree(rows_.comm(), [&] {
    for (const Wall* w : {&surroundings.bush, &surroundings.journal})
      if (w->conductance.size() != nodes || w->temperature.size() != nodes)
        throw core::Bug("a wall has a conductance and a temperature of each column of the film");
    if (!surroundings.supply.empty() && surroundings.supply.size() != nodes)
      throw core::Bug("there is a temperature of the supply of each column of the film");
    if (!surroundings.entering.empty() && surroundings.entering.size() != flow_.entry.size())
      throw core::Bug("there is a temperature of each flow into a pad");
  });
  surroundings_ = std::move(surroundings);
  laws_.set_ambient(surroundings_.ambient);
}

void EnergyTerms::update(const std::vector<double>& thickness, Surroundings surroundings) {
  set_surroundings(std::move(surroundings));
  const Mesh& mesh = rows_.mesh();
  const int n = mesh.nodes_around(), l = mesh.across, begin = rows_.begin(), end = rows_.end();
  const std::size_t nodes = at(rows_.count()) * at(n), cells = nodes * at(l);
  core::agree(rows_.comm(), [&] {
    const Flow& f = flow_;
    if (thickness.size() != nodes || f.around.size() != cells || f.along.size() != cells + at(n) * at(l) ||
        f.across.size() != cells + nodes || f.inflow.size() != cells || f.heat.size() != cells ||
        f.entry.size() != (mesh.closed ? 0 : at(rows_.count()) * at(l)) ||
        (!f.mixing.empty() && f.mixing.size() != cells + nodes))
      throw core::Bug("the flow of a film belongs to another mesh");
  });
  Halo h(rows_, at(n), 1);
  h.exchange(thickness.data());
  around_.assign(nodes, 0);
  across_.assign(nodes, 0);
  along_.assign(nodes + at(n), 0);
  const double k = laws_.conductivity();
  for (int j = begin; j <= end; ++j) {
    const double *below = h.row(j - 1), *row = h.row(j);
    for (int i = 0; i < n; ++i) {
      const std::size_t node = at(rows_.node(i, j));
      if (below && row) along_[node] = k * mesh.width(i) * (below[i] + row[i]) / (2 * l * mesh.dz());
      if (j == end) continue;
      if (mesh.closed || i + 1 < n)
        around_[node] = k * mesh.depth(j) * (row[i] + row[(i + 1) % n]) / (2 * l * mesh.dx());
      across_[node] = k * mesh.width(i) * mesh.depth(j) * l / row[i];
    }
  }
  fed_.assign(nodes, 0);
  for (std::size_t c = 0; c < cells; ++c)
    if (flow_.inflow[c] != 0) fed_[c / at(l)] = 1;
  if (laws_.varied()) at_.resize(cells, 0);
}

double EnergyTerms::wall_share(const Wall& wall, PetscInt node) const {
  return std::min(1.0, wall.conductance[at(node)] / (2 * across_[at(node)]));
}

double EnergyTerms::rise_of_wall(const Wall& wall, PetscInt node) const {
  return wall.temperature[at(node)] - surroundings_.ambient;
}

double EnergyTerms::rise_of_entry(PetscInt cell) const {
  return surroundings_.entering.empty() ? 0.0 : surroundings_.entering[at(cell)] - surroundings_.ambient;
}

double EnergyTerms::rise_of_supply(PetscInt node) const {
  return surroundings_.supply.empty() ? 0.0 : surroundings_.supply[at(node)] - surroundings_.ambient;
}

double EnergyTerms::entering(Direction direction, bool last, int k, int i, int j) const {
  const int l = rows_.mesh().across;
  if (direction == Direction::along) {
    const double m = flow_.along[at(rows_.cell(k, i, last ? j + 1 : j))];
    return last ? -m : m;
  }
  return last ? -flow_.around[at(rows_.cell(k, i, j))] : flow_.entry[at(j - rows_.begin()) * at(l) + at(k)];
}

// The column of cells that stands for what lies beyond an end.
const double* EnergyTerms::beyond(Direction direction, bool last, int i, int j, const double* column, double given,
                                  std::vector<double>& room) const {
  const int l = rows_.mesh().across;
  const bool entry = direction == Direction::around && !last;
  for (int k = 0; k < l; ++k) {
    const double rise = entry ? given * rise_of_entry(static_cast<PetscInt>(j - rows_.begin()) * l + k) : 0.0;
    room[at(k)] = entering(direction, last, k, i, j) > 0 ? 2 * rise - column[k] : column[k];
  }
  return room.data();
}

void EnergyTerms::check_laws(const double* rise) const {
  core::agree(rows_.comm(), [&] {
    for (std::size_t c = 0; c < flow_.heat.size(); ++c)
      if (!(laws_.capacity(rise[c]) > 0 && laws_.conduct(rise[c]).value > 0))
        throw core::DomainError(
            fmt::format("heat capacity or conductivity of the lubricant is not positive at {:.6g} K",
                        surroundings_.ambient + rise[c]));
  });
}

// The half layer has the mean temperature of the cell's centre and the wall's surface.
LawValue EnergyTerms::wall_factor(bool journal, PetscInt node, double rise) const {
  const Wall& wall = journal ? surroundings_.journal : surroundings_.bush;
  const double* mix = mixing(node);
  const double better = mix ? mix[journal ? rows_.mesh().across : 0] : 1.0, share = 0.5 * wall_share(wall, node);
  const LawValue f = laws_.conduct(rise + share * (rise_of_wall(wall, node) - rise));
  return {better * f.value, better * f.slope * (1 - share)};
}

// 1/g = 1/(F g_half) + (1 - s)/g_0 with the share s = g_0/g_half of the half layer at the ambient's temperature.
LawValue EnergyTerms::wall_heat(bool journal, PetscInt node, double rise) const {
  const Wall& wall = journal ? surroundings_.journal : surroundings_.bush;
  const double g = wall.conductance[at(node)], step = rise - rise_of_wall(wall, node);
  if (!laws_.varied() && flow_.mixing.empty()) return {g * step, g};
  const double share = wall_share(wall, node);
  const LawValue f = wall_factor(journal, node, rise);
  const double whole = share + (1 - share) * f.value, now = g * f.value / whole;
  return {now * step, now + g * step * f.slope * share / (whole * whole)};
}

void EnergyTerms::residual(const double* rise, double* out) {
  halo_.exchange(rise);
  const double c = laws_.heat_capacity();
  double* flux = flux_.data();
  if (laws_.varied()) {
    check_laws(rise);
    each_faces(1, out, [&](const Faces& f) {
      for (int k = 0; k < f.count; ++k) {
        const Steps s = steps(f, k);
        const double face = s.upstream + (model_.order == 1 ? 0.0 : limited(s.a, s.b));
        const double beyond_ambient = laws_.conduct(0.5 * (f.left[k] + f.right[k])).value - 1;
        const double g = f.conductance * (f.mixing ? f.mixing[k] : 1.0);
        flux[k] = c * f.flow[k] * laws_.content(face) - beyond_ambient * g * (f.right[k] - f.left[k]);
      }
      scatter(f, flux);
    });
  } else if (model_.order == 1)
    each_faces(1, out, [&](const Faces& f) {
      for (int k = 0; k < f.count; ++k) flux[k] = c * f.flow[k] * (f.flow[k] > 0 ? f.left[k] : f.right[k]);
      scatter(f, flux);
    });
  else
    each_faces(1, out, [&](const Faces& f) {
      for (int k = 0; k < f.count; ++k) {
        const Steps s = steps(f, k);
        flux[k] = c * f.flow[k] * (s.upstream + limited(s.a, s.b));
      }
      scatter(f, flux);
    });
  boundaries(rise, 1, out);
}

void EnergyTerms::linearise(const double* rise) {
  const bool varied = laws_.varied();
  if (model_.order == 1 && !varied) return;
  const std::size_t sizes[] = {flow_.around.size(), flow_.along.size(), flow_.across.size()};
  for (std::size_t d = 0; d < 3; ++d) {
    upstream_[d].resize(sizes[d]);
    downstream_[d].resize(sizes[d]);
    if (!varied) continue;
    capacity_[d].resize(sizes[d]);
    conduct_[d].resize(sizes[d]);
    tilt_[d].resize(sizes[d]);
  }
  if (varied) at_.assign(rise, rise + flow_.heat.size());
  halo_.exchange(rise);
  each_faces(1, nullptr, [&](const Faces& f) {
    const std::size_t d = at(static_cast<int>(f.direction));
    float *p = upstream_[d].data() + f.first, *q = downstream_[d].data() + f.first;
    for (int k = 0; k < f.count; ++k) {
      const Steps s = steps(f, k);
      const Slopes slopes = model_.order == 1 ? Slopes{0, 0} : limited_slopes(s.a, s.b);
      p[k] = static_cast<float>(slopes.upstream);
      q[k] = static_cast<float>(slopes.downstream);
      if (!varied) continue;
      const double face = s.upstream + slopes.upstream * s.a + slopes.downstream * s.b;
      const LawValue conduct = laws_.conduct(0.5 * (f.left[k] + f.right[k]));
      const std::size_t place = f.first + at(k);
      capacity_[d][place] = static_cast<float>(laws_.capacity(face));
      conduct_[d][place] = static_cast<float>(conduct.value);
      tilt_[d][place] = static_cast<float>(-0.5 * conduct.slope * (f.right[k] - f.left[k]));
    }
  });
}

void EnergyTerms::apply(const double* x, double* out) {
  halo_.exchange(x);
  const double c = laws_.heat_capacity();
  double* flux = flux_.data();
  if (laws_.varied())
    each_faces(0, out, [&](const Faces& f) {
      const std::size_t d = at(static_cast<int>(f.direction));
      for (int k = 0; k < f.count; ++k) {
        const Steps s = steps(f, k);
        const std::size_t place = f.first + at(k);
        const double p = upstream_[d][place], q = downstream_[d][place];
        const double g = f.conductance * (f.mixing ? f.mixing[k] : 1.0);
        flux[k] = c * capacity_[d][place] * f.flow[k] * (s.upstream + p * s.a + q * s.b) +
                  g * (tilt_[d][place] * (f.left[k] + f.right[k]) -
                       (static_cast<double>(conduct_[d][place]) - 1) * (f.right[k] - f.left[k]));
      }
      scatter(f, flux);
    });
  else if (model_.order == 1)
    each_faces(0, out, [&](const Faces& f) {
      for (int k = 0; k < f.count; ++k) flux[k] = c * f.flow[k] * (f.flow[k] > 0 ? f.left[k] : f.right[k]);
      scatter(f, flux);
    });
  else
    each_faces(0, out, [&](const Faces& f) {
      const float* p = upstream_[at(static_cast<int>(f.direction))].data() + f.first;
      const float* q = downstream_[at(static_cast<int>(f.direction))].data() + f.first;
      for (int k = 0; k < f.count; ++k) {
        const Steps s = steps(f, k);
        flux[k] = c * f.flow[k] * (s.upstream + static_cast<double>(p[k]) * s.a + static_cast<double>(q[k]) * s.b);
      }
      scatter(f, flux);
    });
  boundaries(x, 0, out);
}

// What crosses walls and ends, what is fed and what heats; `given` is zero for the linear part alone.
void EnergyTerms::boundaries(const double* rise, double given, double* out) const {
  const Mesh& mesh = rows_.mesh();
  const int n = mesh.nodes_around(), l = mesh.across;
  const double c = laws_.heat_capacity();
  const bool varied = laws_.varied();
  const auto inside = [&](PetscInt cell) {
    if (!varied) return rise[cell];
    return given != 0 ? laws_.content(rise[cell]) : laws_.capacity(at_[at(cell)]) * rise[cell];
  };
  const auto wall = [&](bool journal, PetscInt node, PetscInt cell) {
    if (given != 0) return wall_heat(journal, node, rise[cell]).value;
    return wall_heat(journal, node, varied ? at_[at(cell)] : 0).slope * rise[cell];
  };
  const auto end = [&](Direction direction, bool last, int i, int j, double rise_outside, int k) {
    const PetscInt cell = rows_.cell(k, i, j);
    const double m = entering(direction, last, k, i, j);
    out[cell] -= c * m * (m > 0 ? given * laws_.content(rise_outside) : inside(cell));
  };
  for (int j = rows_.begin(); j < rows_.end(); ++j) {
    for (int i = 0; i < n; ++i) {
      const PetscInt node = rows_.node(i, j), first = node * l;
      const double *heat = flow_.heat.data() + first, *inflow = flow_.inflow.data() + first;
      double* y = out + first;
      if (given != 0)
        for (int k = 0; k < l; ++k) y[k] -= given * heat[k];
      if (fed(node))
        for (int k = 0; k < l; ++k)
          y[k] -= c * inflow[k] * (inflow[k] > 0 ? given * laws_.content(rise_of_supply(node)) : inside(first + k));
      y[0] += wall(false, node, first);
      y[l - 1] += wall(true, node, first + l - 1);
      for (int k = 0; k < l && j == 0; ++k) end(Direction::along, false, i, j, 0, k);
      for (int k = 0; k < l && j == mesh.along; ++k) end(Direction::along, true, i, j, 0, k);
    }
    for (int k = 0; k < l && !mesh.closed; ++k) {
      end(Direction::around, false, 0, j, rise_of_entry(static_cast<PetscInt>(j - rows_.begin()) * l + k), k);
      end(Direction::around, true, n - 1, j, 0, k);
    }
  }
}

EnergyBudget EnergyTerms::budget(const double* rise) const {
  const Mesh& mesh = rows_.mesh();
  const int n = mesh.nodes_around(), l = mesh.across;
  const double c = laws_.heat_capacity();
  EnergyBudget b;
  const auto end = [&](Direction direction, bool last, int i, int j, double rise_outside, int k) {
    const double m = entering(direction, last, k, i, j);
    b.ends -= c * m * laws_.content(m > 0 ? rise_outside : rise[rows_.cell(k, i, j)]);
  };
  for (int j = rows_.begin(); j < rows_.end(); ++j) {
    for (int i = 0; i < n; ++i) {
      const PetscInt node = rows_.node(i, j), first = node * l;
      for (int k = 0; k < l; ++k) {
        const double m = flow_.inflow[at(first + k)];
        b.heat += flow_.heat[at(first + k)];
        b.supply += c * m * laws_.content(m > 0 ? rise_of_supply(node) : rise[first + k]);
      }
      b.bush += wall_heat(false, node, rise[first]).value;
      b.journal += wall_heat(true, node, rise[first + l - 1]).value;
      for (int k = 0; k < l && j == 0; ++k) end(Direction::along, false, i, j, 0, k);
      for (int k = 0; k < l && j == mesh.along; ++k) end(Direction::along, true, i, j, 0, k);
    }
    for (int k = 0; k < l && !mesh.closed; ++k) {
      end(Direction::around, false, 0, j, rise_of_entry(static_cast<PetscInt>(j - rows_.begin()) * l + k), k);
      end(Direction::around, true, n - 1, j, 0, k);
    }
  }
  double all[] = {b.heat, b.bush, b.journal, b.ends, b.supply};
  MPI_Allreduce(MPI_IN_PLACE, all, 5, MPI_DOUBLE, MPI_SUM, rows_.comm());
  return {all[0], all[1], all[2], all[3], all[4]};
}

}  // namespace whirl::thermal
