#pragma once
// A film with its heat: pressure, temperatures of film, bush and journal together.

#include <memory>
#include <vector>

#include "whirl/thermal/energy.hpp"
#include "whirl/thermal/film_flow.hpp"
#include "whirl/thermal/options.hpp"
#include "whirl/thermal/solid.hpp"

namespace whirl::thermal {

struct ThdSetup {
  FilmFlowOptions flow;
  int order = 2;         // of the convection of heat
  double ambient = 300;  // K, of what is drawn in through the ends
  WallOptions bush, journal;
  bool inlet_from_bush = false;  // what orifices give has the temperature of the bush there, else `supply`
  std::vector<double> supply;    // K [r, n], of what comes from orifices and grooves
  std::vector<int> mixed{};      // [r, n], the groove of a node that is mixed, from 1, 0 of none; empty: there is none
  double tolerance = 1e-9;       // of temperatures, relative to the ambient's
  int most_iterations = 60;      // rounds of a solution, unless they still converge
  int coarse_start = 50000;      // cells, above which a first solution starts from that of a coarser mesh; 0: never
};

/// What a solution cost: largest is the greatest change of a temperature in each iteration, K.
struct ThdSolve {
  int iterations = 0, pressure = 0, energy_newton = 0, energy_krylov = 0, solid = 0;
  std::vector<double> largest;
  struct Seconds {  // wall time; of the flow also properties and profiles
    double pressure = 0, flow = 0, energy = 0, solids = 0;
  } seconds;
  bool converged = false;
};

/// Pressure, temperature of the film, and temperatures of what conducts heat beside it. One round takes the temperature
/// to the pressure and the flow, these to the film's temperature between its walls, and that to the solids. Rounds are
/// joined by Anderson's method (SNES, options begin with `thd_`): where heat leaves the solids slowly they alone would
/// hardly converge.
class ThdSolver {
public:
  /// thickness m [r, n]. Collective. Throws core::Error, on all ranks, where the flow or a solid does.
  ThdSolver(const Rows& rows, ThdSetup setup, std::vector<double> thickness);
  ~ThdSolver();
  ThdSolver(const ThdSolver&) = delete;
  ThdSolver& operator=(const ThdSolver&) = delete;

  /// From the last state, or from that given to start(), on; at first from the ambient's temperature, on a large mesh
  /// (`-thd_coarse_start` cells) from the solution on one of half the intervals. Rounds are solved as far as the last
  /// one's change is worth it, one more at the end to rounding. Not converging is no error. Collective. Throws
  /// core::NotConverged where the pressure is not found, or bush and journal grow until the film is closed.
  ThdSolve solve();
  /// What start() of another film on this mesh goes on from, [r, n, l + 5]: temperatures of the film [K], those behind
  /// bush and journal [K], what bush and journal grow, over expansion times radius [K], and the pressure [Pa].
  [[nodiscard]] std::vector<double> state() const;
  void start(const std::vector<double>& state);
  /// m [r, n], with what the solids have grown.
  [[nodiscard]] const std::vector<double>& thickness() const;
  [[nodiscard]] const FilmFlow& flow() const;
  [[nodiscard]] const Flow& flows() const;
  /// K [r, n, l].
  [[nodiscard]] const std::vector<double>& temperature() const;
  /// W. Collective.
  [[nodiscard]] EnergyBudget budget();
  /// W [r, n], conducted to bush or journal by the volume of each node. Collective.
  [[nodiscard]] std::vector<double> wall_heat(bool journal);
  /// K, of each groove that is mixed. Collective.
  [[nodiscard]] std::vector<double> mixed();
  // Of the journal or the bush:
  /// Null where the wall is none.
  [[nodiscard]] const Solid* solid(bool journal) const;
  /// K, of its cells.
  [[nodiscard]] Vec solid_temperature(bool journal) const;
  /// K [r, n], of the film's surface.
  [[nodiscard]] std::vector<double> surface(bool journal) const;

private:
  struct Work;
  std::unique_ptr<Work> w_;
};

}  // namespace whirl::thermal
