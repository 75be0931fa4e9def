#pragma once
// Conduction of heat in a bush or a journal, and how it is joined to a film.
//
//   rho c dT/dt = div(k grad T) + source,    -k dT/dn = h (T - T_a) on free surfaces,
//   heat from the film's column (i, j) into the wall: joined (T_film - T_cell), joined = 1/(1/g_film + resistance).
//
// Finite volumes. Conductances in r are those of a logarithmic profile, so that radial conduction is exact.

#include <string>

#include "whirl/thermal/cylinder.hpp"
#include "whirl/thermal/rows.hpp"

namespace whirl::thermal {

struct Material {
  double conductivity = 0;   // W/(m K)
  double density = 0;        // kg/m^3, where heat is stored
  double heat_capacity = 0;  // J/(kg K), likewise
  double expansion = 0;      // 1/K, linear, where its growth changes the clearance
};

/// What happens at a free surface.
struct Surface {
  enum class Kind { adiabatic, convection, prescribed };
  Kind kind = Kind::adiabatic;
  double coefficient = 0;    // W/(m^2 K), of convection
  double temperature = 300;  // K, of what lies outside / prescribed
};

/// The free surfaces of a solid: those at its least and its largest radius, as far as no film wets them, and its ends
/// in z.
struct Surfaces {
  Surface inner, outer, begin, end;
};

/// W, what crosses the surfaces of a solid: in from the film, out through all others.
struct Heats {
  double wall = 0, inner = 0, outer = 0, begin = 0, end = 0;
  /// What is stored, or of a steady state what the solver left.
  [[nodiscard]] double residual() const { return wall - inner - outer - begin - end; }
};

/// Algebraic multigrid for the matrix of a solid: BoomerAMG, coarsened aggressively once, whatever else the options of
/// its prefix say. Of 4e5 cells, also in layers from 1 to 280 thick, it takes 14-18 iterations of conjugate gradients
/// to 1e-10 and 530 bytes a cell; PETSc's own GAMG 17-101 iterations, or three times the memory.
void use_multigrid(PC pc);

/// Conduction in a solid whose rows lie on the ranks that hold the film's rows; what reaches beyond the film lies on
/// the first and on the last rank. Cells are numbered (q, i, k), k fastest, over all ranks in this order. Arrays of
/// columns of the film have the shape [r, n]: rows of this rank, nodes around, i fastest.
class Solid {
public:
  /// Options of the solver begin with `prefix` (conjugate gradients, use_multigrid). Collective on the film's
  /// communicator. Throws core::Error, on all ranks, if the free surface of a rotating journal is of prescribed
  /// temperature.
  Solid(const Rows& film, Cylinder shape, const Material& material, const Surfaces& surfaces, std::string prefix);

  [[nodiscard]] const Cylinder& shape() const { return shape_; }
  [[nodiscard]] MPI_Comm comm() const { return comm_; }
  /// Rows q and cells of this rank.
  [[nodiscard]] int begin() const { return begin_; }
  [[nodiscard]] int end() const { return end_; }
  [[nodiscard]] PetscInt count() const { return (end_ - begin_) * row_cells(); }
  /// Number of a cell among all.
  [[nodiscard]] PetscInt cell(int k, int i, int q) const {
    return static_cast<PetscInt>(q) * row_cells() + static_cast<PetscInt>(i) * shape_.layers() + k;
  }

  // What a matrix of film and solid together is made of.
  /// [r, n] number of the cell at the wall of each column; of a rotating journal that of a row, the same all around.
  [[nodiscard]] const std::vector<PetscInt>& wall() const { return wall_; }
  /// K/W [r, n] from the wall's surface to that cell; 0 of a rotating journal, whose wall is a cell of its own.
  [[nodiscard]] const std::vector<double>& resistance() const { return resistance_; }
  /// W/K [r, n] from the film's cell to the solid's, as of the last join().
  [[nodiscard]] const std::vector<double>& joined() const { return joined_; }
  /// Whether the temperature of a cell is prescribed: its row of matrix() is diagonal and knows no film.
  [[nodiscard]] bool held(PetscInt cell) const;
  /// W/K [cells, cells] symmetric: conduction, free surfaces, and `joined` on the diagonal.
  [[nodiscard]] Mat matrix() const { return matrix_.get(); }
  /// W [cells], right-hand side without the film: from the surroundings and prescribed temperatures.
  [[nodiscard]] Vec supply() const { return supply_.get(); }
  /// J/K [cells].
  [[nodiscard]] core::Vector capacity() const;
  /// A vector [cells], every entry `value`.
  [[nodiscard]] core::Vector temperature(double value) const;

  /// W/K [r, n] from the centre of the film's cell at the wall to the wall: changes matrix(). Collective.
  void join(const std::vector<double>& film);
  /// rhs = supply + joined times film temperature, K [r, n].
  void load(const std::vector<double>& film, Vec rhs) const;

  // The solid by itself, with the film's temperatures given.
  /// Solves matrix() T = rhs from T on; relative to the residual it starts with, to 1e-10 unless options say otherwise,
  /// but not beyond rounding. Returns iterations. Collective. Throws core::NotConverged on all ranks, also if neither a
  /// film nor a surface holds the temperature. `reduction` replaces a smaller relative tolerance.
  int solve(Vec rhs, Vec temperature, double reduction = 0);
  /// W [r, n] into the solid / K [r, n] of the wall's surface, with the film's temperatures, K [r, n].
  [[nodiscard]] std::vector<double> wall_heat(Vec temperature, const std::vector<double>& film) const;
  [[nodiscard]] std::vector<double> wall_temperature(Vec temperature, const std::vector<double>& film) const;
  /// m [r] by which the wall's radius has grown beside each row of the film against that at `reference` [K]: expansion
  /// times radius times the mean rise over the section, as of a ring or a disc free of load (Timoshenko and Goodier
  /// 1951, section 135; exact at both of its radii, whatever the temperature is over r). Its derivative by the
  /// temperature of a cell is expansion R sector(k) angle(i) over the sum of these.
  [[nodiscard]] std::vector<double> growth(Vec temperature, double reference) const;
  /// All that crosses the surfaces; sources in cells of prescribed temperature are not counted. Collective.
  [[nodiscard]] Heats heats(Vec temperature, const std::vector<double>& film) const;

private:
  struct Exposed {  // a free surface of a cell
    double Heats::*to;
    double conductance, temperature;  // W/K, K
  };
  [[nodiscard]] PetscInt row_cells() const { return static_cast<PetscInt>(shape_.columns()) * shape_.layers(); }
  [[nodiscard]] PetscInt local(PetscInt cell) const { return cell - begin_ * row_cells(); }
  [[nodiscard]] const Surface* prescribed_end(int q) const;
  [[nodiscard]] double covered(int i, int q) const;
  template <class Visit>
  void each_neighbour(int k, int i, int q, const Visit& visit) const;
  template <class Visit>
  void each_surface(int k, int i, int q, const Visit& visit) const;
  void place_walls();
  void assemble();
  void assemble_reactions();
  void prepare_solver();

  Mesh film_;
  MPI_Comm comm_;
  Cylinder shape_;
  Material material_;
  Surfaces surfaces_;
  std::string prefix_;
  int begin_ = 0, end_ = 0, film_begin_ = 0, film_end_ = 0;
  std::vector<PetscInt> wall_;
  std::vector<double> resistance_, joined_;
  core::Matrix matrix_, reactions_;  // reactions_: rows of conduction of the cells that are held here
  core::Vector supply_, diagonal_;   // diagonal_: of the matrix without the film
  bool grounded_ = false;            // some surface holds the temperature
  core::LinearSolver solver_;
};

}  // namespace whirl::thermal
