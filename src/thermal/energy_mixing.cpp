#include "thermal/energy_mixing.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/index.hpp"

namespace whirl::thermal {

namespace {

// Over what a cell passes on. Cells differ from the mean by the hundredth part of the step from what comes in, and what
// leaves has the mean by mass all the same. Ten times as much leaves rounding in the way of the solver.
constexpr double strength = 100;

}  // namespace

void GrooveMixing::update(const Rows& rows, const Flow& flow, double heat_capacity, const std::vector<double>& across,
                          const std::vector<int>& member) {
  const auto l = core::at(rows.mesh().across);
  int grooves = member.empty() ? 0 : *std::ranges::max_element(member);
  MPI_Allreduce(MPI_IN_PLACE, &grooves, 1, MPI_INT, MPI_MAX, rows.comm());
  member_ = member;
  conductance_.assign(core::at(grooves), 0);
  cells_.assign(core::at(grooves), 0);
  if (grooves == 0) return;
  if (member_.empty()) member_.assign(across.size(), 0);
  for (std::size_t node = 0; node < member_.size(); ++node) {
    if (member_[node] == 0) continue;
    const auto groove = core::at(member_[node] - 1);
    cells_[groove] += static_cast<double>(l);
    for (std::size_t k = 0; k < l; ++k) {
      const double most = std::max({std::abs(flow.around[node * l + k]), std::abs(flow.along[node * l + k]),
                                    std::abs(flow.across[node * (l + 1) + k]), std::abs(flow.inflow[node * l + k])});
      conductance_[groove] = std::max(conductance_[groove], strength * (heat_capacity * most + across[node]));
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, cells_.data(), grooves, MPI_DOUBLE, MPI_SUM, rows.comm());
  MPI_Allreduce(MPI_IN_PLACE, conductance_.data(), grooves, MPI_DOUBLE, MPI_MAX, rows.comm());
}

std::vector<double> GrooveMixing::means(const Rows& rows, const double* x) const {
  std::vector<double> out(conductance_.size());
  const auto l = core::at(rows.mesh().across);
  for (std::size_t node = 0; node < member_.size(); ++node)
    for (std::size_t k = 0; k < l && member_[node] > 0; ++k) out[core::at(member_[node] - 1)] += x[node * l + k];
  MPI_Allreduce(MPI_IN_PLACE, out.data(), static_cast<int>(out.size()), MPI_DOUBLE, MPI_SUM, rows.comm());
  for (std::size_t g = 0; g < out.size(); ++g) out[g] /= std::max(cells_[g], 1.0);
  return out;
}

void GrooveMixing::add(const Rows& rows, const double* x, double* out) const {
  if (!any()) return;
  const std::vector<double> mean = means(rows, x);
  const auto l = core::at(rows.mesh().across);
  for (std::size_t node = 0; node < member_.size(); ++node)
    for (std::size_t k = 0; k < l && member_[node] > 0; ++k) {
      const auto groove = core::at(member_[node] - 1);
      out[node * l + k] += conductance_[groove] * (x[node * l + k] - mean[groove]);
    }
}

}  // namespace whirl::thermal
