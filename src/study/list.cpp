#include "study/bearing/bearing_map.hpp"
#include "study/bearing/dynamic_coefficients.hpp"
#include "study/bearing/gas_bearing.hpp"
#include "study/bearing/thd_study.hpp"
#include "study/convergence/mesh_convergence.hpp"
#include "study/cycle/cycle_branch.hpp"
#include "study/equilibrium/alignment.hpp"
#include "study/equilibrium/equilibrium_branch.hpp"
#include "study/equilibrium/static.hpp"
#include "study/linear/critical_speed_map.hpp"
#include "study/linear/element_convergence.hpp"
#include "study/linear/frequency_response.hpp"
#include "study/linear/modes.hpp"
#include "study/linear/reduction_errors.hpp"
#include "study/linear/unbalance_response.hpp"
#include "study/locus/locus.hpp"
#include "study/motion/linearity.hpp"
#include "study/motion/motion.hpp"
#include "study/motion/run_up.hpp"
#include "study/stress/stress.hpp"
#include "whirl/study/sweep/sweep.hpp"

namespace whirl::study {
namespace {

template <class S>
deck::Kind<Study> kind(std::string text) {
  return {std::string(S::key), std::move(text), &deck::structure_of<typename S::Given>(),
          [] { return std::make_unique<S>(); }, &S::place};
}

}  // namespace

const std::vector<deck::Kind<Study>>& kinds() {
  static const std::vector<deck::Kind<Study>> all{
      kind<Static>("where the journals sit in their films at one speed, loads, coefficients, film fields"),
      kind<BearingMap>("one bearing: impedance, locus, stiffness and damping over eccentricity, Routh's threshold"),
      kind<GasBearing>(
          "one film of gas: load, flow and losses over eccentricity and under a load, meshes, design maps"),
      kind<DynamicCoefficients>(
          "one bearing: stiffness and damping of its film over speed and frequency, with tilts if wanted"),
      kind<ThdStudy>("one film with heat: pressure, temperature in film and solids, power and heat over the speed"),
      kind<Alignment>("bearing elevations that give zero coupling moments and wanted loads on rigid supports"),
      kind<Modes>("eigenvalues over speed: damping, whirl direction, critical speeds, Campbell diagram"),
      kind<CriticalSpeedMap>("undamped critical speeds of the shaft over the stiffness of its bearings"),
      kind<ElementConvergence>("whirl frequencies over the number of elements of the shaft, condition numbers"),
      kind<FrequencyResponse>("transfer functions from forces to motions over the frequency, at one speed"),
      kind<ReductionErrors>("what reductions of the shaft cost: eigenvalues, eigenvectors, orbits, reduced matrices"),
      kind<UnbalanceResponse>("linear response to unbalance: amplitude, phase, peaks, separation margins"),
      kind<Stress>("bending moments and stresses along the shaft, by what stands still and by unbalance, with margins"),
      kind<EquilibriumBranch>("equilibria over a parameter with folds and Hopf bifurcations"),
      kind<CycleBranch>("limit cycles, forced or self-excited, over a parameter with multipliers and bifurcations"),
      kind<Motion>("a motion in time: orbit, Poincare points, spectrum, Lyapunov exponents, what kind of motion it is"),
      kind<RunUp>("a rotor whose speed rises or falls evenly: amplitude in every revolution on the way"),
      kind<Linearity>(
          "whether a rotor answers random forces as its linearisation: transfer functions, coherence, bounds"),
      kind<Locus>("curve of one bifurcation of a branch in two parameters, with points of codimension two"),
      kind<MeshConvergence>("bifurcations of a branch of cycles on finer and finer film meshes: order, limit, error"),
      kind<Sweep>("the same studies for variants of the machine: one table of all values, trends"),
  };
  return all;
}

}  // namespace whirl::study
