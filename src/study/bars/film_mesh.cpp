#include "study/bars/film_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "study/bars/shaft_mesh.hpp"
#include "study/state_rows.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/study/layout_options.hpp"

namespace whirl::study {
system::Train with_film_mesh(system::Train train, const std::array<double, 2>& factor) {
  for (auto& s : train.supports) s.film = film::refined(s.film, factor);
  return train;
}

MeshLaw law_of(const system::Machine& machine, const LayoutOptions& layout) {
  MeshLaw law;
  law.estimated = layout.bars == BarsFrom::meshes;
  law.shaft_order = order_of_shaft(machine.rotor.element);
  for (const auto& b : machine.bearings) {
    const film::Facts film = film::facts(b.film);
    if (film.cells[0] == 0) continue;
    law.film_order = std::min<double>(law.film_order, film.mesh_order);
    law.kinks |= film.smoothness.derivatives == 0;
    law.piecewise |= !film.smoothness.smooth();
  }
  return law;
}

double order_in_time(const system::Machine& machine, double scheme) {
  for (const auto& b : machine.bearings) scheme = std::min(scheme, film::facts(b.film).smoothness.derivatives + 2.0);
  return scheme;
}

namespace {

// Around and along: half of them shows little of the law, and may be rounded to nearly as many. Around the bearing
// stand the edges of the positive pressure, whose errors of first order show late: the power loss of a bearing of the
// train on 9, 17, 34, 68 and 136 cells is 53484, 53828, 53918, 53988 and 54028 W.
constexpr std::array few_cells{24, 14};

int fewest_cells(const system::Machine& machine, std::size_t direction) {
  int out = std::numeric_limits<int>::max();
  for (const auto& b : machine.bearings)
    if (const int n = film::facts(b.film).cells[direction]; n > 0) out = std::min(out, n);
  return out;
}

}  // namespace

std::vector<FilmMesh> film_meshes(const system::Machine& machine, const LayoutOptions& layout) {
  const MeshLaw law = law_of(machine, layout);
  if (!law.estimated) return {};
  int states = 0;
  for (const auto& b : machine.bearings) states += film::facts(b.film, b.geometry.value_or(film::Geometry{})).states;
  const bool kinks = law.kinks;
  std::vector<double> factors{0.5, 2};
  if (states > layout.refined_states)
    factors = kinks ? std::vector{0.5, 0.625, 0.75, 0.875} : std::vector{0.5, 2.0 / 3};
  else if (kinks)
    factors = {0.53, 0.71, 1.37, 1.87};  // meshes without common divisors: others see the same kinks alike
  std::vector<FilmMesh> out;
  for (std::size_t d = 0; d < 2; ++d) {
    std::vector<double> own = factors;
    if (!kinks && states <= layout.refined_states && fewest_cells(machine, d) < few_cells[d]) own.push_back(4);
    const auto cells_of = [&](const std::array<double, 2>& factor) {
      std::vector<int> cells;
      for (const auto& b : machine.bearings) cells.push_back(film::facts(film::refined(b.film, factor)).cells[d]);
      return cells;
    };
    // Few cells are rounded to the same ones twice; a mesh counts once, and that in use is known.
    std::set<std::vector<int>> met{cells_of({1, 1})};
    const std::vector<int> in_use = *met.begin();
    for (const double factor : own) {
      FilmMesh mesh{d == 0 ? Axis::around : Axis::along, {1, 1}, 1};
      mesh.factor[d] = factor;
      const std::vector<int> cells = cells_of(mesh.factor);
      if (!met.insert(cells).second) continue;
      // The film whose mesh changes least speaks for all: its spacing gives the largest error.
      bool any = false;
      for (std::size_t k = 0; k < cells.size(); ++k) {
        if (in_use[k] == 0) continue;
        const double spacing = static_cast<double>(in_use[k]) / cells[k];
        if (!any || std::abs(std::log(spacing)) < std::abs(std::log(mesh.spacing))) mesh.spacing = spacing;
        any = true;
      }
      if (any && mesh.spacing != 1) out.push_back(mesh);
    }
  }
  return out;
}

core::Vector resampled(const system::Plant& to, const system::Plant& from, const std::vector<double>& whole) {
  core::Vector x = core::make_vector(to.comm(), to.local_size(), PETSC_DETERMINE);
  to.resample(from, whole.data(), x.get());
  return x;
}

// One state after another is whole on every rank, each of which resamples all of it.
solve::Cycle resampled(const system::Plant& to, system::Plant& from, solve::Cycle c) {
  if (to.size() == from.size()) return c;
  StateRows states(from);
  const Eigen::MatrixXd x = c.x;
  c.x.resize(to.local_size(), x.cols());
  for (Eigen::Index k = 0; k < x.cols(); ++k)
    c.x.col(k) = rows_of(resampled(to, from, core::gather(states.vector(x.col(k)))).get());
  return c;
}

}  // namespace whirl::study
