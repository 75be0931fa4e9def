#include "thermal/energy_terms.hpp"

#include <algorithm>

#include "thermal/energy_faces.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/index.hpp"

namespace whirl::thermal {

using core::at;

EnergyTerms::EnergyTerms(const Rows& rows, const Flow& flow, const EnergyModel& model)
    : rows_(rows), flow_(flow), model_(model), halo_(rows, at(rows.mesh().nodes_around()) * at(rows.mesh().across), 2) {
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
        f.entry.size() != (mesh.closed ? 0 : at(rows_.count()) * at(l)))
      throw core::Bug("the flow of a film belongs to another mesh");
  });
  Halo h(rows_, at(n), 1);
  h.exchange(thickness.data());
  around_.assign(nodes, 0);
  across_.assign(nodes, 0);
  along_.assign(nodes + at(n), 0);
  const double k = model_.conductivity;
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

void EnergyTerms::residual(const double* rise, double* out) {
  halo_.exchange(rise);
  const double c = model_.heat_capacity;
  double* flux = flux_.data();
  if (model_.order == 1)
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
  if (model_.order == 1) return;
  const std::size_t sizes[] = {flow_.around.size(), flow_.along.size(), flow_.across.size()};
  for (std::size_t d = 0; d < 3; ++d) {
    upstream_[d].resize(sizes[d]);
    downstream_[d].resize(sizes[d]);
  }
  halo_.exchange(rise);
  each_faces(1, nullptr, [&](const Faces& f) {
    float* p = upstream_[at(static_cast<int>(f.direction))].data() + f.first;
    float* q = downstream_[at(static_cast<int>(f.direction))].data() + f.first;
    for (int k = 0; k < f.count; ++k) {
      const Steps s = steps(f, k);
      const Slopes slopes = limited_slopes(s.a, s.b);
      p[k] = static_cast<float>(slopes.upstream);
      q[k] = static_cast<float>(slopes.downstream);
    }
  });
}

void EnergyTerms::apply(const double* x, double* out) {
  halo_.exchange(x);
  const double c = model_.heat_capacity;
  double* flux = flux_.data();
  if (model_.order == 1)
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
  const double c = model_.heat_capacity;
  const auto end = [&](Direction direction, bool last, int i, int j, double rise_outside, int k) {
    const PetscInt cell = rows_.cell(k, i, j);
    const double m = entering(direction, last, k, i, j);
    out[cell] -= c * m * (m > 0 ? given * rise_outside : rise[cell]);
  };
  for (int j = rows_.begin(); j < rows_.end(); ++j) {
    for (int i = 0; i < n; ++i) {
      const PetscInt node = rows_.node(i, j), first = node * l;
      const double *x = rise + first, *heat = flow_.heat.data() + first, *inflow = flow_.inflow.data() + first;
      double* y = out + first;
      if (given != 0)
        for (int k = 0; k < l; ++k) y[k] -= given * heat[k];
      if (fed(node))
        for (int k = 0; k < l; ++k) y[k] -= c * inflow[k] * (inflow[k] > 0 ? given * rise_of_supply(node) : x[k]);
      const Surroundings& s = surroundings_;
      y[0] += s.bush.conductance[at(node)] * (x[0] - given * rise_of_wall(s.bush, node));
      y[l - 1] += s.journal.conductance[at(node)] * (x[l - 1] - given * rise_of_wall(s.journal, node));
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
  const double c = model_.heat_capacity;
  EnergyBudget b;
  const auto end = [&](Direction direction, bool last, int i, int j, double rise_outside, int k) {
    const double m = entering(direction, last, k, i, j);
    b.ends -= c * m * (m > 0 ? rise_outside : rise[rows_.cell(k, i, j)]);
  };
  for (int j = rows_.begin(); j < rows_.end(); ++j) {
    for (int i = 0; i < n; ++i) {
      const PetscInt node = rows_.node(i, j), first = node * l;
      const Surroundings& s = surroundings_;
      for (int k = 0; k < l; ++k) {
        const double m = flow_.inflow[at(first + k)];
        b.heat += flow_.heat[at(first + k)];
        b.supply += c * m * (m > 0 ? rise_of_supply(node) : rise[first + k]);
      }
      b.bush += s.bush.conductance[at(node)] * (rise[first] - rise_of_wall(s.bush, node));
      b.journal += s.journal.conductance[at(node)] * (rise[first + l - 1] - rise_of_wall(s.journal, node));
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
