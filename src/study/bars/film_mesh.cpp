#include "study/bars/film_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/film/smoothness.hpp"
#include "whirl/film/state_model.hpp"

namespace whirl::study {
namespace {

constexpr int most_states = 4000;

int cells_of(const film::Options& o, std::size_t d, double factor) {
  if (factor == 1) return o.cells[d];
  int cells = std::max(4, static_cast<int>(std::lround(o.cells[d] * factor)));
  if (o.quadrature == film::Options::Quadrature::simpson) cells += cells % 2;
  return cells;
}

}  // namespace

system::Train with_film_mesh(system::Train train, const std::array<double, 2>& factor) {
  for (auto& s : train.supports) {
    const film::Options before = s.film;
    for (std::size_t d = 0; d < 2; ++d) s.film.cells[d] = cells_of(before, d, factor[d]);
  }
  return train;
}

MeshLaw law_of(const system::Machine& machine) {
  MeshLaw law;
  for (const auto& b : machine.bearings) {
    if (!film::has_mesh(b.film.kind)) continue;
    if (b.film.differences == film::Options::Differences::upwind) law.film_order = 1;
    const film::Smoothness smoothness = film::smoothness(b.film);
    law.kinks |= smoothness.derivatives == 0;
    law.piecewise |= !smoothness.smooth();
  }
  return law;
}

double order_in_time(const system::Machine& machine, double scheme) {
  for (const auto& b : machine.bearings) scheme = std::min(scheme, film::smoothness(b.film).derivatives + 2.0);
  return scheme;
}

std::vector<FilmMesh> film_meshes(const system::Machine& machine) {
  int states = 0;
  for (const auto& b : machine.bearings)
    states += film::estimated_states(b.geometry.value_or(film::Geometry{}), b.film);
  std::vector<double> factors{0.5, 2};
  if (states > most_states)
    factors = {0.5, 2.0 / 3};
  else if (law_of(machine).kinks)
    factors = {0.5, 0.75, 1.5, 2};
  std::vector<FilmMesh> out;
  for (std::size_t d = 0; d < 2; ++d)
    for (const double factor : factors) {
      FilmMesh mesh{d == 0 ? Axis::around : Axis::along, {1, 1}, 1};
      mesh.factor[d] = factor;
      // The film whose mesh changes least speaks for all: its spacing gives the largest error.
      bool any = false;
      for (const auto& b : machine.bearings) {
        if (!film::has_mesh(b.film.kind) || (d == 1 && !film::has_mesh_along(b.film.kind))) continue;
        const double spacing = static_cast<double>(b.film.cells[d]) / cells_of(b.film, d, factor);
        if (!any || std::abs(std::log(spacing)) < std::abs(std::log(mesh.spacing))) mesh.spacing = spacing;
        any = true;
      }
      if (any && mesh.spacing != 1) out.push_back(mesh);
    }
  return out;
}

core::Vector resampled(const system::Plant& to, const system::Plant& from, const std::vector<double>& whole) {
  core::Vector x = core::make_vector(to.comm(), to.local_size(), PETSC_DETERMINE);
  const std::vector<double> there = to.resampled(from, whole.data());
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
  const core::WriteArray a(x.get());
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = there[static_cast<std::size_t>(begin + i)];
  return x;
}

solve::Cycle resampled(const system::Plant& to, const system::Plant& from, solve::Cycle c) {
  if (to.size() == from.size()) return c;
  const Eigen::MatrixXd x = c.x;
  c.x.resize(to.size(), x.cols());
  for (Eigen::Index k = 0; k < x.cols(); ++k) {
    const Eigen::VectorXd column = x.col(k);
    const std::vector<double> there = to.resampled(from, column.data());
    c.x.col(k) = Eigen::Map<const Eigen::VectorXd>(there.data(), to.size());
  }
  return c;
}

}  // namespace whirl::study
