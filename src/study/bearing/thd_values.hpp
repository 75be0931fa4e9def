#pragma once
// Named values of a film with heat, its row in the table over the speed, and what its fluid is over the temperature.

#include <span>
#include <string>
#include <vector>

#include "study/bearing/thd_load.hpp"
#include "study/bearing/thd_study.hpp"
#include "study/pieces.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// A column of the table over the speed.
struct ThdColumn {
  const char *name, *unit, *description;
};
[[nodiscard]] std::span<const ThdColumn> thd_columns();
/// One number for each column, of a film that is solved. Collective.
[[nodiscard]] std::vector<double> thd_row(ThdAtSpeed& film, double speed);

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

}  // namespace whirl::study
