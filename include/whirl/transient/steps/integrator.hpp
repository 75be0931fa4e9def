#pragma once
// Integration in time of F(angle(t), x, dx/dt; p) = 0 by PETSc TS.

#include <functional>
#include <memory>
#include <string>

#include "whirl/problem/drive.hpp"
#include "whirl/problem/system.hpp"
#include "whirl/transient/steps/force.hpp"
#include "whirl/transient/steps/scheme.hpp"
#include "whirl/transient/steps/tangents.hpp"

namespace whirl::transient {

/// How the linear problems of a step are solved.
enum class Algebra {
  automatic,  ///< by structure where the system tells one, on one rank; else assembled
  assembled   ///< dense LAPACK where the system is small, MUMPS where it is not
};

struct IntegratorOptions {
  Scheme scheme{};
  /// Estimated error of a step: root mean square of the scaled states, relative where they exceed one.
  double tolerance = 1e-8;
  double first_step = 0;           ///< [s]; 0: a thousandth of a revolution
  std::string prefix = "motion_";  ///< of the PETSc options
  Algebra algebra = Algebra::automatic;
  /// External forces, which outlive the integrator; null: none. Steps end at their breaks.
  Forces* forces = nullptr;
  /// Called after every step with the time reached [s] and the length of the step [s]; on every rank.
  std::function<void(double time, double step)> after_step{};
};

/// The motion of one system from a state at t = 0.
///
/// The scheme is singly diagonally implicit, stiffly accurate and L-stable of order 4 with an estimate of order 3
/// (Hairer and Wanner 1996, IV (6.16)), so that neither stiff films nor the shaft's high modes limit the step. What is
/// kept from step to step only saves work: after restart() state, time and step() decide all. On an accelerated shaft
/// the system's parameter must be its speed. All members are collective on the system's communicator.
class Integrator {
public:
  /// `x` [SI] at t = 0. `system` outlives this.
  Integrator(problem::System& system, problem::Drive drive, Vec x, IntegratorOptions options = {});
  ~Integrator();
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Goes on to exactly `time` [s]. Throws core::DomainError if the motion leaves the validity of a film, with the time
  /// and the film's text, core::NotConverged if steps fail for another reason.
  void advance(double time);
  /// The same with steps that end at `end` but need not at `time` <= end: the state there is interpolated, to the
  /// tolerance. With deviations carried along they do end there.
  void advance(double time, double end);
  /// Whether steps choose their own ends, so that a state at a wanted time is interpolated in any case. advance() then
  /// goes back too, as far as the beginning of the last step.
  [[nodiscard]] bool goes_its_own_pace() const;
  /// Of such a scheme: to `time` or to the end of one step, the next one where the motion stands at an end; whichever
  /// comes first, as time() tells.
  void advance_within_step(double time);
  /// Another integrator of the same motion, which stands here, for excursions that this one does not notice. What the
  /// system is at (its parameter) they share.
  [[nodiscard]] std::unique_ptr<Integrator> twin() const;
  /// Carries small deviations along from now on, by the exact derivative of each discrete step; null: none. New ones
  /// are made to obey the equations without rates first. They outlive their use here.
  void carry(Tangents* tangents);

  [[nodiscard]] double time() const;
  /// The length of step [s] that the error control has arrived at.
  [[nodiscard]] double step() const;
  /// Goes on from what scaled() holds, at `time` with `step`: where a checkpoint left off, or at constant speed one
  /// revolution earlier. What follows depends on these alone, to the bit: predictions and factors kept are dropped.
  void restart(double time, double step);
  /// At the end of a revolution: time goes on from `earlier` [s] less (0 unless the equations repeat themselves after
  /// it). Schemes of one step then forget() as by restart(); those of several keep their history.
  void close_revolution(double earlier);
  /// State in SI.
  void state(Vec x) const;
  /// State over its scales; stays valid and follows the motion.
  [[nodiscard]] Vec scaled() const;
  [[nodiscard]] const problem::Drive& drive() const;

  /// What it took so far.
  struct Work {
    long steps = 0, rejected = 0, residuals = 0;
    long jacobians = 0;       ///< tangents of the films
    long factorisations = 0;  ///< of a step's matrix, or of the parts of it that are kept
  };
  [[nodiscard]] Work work() const;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace whirl::transient
