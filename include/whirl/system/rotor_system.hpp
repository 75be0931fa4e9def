#pragma once
// Rotor, films, pedestals and forcing as one System.

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "whirl/core/entry_stream.hpp"
#include "whirl/film/state_model.hpp"
#include "whirl/problem/settles.hpp"
#include "whirl/rotor/rotor.hpp"
#include "whirl/system/plant.hpp"
#include "whirl/system/train.hpp"

namespace whirl::system {

class FilmPart;

/// A parameter other than the speed: the train as a function of it, from which everything that depends on it is
/// rebuilt.
struct Varying {
  std::function<Train(double)> train;
  double value = 0;      ///< start value, SI
  double magnitude = 1;  ///< typical size, for the step of the difference quotient dF/dp
};

/// State of a journal in its bearing, journal minus pedestal minus elevation [m], [m/s].
using JournalState = PlaceState;

/// F(angle, x, xdot; p) = 0 of a train. With q = (rotor coordinates, pedestals) the state is x = (q_1, v_1, q_2, v_2,
/// ...) and
///
///     row 2i:     M v' + (C + Omega G) v + K q - g - Omega^2 (u_c cos angle + u_s sin angle)
///                                                  - alpha (u_c sin angle - u_s cos angle) - f_film = 0
///     row 2i + 1: q' - v = 0
///
/// in this order, so that no diagonal entry of dF/dx is zero. alpha is the shaft's angular acceleration, whose torque
/// follows the bent axis and adds no moment of its own. f_film acts on the journal and with the opposite sign on
/// the pedestal. Rows follow the rotor's distribution; pedestals are on its last rank. Film i is evaluated on rank i
/// mod size, its force and tangents are summed over the ranks. The own states of films that have some follow behind
/// all pairs (q, v), film by film, with the rows g(motion, s, s') = 0. They are shared out over all ranks, cut where
/// the films allow it; the rotor then stands with the pedestals on the first rank. Source: Gavalas (2022) eq. 2.14 with
/// errata 14, 20, 23.
class RotorSystem : public Plant, public problem::Settles {
public:
  /// The speed [rad/s] is the parameter.
  RotorSystem(MPI_Comm comm, Train train, double speed);
  /// `varying.value` is the parameter and the speed is fixed.
  RotorSystem(MPI_Comm comm, Varying varying, double speed);
  ~RotorSystem() override;

  [[nodiscard]] MPI_Comm comm() const override { return comm_; }
  [[nodiscard]] PetscInt size() const override { return 2 * n_ + n_own_; }
  [[nodiscard]] PetscInt local_size() const override { return 2 * (end_ - begin_) + own_here_; }
  [[nodiscard]] double parameter() const override { return varying_.train ? varying_.value : speed_; }
  void set_parameter(double p) override;
  [[nodiscard]] double speed() const override { return speed_; }
  [[nodiscard]] bool parameter_is_speed() const override { return !varying_.train; }
  void residual(double angle, Vec x, Vec xdot, Vec f) override;
  [[nodiscard]] core::Matrix make_jacobian() override;
  void jacobian(double angle, Vec x, Vec xdot, double alpha, double sigma, Mat j) override;
  void parameter_derivative(double angle, Vec x, Vec xdot, Vec f) override;
  void scales(Vec state_scale, Vec residual_scale) override;
  /// "machine" (rotor and pedestals), then the fields of every film with own states by the name of its bearing.
  [[nodiscard]] std::vector<problem::Field> fields() const override;
  [[nodiscard]] problem::Structure* structure() override;
  /// Where every film with own states offers a preconditioner.
  [[nodiscard]] std::unique_ptr<problem::PartInverse> make_part_inverse() override;

  /// Another train of the same shape (nodes, masters, film meshes): everything is rebuilt, the active parameter and the
  /// speed stay. Collective.
  void set_train(Train train);

  /// The forces of unbalance.
  void set_forcing(bool on) override { forcing_ = on; }
  /// The angular acceleration alpha [rad/s^2] of a shaft whose speed follows from outside; 0 at the start.
  void set_acceleration(double alpha) { acceleration_ = alpha; }

  [[nodiscard]] Places places() const override;
  [[nodiscard]] std::vector<PlaceState> shown(const double* x) const override { return journals(x); }
  /// Of rigid bores from the place of the journal, of films with thicknesses as states the least of these.
  [[nodiscard]] std::vector<double> film_thickness(const double* x) const override;
  [[nodiscard]] core::Vector guess() override;
  void displace(Vec x, const std::array<double, 2>& offset) override;
  [[nodiscard]] bool has_film_mesh() const override;
  [[nodiscard]] std::optional<Groups> groups() const override { return groups_of(train_); }
  [[nodiscard]] std::vector<double> resampled(const Plant& other, const double* x) const override;

  // Facts about the machine, for studies.
  [[nodiscard]] const Train& train() const { return train_; }
  [[nodiscard]] const rotor::Rotor& rotor() const { return *rotor_; }
  [[nodiscard]] int n_bearings() const { return static_cast<int>(train_.supports.size()); }
  /// Number of coordinates q: rotor and pedestals.
  [[nodiscard]] PetscInt coordinates() const { return n_; }
  /// Coordinate of the journal / pedestal of bearing b in direction d (0 x, 1 y); -1: no pedestal.
  [[nodiscard]] PetscInt journal(int b, int d) const {
    return bearings_[static_cast<std::size_t>(b)].journal[static_cast<std::size_t>(d)];
  }
  [[nodiscard]] PetscInt pedestal(int b, int d) const {
    return bearings_[static_cast<std::size_t>(b)].pedestal[static_cast<std::size_t>(d)];
  }
  /// Journal states from a state held as a whole [size()]. Not collective.
  [[nodiscard]] std::vector<JournalState> journals(const double* x) const;
  /// Film responses at the states of the journals, each evaluated by its rank; the same answer on all ranks.
  /// Collective.
  [[nodiscard]] std::vector<film::Response> film_responses(const std::vector<JournalState>& journals, film::Need need);
  /// The same at a whole state [size()] of a train whose films may have own states; these are held constant.
  [[nodiscard]] std::vector<film::Response> film_responses(const double* x, film::Need need);
  /// False where a film has a damped liner.
  [[nodiscard]] bool constant_rates() const override;
  /// Number of own states of all films, which stand at the end of a whole state.
  [[nodiscard]] PetscInt own_states() const { return n_own_; }
  /// Report quantities and fields of film b at a whole state [size()]. Not collective.
  [[nodiscard]] film::Summary film_summary(int b, const double* x);
  [[nodiscard]] std::vector<film::Field> film_fields(int b, const double* x);
  /// Gives every film the own states at which it rests with the journals where x has them. Collective.
  void relax_films(Vec x);
  /// Films that are linear but for the set of their full nodes settle.
  [[nodiscard]] bool settles() const override;
  void settle(Vec x) override;
  /// Displacements of all shaft nodes (x, y, dx/dz, dy/dz per node) [4 n_nodes] from a whole state; `component` 0 takes
  /// q, 1 takes v. Static shapes of a reduced rotor need the gravity offset: `with_gravity`. Collective.
  [[nodiscard]] std::vector<double> shaft(const double* x, int component, bool with_gravity) const;
  /// Force of unbalance per Omega^2 on each coordinate as cosine and sine parts [coordinates()], whole on every rank.
  [[nodiscard]] const std::vector<double>& unbalance_cosine() const { return unbalance_c_; }
  [[nodiscard]] const std::vector<double>& unbalance_sine() const { return unbalance_s_; }

private:
  struct Bearing {
    std::array<PetscInt, 2> journal{-1, -1}, pedestal{-1, -1};
    std::unique_ptr<film::Model> film;  // null for a film with own states
    std::unique_ptr<FilmPart> part;     // null for a film without
    // Coordinates of journal and pedestal with their signs, whose sum is what the film sees, along x and y.
    std::vector<std::vector<std::pair<PetscInt, double>>> ports;
  };
  /// Films at one state: what they do to the journals on all ranks, and this rank's rows of own states.
  struct Films {
    std::vector<film::Response> journal;
    std::vector<film::StateResponse> own;
  };
  class Blocks;
  class FilmInverse;
  struct Settling;
  /// The systems at p - step and p + step, for the difference quotient dF/dp.
  struct Neighbours {
    std::unique_ptr<RotorSystem> minus, plus;
    double step = 0;
  };

  void build();
  void share_out_own_states();
  void make_constant_parts();
  /// Made when first wanted at this value of the parameter. Collective.
  [[nodiscard]] Neighbours& neighbours();
  /// j += alpha times the derivatives of the film forces and rows, sigma times those in the rates; zeros at their
  /// places without films. Collective: assembles j.
  void add_films(Mat j, const Films* films, double alpha, double sigma) const;
  [[nodiscard]] Films films_at(Vec x, Vec xdot, film::Need need);
  /// `own` and `rates` are what this rank's films see, as gathered; no rates are zero rates.
  [[nodiscard]] Films films_at(const std::vector<JournalState>& journals, std::span<const double> own,
                               std::span<const double> rates, film::Need need);
  /// settle() on several ranks, and what it works with. Collective.
  void settle_together(Vec x);
  [[nodiscard]] Settling& settling();
  void sum_over_ranks(std::vector<film::Response>& films) const;
  /// Factors of the cosine and the sine parts of the unbalance at a shaft angle [1/s^2].
  [[nodiscard]] std::array<double, 2> unbalance_factors(double angle) const;
  [[nodiscard]] film::Motion motion(const JournalState& journal) const;
  /// This rank evaluates film `bearing`, or a part of it.
  [[nodiscard]] bool evaluates(std::size_t bearing) const;
  [[nodiscard]] bool owns(PetscInt coordinate) const { return coordinate >= begin_ && coordinate < end_; }
  /// What the films see of a distributed state on this rank: the journals' entries, then own states. Collective.
  [[nodiscard]] std::vector<double> gather_inputs(Vec x);
  /// The same into inputs_.
  void scatter_inputs(Vec x);
  [[nodiscard]] std::vector<JournalState> journals_of(std::span<const double> inputs) const;

  MPI_Comm comm_;
  Train train_;
  Varying varying_;
  double speed_;
  bool forcing_ = true;
  double acceleration_ = 0;
  std::unique_ptr<rotor::Rotor> rotor_;
  std::vector<Bearing> bearings_;
  PetscInt n_ = 0, n_rotor_ = 0, begin_ = 0, end_ = 0;    // coordinates: all, of the rotor, this rank's range
  PetscInt n_own_ = 0, own_here_ = 0;                     // own states of films: all, on this rank
  bool first_holds_rotor_ = false;                        // because films with own states are shared out over all
  core::Matrix mass_, damping_, gyroscopic_, stiffness_;  // [n x n] with pedestals
  core::Matrix j_at_rest_, j_gyroscopic_, j_rates_;       // constant parts of the Jacobian, made when first wanted
  mutable core::EntryStream film_entries_;                // of the films in matrices of make_jacobian()'s pattern
  std::vector<double> load_;                              // gravity on this rank's coordinates [N]
  std::vector<double> unbalance_c_, unbalance_s_;         // whole, per Omega^2
  std::vector<PetscInt> wanted_;                          // entries of a state that gather_inputs() gathers
  core::Scatter gather_inputs_;
  core::Vector inputs_;
  std::unique_ptr<Blocks> blocks_;
  Neighbours neighbours_;
  std::unique_ptr<Settling> settling_;  // made when first wanted
};

}  // namespace whirl::system
