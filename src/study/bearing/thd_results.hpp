#pragma once
// What a film with heat leaves in the results: named values with their bars, rows over the speed, fields and pictures,
// and films of one temperature beside it.

#include <string>
#include <vector>

#include "study/bearing/thd_at_speed.hpp"
#include "study/bearing/thd_load.hpp"
#include "study/bearing/thd_study.hpp"
#include "study/pieces.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/io/table.hpp"

namespace whirl::study {

/// The table over the speed, without rows.
[[nodiscard]] io::Table thd_table();
/// Appends the row of a film that is solved. Collective.
void append_thd(io::Table& table, ThdAtSpeed& film, double speed);

/// All named values of a film that is solved, but for what rounding and iterations leave. Collective.
void put_thd_values(io::StudySummary& summary, ThdAtSpeed& film, const ThdOptions& options);

/// Intervals around and along and layers across of the meshes that the error bars stand on, the deck's first, each with
/// half of the cells of the one before it in every direction. The list ends before a mesh on which an orifice would
/// stand further from where it belongs than on the deck's, or with the deck's where no bars are wanted.
[[nodiscard]] std::vector<std::array<int, 3>> thd_meshes(const ThdOptions& options, double length,
                                                         const LayoutOptions& layout);

/// Solves the film on the coarser meshes at one speed, puts the error bars beside the values that `context` has in its
/// summary, and all values over the mesh into its results. Collective.
/// Values without a limit get none, and a warning that names them; meshes without an answer, too.
void put_thd_bars(Context& context, ThdAtSpeed& film, const ThdOptions& options, const film::Geometry& geometry,
                  double speed, const FilmStart& start, double energy_residual, Pieces& pieces);

/// Names of those extremes of put_thd_values() that stand at an orifice or at a node beside one. Collective.
[[nodiscard]] std::vector<std::string> extremes_at_orifices(ThdAtSpeed& film);

/// Puts the table `properties` into `group`: for each of the options' `temperatures` viscosity Pa s, density kg/m^3 at
/// the pressure of the ambient, conductivity W/(m K), heat capacity J/(kg K), Prandtl number, of a gas the ratio of
/// specific heats c/(c - r), and the clearance m that bush and journal leave when both have this temperature
/// throughout. A part without `growth` keeps its size. Nothing without temperatures. Source: Skarolek (2011) fig. 1.9.
void put_properties(io::Group& group, const ThdOptions& options, const thermal::Fluid& fluid,
                    const film::Geometry& geometry);

/// K, of the cells of a film: by volume, and the extremes and percentiles of the cells.
struct TemperatureNumbers {
  double mean = 0, minimum = 0, maximum = 0, percentile_1 = 0, percentile_99 = 0;
};
/// Collective. Percentiles are right to a millionth of the span.
[[nodiscard]] TemperatureNumbers temperature_numbers(const ThdAtSpeed& film, const std::vector<double>& temperature);

/// K, of a surface: its mean and its greatest temperature, of arrays [r, n]. Collective.
struct SurfaceNumbers {
  double mean = 0, maximum = 0;
};
[[nodiscard]] SurfaceNumbers surface_numbers(const ThdAtSpeed& film, const std::vector<double>& temperature);

/// Fields of film and solids into `group`, rows shared by the ranks, and their meshes. Collective.
void put_thd_fields(Context& context, ThdAtSpeed& film, const film::Geometry& geometry);

/// Four grids of what the group `film` of the results holds by now: the cells between bush and journal, and the surface
/// with pressure, thickness, walls and flow, each as it lies and unwrapped (x = radius times angle, y along the shaft;
/// the film a hundred times as thick). Collective.
void show_film(Context& context, ThdAtSpeed& film, const film::Geometry& geometry);

/// The temperature of a solid into a group `name` of the results, and its grid: a bush where the film ends, a journal
/// where it stands, a turning one as the half of a section through its axis. Collective.
void put_solid(Context& context, const ThdAtSpeed& film, const thermal::Solid& solid, Vec temperature,
               const std::string& name, const film::Geometry& geometry);

/// Puts the temperatures at which a film of one temperature, at the place of the journal that `film` has and with the
/// clearance that it has, has the same load (magnitude of the force), the same power loss and the same flow of the
/// supplies as `film`: `temperature.effective.*` K into `summary`, and of the film with the same load the relative
/// errors of the other quantities. The table `effective` in `group` has all: a row for each quantity that is held.
/// A quantity that no temperature up to one span of the film's temperatures beyond them gives is absent, with a
/// warning; one that is zero, as the power loss at rest, too. Collective. Cost: 10 to 30 flows of a film that is
/// solved.
void put_effective(io::Group& group, io::StudySummary& summary, ThdAtSpeed& film, double ambient);

/// Puts the temperature at which the heat balance of the whole film is even, at the place of the journal that `film`
/// has, and what a film of that temperature carries and loses. Walls that conduct have the mean temperature of their
/// surfaces. Puts nothing of a gas, whose Prandtl number is too small, and of a film that dissipates nothing.
/// Collective.
void put_lumped(io::StudySummary& summary, ThdAtSpeed& film, const ThdOptions& options, const film::Geometry& geometry);

}  // namespace whirl::study
