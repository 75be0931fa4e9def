#pragma once
// Films with states of their own: motion, states and their rates in, residual and journal force out.

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "whirl/film/model.hpp"

namespace whirl::film {

/// One entry of a sparse matrix; entries of the same place add up.
struct Entry {
  int row, column;
  double value;
};

/// Derivatives of the rows of a film whose states are lines in a ring, one array [rows] per place of the neighbour: a
/// line is a run of consecutive states, `before` and `after` are the lines on either side, `below` and `above` the
/// neighbours within the line (zero at its ends). Empty arrays are zero.
struct Stencil {
  enum Place { centre, before, after, below, above, second_before, n_places };
  std::array<std::vector<double>, n_places> at;
};

/// g(motion, s, s') [n] of the own states s [n] with rates s', the force on the journal, and all derivatives. Of a part
/// of a film: its rows, and its share of force and derivatives, which add up (min_thickness: the least).
struct StateResponse {
  Response journal;                                           // force and its derivatives at constant s
  std::vector<double> residual;                               // [n] g
  std::vector<Entry> d_states;                                // dg/ds, the same places in the same order in every call
  std::vector<Entry> d_rates;                                 // dg/ds', likewise
  Stencil by_states, by_rates;                                // the same of a film in lines
  std::vector<std::array<double, 4>> d_position, d_velocity;  // [n] dg/d(position), dg/d(velocity)
  std::vector<double> d_speed;                                // [n] dg/dOmega
  std::vector<std::array<double, 4>> force_d_states;          // [n] d force_i/d s_k at [k][i]
  std::vector<std::array<double, 4>> force_d_rates;           // likewise d force_i/d s'_k; empty if zero
};

/// How the states of a film may be shared out: `lines` runs of equal length that form a ring. A row depends on its own
/// line and on `reach` lines on either side. A film of one line is not cut.
struct Ring {
  int lines = 1, reach = 0;
};

/// Lines [begin, end) of a ring.
struct Lines {
  int begin = 0, end = 1;
  [[nodiscard]] int count() const { return end - begin; }
};

/// A film with own states: g(motion, s, s') = 0, force = f(motion, s, s'). Not thread-safe (own workspace).
class StateModel {
public:
  StateModel() = default;
  StateModel(const StateModel&) = delete;
  StateModel& operator=(const StateModel&) = delete;
  virtual ~StateModel() = default;
  /// Number n of own states.
  [[nodiscard]] virtual std::size_t states() const = 0;
  [[nodiscard]] virtual Ring ring() const { return {}; }
  /// States of one line.
  [[nodiscard]] std::size_t line() const { return states() / static_cast<std::size_t>(ring().lines); }
  /// At most so many entries of d_states and d_rates together have the same row.
  [[nodiscard]] virtual int row_entries() const = 0;
  /// True if the force does not depend on s' and dg/ds' depends on nothing.
  [[nodiscard]] virtual bool constant_rates() const { return true; }
  /// Typical magnitude of every state.
  [[nodiscard]] virtual double state_scale() const = 0;
  /// True if Newton's method on a film by itself is to take whole steps even where the residual rises: a film that is
  /// linear but for the set of its full nodes, of which a whole step finds the next one.
  [[nodiscard]] virtual bool whole_steps() const { return false; }
  /// The states of a film that carries nothing, to start from. Throws as evaluate() does.
  virtual void unloaded(const Motion& motion, std::span<double> states) const = 0;
  /// Fills `response`; derivatives are empty or zero if only the force is needed. Throws core::DomainError outside the
  /// validity (film thickness not positive: contact).
  void evaluate(const Motion& motion, std::span<const double> states, std::span<const double> rates, Need need,
                StateResponse& response);
  /// The same for some lines (all, if the film is not cut). `states` and `rates` hold in front of them and behind them
  /// `reach` lines each. The derivatives of a film in lines are by_states and by_rates, not triplets.
  virtual void evaluate_lines(const Motion& motion, Lines part, std::span<const double> states,
                              std::span<const double> rates, Need need, StateResponse& response) = 0;
  /// Own states on this mesh from those of `other`, the same film on another one.
  virtual void resample(const Motion& motion, const StateModel& other, std::span<const double> from,
                        std::span<double> to) const = 0;
  /// Least thickness of the film [m].
  [[nodiscard]] virtual double least_thickness(const Motion& motion, std::span<const double> states) const = 0;
  virtual Summary summary(const Motion& motion, std::span<const double> states) = 0;
  virtual std::vector<Field> fields(const Motion& motion, std::span<const double> states) = 0;
};

/// True for the films that make_state_model() makes; the others belong to make_model().
[[nodiscard]] bool has_states(const Options& options);

/// The film described by the options, which has own states; throws core::InputError on values outside their range.
std::unique_ptr<StateModel> make_state_model(const Geometry& geometry, const Options& options,
                                             const Lubricant& lubricant);

/// The lines `part` of a ring film with their neighbours, as evaluate_lines() wants them, from all its states.
[[nodiscard]] std::vector<double> with_neighbours(const StateModel& film, Lines part, std::span<const double> states);

/// Adds the entries of `stencil`, the rows of `part`, to `entries`, numbered in all states of the film.
void add_entries(const StateModel& film, Lines part, const Stencil& stencil, std::vector<Entry>& entries);

/// Own states at which g(motion, s, 0) = 0, by Newton from `states`. Throws core::NotConverged or core::DomainError.
void relax(StateModel& film, const Motion& motion, std::vector<double>& states);

/// Stiffness K [N/m] and damping C [N s/m] (xx, xy, yx, yy) of a film about equilibrium: K + i omega C is minus the
/// transfer function from the position to the force, with the own states eliminated at the frequency omega [rad/s].
/// Source: van de Vrande (2001) sec. 4.4, where omega/Omega is the parameter.
struct Coefficients {
  std::array<double, 4> stiffness{}, damping{};
};
Coefficients coefficients(StateModel& film, const Motion& motion, std::span<const double> states, double omega);

}  // namespace whirl::film
