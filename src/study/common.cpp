#include "common.hpp"

#include <fmt/core.h>

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "study/bars/mesh_wave.hpp"
#include "study/bars/unresolved.hpp"
#include "study/columns.hpp"
#include "study/make_plant.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"
#include "whirl/solve/newton/machine_modes.hpp"

namespace whirl::study {

using core::check;

std::vector<film::PortCoefficients> film_coefficients(system::RotorSystem& system, const std::vector<double>& x,
                                                      double omega) {
  const std::vector<film::Response> films = system.film_responses(x.data(), film::Need::tangents);
  std::vector<film::PortCoefficients> out(films.size());
  for (std::size_t b = 0; b < films.size(); ++b) {
    out[b].ports = static_cast<std::size_t>(system.ports(static_cast<int>(b)));
    for (std::size_t d = 0; d < out[b].ports; ++d)
      for (std::size_t e = 0; e < out[b].ports; ++e) {
        out[b].stiffness[d][e] = -films[b].d_position[d][e];
        out[b].damping[d][e] = -films[b].d_velocity[d][e];
      }
  }
  if (system.own_states() == 0) return out;
  if (!(omega > 0)) throw core::InputError("the frequency of stiffness and damping must be positive");
  const core::Vector at = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
  core::fill(at.get(), x);
  solve::FrequencyResolvent transfer(system);
  transfer.linearise(at.get());
  const auto blocks = transfer.evaluate({0, omega}, false);
  std::size_t part = 0;
  for (std::size_t b = 0; b < films.size(); ++b) {
    const auto bearing = static_cast<int>(b);
    if (system.own_states(bearing) == 0) continue;
    std::vector<PetscInt> position, rate;
    for (int d = 0; d < system.ports(bearing); ++d) {
      position.push_back(2 * system.journal(bearing, d));
      rate.push_back(position.back() + 1);
    }
    const Eigen::MatrixXcd k = transfer.from_motion(part, blocks[part], {0, omega}, position, rate, position);
    for (Eigen::Index d = 0; d < k.rows(); ++d)
      for (Eigen::Index e = 0; e < k.cols(); ++e) {
        out[b].stiffness[static_cast<std::size_t>(d)][static_cast<std::size_t>(e)] += k(d, e).real();
        out[b].damping[static_cast<std::size_t>(d)][static_cast<std::size_t>(e)] += k(d, e).imag() / omega;
      }
    ++part;
  }
  return out;
}

namespace {

// One more step where Newton's method has ended just below its tolerance: damping that is a thousandth of the frequency
// has lost as many digits more than the equilibrium. Error bars do not show it, as every mesh follows the same path.
void polish(solve::Equilibria& equilibria, Vec x, solve::NewtonOptions options, solve::NewtonResult& result) {
  constexpr double enough = 1e-13;
  if (!result.converged || result.residual <= enough) return;
  const core::Vector before = core::duplicate(x);
  check(VecCopy(x, before.get()));
  options.tolerance = enough;
  options.max_iterations = 1;
  const double residual = equilibria.find(x, options).residual;
  if (residual < result.residual)
    result.residual = residual;
  else
    check(VecCopy(before.get(), x));
}

}  // namespace

solve::NewtonResult find_rest(system::Plant& system, Vec x) {
  solve::Equilibria equilibria(system);
  return find_rest(equilibria, system, x);
}

solve::NewtonResult find_rest(solve::Equilibria& equilibria, system::Plant& system, Vec x) {
  solve::NewtonOptions options;
  options.max_iterations = 30;
  const bool has_parts = problem::parts_of(system.fields()).size() > 0;
  if (has_parts) options.patience = 4;
  const core::Vector start = core::duplicate(x);
  check(VecCopy(x, start.get()));
  system.set_forcing(false);
  auto result = equilibria.find(x, options);
  if (!result.converged && has_parts) {
    // A film that starts without its pressure (orifices) has residuals that grow before they fall: no line search lets
    // them, and whole steps get through.
    check(VecCopy(start.get(), x));
    options.searches = false;
    result = equilibria.find(x, options);
  }
  polish(equilibria, x, options, result);
  system.set_forcing(true);
  return result;
}

bool Walker::attempt(double speed) {
  system_.set_parameter(speed);
  trial_ = core::duplicate(x_.get());
  check(VecCopy(x_.get(), trial_.get()));
  const solve::NewtonResult result = find_rest(equilibria_, system_, trial_.get());
  reason_ = result.reason;
  if (!result.converged) return false;
  std::swap(x_, trial_);
  last_ = speed;
  return true;
}

Trail Walker::trail() {
  const auto leave = [this] {
    if (!x_) return std::vector<double>{};  // it has found nothing yet
    std::vector<double> state = system_.gather(x_.get());
    state.push_back(last_);
    const std::vector<double> anchor = equilibria_.anchor();
    state.insert(state.end(), anchor.begin(), anchor.end());
    return state;
  };
  const auto take = [this](const std::vector<double>& state) {
    if (state.empty()) return void(x_ = {});
    if (!x_) x_ = core::make_vector(system_.comm(), system_.local_size(), PETSC_DETERMINE);
    const auto size = static_cast<std::ptrdiff_t>(system_.size());
    core::fill(x_.get(), {state.begin(), state.begin() + size});
    last_ = state[static_cast<std::size_t>(size)];
    equilibria_.take_anchor({state.begin() + size + 1, state.end()});
  };
  return {leave, take};
}

// Where nothing leads to from the neighbour there may be an equilibrium all the same: a speed behind a range without
// any.
Vec Walker::at(double speed) {
  if (!x_) {
    start_at(speed);
  } else if (!walk_to(speed)) {
    const std::string why =
        fmt::format("the equilibrium could not be followed from {:.6g} to {:.6g} rad/s: {}", last_, speed, reason_);
    const double before = last_;
    system_.set_parameter(speed);
    core::Vector kept = std::exchange(x_, first_guess(system_));
    if (!attempt(speed)) {
      x_ = std::move(kept);
      last_ = before;
      throw core::NotConverged(why);
    }
  }
  system_.set_parameter(speed);
  return x_.get();
}

// A thick film is easier to hit than a thin one: from a higher speed if need be.
void Walker::start_at(double speed) {
  constexpr int higher = 12;
  double start = speed;
  for (int k = 0; k <= higher; ++k, start *= 1.4) {
    system_.set_parameter(start);
    x_ = first_guess(system_);
    if (!attempt(start)) continue;
    if (walk_to(speed)) return;
    throw core::NotConverged(
        fmt::format("the equilibrium could not be followed from {:.6g} to {:.6g} rad/s: {}", last_, speed, reason_));
  }
  x_ = {};
  throw core::NotConverged(fmt::format("no equilibrium near {:.6g} rad/s: {}", speed, reason_));
}

bool Walker::walk_to(double speed) {
  double step = speed - last_;
  while (last_ != speed) {
    const double next = std::abs(step) >= std::abs(speed - last_) ? speed : last_ + step;
    if (attempt(next)) continue;
    step = (next - last_) / 2;
    if (std::abs(step) < 1e-4 * std::max(1.0, speed)) return false;
  }
  return true;
}

solve::Stability equilibrium_stability(system::Plant& system, Vec x) {
  spectral::EigenOptions options;
  options.count = 60;
  options.shapes = may_have_mesh_waves(system);
  options.rounding = true;
  // Without damping the real parts are rounding errors, and none of them is a bifurcation.
  std::vector<std::complex<double>> values;
  std::map<double, double> rounding;  // by real part: that of the values that are nearly undamped
  int neutral = 0;
  const solve::MachineModes found = solve::machine_modes(system, x, options);
  const auto* rotor = dynamic_cast<const system::RotorSystem*>(&system);
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const double limit = rotor ? resolved_to(rotor->train().rotor) : infinite;
  // Damping below its rounding makes no machine an undamped one where no beam theory holds.
  const double beams_to = rotor ? shear_cut_off(rotor->train().rotor) : infinite;
  std::vector<std::complex<double>> of_mesh;
  for (const auto& mode : found.modes) {
    if (mode.lambda.real() > 0 && is_of_elements(mode.lambda, limit)) continue;
    // A real one is a wave that stands still.
    const bool grows = !mode.neutral() && mode.lambda.real() > 0;
    if (options.shapes && grows && cells_per_wave(system, mode.shape)) {
      of_mesh.push_back(mode.lambda);
      continue;
    }
    values.push_back(mode.lambda);
    if (mode.lambda.imag() != 0) values.push_back(std::conj(mode.lambda));
    if (mode.rounding > 0) rounding[mode.lambda.real()] = mode.rounding;
    if (mode.neutral() && std::abs(mode.lambda.imag()) <= beams_to) neutral += mode.lambda.imag() != 0 ? 2 : 1;
  }
  solve::Stability s = solve::make_stability(std::move(values), [&rounding](std::complex<double> v) {
    const auto at = rounding.find(v.real());
    return v.real() - (at == rounding.end() ? 0 : at->second);
  });
  s.neutral = neutral;
  s.missed = found.doubt.empty() ? found.missed : -1;
  s.mesh_waves = std::move(of_mesh);
  return s;
}

void MissedModes::warn(io::StudySummary& summary) const {
  if (most_ > 0)
    summary.warnings.push_back(fmt::format(
        "up to {} eigenvalues that the count finds in the region were missed: stability may be wrong", most_));
  if (unsure_)
    summary.warnings.emplace_back("how many eigenvalues there are could not be counted for sure: some may be missed");
  if (most_ > 0) summary.set("missed_eigenvalues", most_, "1");
}

std::vector<std::string> names_of_bearings(const system::Machine& machine) {
  return system::bearing_names(machine);
}

void put_bearings(io::Group& group, const system::Machine& machine) {
  std::vector<double> clearance, preload, offset, arc;
  std::vector<std::int64_t> node;
  std::vector<std::string> bore;
  for (const auto& b : machine.bearings) {
    const film::Geometry g = b.geometry.value_or(film::Geometry{});
    const bool lobes = g.type == film::Geometry::Bore::lemon_bore;
    clearance.push_back(g.clearance);
    preload.push_back(lobes ? g.preload : 0.0);
    offset.push_back(lobes ? g.offset : 0.0);
    arc.push_back(g.arc);
    node.push_back(b.node);
    bore.emplace_back(lobes                                         ? "lemon_bore"
                      : g.type == film::Geometry::Bore::cylindrical ? "cylindrical"
                                                                    : "partial_arc");
  }
  auto& bearings = group.child("bearings");
  bearings.put("name", names_of_bearings(machine), "bearings in the order of the deck");
  bearings.put("node", node, "shaft node, 1-based");
  bearings.put("bore", bore, "kind of geometry");
  bearings.put("clearance", clearance, "m", "assembled radial clearance c_b; zero for a linear film");
  bearings.put("preload", preload, "1", "m = 1 - c_b/c_p of two lobes; zero for one pad at the bottom");
  bearings.put("offset", offset, "m", "horizontal distance between the centres of the two lobes");
  bearings.put("arc", arc, "rad", "angular extent of each pad");
  put_elements(group, machine);
}

void put_elements(io::Group& group, const system::Machine& machine) {
  const auto& all = machine.elements;
  if (all.empty()) return;
  using E = system::Element;
  auto& elements = group.child("elements");
  elements.put("name", column(all, &E::name), "elements in the order of the deck");
  elements.put("role", column(all, [](const E& e) { return deck::name_of(e.role); }), "what they are");
  elements.put("node", column(all, &E::node), "shaft node, 1-based");
  elements.put("to_node", column(all, [](const E& e) { return e.to_node.value_or(0); }),
               "shaft node of the other end, 1-based; 0: the ground or a pedestal");
  elements.put("to_pedestal", column(all, [](const E& e) { return e.to_pedestal.value_or(""); }),
               "bearing on whose pedestal the other end is; empty: none");
}

void put_places(io::Group& group, const system::Machine& machine, const system::Plant& plant) {
  if (system::is_rotor(machine)) return put_bearings(group, machine);
  group.child("places").put("name", plant.places().names, plant.places().text);
}

std::string number_text(double value_si, const std::string& unit) {
  return fmt::format("{:.6g}", deck::from_si(value_si, unit));
}

void put_groups(io::StudySummary& summary, const system::Train& train) {
  put_groups(summary, system::dimensionless_groups(train));
}

void put_groups(io::StudySummary& summary, const std::optional<system::DimensionlessGroups>& groups) {
  if (!groups) return;
  summary.set("nondimensional.speed_scale", groups->speed_scale, "rad/s");
  summary.set("nondimensional.load", groups->load, "1");
  summary.set("nondimensional.unbalance", groups->unbalance, "1");
  summary.set("nondimensional.length_to_diameter", groups->length_to_diameter, "1");
  summary.set("nondimensional.sommerfeld_times_speed", groups->load / groups->bearings, "1");
}

solve::ContinuationOptions continuation_of(const Parameter& p, double scale, double first, double longest) {
  const double width = std::abs(p.range.to - p.range.from) / scale;
  solve::ContinuationOptions out;
  out.initial_step = p.step ? p.step->initial.value / scale : width / first;
  out.min_step = p.step ? p.step->min.value / scale : width / 1e6;
  out.max_step = p.step ? p.step->max.value / scale : width / longest;
  out.beta_1 = p.beta_1;
  out.beta_2 = p.beta_2;
  const bool natural = p.continuation == Following::natural;
  out.kind = natural ? solve::Continuation::natural : solve::Continuation::arclength;
  return out;
}

double state_weight_of(const solve::ContinuationOptions& continuation) {
  return std::pow(continuation.max_step / 0.5, 2);
}

std::string branch_status(const solve::BranchEnd& end, const std::string& unit) {
  if (end.completed) return "completed";
  return fmt::format("ended at {:.6g} {}: {}", end.parameter, unit, end.reason);
}

}  // namespace whirl::study
