#pragma once
// One bearing with heat as a deck describes it, on the ranks of a communicator.

#include <array>
#include <memory>
#include <vector>

#include "whirl/study/bearing/thd.hpp"
#include "whirl/thermal/thd.hpp"

namespace whirl::study {

/// A film at one speed.
class ThdFilm {
public:
  /// Collective. Throws core::Error, on all ranks, where the mesh cannot hold what the options ask for.
  ThdFilm(MPI_Comm comm, const ThdOptions& options, const film::Geometry& geometry, double speed);

  [[nodiscard]] const thermal::Rows& rows() const { return rows_; }
  /// m [r, n].
  [[nodiscard]] const std::vector<double>& thickness() const { return thd_->thickness(); }
  /// m, of the journal's middle from the bearing's.
  [[nodiscard]] const std::array<double, 2>& place() const { return place_; }
  [[nodiscard]] thermal::Thd& thd() { return *thd_; }
  /// Whether the temperatures settled. Collective.
  bool solve() { return (cost_ = thd_->solve()).converged; }
  [[nodiscard]] const thermal::ThdSolve& cost() const { return cost_; }
  [[nodiscard]] bool is_gas() const { return flow_.fluid.gas; }
  /// Pressure Pa [r, n] and what it does with the temperature of the ambient everywhere.
  struct Isothermal {
    std::vector<double> pressure;
    thermal::FlowReport report;
  };
  [[nodiscard]] Isothermal isothermal() const;

private:
  thermal::Rows rows_;
  std::vector<double> thickness_;
  thermal::FilmFlowOptions flow_;
  double ambient_;
  std::array<double, 2> place_;
  std::unique_ptr<thermal::Thd> thd_;
  thermal::ThdSolve cost_;
};

}  // namespace whirl::study
