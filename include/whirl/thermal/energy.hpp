#pragma once
// The energy equation of a film, in film-fitted finite volumes:
//
//   sum over the faces of a cell of (m i(T_f) - k A dT/dn) = heat + inflow i(T_inflow) + g (T_wall - T),   di = c dT
//
// with the mass flows m of the pressure equation. Net outflow of mass equals the inflow in every cell, so that a
// constant temperature needs no source. Temperatures of faces are those upstream, first order, or with a limited slope,
// second order in smooth regions; neither makes new extrema. In the half volume into which flow enters through an end
// the temperature is of first order, what leaves it of second.

#include <array>
#include <memory>
#include <vector>

#include "whirl/core/gate.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/thermal/flow.hpp"
#include "whirl/thermal/property.hpp"
#include "whirl/thermal/rows.hpp"

namespace whirl::thermal {

/// What lies beyond the layer of cells at a wall: [r, n] each, r rows of this rank, n nodes around.
struct Wall {
  std::vector<double> conductance;  // W/K, from the cell's centre to where the temperature is given, through a film of
                                    // the conductivity at the ambient's temperature without turbulence; 0 of an
                                    // adiabatic wall; Energy::half_layer() of one whose surface has that temperature
  std::vector<double> temperature;  // K
};

/// Temperatures given from outside.
struct Surroundings {
  Wall bush, journal;            // at zeta = 0 and 1
  double ambient = 300;          // K, of what flows in through the ends
  std::vector<double> supply;    // K [r, n], of what comes from orifices and grooves; empty: ambient
  std::vector<double> entering;  // K [r, l], of what flows into cells i = 0 of a pad; empty: ambient
  // [r, n], the groove of a node whose oil is mixed to one temperature, counted from 1, 0 of none; empty: there is none
  std::vector<int> mixed{};
};

/// The lubricant and the order of the scheme. Where a law falls to zero or below, DomainError ends the solution.
struct EnergyModel {
  double heat_capacity = 0;         // J/(kg K), times its law
  double conductivity = 0;          // W/(m K), times its law
  int order = 2;                    // of convection: 1 or 2
  PropertyLaw heat_capacity_law{};  // over the temperature
  PropertyLaw conductivity_law{};
};

/// W, what crosses the control volume of the whole film, as enthalpy above that at the ambient's temperature.
struct EnergyBudget {
  double heat = 0;     // what the motion leaves
  double bush = 0;     // conducted to the bush
  double journal = 0;  // conducted to the journal
  double ends = 0;     // carried out through the ends, less what is carried in
  double supply = 0;   // carried in by orifices and grooves
  [[nodiscard]] double residual() const { return heat + supply - bush - journal - ends; }
};

/// What a solution cost.
struct EnergySolve {
  int newton = 0;       // Newton steps; one of first order, whose equations are linear
  int krylov = 0;       // iterations of the linear solver in all of them
  double residual = 0;  // W, Euclidean norm over cells
  double before = 0;    // W, of the temperatures given
  double scale = 0;     // W, of the ambient's temperature everywhere: what heats the film
  bool converged = false;
  /// Neither converged nor nearer, and not for rounding; also where the residual is not a number.
  [[nodiscard]] bool stuck() const { return !converged && !(residual <= 1e-6 * scale) && !(residual <= 0.9 * before); }
};

class EnergyTerms;
class EnergyLines;

/// Temperatures [rows.cells()] of a film. PETSc options with prefix `film_energy_` come on top: SNES with an inexact
/// Newton method (Eisenstat-Walker), GMRES preconditioned from the right by line Gauss-Seidel: the first-order operator
/// is solved exactly in each column across the film, columns are swept with the flow. With another preconditioner, say
/// `-film_energy_pc_type lu`, the Jacobian is assembled. `-film_energy_sweeps` sets how often columns are swept, by
/// default twice, four times where flow around the film reverses.
class Energy {
public:
  /// `rows` and `flow` are kept by reference and outlive this. thickness [r, n], m. Collective. Throws core::Error, on
  /// all ranks, if an array has a wrong size.
  Energy(const Rows& rows, const Flow& flow, const EnergyModel& model, const std::vector<double>& thickness,
         Surroundings surroundings);
  ~Energy();
  Energy(const Energy&) = delete;
  Energy& operator=(const Energy&) = delete;

  /// W/K [r, n] from the centre of a cell at a wall to the wall, k A/(h/(2 l)), k that at the ambient's temperature.
  [[nodiscard]] static std::vector<double> half_layer(const Rows& rows, double conductivity,
                                                      const std::vector<double>& thickness);
  /// After the flow, which it reads anew, the thickness or the surroundings have changed. Collective.
  void update(const std::vector<double>& thickness, Surroundings surroundings);
  /// Walls only: of conductances and temperatures that change with the solids. Collective.
  void set_surroundings(Surroundings surroundings);

  /// Solves for the temperature, K, from the one given, until the residual's norm is `tolerance` times the norm of the
  /// residual at the ambient's temperature everywhere, or `reduction` times the one it starts with. Not converging is
  /// no error, the outcome says it. Collective.
  EnergySolve solve(Vec temperature, double tolerance = 1e-10, double reduction = 0);

  // The parts of a coupled system.
  /// W [cells]: what flows out of each cell less what comes in. Collective.
  void residual(Vec temperature, Vec out);
  /// Takes the point at which jacobian() and assemble() are. Collective.
  void linearise(Vec temperature);
  /// W/K: exact derivative of residual(), as a product.
  [[nodiscard]] Mat jacobian() const { return jacobian_.get(); }
  /// The same as a sparse matrix, in the numbering of rows.cells(), without the means of grooves that are mixed, which
  /// join all cells of a groove. Collective.
  [[nodiscard]] core::Matrix assemble() const;
  /// x = one application of the line preconditioner to r. Collective.
  void precondition(Vec r, Vec x);
  /// Sweeps of each application.
  [[nodiscard]] int sweeps() const;
  [[nodiscard]] EnergyBudget budget(Vec temperature);
  /// K, of each groove that is mixed. Collective.
  [[nodiscard]] std::vector<double> mixed(Vec temperature);
  /// - [r, n]: how much better than half_layer() says the half layer at a wall conducts, by the conductivity there over
  /// that at the ambient's temperature and by turbulence.
  [[nodiscard]] std::vector<double> wall_factors(Vec temperature, bool journal);
  /// W [r, n], conducted to a wall from each of its cells: budget() has their sums.
  [[nodiscard]] std::vector<double> wall_heat(Vec temperature, bool journal);

private:
  static PetscErrorCode form_residual(SNES, Vec x, Vec f, void* self);
  static PetscErrorCode form_jacobian(SNES, Vec x, Mat, Mat, void* self);
  void make_solver();

  const Rows& rows_;
  core::Gate gate_;
  std::unique_ptr<EnergyTerms> terms_;
  std::unique_ptr<EnergyLines> lines_;
  core::Matrix jacobian_, assembled_;
  core::Vector rise_, residual_;
  core::NonlinearSolver snes_;
};

}  // namespace whirl::thermal
