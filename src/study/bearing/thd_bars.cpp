// Error bars of a film with heat, by coarser meshes.
#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "study/bearing/held_film.hpp"
#include "study/bearing/thd_results.hpp"
#include "study/findings.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/study/layout_options.hpp"

namespace whirl::study {
namespace {

constexpr std::array<int, 3> least{8, 4, 2};

// How far an orifice is moved to a node, around [rad] and along [of the length]: greatest over all.
std::array<double, 2> displacement(const ThdOptions& o, const std::array<int, 3>& cells, double length) {
  const auto off = [](double at) { return std::abs(at - std::round(at)); };
  const double step = 2 * std::numbers::pi / cells[0];
  std::array<double, 2> most{};
  for (const thermal::OrificeRing& ring : o.orifices) {
    for (int k = 0; k < ring.count; ++k)
      most[0] = std::max(most[0], step * off((ring.angle + 2 * std::numbers::pi * k / ring.count) / step));
    most[1] = std::max(most[1], off((ring.z / length + 0.5) * cells[1]) / cells[1]);
  }
  return most;
}

// How far the ends of a groove are moved to nodes, around [rad] and along [of the length]: greatest over all.
std::array<double, 2> displacement_of_grooves(const ThdOptions& o, const std::array<int, 3>& cells, double length) {
  const auto off = [](double at) { return std::abs(at - std::round(at)); };
  const double step = 2 * std::numbers::pi / cells[0];
  std::array<double, 2> most{};
  for (const thermal::SupplyGroove& groove : o.grooves)
    for (const double side : {-0.5, 0.5}) {
      most[0] = std::max(most[0], step * off((groove.angle + side * groove.width) / step));
      const double along = std::min(groove.length.value_or(length), length) / length;
      most[1] = std::max(most[1], off((0.5 + side * along) * cells[1]) / cells[1]);
    }
  return most;
}

bool grooves_move(const ThdOptions& o, const std::vector<std::array<int, 3>>& meshes, double length) {
  return std::ranges::any_of(meshes, [&](const std::array<int, 3>& cells) {
    const std::array<double, 2> moved = displacement_of_grooves(o, cells, length);
    return moved[0] > 1e-9 || moved[1] > 1e-9;
  });
}

// Values on another mesh with the residual of the energy behind them; not a number where there is no answer, with the
// reason.
std::vector<double> values_on(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry, double speed,
                              const FilmStart& start, const SummaryBars& bars, std::string& reason) {
  std::vector<double> out;
  // A mesh of few rows is solved by each rank for itself.
  const bool shared = options.cells[1] + 1 >= 2 * core::size_of(comm);
  const bool answered = has_answer(
      [&] {
        const SolvedFilm solved = solve_film(shared ? comm : MPI_COMM_SELF, options, geometry, speed, start);
        ThdAtSpeed& film = *solved.film;
        if (!solved.converged) {
          core::NotConverged error(fmt::format("temperatures did not settle in {} rounds", film.cost().iterations));
          error.mark_agreed();
          throw error;
        }
        io::StudySummary there;
        put_thd_values(there, film, options);
        out = bars.row(there);
        out.push_back(film.thd().budget().residual());
      },
      &reason);
  if (!answered) {
    out = bars.row({});
    out.push_back(io::no_value);
  }
  core::share(comm, out.data(), out.size());
  return out;
}

// Names of values that have no limit on ever finer meshes. Near an orifice the gas flows with 1/r, r the distance: its
// dissipation and work grow with ln(r), and so does what they change of the temperature and of the pressure there.
std::set<std::string> without_limit(ThdAtSpeed& film, const ThdOptions& options, const io::StudySummary& summary) {
  if (options.orifices.empty()) return {};
  std::set<std::string> out{"heat.dissipation", "heat.expansion"};
  for (const std::string& name : extremes_at_orifices(film)) out.insert(name);
  std::erase_if(out, [&](const std::string& name) {
    return std::ranges::none_of(summary.values, [&](const auto& entry) { return entry.first == name; });
  });
  return out;
}

}  // namespace

std::vector<std::array<int, 3>> thd_meshes(const ThdOptions& options, double length, const LayoutOptions& layout) {
  std::vector<std::array<int, 3>> out{options.cells};
  if (layout.bars == BarsFrom::none) return out;
  const std::array<double, 2> own = displacement(options, options.cells, length);
  for (int k = 1; k < options.meshes; ++k) {
    std::array<int, 3> cells = out.back();
    for (std::size_t d = 0; d < 3; ++d) cells[d] = (cells[d] + 1) / 2;
    if (cells[0] < least[0] || cells[1] < least[1] || cells[2] < least[2]) break;
    const std::array<double, 2> moved = displacement(options, cells, length);
    if (moved[0] > own[0] + 1e-9 || moved[1] > own[1] + 1e-9) break;
    out.push_back(cells);
  }
  return out;
}

void put_thd_bars(Context& context, ThdAtSpeed& film, const ThdOptions& options, const film::Geometry& geometry,
                  double speed, const FilmStart& start, double energy_residual, Pieces& pieces) {
  const std::vector<std::array<int, 3>> meshes = thd_meshes(options, geometry.length, context.layout);
  io::StudySummary& summary = context.results.summary();
  const auto total = [](const std::array<int, 3>& c) { return static_cast<double>(c[0]) * c[1] * c[2]; };
  // What feeds a film is a point or an edge that moves to the nearest node: errors of first order.
  const bool fed = !options.orifices.empty() || !options.grooves.empty();
  SummaryBars bars(summary,
                   {.film_order = fed ? 1.0 : 2.0, .feeds_move = grooves_move(options, meshes, geometry.length)});
  const std::size_t count = summary.values.size();
  std::vector<std::vector<double>> found(1);  // of each mesh
  for (const auto& [name, q] : summary.values) found[0].push_back(q.value);
  found[0].push_back(energy_residual);
  for (std::size_t m = 1; m < meshes.size(); ++m) {
    const std::string cells = fmt::format("{}", fmt::join(meshes[m], " x "));
    auto [values, reason] = pieces.value(fmt::format("mesh {}", m), [&] {
      context.results.progress(cells + " cells for the error bars");
      ThdOptions there = options;
      there.cells = meshes[m];
      for (thermal::WallOptions* wall : {&there.bush, &there.journal}) wall->layers = std::max(2, wall->layers >> m);
      std::pair<std::vector<double>, std::string> out;
      out.first = values_on(context.comm, there, geometry, speed, start, bars, out.second);
      return out;
    });
    found.push_back(std::move(values));
    if (!reason.empty())
      summary.warnings.push_back(fmt::format("the error bars lack the mesh of {} cells: {}", cells, reason));
    bars.add(Axis::around, std::cbrt(total(meshes[0]) / total(meshes[m])), {found[m].begin(), found[m].end() - 1});
  }
  if (meshes.size() > 1) {
    io::Group& group = context.results.group().child("meshes");
    // From coarse to fine.
    const auto column = [&](const auto& of) {
      std::vector<double> out;
      for (std::size_t m = meshes.size(); m-- > 0;) out.push_back(of(m));
      return out;
    };
    group.put("cells", column([&](std::size_t m) { return total(meshes[m]); }), "1", "cells of the film");
    for (std::size_t d = 0; d < 3; ++d) {
      constexpr const char* names[] = {"around", "along", "across"};
      group.put(names[d], column([&](std::size_t m) { return static_cast<double>(meshes[m][d]); }), "1",
                "intervals, or layers");
    }
    for (std::size_t k = 0; k < count; ++k)
      group.put(summary.values[k].first, column([&](std::size_t m) { return found[m][k]; }),
                summary.values[k].second.unit, "over the mesh");
    group.put("energy_residual", column([&](std::size_t m) { return found[m][count]; }), "W",
              "what the balance of the whole film leaves");
  }
  const std::set<std::string> limitless = without_limit(film, options, summary);
  // Differences that fall more slowly than with the root of the spacing are no measure of what is left: beside point
  // sources some grow with its logarithm.
  std::map<std::string, double> size;  // of a vector or of all heats, of which one may vanish
  const auto kin = [&](std::size_t k) {
    const std::string& name = summary.values[k].first;
    return name.starts_with("heat.") ? "heat" : stem_of(name);
  };
  for (std::size_t k = 0; k < count; ++k) size[kin(k)] = std::max(size[kin(k)], std::abs(found[0][k]));
  std::vector<std::string> steady;
  for (std::size_t k = 0; k < count && meshes.size() > 2; ++k) {
    if (limitless.contains(summary.values[k].first)) continue;
    const double fine = std::abs(found[0][k] - found[1][k]), coarse = std::abs(found[1][k] - found[2][k]);
    if (fine * std::numbers::sqrt2 >= coarse && fine > 1e-6 * size[kin(k)]) steady.push_back(summary.values[k].first);
  }
  if (!steady.empty())
    summary.warnings.push_back(
        fmt::format("the meshes are too coarse to confirm convergence of {}: the error bars may be too small",
                    fmt::join(steady, ", ")));
  const double left = options.tolerance * options.ambient.temperature;
  bars.write([&](const std::string& name, double value) {
    if (name.starts_with("temperature.")) return left;
    if (options.load.values.empty()) return options.tolerance * std::abs(value);
    // Under a load the place is found as far as the force shows it.
    const auto [x, y] = load_along(options.load);
    return load_tolerance * (name == "load.x" || name == "load.y" ? std::hypot(x, y) : std::abs(value));
  });
  if (limitless.empty()) return;
  for (auto& [name, q] : summary.values)
    if (limitless.contains(name)) q.more.clear();
  summary.warnings.push_back(
      fmt::format("these values have no error bar, because beside orifices, which are points, they change with the "
                  "logarithm of the "
                  "mesh spacing and have no limit: {}. heat.film, temperature.mean and the percentiles do converge",
                  fmt::join(limitless, ", ")));
}

}  // namespace whirl::study
