#pragma once
// A fluid film: motion of the journal and, where the film has some, own states and their rates in; force on the journal
// and residual out.

#include <mpi.h>

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "whirl/core/inverse.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/film/contract/response.hpp"
#include "whirl/film/contract/share.hpp"

namespace whirl::core {
class SparseLu;
}

namespace whirl::film {

/// Rad/s, of a typical whirl: what rates are measured in, per typical magnitude.
inline constexpr double typical_frequency = 300;

/// States [begin, end) of a film that are of one kind, and the rows of the same numbers. A film that is cut through
/// several kinds numbers them slab by slab, so that each rank holds all that stands in its slabs: its kinds come again,
/// `repeats` times in all, each time `stride` further on, and it is cut at multiples of the stride.
struct StateField {
  std::string name, unit;
  double scale;  ///< typical magnitude
  int begin, end;
  /// Typical magnitude of the residual of the rows, in their own unit; zero where these are rates of the states.
  double residual_scale = 0;
  int stride = 0, repeats = 1;
  /// visit(state) for each of them.
  template <class Visit>
  void each(const Visit& visit) const {
    for (int r = 0; r < repeats; ++r)
      for (int k = begin; k < end; ++k) visit(k + r * stride);
  }
  /// That, or what rates of the states are measured in.
  [[nodiscard]] double row_scale() const { return residual_scale > 0 ? residual_scale : scale * typical_frequency; }
};

/// Derivatives dg/ds and dg/ds' of this rank's share of a film, at its places.
struct StateDerivatives {
  std::span<const double> states, rates;
};
/// Inverse of alpha dg/ds + sigma dg/ds' of a whole film whose shares stand on the ranks of one communicator.
using StateInverse = core::Inverse<StateDerivatives>;
using ExactStateInverse = core::ExactInverse<StateDerivatives>;

/// A film: g(motion, s, s') = 0, force = f(motion, s, s') with states s of its own. Most films have none, as their
/// pressure is condensed: force = f(motion), and everything about states is empty. Not thread-safe (own workspace).
class Film {
public:
  Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;
  virtual ~Film();
  /// The motions that it sees; of all others it knows nothing, and its force along them is zero.
  [[nodiscard]] virtual std::span<const Port> ports() const;
  /// Fills `response` with the rows of a share and what it adds to the force on the journal; `states` and `rates` are
  /// those it sees. Derivatives are those of the discrete equations, empty or zero if only the force is needed. Throws
  /// core::DomainError outside the validity: film thickness not positive, or a film that runs dry.
  virtual void evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                        std::span<const double> rates, Need need, StateResponse& response) = 0;
  /// The same of the whole film, from its states in their order.
  void evaluate(const JournalMotion& motion, std::span<const double> states, std::span<const double> rates, Need need,
                StateResponse& response);
  /// The same of a film without states; core::Bug if it has some.
  void evaluate(const JournalMotion& motion, Need need, Response& response);
  /// Report quantities; throws as evaluate() does.
  virtual FilmReport summary(const JournalMotion& motion, std::span<const double> states) = 0;
  /// Pressure and thickness at the grid nodes; empty where the film knows no pressure. Throws as evaluate() does.
  virtual std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> states) = 0;
  /// Least thickness of the film [m] over its whole length, exactly where the bore is rigid: not positive where the
  /// surfaces touch. Infinite for a linear film. From some of the states alone it is that of these or of the whole
  /// film: the least over all shares is the film's. Throws as evaluate() does where the film has to be known.
  [[nodiscard]] virtual double least_thickness(const JournalMotion& motion, std::span<const double> states) = 0;
  /// Whether least_thickness() depends on the states: not where the walls are rigid.
  [[nodiscard]] virtual bool thickness_of_states() const { return true; }
  /// Starts the search for its pressure from where `other` ended, a film of the same mesh with other numbers. Without
  /// effect on a film that searches nothing, or if the meshes differ.
  virtual void start_from(const Film& /*other*/) {}

  /// Number n of own states.
  [[nodiscard]] virtual std::size_t states() const { return 0; }
  /// What they are, in their order.
  [[nodiscard]] virtual std::vector<StateField> state_fields() const { return {}; }
  /// Where the film may be cut, near state `near` of 0 ... n; monotonic, and 0 and n are always among these.
  [[nodiscard]] virtual int cut(int /*near*/) const { return 0; }
  /// What holds states [begin, end), which are where it may be cut.
  [[nodiscard]] virtual Share share(int /*begin*/, int /*end*/) const { return {}; }
  /// The share that holds all, made once.
  [[nodiscard]] const Share& whole() const;
  /// True if the force does not depend on s' and dg/ds' depends on nothing.
  [[nodiscard]] virtual bool constant_rates() const { return true; }
  /// True if Newton's method on a film by itself is to take whole steps even where the residual rises: a film that is
  /// linear but for the set of its full nodes, of which a whole step finds the next one. Its inverse is exact.
  [[nodiscard]] virtual bool whole_steps() const { return false; }
  /// Rates of the states per velocity of the journal, [port][state], while nothing changes that the film remembers: the
  /// deflection of a liner, what a gap holds beyond its volume. Empty if they are zero. They do not depend on anything.
  [[nodiscard]] virtual PortColumns carried_rates() const { return {}; }
  /// The states of a film that carries nothing, to start from. Throws as evaluate() does.
  virtual void unloaded(const JournalMotion& /*motion*/, std::span<double> /*states*/) const {}
  /// Own states on this mesh from those of `other`, the same film on another one.
  virtual void resample(const JournalMotion& /*motion*/, const Film& /*other*/, std::span<const double> /*from*/,
                        std::span<double> /*to*/) const {}
  /// What the film offers to solve its linearised equations with, if `share` is this rank's of a film whose shares
  /// stand on all ranks of `comm`; null if it offers nothing, on all ranks. Collective.
  [[nodiscard]] virtual std::unique_ptr<StateInverse> inverse(MPI_Comm /*comm*/, const Share& /*share*/) const {
    return nullptr;
  }

private:
  friend class LentLu;
  mutable std::unique_ptr<const Share> whole_;
  std::unique_ptr<core::SparseLu> spare_lu_;
};

/// The film described by the options; throws core::InputError on values outside their range.
std::unique_ptr<Film> make_film(const Geometry& geometry, const Options& options, const Lubricant& lubricant);

/// Own states at which g(motion, s, 0) = 0, by Newton from `states`; those of a film without states are none. Throws
/// core::NotConverged or core::DomainError. Returns how many factorisations that took.
long relax(Film& film, const JournalMotion& motion, std::vector<double>& states);

/// The film without its states, itself if it has none: they take the values at which nothing that the film remembers
/// changes, whatever the motion, g(motion, s, s') = 0 with s' = carried_rates() times the velocity, found by Newton's
/// method from those of the last motion to a tolerance below which the start does not show. Force, stiffness and flows
/// of a journal at rest are those of the film with states; damping is that of a film whose memory stands still. Where
/// no such states are found evaluate() throws core::DomainError as well. Cost: a sparse LU per Newton step, and one
/// solve for each component of the force.
[[nodiscard]] std::unique_ptr<Film> condense(std::unique_ptr<Film> film);

/// Stiffness K [N/m] and damping C [N s/m] (xx, xy, yx, yy) of a film about equilibrium: K + i omega C is minus the
/// transfer function from the position to the force, with the own states eliminated at the frequency omega [rad/s], on
/// which those of a film without states do not depend.
/// Source: van de Vrande (2001) sec. 4.4, where omega/Omega is the parameter.
struct Coefficients {
  std::array<double, 4> stiffness{}, damping{};
};
Coefficients coefficients(Film& film, const JournalMotion& motion, std::span<const double> states, double omega);

/// The same of all ports, [i][j] of the force along port i by the motion along port j of a film's ports(): x, y [N/m,
/// N s/m] and of a film that follows tilt both slopes with their moments. Zero beyond `ports`.
struct PortCoefficients {
  std::size_t ports = 0;
  std::array<std::array<double, 4>, 4> stiffness{}, damping{};
};
PortCoefficients port_coefficients(Film& film, const JournalMotion& motion, std::span<const double> states,
                                   double omega);

}  // namespace whirl::film
