#pragma once
// The hub of a machine: the rotor with its pedestals.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "change.hpp"
#include "hub_rows.hpp"
#include "part.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/rotor/rotor.hpp"
#include "whirl/system/train.hpp"

namespace whirl::system {

/// With q = (rotor coordinates, pedestals), v = q' and the state (q_1, v_1, q_2, v_2, ...)
///
///     row 2i:     M v' + (C + Omega G) v + (K + Omega N) q - load - Omega^2 (u_c cos angle + u_s sin angle)
///                                              - alpha (u_c sin angle - u_s cos angle)
///     row 2i + 1: q' - v
///
/// A rotor reduced in state space has the rows N u' + (P + Omega Q) u - loads - forces of its own, in pairs of states;
/// of its masters these are displacement and velocity, and forces of films act on the first row of the pair. Either way
/// the rows are linear in states and rates with three constant matrices, and that is what is kept. Pedestals and
/// elements are joints: K, C and M between few coordinates, which stand in these matrices at the speed that they were
/// last told. Elements that carry no static load are measured from a place of rest. Rows follow the
/// rotor's distribution with the pedestals on its last rank, or all stand on the first one. Its rows are the first on
/// every rank.
class RotorPart final : public Part {
public:
  /// Force of unbalance per Omega^2 on the rows [2 coordinates()], whole on every rank.
  struct Unbalances {
    std::vector<double> cosine, sine;
  };
  /// Derivatives in a parameter of the numbers that the rows are made of: of those that depend on it.
  struct Rates {
    std::optional<HubRows> rows;  // the same on all ranks whether there are some
    std::vector<double> load;     // as load(), or empty
    std::optional<Unbalances> unbalance;
  };

  /// `train` outlives it. Collective.
  RotorPart(MPI_Comm comm, const Train& train, bool on_first);

  [[nodiscard]] const rotor::Rotor& rotor() const { return *rotor_; }
  /// Number of coordinates q: of all, of the rotor alone.
  [[nodiscard]] PetscInt coordinates() const { return n_; }
  [[nodiscard]] PetscInt rotor_coordinates() const { return n_rotor_; }
  /// Coordinates [begin(), end()) stand on this rank.
  [[nodiscard]] PetscInt begin() const { return begin_; }
  [[nodiscard]] PetscInt end() const { return end_; }
  [[nodiscard]] bool owns(PetscInt coordinate) const { return coordinate >= begin_ && coordinate < end_; }
  /// Coordinates of the pedestal of a bearing in x and y; -1: it has none.
  [[nodiscard]] const std::array<PetscInt, 2>& pedestal(std::size_t bearing) const { return pedestals_[bearing]; }
  /// The rows without loads, pedestals behind the rotor.
  [[nodiscard]] const HubRows& linear() const { return linear_; }
  /// The same for a vibration of one frequency with hysteresis: the rotor's K times `damping` [s] on velocities and K x
  /// [[0, 1], [-1, 0]] times `turning` on displacements. At the same places. Collective.
  [[nodiscard]] HubRows with_loss(double damping, double turning) const;
  /// Weight and static load on this rank's rows, and what elements away from their place of rest lack [N].
  [[nodiscard]] const std::vector<double>& load() const { return load_; }

  /// The joints at this speed from now on, true if they are others than before. Throws core::DomainError beyond the
  /// table of an element, and then nothing has changed. Collective.
  bool follow(double speed);
  /// Derivatives of linear() by the speed, but for what is turning: those of joints; null where none changes.
  [[nodiscard]] const HubRows* by_speed() const { return varies_ ? &by_speed_ : nullptr; }
  /// Motions at an element: its node less its other end, along x, y, dx/dz and dy/dz.
  using Motions = std::vector<std::array<double, 4>>;
  /// Where elements are without force if they carry no static load [elements].
  void set_rest(Motions rest);
  /// How that place moves with the active parameter.
  void set_rest_rate(Motions rate) { rest_rate_ = std::move(rate); }
  /// Derivative of load() by the speed with set_rest_rate(): rows here; empty if zero.
  [[nodiscard]] std::vector<double> load_by_speed() const;
  /// Motions at the elements from the displacements of all coordinates [2 coordinates()], velocities between them.
  [[nodiscard]] Motions motions(const double* states) const;
  /// Forces of an element on its node: -(K (d - rest) + C v) at motions d and velocities v.
  [[nodiscard]] std::array<double, 4> force(std::size_t element, const std::array<double, 4>& motion,
                                            const std::array<double, 4>& velocity) const;
  [[nodiscard]] const Unbalances& unbalance() const { return unbalance_; }
  /// Factors of the cosine and the sine parts of the unbalance [1/s^2].
  [[nodiscard]] static std::array<double, 2> unbalance_factors(const Instant& at);

  [[nodiscard]] PetscInt row() const override { return 0; }
  [[nodiscard]] PetscInt rows() const override { return 2 * (end_ - begin_); }
  [[nodiscard]] std::vector<problem::Field> fields(const std::string& name) const override;
  void scales(double* states, double* rows) const override;
  void residual(const Instant& at, double* f) const override;
  void speed_derivative(const Instant& at, double* f) const override;

  /// A rotor with other numbers; it counts. Collective.
  [[nodiscard]] std::unique_ptr<rotor::Rotor> make_rotor(const rotor::Options& options);
  /// Rotors made so far.
  [[nodiscard]] long made() const { return made_; }
  /// Refuses a rotor that has damping which turns with it, where the first one had none: the pattern of the Jacobian is
  /// without it. Throws core::InputError.
  void check_pattern(const rotor::Rotor& rotor) const;
  /// Takes what differs from the train, which has changed; `rotor` is a new one if its shaft differs. Collective.
  void take(const TrainChange& change, std::unique_ptr<rotor::Rotor> rotor);
  /// Differences of two trains over `step`. Exact where the rows are linear in a number of the train. Collective.
  [[nodiscard]] Rates rates(const TrainChange& change, const Train& minus, const Train& plus, double step);
  /// f [rows()] = what they do to the rows. Collective.
  void apply(const Rates& rates, const Instant& at, double* f) const;

private:
  /// What load is linear in: gravity along -y and x [m/s^2], the load of a rigid rotor [N], the weights of the
  /// pedestals along x and y [N], and forces and moments on nodes.
  struct Weights {
    double gravity, gravity_x, rotor_load;
    std::vector<double> pedestals_x, pedestals;
    std::vector<StaticLoad> loads;
  };
  [[nodiscard]] static Weights weights_of(const Train& train);
  /// Those of a rotor, zero at the joints. Collective.
  [[nodiscard]] HubRows rows_of(const rotor::Rotor& rotor) const;
  /// This rank's rows of a matrix of the rotor: all rows on the first rank if the rotor stands there.
  [[nodiscard]] core::Matrix here(Mat of_rotor) const;
  /// Coordinates that move one end of an element and how: its node +1, its other end -1.
  using Ends = std::vector<std::pair<PetscInt, double>>;
  /// K, C and M of the joints of a train at a speed, or their derivatives by it; zeros too, and without a speed zeros
  /// of elements.
  [[nodiscard]] HubRows joints_of(const Train& train, std::optional<double> speed, bool by_speed) const;
  void join();
  /// += B K rest of the elements that carry no static load, K of `train` at the speed of follow().
  void add_rest(const Train& train, const Motions& rest, bool by_speed, double factor, std::vector<double>& rows) const;
  void update_load();
  [[nodiscard]] std::vector<double> load_of(const rotor::Rotor& rotor, const Weights& weights) const;
  [[nodiscard]] Unbalances unbalance_of(const rotor::Rotor& rotor, const std::vector<UnbalanceMass>& masses) const;

  MPI_Comm comm_;
  const Train& train_;
  bool on_first_;
  long made_ = 0;
  std::unique_ptr<rotor::Rotor> rotor_;
  std::vector<std::array<PetscInt, 2>> pedestals_;
  PetscInt n_ = 0, n_rotor_ = 0, begin_ = 0, end_ = 0;
  HubRows base_, linear_;               // of the rotor at all places, and with the joints
  std::vector<double> weights_, load_;  // load_ with what elements lack
  HubRows by_speed_;
  std::optional<double> speed_;  // of the joints, empty where they follow from another train
  bool varies_ = false;          // joints with the speed
  std::vector<std::vector<Ends>> ends_;
  Motions rest_, rest_rate_;
  Unbalances unbalance_;
};

}  // namespace whirl::system
