#pragma once
// The terms of the energy equation: fluxes through faces, one column of faces across the film at a time.

#include <array>
#include <vector>

#include "thermal/energy_laws.hpp"
#include "thermal/halo.hpp"
#include "whirl/thermal/energy.hpp"

namespace whirl::thermal {

/// Faces around, along and across the film.
enum class Direction { around, along, across };

/// Faces between two neighbouring columns of cells, l of them, or between the cells of one column, l - 1. Flow and
/// fluxes are positive from the cells on the left to those on the right, that is to larger i, j, k.
struct Faces {
  Direction direction;
  int i, j;                                           // of the column on the right, or of the column
  int count;                                          // of faces
  std::size_t first;                                  // place of the first one among all of this direction
  const double* flow;                                 // kg/s [count]
  double conductance;                                 // W/K, of one
  const double* mixing;                               // - [count], times this; null: 1
  const double *far_left, *left, *right, *far_right;  // K [count], of the cells before and behind the faces
  double *out_left, *out_right;  // W [count], of the cells on either side; null where another rank's
};

/// All terms, as of one flow and one set of surroundings. Temperatures are rises above the ambient's: these keep a
/// constant temperature to the last digit.
class EnergyTerms {
public:
  EnergyTerms(const Rows& rows, const Flow& flow, const EnergyModel& model);
  /// Collective.
  void update(const std::vector<double>& thickness, Surroundings surroundings);
  void set_surroundings(Surroundings surroundings);

  [[nodiscard]] const Rows& rows() const { return rows_; }
  [[nodiscard]] const Flow& flow() const { return flow_; }
  [[nodiscard]] const EnergyModel& model() const { return model_; }
  [[nodiscard]] const Surroundings& surroundings() const { return surroundings_; }
  [[nodiscard]] const EnergyLaws& laws() const { return laws_; }
  /// [l + 1] of a column, null where the flow is laminar.
  [[nodiscard]] const double* mixing(PetscInt node) const {
    const auto layers = static_cast<std::size_t>(rows_.mesh().across) + 1;
    return flow_.mixing.empty() ? nullptr : flow_.mixing.data() + static_cast<std::size_t>(node) * layers;
  }

  /// W [r, n, l]: out less in, of rises [r, n, l]. Collective.
  void residual(const double* rise, double* out);
  /// Takes the derivative at a rise / applies it. Collective.
  void linearise(const double* rise);
  void apply(const double* x, double* out);
  /// Adds the derivative to a matrix in the numbering of the cells. Each rank its rows.
  void fill(Mat matrix) const;
  [[nodiscard]] EnergyBudget budget(const double* rise) const;

  /// W/K, of each face between columns i and i + 1, rows j - 1 and j, layers.
  [[nodiscard]] double around(PetscInt node) const { return around_[static_cast<std::size_t>(node)]; }
  [[nodiscard]] double along(PetscInt node) const { return along_[static_cast<std::size_t>(node)]; }
  [[nodiscard]] double across(PetscInt node) const { return across_[static_cast<std::size_t>(node)]; }
  /// Whether anything flows into or out of the column by orifices and grooves.
  [[nodiscard]] bool fed(PetscInt node) const { return fed_[static_cast<std::size_t>(node)] != 0; }

  /// A cell beyond the first or last of a line stands for what lies there: its temperature is
  /// (1 - 2 share) T + 2 share T_s, where T_s is that of the surface or of what flows in. The share of a wall is that
  /// of the half layer in the resistance up to where T_s is given; of an end it is one where flow enters and else zero.
  [[nodiscard]] double wall_share(const Wall& wall, PetscInt node) const;
  /// How much better the half layer at a wall conducts at the rise of its cell, and the derivative, 1/K.
  [[nodiscard]] LawValue wall_factor(bool journal, PetscInt node, double rise) const;
  /// W that a wall takes from its cell, and the derivative, W/K.
  [[nodiscard]] LawValue wall_heat(bool journal, PetscInt node, double rise) const;
  /// kg/s, what enters the cell of an end from outside.
  [[nodiscard]] double entering(Direction direction, bool last, int k, int i, int j) const;

private:
  template <class Visit>
  void each_faces(double given, double* out, const Visit& visit);
  void boundaries(const double* rise, double given, double* out) const;
  void check_laws(const double* rise) const;
  [[nodiscard]] double rise_of_wall(const Wall& wall, PetscInt node) const;
  [[nodiscard]] double rise_of_entry(PetscInt cell) const;
  [[nodiscard]] double rise_of_supply(PetscInt node) const;
  const double* beyond(Direction direction, bool last, int i, int j, const double* column, double given,
                       std::vector<double>& room) const;

  const Rows& rows_;
  const Flow& flow_;
  EnergyModel model_;
  EnergyLaws laws_;
  Surroundings surroundings_;
  std::vector<double> around_, along_, across_;  // W/K [r, n], [r + 1, n], [r, n], of one face
  std::vector<char> fed_;                        // [r, n]
  Halo halo_;
  // Of each face, the derivatives of the limited slope; single precision is enough for a Jacobian.
  std::array<std::vector<float>, 3> upstream_, downstream_;
  // Of properties over the temperature: heat capacity and conductivity of each face over those at the ambient's
  // temperature, half the derivative of the latter times the step, and where the derivative is.
  std::array<std::vector<float>, 3> capacity_, conduct_, tilt_;
  std::vector<double> at_;
  std::vector<double> flux_, line_, before_, behind_;
};

}  // namespace whirl::thermal
