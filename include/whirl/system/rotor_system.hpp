#pragma once
// Rotor, films, pedestals and forcing as one System.

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "whirl/core/entry_stream.hpp"
#include "whirl/core/error.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/rotor/rotor.hpp"
#include "whirl/system/plant.hpp"
#include "whirl/system/train.hpp"

namespace whirl::system {

class FilmPart;
class HubRows;
class Part;
class RotorPart;
class RotorSystem;
struct Instant;

/// Finds static equilibria: what solvers do, which the equations need where an element carries no static load.
class RestFinder {
public:
  RestFinder() = default;
  RestFinder(const RestFinder&) = delete;
  RestFinder& operator=(const RestFinder&) = delete;
  virtual ~RestFinder() = default;
  /// x = the equilibrium of `machine` without forcing at its present parameter, which stays; x is near it if `near`.
  /// Collective; throws core::NotConverged or core::DomainError, on all ranks.
  virtual void find(RotorSystem& machine, Vec x, bool near) const = 0;
};

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
/// in this order, so that no diagonal entry of dF/dx is zero. A rotor reduced in state space has rows of its own in
/// their place (rotor::StateMatrices); the pairs of its masters are still displacement and velocity. alpha is the
/// shaft's angular acceleration, whose torque follows the bent axis and adds no moment of its own. f_film acts on the
/// journal and with the opposite sign on the pedestal. Rows follow the rotor's distribution; pedestals are on its last
/// rank. Elements stand in M, C and K at the speed; one that carries no static load acts on q - q_rest(p), the motion
/// about the static equilibrium of the machine without such elements, which the machine finds at every parameter and
/// whose derivative is in dF/dp. A film without own states is evaluated on one rank, film i on rank i mod size; its
/// force and tangents are summed over the ranks. The own states of films that have some follow behind all pairs (q, v),
/// film by film, with the rows g(motion, s, s') = 0. They are shared out over all ranks, cut where the films allow it;
/// the rotor then stands with the pedestals on the first rank. Source: Gavalas (2022) eq. 2.14 with errata 14, 20, 23.
class RotorSystem : public Plant {
public:
  /// The speed [rad/s] is the parameter.
  RotorSystem(MPI_Comm comm, Train train, double speed);
  /// `varying.value` is the parameter and the speed is fixed.
  RotorSystem(MPI_Comm comm, Varying varying, double speed);
  ~RotorSystem() override;

  [[nodiscard]] MPI_Comm comm() const override { return comm_; }
  [[nodiscard]] PetscInt size() const override { return 2 * n_ + n_own_; }
  [[nodiscard]] PetscInt local_size() const override;
  [[nodiscard]] double parameter() const override { return varying_.train ? varying_.value : speed_; }
  void set_parameter(double p) override;
  [[nodiscard]] double speed() const override { return speed_; }
  [[nodiscard]] bool parameter_is_speed() const override { return !varying_.train; }
  void residual(double angle, Vec x, Vec xdot, Vec f) override;
  [[nodiscard]] core::Matrix make_jacobian() override;
  void jacobian(double angle, Vec x, Vec xdot, double alpha, double sigma, Mat j) override;
  /// Where films have states.
  bool entries(double angle, Vec x, Vec xdot, double alpha, double sigma, problem::Entries& out) override;
  void parameter_derivative(double angle, Vec x, Vec xdot, Vec f) override;
  void scales(Vec state_scale, Vec residual_scale) override;
  /// "machine" (rotor and pedestals), then the fields of every film with own states by the name of its bearing.
  [[nodiscard]] std::vector<problem::Field> fields() const override;
  [[nodiscard]] std::vector<problem::KinematicRow> kinematic() const override;
  [[nodiscard]] problem::BlockStructure* structure() override;
  /// Where a film with own states offers a preconditioner; films that offer none are factorised.
  [[nodiscard]] std::unique_ptr<problem::PartInverse> make_part_inverse() override;

  /// Another train of the same shape (nodes, masters, pedestals, film meshes): parts whose numbers differ are made
  /// anew, the active parameter and the speed stay. If a part refuses its numbers, nothing changes. Collective.
  void set_train(Train train);
  /// Rotors and films made so far, those for dF/dp among them. Not collective.
  struct Made {
    long rotors = 0, films = 0;
  };
  [[nodiscard]] Made made() const;

  /// The forces of unbalance.
  void set_forcing(bool on) override { forcing_ = on; }
  /// The angular acceleration alpha [rad/s^2] of a shaft whose speed follows from outside; 0 at the start.
  void set_acceleration(double alpha) { acceleration_ = alpha; }

  /// What the loss factor eta of the rotor adds to dF/dx of a vibration: `damping` [s] times its K on velocities and
  /// `turning` times K x [[0, 1], [-1, 0]] on displacements.
  struct Loss {
    double damping = 0, turning = 0;
  };
  /// That of a vibration Re(z exp(i frequency t)), frequency > 0 [rad/s]: with it the Jacobian holds K (1 + i eta s), s
  /// = 1 of backward and s = sign(frequency - Omega) of forward circular motion; in the stationary frame s = 1 of both.
  /// Zero without a loss factor. Source: Skarolek (2011), (2.36); Genta & Amati (2010).
  [[nodiscard]] Loss loss_at(double frequency) const;
  /// The sense s of forward motion there: -1, 0 or 1.
  [[nodiscard]] int loss_sense(double frequency) const;
  /// While it lives jacobian() and entries() have the loss; residual() never has.
  class WithLoss {
  public:
    /// Collective.
    WithLoss(RotorSystem& system, const Loss& loss) : system_(system) { system_.set_loss(loss); }
    /// Not collective: it may end by an exception that other ranks do not have.
    ~WithLoss() { system_.drop_loss(); }
    WithLoss(const WithLoss&) = delete;
    WithLoss& operator=(const WithLoss&) = delete;

  private:
    RotorSystem& system_;
  };

  [[nodiscard]] ShownPlaces places() const override;
  [[nodiscard]] std::vector<PlaceState> shown(const double* x) const override;
  /// Of rigid bores from the place of the journal, over the whole length where the film sees its tilt; of films with
  /// thicknesses as states the least of these.
  [[nodiscard]] std::vector<double> film_thickness(const double* x) const override;
  /// What the films see is gathered, no more.
  [[nodiscard]] std::vector<PlaceState> shown_at(Vec x) override;
  /// Each rank looks at the films and shares of films that it holds: no state is gathered.
  [[nodiscard]] Observed observe(Vec x) override;
  [[nodiscard]] core::Vector guess() override;
  void displace(Vec x, const std::array<double, 2>& offset) override;
  [[nodiscard]] bool has_film_mesh() const override;
  [[nodiscard]] std::optional<DimensionlessGroups> groups() const override { return dimensionless_groups(train_); }
  [[nodiscard]] std::vector<double> resampled(const Plant& other, const double* x) const override;
  /// Films by the ranks that hold a share of them.
  void resample(const Plant& other, const double* x, Vec to) const override;

  // Facts about the machine, for studies.
  [[nodiscard]] const Train& train() const { return train_; }
  [[nodiscard]] const rotor::Rotor& rotor() const;
  [[nodiscard]] int n_bearings() const { return static_cast<int>(train_.supports.size()); }
  /// Number of coordinates q: rotor and pedestals.
  [[nodiscard]] PetscInt coordinates() const { return n_; }
  /// Number of motions that the film of bearing b sees, and of force components that it gives: x and y, and the slopes
  /// dx/dz and dy/dz with their moments where it tilts.
  [[nodiscard]] int ports(int b) const;
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
  /// What an element does to its node [N, N m], and the motion of that less the motion of its other end.
  struct ElementState {
    std::array<double, 4> motion{}, force{};
    int freedoms = 2;  ///< x and y, or with the slopes
  };
  /// At a whole state at rest. Collective.
  [[nodiscard]] std::vector<ElementState> elements(const double* x);
  /// Journal states from a state held as a whole [size()]. Not collective.
  [[nodiscard]] std::vector<JournalState> journals(const double* x) const;
  /// Film responses at a whole state [size()], each evaluated by its ranks; own states of films are held constant. The
  /// same answer on all ranks. Collective.
  [[nodiscard]] std::vector<film::Response> film_responses(const double* x, film::Need need);
  /// False where a film has a damped liner.
  [[nodiscard]] bool constant_rates() const override;
  /// Number of own states of all films, which stand at the end of a whole state; of film b.
  [[nodiscard]] PetscInt own_states() const { return n_own_; }
  [[nodiscard]] PetscInt own_states(int b) const;
  /// Report quantities of all films at a whole state [size()]: each by one rank, the same answer on all. Collective.
  [[nodiscard]] std::vector<film::FilmReport> film_summaries(const double* x);
  /// Fields of film b at a whole state [size()]. Not collective.
  [[nodiscard]] std::vector<film::NodalField> film_fields(int b, const double* x);
  /// Gives every film the own states at which it rests with the journals where x has them. Collective.
  void relax_films(Vec x);
  /// Films that are linear but for the set of their full nodes settle.
  [[nodiscard]] bool settles() const override;
  void settle(Vec x) override { settle(x, false); }
  /// Displacements of all shaft nodes (x, y, dx/dz, dy/dz per node) [4 n_nodes] from a whole state; `component` 0 takes
  /// q, 1 takes v. Static shapes of a reduced rotor need the gravity offset: `with_gravity`. Collective.
  [[nodiscard]] std::vector<double> shaft(const double* x, int component, bool with_gravity) const;
  /// The same from a distributed state, of which rotor and pedestals alone are gathered.
  [[nodiscard]] std::vector<double> shaft(Vec x, int component, bool with_gravity) const;
  /// States of rotor and pedestals of a distributed state, whole on every rank [2 coordinates()]. Collective.
  [[nodiscard]] std::vector<double> hub_states(Vec x) const;
  /// Force of unbalance per Omega^2 on the rows of rotor and pedestals as cosine and sine parts [2 coordinates()],
  /// whole on every rank. Only of a rotor reduced in state space it acts on rows that are no momentum.
  [[nodiscard]] const std::vector<double>& forcing_cosine() const;
  [[nodiscard]] const std::vector<double>& forcing_sine() const;

private:
  struct Bearing {
    std::array<PetscInt, 4> journal{-1, -1, -1, -1};
    std::array<PetscInt, 2> pedestal{-1, -1};
    std::unique_ptr<FilmPart> part;
    [[nodiscard]] bool tilts() const { return journal[2] >= 0; }
  };
  class MachineBlocks;
  class FilmComms;
  class FilmInverses;
  template <class Interface>
  class OfFilms;
  class OfExactFilms;
  struct Settling;
  /// What the films of this rank see.
  struct FilmInputs {
    std::vector<JournalState> journals;
    std::vector<double> own, rates;
  };
  class Slope;
  class Rest;

  void build();
  /// Joints at the speed, in all matrices that hold them. Collective.
  void prepare();
  /// Also the place of rest of elements that carry no static load, and how it moves with the parameter. Collective;
  /// throws core::DomainError where there is none.
  void prepare_loads(bool derivative);
  /// Slopes of the axes of all bearings of a train, as axis() says. Collective.
  [[nodiscard]] std::vector<std::array<double, 2>> axes_of(const Train& train) const;
  void share_out_own_states();
  /// The parts of some bearings with the numbers of `train`. Collective.
  [[nodiscard]] std::vector<std::unique_ptr<FilmPart>> parts_at(const Train& train,
                                                                const std::vector<std::size_t>& bearings);
  /// Rotor and pedestals, then the films.
  [[nodiscard]] std::vector<const Part*> parts() const;
  void set_loss(const Loss& loss);
  void drop_loss() noexcept;
  /// Made when first wanted at this value of the parameter. Collective.
  [[nodiscard]] Slope& slope();
  [[nodiscard]] Instant instant(double angle, Vec x, Vec xdot) const;
  /// Takes forces on journals, by ports, from this rank's rows: B f in the equation above.
  void subtract(const std::vector<std::array<double, 4>>& forces, double* rows) const;
  /// The same of one component of the films' responses.
  void subtract(std::array<double, 4> film::Response::*of, double* rows) const;
  /// The rows of rotor and pedestals that are linear, with the loss if there is one.
  [[nodiscard]] const HubRows& hub_rows() const;
  /// alpha dF/dx + sigma dF/d(dx/dt) with the films as evaluated last, into a list of entries or a stream: always the
  /// same places. Without `films` theirs hold zeros.
  template <class Entries>
  void list(Entries& out, bool films, double alpha, double sigma) const;
  [[nodiscard]] FilmInputs film_inputs(Vec x, Vec xdot);
  /// All films, each by the ranks that hold it: the parts then hold their rows here, and the bearings the responses of
  /// the journals, the same on all ranks. Collective.
  void evaluate_films(Vec x, Vec xdot, film::Need need);
  void evaluate_films(const FilmInputs& in, film::Need need);
  [[nodiscard]] std::vector<film::Response> responses() const;
  /// Film `bearing`, or another one in its place; a core::DomainError says which.
  void evaluate(std::size_t bearing, FilmPart& part, const FilmInputs& in, film::Need need) const;
  /// Runs f; its core::DomainError says at which bearing.
  template <class F>
  void at_bearing(std::size_t bearing, F&& f) const {
    try {
      f();
    } catch (const core::DomainError& e) {
      throw core::DomainError("bearing " + train_.supports[bearing].name + ": " + e.what());
    }
  }
  /// What settle() works with; the ranks that hold each film. Made when first wanted. Collective.
  [[nodiscard]] Settling& settling();
  /// `still`: as if the journals did not move.
  void settle(Vec x, bool still);
  const FilmComms& film_comms();
  void sum_over_ranks();
  /// The films that are `wanted` of a whole state of another machine in `to`, one of this.
  template <class Wanted>
  void resample_films(const RotorSystem& other, const double* x, double* to, Wanted&& wanted) const;
  [[nodiscard]] film::JournalMotion motion(const JournalState& journal) const;
  /// What the film of a bearing sees of positions and velocities at its ports.
  [[nodiscard]] film::JournalMotion motion(std::size_t bearing, std::span<const double> place,
                                           std::span<const double> rate) const;
  /// Films with own states are shared out over all ranks, and the rotor stands on the first one.
  [[nodiscard]] bool first_holds_rotor() const { return n_own_ > 0 && core::size_of(comm_) > 1; }
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
  long films_made_ = 0;
  std::unique_ptr<RotorPart> hub_;
  std::vector<Bearing> bearings_;
  std::vector<std::array<double, 2>> axes_;
  PetscInt n_ = 0, n_own_ = 0, own_here_ = 0;  // coordinates; own states of films: all, on this rank
  core::Matrix pattern_;                       // of the Jacobian, made when first wanted
  core::EntryStream stream_;                   // of its entries
  Loss loss_;
  std::unique_ptr<const HubRows> lossy_;  // rows with the loss while it acts
  std::vector<PetscInt> wanted_;          // entries of a state that gather_inputs() gathers
  core::Scatter gather_inputs_;
  core::Vector inputs_;
  std::size_t journal_inputs_ = 0;  // before the own states among them: position and velocity of each end of each port
  std::unique_ptr<MachineBlocks> blocks_;
  std::unique_ptr<Rest> rest_;                   // null if all elements carry static load
  std::unique_ptr<Slope> slope_;                 // at this value of the parameter, made when first wanted
  std::unique_ptr<Settling> settling_;           // made when first wanted
  std::shared_ptr<const FilmComms> film_comms_;  // of all inverses of the films, made with the first
};

}  // namespace whirl::system
