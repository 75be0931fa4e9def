#pragma once
// One bearing with heat as a deck describes it, on the ranks of a communicator.

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "study/bearing/thd_study.hpp"
#include "whirl/thermal/thd_solver.hpp"

namespace whirl::study {

/// Node [around, along] of each orifice, ring by ring, on the mesh of `cells` of a film that is `length` long [m].
[[nodiscard]] std::vector<std::array<int, 2>> orifice_nodes(const ThdOptions& options, double length);
/// The first ring with an orifice at the node of another one, of it or of a ring before it; from 0.
[[nodiscard]] std::optional<std::size_t> orifices_at_one_node(const ThdOptions& options, double length);

/// A film at one speed.
class ThdAtSpeed {
public:
  /// Collective. Throws core::Error, on all ranks, where the mesh cannot hold what the options ask for.
  ThdAtSpeed(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry, double speed);

  [[nodiscard]] const thermal::Rows& rows() const { return rows_; }
  /// m [r, n].
  [[nodiscard]] const std::vector<double>& thickness() const { return thd_->thickness(); }
  /// m, of the journal's middle from the bearing's.
  [[nodiscard]] const std::array<double, 2>& place() const { return place_; }
  /// In clearances; rad, from +x.
  [[nodiscard]] double eccentricity() const { return std::hypot(place_[0], place_[1]) / clearance_; }
  [[nodiscard]] double attitude() const { return std::atan2(place_[1], place_[0]); }
  [[nodiscard]] thermal::ThdSolver& thd() { return *thd_; }
  /// Whether the temperatures settled. Collective.
  bool solve() { return (cost_ = thd_->solve()).converged; }
  [[nodiscard]] const thermal::ThdSolve& cost() const { return cost_; }
  [[nodiscard]] bool is_gas() const { return flow_.fluid.gas; }
  [[nodiscard]] const thermal::Fluid& fluid() const { return flow_.fluid; }
  [[nodiscard]] const std::vector<thermal::Orifice>& orifices() const { return flow_.orifices; }
  /// rad/s
  [[nodiscard]] double speed() const { return flow_.speed; }
  /// [r, n], the groove that feeds a node, counted from 1 in the order of the deck, 0 of none; empty: there is none.
  [[nodiscard]] std::vector<int> grooves() const;
  /// Pressure Pa [r, n] and what it does with one temperature everywhere.
  struct Isothermal {
    std::vector<double> pressure;
    thermal::FlowReport report;
    double drawn = 0;  ///< kg/s, of all that comes in
    double inlet = 0;  ///< K, mean temperature of that
  };
  /// Before solids grow, at the temperature of the ambient / at another, K, also between solids as they have grown:
  /// `pressure` is as in force_beside(). Collective.
  [[nodiscard]] Isothermal isothermal() const;
  [[nodiscard]] Isothermal isothermal(double temperature, std::vector<double>& pressure, bool grown = false) const;
  /// N, on the journal `move` m from where it is, with the temperatures that the film has. `pressure` Pa [r, n] is
  /// where the search for it begins, empty: from none, and what it finds. Collective. Throws core::NotConverged.
  [[nodiscard]] std::array<double, 2> force_beside(const std::array<double, 2>& move,
                                                   std::vector<double>& pressure) const;

private:
  thermal::Rows rows_;
  std::vector<double> thickness_;
  thermal::FilmFlowOptions flow_;
  std::vector<double> supply_;  // K [r, n]
  double ambient_, clearance_;
  std::array<double, 2> place_;
  std::unique_ptr<thermal::ThdSolver> thd_;
  thermal::ThdSolve cost_;
};

}  // namespace whirl::study
