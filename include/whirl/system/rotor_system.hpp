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

/// A parameter other than the speed: the train as a function of it. Of the system, what depends on it is made anew at
/// every value, and nothing else.
struct Varying {
  std::function<Train(double)> train;
  double value = 0;      ///< start value, SI
  double magnitude = 1;  ///< typical size, for the step of the difference quotient dF/dp
};

/// State of a journal in its bearing, journal minus pedestal minus elevation [m], [m/s]; and where the film sees it the
/// slope of the shaft minus that of the bearing, dx/dz and dy/dz [-], [1/s]. Pedestals do not tilt.
struct JournalState : PlaceState {
  std::array<double, 2> tilt{}, tilt_rate{};
};

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

  /// Another train of the same shape (nodes, masters, pedestals, film meshes): parts whose numbers differ are made
  /// anew, the active parameter and the speed stay. If a part refuses its numbers, nothing changes. Collective.
  void set_train(Train train);
  /// Rotors and films made so far, those for dF/dp among them. Not collective.
  struct Made {
    long rotors = 0, films = 0;
  };
  [[nodiscard]] const Made& made() const { return made_; }

  /// The forces of unbalance.
  void set_forcing(bool on) override { forcing_ = on; }
  /// The angular acceleration alpha [rad/s^2] of a shaft whose speed follows from outside; 0 at the start.
  void set_acceleration(double alpha) { acceleration_ = alpha; }

  [[nodiscard]] Places places() const override;
  [[nodiscard]] std::vector<PlaceState> shown(const double* x) const override;
  /// Of rigid bores from the place of the journal, over the whole length where the film sees its tilt; of films with
  /// thicknesses as states the least of these.
  [[nodiscard]] std::vector<double> film_thickness(const double* x) const override;
  /// Each rank looks at the films and shares of films that it holds: no state is gathered.
  [[nodiscard]] Observed observe(Vec x) override;
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
  /// Number of motions that the film of bearing b sees, and of force components that it gives: x and y, and the slopes
  /// dx/dz and dy/dz with their moments where it tilts.
  [[nodiscard]] int ports(int b) const { return static_cast<int>(bearings_[static_cast<std::size_t>(b)].ports.size()); }
  /// Slope dx/dz, dy/dz of the axis of bearing b: that of the deck, else that of the shaft on rigid supports at the
  /// elevations of the bearings, at rest under gravity. Zero of a film that does not tilt.
  [[nodiscard]] const std::array<double, 2>& axis(int b) const { return axes_[static_cast<std::size_t>(b)]; }
  /// Coordinate of the journal / pedestal of bearing b along port d / in direction d (0 x, 1 y); -1: no pedestal.
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
  /// Number of own states of all films, which stand at the end of a whole state; of film b.
  [[nodiscard]] PetscInt own_states() const { return n_own_; }
  [[nodiscard]] PetscInt own_states(int b) const;
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
  [[nodiscard]] const std::vector<double>& unbalance_cosine() const { return unbalance_.cosine; }
  [[nodiscard]] const std::vector<double>& unbalance_sine() const { return unbalance_.sine; }

private:
  struct Bearing {
    std::array<PetscInt, 4> journal{-1, -1, -1, -1};
    std::array<PetscInt, 2> pedestal{-1, -1};
    std::unique_ptr<FilmPart> part;
    // Coordinates of journal and pedestal with their signs, whose sum is what the film sees, along x and y, and the
    // slopes of the journal if it tilts.
    std::vector<std::vector<std::pair<PetscInt, double>>> ports;
    [[nodiscard]] bool tilts() const { return ports.size() > 2; }
  };
  /// Films at one state: what they do to the journals on all ranks, and this rank's rows of own states.
  struct Films {
    std::vector<film::Response> journal;
    std::vector<film::StateResponse> own;
  };
  class Blocks;
  class FilmComms;
  class FilmInverse;
  struct Settling;
  /// Matrices of coordinates, pedestals behind the rotor.
  struct Matrices {
    core::Matrix mass, damping, gyroscopic, stiffness;
  };
  /// What load is linear in: gravity [m/s^2], the load of a rigid rotor and the weights of the pedestals [N].
  struct Weights {
    double gravity, rotor_load;
    std::vector<double> pedestals;
  };
  /// Force of unbalance per Omega^2, whole on every rank.
  struct Unbalances {
    std::vector<double> cosine, sine;
  };
  /// What the films of this rank see.
  struct FilmInputs {
    std::vector<JournalState> journals;
    std::vector<double> own, rates;
  };
  class Slope;

  void build();
  /// Slopes of the axes of all bearings of a train, as axis() says. Collective.
  [[nodiscard]] std::vector<std::array<double, 2>> axes_of(const Train& train) const;
  void share_out_own_states();
  [[nodiscard]] std::unique_ptr<rotor::Rotor> make_rotor(const rotor::Options& options);
  /// The parts of some bearings with the numbers of `train`. Collective.
  [[nodiscard]] std::vector<FilmPart> parts_at(const Train& train, const std::vector<std::size_t>& bearings);
  /// Those of a rotor, zero at the pedestals. Collective, as are the others.
  [[nodiscard]] Matrices matrices_of(const rotor::Rotor& rotor) const;
  void make_matrices();
  void set_pedestals();
  [[nodiscard]] static Weights weights_of(const Train& train);
  [[nodiscard]] std::vector<double> load_of(const rotor::Rotor& rotor, const Weights& weights) const;
  [[nodiscard]] Unbalances unbalance_of(const rotor::Rotor& rotor, const std::vector<UnbalanceMass>& masses) const;
  void make_constant_parts();
  void fill_constant_parts();
  /// Made when first wanted at this value of the parameter. Collective.
  [[nodiscard]] const Slope& slope();
  /// K q + (C + Omega G) v + M v' on this rank's coordinates. Collective.
  [[nodiscard]] core::Vector products(const Matrices& m, Vec x, Vec xdot) const;
  /// Takes forces on journals, by ports, from this rank's rows: B f in the equation above.
  void subtract(const std::vector<std::array<double, 4>>& forces, double* rows) const;
  /// j += alpha times the derivatives of the film forces and rows, sigma times those in the rates; zeros at their
  /// places without films. Collective: assembles j.
  void add_films(Mat j, const Films* films, double alpha, double sigma) const;
  [[nodiscard]] FilmInputs film_inputs(Vec x, Vec xdot);
  [[nodiscard]] Films films_at(Vec x, Vec xdot, film::Need need);
  [[nodiscard]] Films films_at(const FilmInputs& in, film::Need need);
  /// Film `bearing`, or another one in its place; a core::DomainError says which.
  void evaluate(std::size_t bearing, const FilmPart& part, const FilmInputs& in, film::Need need,
                film::StateResponse& response) const;
  /// What settle() works with; the ranks that hold each film. Made when first wanted. Collective.
  [[nodiscard]] Settling& settling();
  const FilmComms& film_comms();
  void sum_over_ranks(std::vector<film::Response>& films) const;
  /// Factors of the cosine and the sine parts of the unbalance at a shaft angle [1/s^2].
  [[nodiscard]] std::array<double, 2> unbalance_factors(double angle) const;
  [[nodiscard]] film::Motion motion(const JournalState& journal) const;
  /// Films with own states are shared out over all ranks, and the rotor stands on the first one.
  [[nodiscard]] bool first_holds_rotor() const { return n_own_ > 0 && core::size_of(comm_) > 1; }
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
  Made made_;
  std::unique_ptr<rotor::Rotor> rotor_;
  std::vector<Bearing> bearings_;
  std::vector<std::array<double, 2>> axes_;
  PetscInt n_ = 0, n_rotor_ = 0, begin_ = 0, end_ = 0;  // coordinates: all, of the rotor, this rank's range
  PetscInt n_own_ = 0, own_here_ = 0;                   // own states of films: all, on this rank
  Matrices matrices_;
  core::Matrix j_at_rest_, j_gyroscopic_, j_rates_;  // constant parts of the Jacobian, made when first wanted
  mutable core::EntryStream film_entries_;           // of the films in matrices of make_jacobian()'s pattern
  std::vector<double> load_;                         // gravity on this rank's coordinates [N]
  Unbalances unbalance_;
  std::vector<PetscInt> wanted_;  // entries of a state that gather_inputs() gathers
  core::Scatter gather_inputs_;
  core::Vector inputs_;
  // Before the own states among them: 8 of each bearing, position and velocity of journal and pedestal in x and y; then
  // 4 of each that tilts, slope and rate in x and y.
  std::size_t journal_inputs_ = 0;
  std::unique_ptr<Blocks> blocks_;
  std::unique_ptr<Slope> slope_;                 // at this value of the parameter, made when first wanted
  std::unique_ptr<Settling> settling_;           // made when first wanted
  std::shared_ptr<const FilmComms> film_comms_;  // of all inverses of the films, made with the first
};

}  // namespace whirl::system
