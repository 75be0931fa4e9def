#include "study/bars/mesh_wave.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/bars/error_bar.hpp"
#include "study/state_rows.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {
namespace {

constexpr double resolved = 8;  // cells in a wave

bool of_film_mesh(const problem::Field& field) {
  return field.quantity == "thickness";
}

// Cells around the film of that name and states in each of its lines, which stand one after another around the bearing.
std::pair<int, PetscInt> mesh_of(const system::RotorSystem& rotor, const std::string& name) {
  const auto& supports = rotor.train().supports;
  for (std::size_t b = 0; b < supports.size(); ++b) {
    const PetscInt states = rotor.own_states(static_cast<int>(b));
    if (supports[b].name != name || states == 0) continue;
    const int around = film::facts(supports[b].film).cells[0];
    return {around, std::max<PetscInt>(1, states / around)};
  }
  return {0, 1};
}

std::string between(const std::array<double, 2>& range) {
  return range[0] == range[1] ? fmt::format("{:.6g}", range[0]) : fmt::format("{:.6g} to {:.6g}", range[0], range[1]);
}

}  // namespace

bool may_have_mesh_waves(const system::Plant& system) {
  const std::vector<problem::Field> fields = system.fields();
  return dynamic_cast<const system::RotorSystem*>(&system) && std::any_of(fields.begin(), fields.end(), of_film_mesh);
}

std::optional<double> cells_per_wave(system::Plant& system, const std::vector<std::complex<double>>& shape) {
  const auto* rotor = dynamic_cast<const system::RotorSystem*>(&system);
  if (!rotor || shape.empty()) return {};
  PetscInt first = 0;  // row of this rank in the whole shape
  {
    const core::Vector x = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
    core::check(VecGetOwnershipRange(x.get(), &first, nullptr));
  }
  double steps = 0, size = 0, least = resolved;
  for (const problem::Field& field : system.fields()) {
    if (!of_film_mesh(field)) continue;
    const auto [around, per_line] = mesh_of(*rotor, field.name);
    if (around > 0) least = std::min(least, around / 3.0);
    std::vector<std::complex<double>> phi;
    field.each([&](PetscInt row) { phi.push_back(shape[static_cast<std::size_t>(first + row)]); });
    const auto line = static_cast<std::size_t>(per_line);
    for (std::size_t k = 0; k < phi.size(); ++k) {
      size += std::norm(phi[k]);
      steps += std::norm(phi[(k + line) % phi.size()] - phi[k]);
    }
  }
  steps = sum_over(system.comm(), steps);
  size = sum_over(system.comm(), size);
  if (size == 0) return {};
  const double cells = std::numbers::pi / std::asin(std::min(1.0, std::sqrt(steps / size) / 2));
  return cells < least ? std::optional(cells) : std::nullopt;
}

void MeshWaves::add(double parameter, const std::vector<std::complex<double>>& waves) {
  const auto widen = [](std::array<double, 2>& range, double value, bool first) {
    range = first ? std::array{value, value} : std::array{std::min(range[0], value), std::max(range[1], value)};
  };
  for (const auto& w : waves) {
    widen(at_, parameter, most_ == 0);
    widen(frequencies_, w.imag(), most_ == 0);
    most_ = std::max<std::size_t>(most_, 1);
  }
  most_ = std::max(most_, waves.size());
}

void MeshWaves::warn(io::StudySummary& summary, const std::string& unit, const std::string& where) const {
  if (most_ == 0) return;
  const std::string frequencies = frequencies_[1] > 0 ? fmt::format(" ({} rad/s)", between(frequencies_)) : "";
  summary.warnings.push_back(fmt::format(
      "{} {} of the film's mesh{}, fewer than eight cells long, {} left out: the film is not resolved there, and no "
      "such motion belongs to the machine. Use 'differences: upwind' or more cells around the bearing",
      where.empty() ? fmt::format("at {} {}", between(at_), unit) : where,
      most_ == 1 ? "a wave" : fmt::format("up to {} waves", most_), frequencies, most_ == 1 ? "is" : "are"));
}

}  // namespace whirl::study
