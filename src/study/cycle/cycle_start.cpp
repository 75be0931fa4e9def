// Where branches of cycles begin: at an equilibrium, at a Hopf point, at a flip.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/branch_state.hpp"
#include "study/cycle/coexisting.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/make_plant.hpp"
#include "study/packed.hpp"
#include "study/state_rows.hpp"
#include "study/stored_vector.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/machine_modes.hpp"

namespace whirl::study {
namespace {

using core::check;

constexpr double two_pi = 2 * std::numbers::pi;

// Two laps on one mesh.
std::vector<double> two_laps(const std::vector<double>& mesh) {
  std::vector<double> out;
  for (const double s : mesh) out.push_back(s / 2);
  for (std::size_t k = 1; k < mesh.size(); ++k) out.push_back((1 + mesh[k]) / 2);
  return out;
}

}  // namespace

// The first guess is the equilibrium, held for the whole turn: Newton adds the vibration.
core::Vector CycleFollower::start(const solve::PeriodicProblem& problem) const {
  if (first_) return problem.scatter(*first_);
  const Eigen::VectorXd rest = rows_of(find_rest(*system_).get());
  solve::Cycle guess{problem.mesh(), {}, two_pi * options_.period / system_->speed(), system_->parameter()};
  guess.x = rest.replicate(1, guess.intervals() * problem.scheme().degree);
  return problem.scatter(guess);
}

// The Hopf point is found on the branch of equilibria; there the cycle is the equilibrium itself, and the branch leaves
// along the critical mode x(s) = x_H + a Re(phi exp(2 pi i s)) with T = 2 pi/omega. A step along this tangent asks for
// an amplitude and leaves speed and period free.
solve::Restart CycleFollower::start_at_hopf() {
  solve::EquilibriumProblem equilibria(*system_, scale_, state_weight());
  core::Vector u = equilibria.make_unknown(), at_hopf,
               x = core::make_vector(system_->comm(), system_->local_size(), PETSC_DETERMINE);
  if (system_->parameter_is_speed()) {
    Walker walker(*system_);
    check(VecCopy(walker.at(system_->parameter()), x.get()));
  } else {
    x = first_guess(*system_);
  }
  equilibria.from_state(x.get(), system_->parameter(), u.get());
  solve::LocatedEvent hopf{};
  solve::BranchCallbacks callbacks;
  callbacks.stability = [&](Vec v) {
    equilibria.to_state(v, x.get());
    return equilibrium_stability(*system_, x.get());
  };
  callbacks.on_event = [&](const solve::LocatedEvent& found, Vec v) {
    if (at_hopf || found.event != solve::Event::hopf || !found.located) return;
    at_hopf = core::duplicate(x.get());
    equilibria.to_state(v, at_hopf.get());
    hopf = found;
  };
  callbacks.checkpoint = [&](const solve::ResumePoint&, Vec, Vec) { return !at_hopf; };
  const auto search = [&] {
    solve::ContinuationOptions o = continuation_;
    o.initial_step = o.max_step;
    o.newton.max_iterations = 20;
    // Points of the branch of cycles say nothing of how far the Hopf point is.
    o.max_points = std::max(o.max_points, solve::ContinuationOptions().max_points);
    const solve::BranchEnd end = solve::follow_branch(equilibria, std::move(u), o, callbacks);
    if (!at_hopf) throw core::NotConverged("no Hopf point in the range: " + end.reason);
  };
  const io::Group& piece = pieces_->get("hopf", [&](io::Group& found) {
    search();
    put_packed(found, "event", hopf, "where, with what changes there");
    put_columns(found, "state", rows_of(at_hopf.get()), stored(), "SI", "equilibrium, in natural order");
  });
  hopf = take_packed<solve::LocatedEvent>(piece, "event");
  const double parameter = hopf.parameter * scale_;
  at_hopf = core::duplicate(x.get());
  {
    const Eigen::MatrixXd state = take_columns(piece, "state", stored());
    const core::WriteArray a(at_hopf.get());
    if (layout().shared)
      std::copy_n(state.data(), a.size(), a.data());
    else
      core::fill(at_hopf.get(), {state.data(), state.data() + state.size()});
  }

  system_->set_parameter(parameter);
  const auto modes = solve::machine_modes(*system_, at_hopf.get(), {}).modes;
  const spectral::Mode* critical = nullptr;
  for (const auto& m : modes)
    if (m.lambda.imag() > 0 && (!critical || std::abs(m.lambda.real()) < std::abs(critical->lambda.real())))
      critical = &m;
  core::require(critical != nullptr, "a Hopf point has a complex eigenvalue");
  const Eigen::VectorXd rest = rows_of(at_hopf.get());
  const Eigen::Index n = rest.size();
  PetscInt first = 0;
  check(VecGetOwnershipRange(at_hopf.get(), &first, nullptr));
  Eigen::VectorXcd phi(n);
  for (Eigen::Index k = 0; k < n; ++k) phi(k) = critical->shape[static_cast<std::size_t>(first + k)];
  // The phase in which the motion is largest at s = 0: there it stands at right angles to its rate, so that even one
  // point of the cycle fixes the phase and is not moved by it.
  std::complex<double> square = phi.cwiseQuotient(problem_->state_scale()).array().square().sum();
  square = {sum_over(system_->comm(), square.real()), sum_over(system_->comm(), square.imag())};
  phi *= std::exp(std::complex<double>(0, -0.5 * std::arg(square)));
  solve::Cycle still{problem_->mesh(), {}, two_pi / critical->lambda.imag(), parameter}, mode = still;
  const auto& scheme = problem_->scheme();
  still.x = rest.replicate(1, still.intervals() * scheme.degree);
  mode.x.resize(n, still.x.cols());
  for (Eigen::Index i = 0; i < still.intervals(); ++i)
    for (Eigen::Index l = 1; l <= scheme.degree; ++l) {
      const double begin = still.mesh[static_cast<std::size_t>(i)];
      const double s = begin + (still.mesh[static_cast<std::size_t>(i) + 1] - begin) * scheme.node(l);
      mode.x.col(i * scheme.degree + l - 1) = (phi * std::exp(std::complex<double>(0, two_pi * s))).real();
    }
  // Small, so that the equation's own rate about the equilibrium is that of the mode.
  solve::Cycle reference = still;
  reference.x += 1e-4 * mode.x;
  problem_->set_phase_reference(reference);
  solve::Restart restart;
  restart.u = problem_->scatter(still);
  mode.period = mode.parameter = 0;
  restart.tangent = problem_->scatter(mode);
  check(VecScale(restart.tangent.get(),
                 1 / std::sqrt(solve::inner(*problem_, restart.tangent.get(), restart.tangent.get()))));
  restart.step = continuation_.initial_step;
  restart.point.index = -1;  // the Hopf point is no cycle: the first one comes next
  restart.point.parameter = parameter / scale_;
  hopf.critical = {0, critical->lambda.imag()};
  record_hopf(hopf, at_hopf.get(), restart);
  return restart;
}

std::vector<solve::Cycle> CycleFollower::coexisting() {
  system_->set_parameter(continuation_.from * scale_);
  const auto made = make_problem(*system_, options_.period, solve::uniform_mesh(options_.intervals), 1);
  solve::PeriodicProblem& problem = *made;
  std::vector<core::Vector> known;
  known.push_back(start(problem));
  core::Vector row = core::duplicate(known.front().get());
  solve::parameter_row(problem, row.get());
  solve::NewtonOptions newton = newton_;
  newton.max_iterations = 40;
  if (!solve::newton(problem, known.front().get(), row.get(), continuation_.from, newton).converged) return {};
  const solve::Cycle first = problem.gather(known.front().get());
  // The same motion begun some turns later is no other one.
  const auto copies = [&](Vec u) {
    const solve::Cycle cycle = problem.gather(u);
    std::vector<core::Vector> out;
    for (int turn = 1; turn < options_.period; ++turn)
      out.push_back(problem.scatter(delayed(cycle, problem.scheme(), static_cast<double>(turn) / options_.period)));
    return out;
  };
  const auto guess = [&](int k) {
    return problem.scatter(other_vibration(first, problem.scheme(), options_.period, k));
  };
  std::vector<solve::Cycle> out;
  for (const auto& u : solve::deflate(problem, state_weight(), known, guess,
                                      deflation_options(*options_.parameter.deflation, newton), copies))
    out.push_back(problem.gather(u.get()));
  return out;
}

FlipSeed CycleFollower::seed_at(const solve::Cycle& cycle) {
  FlipSeed seed{cycle, cycle};
  seed.direction.x = problem_->critical_motion(-1);
  return seed;
}

namespace {

// A motion on the first lap, `second` times it on the second one.
solve::Cycle two(const solve::Cycle& one, double second) {
  solve::Cycle out{two_laps(one.mesh), Eigen::MatrixXd(one.x.rows(), 2 * one.x.cols()), 2 * one.period, one.parameter};
  out.x << one.x, second * one.x;
  return out;
}

}  // namespace

std::unique_ptr<solve::PeriodicProblem> CycleFollower::twice_the_period(const FlipSeed& seed, double finer) const {
  auto twice = make_problem(*system_, 2 * options_.period, two_laps(seed.cycle.mesh), finer);
  if (autonomous()) twice->set_phase_reference(two(seed.cycle, 1));
  return twice;
}

// The branch leaves along +delta on the first lap and -delta on the second, at first without a change of the parameter.
solve::Restart CycleFollower::leave_flip(const solve::PeriodicProblem& twice, const FlipSeed& seed) const {
  solve::Cycle direction = two(seed.direction, -1);
  direction.parameter = 0;
  solve::Restart restart;
  restart.u = twice.scatter(two(seed.cycle, 1));
  restart.tangent = twice.scatter(direction);
  check(VecScale(restart.tangent.get(),
                 1 / std::sqrt(solve::inner(twice, restart.tangent.get(), restart.tangent.get()))));
  return restart;
}

solve::Restart CycleFollower::start_at_flip() {
  system_->set_parameter(seed_->cycle.parameter);
  problem_ = make_problem(*system_, options_.period, two_laps(seed_->cycle.mesh), 1);
  if (autonomous()) problem_->set_phase_reference(two(seed_->cycle, 1));
  solve::Restart restart = leave_flip(*problem_, *seed_);
  restart.step = continuation_.initial_step;
  restart.point.index = -1;  // the flip itself belongs to the branch of the simple period
  restart.point.parameter = seed_->cycle.parameter / scale_;
  context_.results.summary().set("flip", seed_->cycle.parameter / scale_, unit_);
  return restart;
}

// Of a branch born at a flip the first lap minus the second one, of one born at a Hopf point the motion about its mean:
// at equidistant times, scaled; the rows of this rank.
Eigen::MatrixXd CycleFollower::vanishing(const solve::Cycle& orbit) const {
  constexpr int samples = 24;
  const auto at = [&](double s) -> Eigen::VectorXd {
    return orbit.at(problem_->orbit_scheme(), s).cwiseQuotient(problem_->state_scale());
  };
  Eigen::MatrixXd motion(orbit.x.rows(), samples);
  for (int k = 0; k < samples; ++k) {
    const double s = static_cast<double>(k) / samples;
    motion.col(k) = seed_ ? at(s / 2) - at(s / 2 + 0.5) : at(s);
  }
  if (!seed_) motion.colwise() -= motion.rowwise().mean().eval();
  return motion;
}

double CycleFollower::product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) const {
  return sum_over(system_->comm(), (a.array() * b.array()).sum());
}

// Where the branch runs into what it was born of its parameter turns as at a fold, which it is not.
bool CycleFollower::at_its_origin(const solve::Cycle& orbit) const {
  if (!may_return() || vanishing_.cols() == 0) return false;
  const Eigen::MatrixXd motion = vanishing(orbit);
  return product(motion, vanishing_) < 0 || std::sqrt(product(motion, motion)) < 0.02 * largest_;
}

// A branch may run back into what it was born of: the cycle of half the period, or an equilibrium. Beyond that point it
// either repeats itself with the laps exchanged or half a period later, when what vanishes there changes its sign, or
// the step has landed on the simple cycle run twice or on the equilibrium, when nothing is left of it.
bool CycleFollower::returned(const solve::Cycle& orbit) {
  Eigen::MatrixXd motion = vanishing(orbit);
  const bool turned = vanishing_.cols() > 0 && product(motion, vanishing_) < 0;
  const double size = std::sqrt(product(motion, motion));
  largest_ = std::max(largest_, size);
  const bool vanished = size < 1e-3 * largest_;
  vanishing_ = std::move(motion);
  return turned || vanished;
}

}  // namespace whirl::study
