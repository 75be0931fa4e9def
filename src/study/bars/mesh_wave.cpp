#include "study/bars/mesh_wave.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "study/bars/error_bar.hpp"
#include "study/state_rows.hpp"
#include "whirl/film/options.hpp"
#include "whirl/solve/newton/machine_modes.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {
namespace {

constexpr double of_eight_cells = 0.5857864376269049;  // 4 sin^2(pi/8)

}  // namespace

double roughness(system::Plant& system, const spectral::Mode& mode) {
  const auto* rotor = dynamic_cast<const system::RotorSystem*>(&system);
  if (!rotor || mode.shape.empty()) return 0;
  PetscInt first = 0;  // row of this rank in the whole shape
  {
    const core::Vector x = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
    core::check(VecGetOwnershipRange(x.get(), &first, nullptr));
  }
  double steps = 0, size = 0;
  for (const problem::Field& field : system.fields()) {
    if (field.quantity != "thickness") continue;
    // States stand line by line around the bearing; their numbers tell how many a line has.
    const auto& supports = rotor->train().supports;
    PetscInt per_line = 1;
    for (std::size_t b = 0; b < supports.size(); ++b)
      if (supports[b].name == field.name && rotor->own_states(static_cast<int>(b)) > 0)
        per_line =
            std::max<PetscInt>(1, rotor->own_states(static_cast<int>(b)) / film::facts(supports[b].film).cells[0]);
    std::vector<std::complex<double>> phi;
    field.each([&](PetscInt row) { phi.push_back(mode.shape[static_cast<std::size_t>(first + row)]); });
    const auto line = static_cast<std::size_t>(per_line);
    for (std::size_t k = 0; k < phi.size(); ++k) {
      size += std::norm(phi[k]);
      if (k + line < phi.size()) steps += std::norm(phi[k + line] - phi[k]);
    }
  }
  steps = sum_over(system.comm(), steps);
  size = sum_over(system.comm(), size);
  return size > 0 ? steps / size : 0;
}

std::optional<double> mesh_wave_at(system::Plant& system, Vec x, double omega) {
  const std::vector<problem::Field> fields = system.fields();
  if (std::none_of(fields.begin(), fields.end(), [](const problem::Field& f) { return f.quantity == "thickness"; }))
    return {};
  spectral::EigenOptions options;
  options.count = 60;
  const std::vector<spectral::Mode> modes = solve::machine_modes(system, x, options).modes;
  const std::complex<double> wanted(0, omega);
  const auto nearest = std::min_element(modes.begin(), modes.end(), [&](const auto& a, const auto& b) {
    return std::abs(a.lambda - wanted) < std::abs(b.lambda - wanted);
  });
  if (nearest == modes.end()) return {};
  const double r = roughness(system, *nearest);
  if (r <= of_eight_cells) return {};
  return std::numbers::pi / std::asin(std::min(1.0, std::sqrt(r) / 2));
}

void put_mesh_wave(io::Bifurcation& b, double cells) {
  b.more["cells_per_wave"] = cells;
  b.uncertainty = unknown;
  b.criticality = "undetermined";
  b.criticality_by = fmt::format("a wave of the film's mesh, {:.1f} cells long: no property of the machine", cells);
}

bool is_mesh_wave(const io::Bifurcation& b) {
  return b.more.contains("cells_per_wave");
}

void warn_of_mesh_wave(const io::Bifurcation& b, io::StudySummary& summary) {
  summary.warnings.push_back(
      fmt::format("the Hopf point at {:.6g} {} is a wave of the film's mesh ({:.1f} cells long) and does not belong to "
                  "the machine: "
                  "from there on the film is not resolved; use 'differences: upwind' or more cells around the bearing",
                  b.value, b.unit, b.more.at("cells_per_wave")));
}

}  // namespace whirl::study
