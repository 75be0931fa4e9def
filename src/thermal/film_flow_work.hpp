#pragma once
// What the equation for the pressure of a film works with.

#include <utility>
#include <vector>

#include "whirl/core/gate.hpp"
#include "whirl/thermal/film_flow.hpp"

namespace whirl::thermal {

struct Profile;

/// kg/s through a face, and its derivatives in the pressures before and behind it.
struct Flux {
  double value, before, behind;
};

struct FilmFlow::Work {
  struct Face {           // of a gas per pressure
    double gradient = 0;  // kg/s per m of width and Pa/m: negative
    double drag = 0;      // kg/s per m of width
    double reynolds = 0;  // -, of turbulence
  };
  struct Hole {
    double conductance;  // kg/(s Pa^2) of the film around it
    double logarithm;    // of the rim over the radius at which a node stands for its source
    double area;         // m^2, with the discharge coefficient
    double reynolds;     // 1/Pa
  };

  Work(const Rows& rows, FilmFlowOptions options, std::vector<double> thickness);
  void set_temperature(const std::vector<double>& cells);
  void residual(Vec state, Vec out) const;
  void jacobian(Vec state, Mat matrix) const;
  int solve(double tolerance, double reduction);
  /// Pressure of every other node around, in between their mean.
  void begin_on_half();

  static std::size_t at(PetscInt k) { return static_cast<std::size_t>(k); }
  /// Place of a node in arrays with a row before and one behind.
  [[nodiscard]] std::size_t halo(int i, int q) const { return at((q - rows.begin() + 1) * n + i); }
  /// The profile at the face between two nodes, by their places.
  void face(std::size_t a, std::size_t b, Profile& profile);
  [[nodiscard]] double density(std::size_t a, std::size_t b, std::size_t k) const;
  /// rho |U| h/mu at the face that face() was called for last; of a gas per pressure.
  [[nodiscard]] double reynolds(std::size_t a, std::size_t b) const;
  /// k/12 of the pressure's flow, and its derivative in the Reynolds number.
  [[nodiscard]] Valued resist(const Resistance& law, double reynolds) const;
  /// Conductance of the film around an orifice, over the one that is laminar, at a node's pressure.
  [[nodiscard]] Valued around_hole(std::size_t k, double p) const;
  /// How eddies help to conduct heat across.
  void mix(Flow& flow) const;
  [[nodiscard]] Flux through(const Face& face, const Resistance& law, double width, double step, double p,
                             double q) const;
  /// The same of a film that conserves its mass, in the states of both nodes.
  [[nodiscard]] Flux through_partly(double gradient, double drag, double p, double q) const;
  void choose_scale();
  [[nodiscard]] MassFlow through_hole(std::size_t k, double p) const;

  const Rows& rows;
  const Mesh mesh;
  const FilmFlowOptions options;
  const int n;
  const bool conserving = options.cavitation == FilmFlowOptions::Cavitation::mass_conserving;
  double scale = 1;  // Pa, of the pressure: an empty share times this is a state below zero
  const bool turbulent = options.turbulence != Turbulence::laminar;
  const Resistance law_around = resistance_around(options.turbulence), law_along = resistance_along(options.turbulence);
  std::vector<double> h, temperature, mu;  // with the rows beside
  std::vector<bool> fixed;                 // nodes whose pressure is given
  std::vector<double> given;
  std::vector<std::size_t> here;  // orifices of this rank
  std::vector<Hole> at_hole;
  std::vector<Face> around, along;
  std::vector<double> pressure, hole;  // Pa [r, n], behind the orifices of this rank
  std::vector<double> filled;          // - [r, n]
  core::Vector u, f, low, high;
  core::Matrix j;
  core::NonlinearSolver snes;
  PetscInt first = 0, first_before = 0, first_behind = 0;  // numbers: of this rank, of the rows beside
  double typical = 0;
  bool cold = true;  // no pressure was given or found before
  bool multigrid = false, split_done = false;
  core::Gate gate{rows.comm()};

private:
  static PetscErrorCode form_residual(SNES snes, Vec x, Vec out, void* context);
  static PetscErrorCode form_jacobian(SNES snes, Vec x, Mat a, Mat matrix, void* context);
  void place();
  void prepare_solver();
  void choose_linear_solver();
  void split_rims(PC pc) const;
  void finish_linear_solver();
  void limit_linear_solver(double residual);
  void choose_lag(int newton, int krylov);
  void load(const std::vector<double>& p);
  [[nodiscard]] std::vector<double> nodes_of(const double* state) const;
  /// node(number here, place) of all nodes here, edge(i, j, i', j', flux) of all faces that these have.
  template <class Node, class Edge>
  void visit(const std::vector<double>& p, const Node& node, const Edge& edge) const;
  std::vector<double> mu_at_;
};

}  // namespace whirl::thermal
