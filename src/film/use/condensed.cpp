#include "film/use/condensed.hpp"

#include <algorithm>
#include <utility>

#include "whirl/core/error.hpp"

namespace whirl::film {

Condensed::Condensed(std::unique_ptr<Film> film)
    : film_(std::move(film)), carried_rates_(film_->carried_rates()), steady_(*film_) {}

// carried_rates() times `by`, which is a velocity or a displacement.
std::vector<double> Condensed::carried(const std::array<double, 4>& by) const {
  std::vector<double> out(film_->states(), 0.0);
  for (std::size_t port = 0; port < carried_rates_.size(); ++port) {
    const double times = by[static_cast<std::size_t>(film_->ports()[port])];
    if (times == 0.0) continue;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += times * carried_rates_[port][k];
  }
  return out;
}

bool Condensed::attempt(const JournalMotion& motion, Need need, std::vector<double> states, double error) {
  there_ = false;
  try {
    steady_.solve(motion, carried(motion.velocity), Steady::Until::same_force, need, states, error);
  } catch (const core::DomainError&) {
    reason_ = std::current_exception();
    return false;
  } catch (const core::NotConverged&) {
    reason_ = std::current_exception();
    return false;
  }
  found_ = motion;
  states_ = std::move(states);
  return there_ = true;
}

namespace {

// Changes of the ports' positions and velocities, and of the speed: the order of Steady::slopes().
Eigen::VectorXd change(const JournalMotion& from, const JournalMotion& to, std::span<const Port> ports) {
  const auto n = static_cast<Eigen::Index>(ports.size());
  Eigen::VectorXd out(2 * n + 1);
  for (Eigen::Index p = 0; p < n; ++p) {
    const auto w = static_cast<std::size_t>(ports[static_cast<std::size_t>(p)]);
    out(p) = to.position[w] - from.position[w];
    out(n + p) = to.velocity[w] - from.velocity[w];
  }
  out(2 * n) = to.speed - from.speed;
  return out;
}

}  // namespace

Condensed::Near Condensed::nearest(const JournalMotion& motion) const {
  Near out;
  double least = Steady::unknown;
  const auto ports = film_->ports();
  for (const Known& k : known_) {
    const Eigen::VectorXd by = change(k.motion, motion, ports);
    const double distance = by.cwiseProduct(moves_).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    out.known = &k;
    out.by = by;
  }
  if (!out.known) return out;
  out.moved = (out.known->slopes * out.by.cast<float>()).cast<double>();
  out.size = steady_.size(out.moved);
  return out;
}

// Not where slopes change the states by more than half a typical one, where they say little.
bool Condensed::predict(const JournalMotion& motion, Need need) {
  constexpr double most = 0.5;
  const Near near = nearest(motion);
  if (!(near.size <= most)) return false;
  std::vector<double> states = near.known->states;
  for (std::size_t k = 0; k < states.size(); ++k) states[k] += near.moved(static_cast<Eigen::Index>(k));
  // Slopes in single precision.
  return attempt(motion, need, std::move(states), steady_.lacks(near.size) + 1e-6 * near.size);
}

// The last steps of Newton's method move a cycle by less than shows in tangents. What is left out of the force is
// second order.
bool Condensed::extrapolate(const JournalMotion& motion, Response& response) const {
  constexpr double not_in_tangents = 1e-8, not_in_force = 1e-13;
  if (known_.empty() || film_->thickness_of_states()) return false;
  const Near near = nearest(motion);
  if (!(steady_.bends(near.size) <= not_in_tangents && steady_.bends(near.size) * near.size <= not_in_force))
    return false;
  response = near.known->response;
  response.min_thickness = film_->least_thickness(motion, near.known->states);
  const auto ports = film_->ports();
  for (const Port from : ports) {
    const auto i = static_cast<std::size_t>(from);
    for (std::size_t w = 0; w < ports.size(); ++w) {
      const auto j = static_cast<std::size_t>(ports[w]);
      const auto k = static_cast<Eigen::Index>(w);
      response.force[i] += response.d_position[i][j] * near.by(k) +
                           response.d_velocity[i][j] * near.by(static_cast<Eigen::Index>(ports.size()) + k);
    }
    response.force[i] += response.d_speed[i] * near.by(near.by.size() - 1);
  }
  return true;
}

void Condensed::remember(const Eigen::MatrixXd& slopes, const Response& response) {
  constexpr std::size_t most_bytes = 16 << 20;
  moves_.resize(slopes.cols());
  for (Eigen::Index w = 0; w < slopes.cols(); ++w) moves_(w) = steady_.size(slopes.col(w));
  const std::size_t each = states_.size() * (sizeof(double) + static_cast<std::size_t>(slopes.cols()) * sizeof(float));
  if (known_.size() < std::max<std::size_t>(1, most_bytes / each)) {
    known_.push_back({*found_, states_, slopes.cast<float>(), response});
    return;
  }
  known_[oldest_] = {*found_, states_, slopes.cast<float>(), response};
  oldest_ = (oldest_ + 1) % known_.size();
}

// From the last states, with what the film remembers carried along.
bool Condensed::follow(const JournalMotion& motion, Need need) {
  std::array<double, 4> moved{};
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = motion.position[i] - found_->position[i];
  std::vector<double> states = carried(moved);
  for (std::size_t k = 0; k < states.size(); ++k) states[k] += states_[k];
  if (carried_rates_.empty()) {
    std::vector<double> further = states;
    steady_.follow(*found_, motion, further);
    if (attempt(motion, need, std::move(further))) return true;
  }
  return attempt(motion, need, std::move(states));
}

bool Condensed::start_anew(const JournalMotion& motion, Need need) {
  std::vector<double> states(film_->states());
  film_->unloaded(motion, states);
  return attempt(motion, need, std::move(states));
}

// A journal that has gone deep into a liner is reached from the centre of the bearing by steps; the same steps from the
// same centre, so that the way there does not show.
void Condensed::solve(const JournalMotion& motion, Need need) {
  if (there_ && *found_ == motion) return;
  if ((!known_.empty() && predict(motion, need)) || (found_ && follow(motion, need)) || start_anew(motion, need))
    return;
  const std::exception_ptr reason = reason_;
  const std::optional<JournalMotion> before = found_;
  const std::vector<double> states = states_;
  JournalMotion centred;
  centred.speed = motion.speed;
  if (!carried_rates_.empty() && start_anew(centred, Need::force)) {
    constexpr double shortest = 1.0 / 64;
    double reached = 0.0;
    for (double step = 0.5; reached < 1.0 && step >= shortest;) {
      const double next = std::min(1.0, reached + step);
      JournalMotion way = motion;
      for (std::size_t i = 0; i < 4; ++i) {
        way.position[i] *= next;
        way.velocity[i] *= next;
      }
      if (follow(way, next < 1.0 ? Need::force : need))
        reached = next;
      else
        step *= 0.5;
    }
    if (reached == 1.0) return;
  }
  found_ = before;
  states_ = states;
  there_ = false;
  // To a solver outside it is a place that the film can not be taken to: a shorter step may end where it can.
  try {
    std::rethrow_exception(reason);
  } catch (const core::NotConverged& e) {
    throw core::DomainError(e.what());
  }
}

void Condensed::evaluate(const JournalMotion& motion, const Share& /*share*/, std::span<const double> /*states*/,
                         std::span<const double> /*rates*/, Need need, StateResponse& all) {
  Response& response = all.without_states();
  if (extrapolate(motion, response)) return;
  solve(motion, need);
  response.force = steady_.here().journal.force;
  response.min_thickness = steady_.here().journal.min_thickness;
  if (need == Need::force) return;
  const StateResponse& at = steady_.tangents();
  response = at.journal;
  const auto ports = film_->ports();
  const auto n = static_cast<Eigen::Index>(states_.size());
  const auto thin = [n](const std::vector<double>& v) { return Eigen::Map<const Eigen::VectorXd>(v.data(), n); };
  const Share& whole = film_->whole();
  if (carried_rates_.empty()) {
    const Eigen::MatrixXd slopes = steady_.slopes();
    for (std::size_t f = 0; f < ports.size(); ++f) {
      const auto i = static_cast<std::size_t>(ports[f]);
      const Eigen::RowVectorXd by = at.forces.row(static_cast<Eigen::Index>(f)) * slopes;
      const auto count = static_cast<Eigen::Index>(ports.size());
      for (Eigen::Index w = 0; w < count; ++w) {
        const auto j = static_cast<std::size_t>(ports[static_cast<std::size_t>(w)]);
        response.d_position[i][j] += by(w);
        response.d_velocity[i][j] += by(count + w);
      }
      response.d_speed[i] += by(2 * count);
    }
    remember(slopes, response);
    return;
  }
  const Eigen::MatrixXd lambdas = steady_.solve_transposed(at.forces.transpose());
  const Eigen::MatrixXd by_inputs = at.inputs * lambdas;
  for (std::size_t f = 0; f < ports.size(); ++f) {
    const auto i = static_cast<std::size_t>(ports[f]);
    const auto lambda = lambdas.col(static_cast<Eigen::Index>(f));
    // What a rate of each state does to the force, all in all.
    Eigen::VectorXd by_rates = Eigen::VectorXd::Zero(n);
    for_entries(whole, whole.d_rates, at.d_rates,
                [&](int row, int column, double value) { by_rates(column) -= lambda(row) * value; });
    const auto component = static_cast<Eigen::Index>(f);
    if (at.force_rates.rows() > 0) by_rates += at.force_rates.row(component).transpose();
    for (std::size_t w = 0; w < ports.size(); ++w) {
      const auto j = static_cast<std::size_t>(ports[w]);
      const auto motion_of = static_cast<Eigen::Index>(w), rate_of = static_cast<Eigen::Index>(ports.size() + w);
      response.d_position[i][j] -= by_inputs(motion_of, component);
      response.d_velocity[i][j] += by_rates.dot(thin(carried_rates_[w])) - by_inputs(rate_of, component);
    }
    response.d_speed[i] -= lambda.dot(thin(at.d_speed));
  }
}

FilmReport Condensed::summary(const JournalMotion& motion, std::span<const double> /*states*/) {
  solve(motion, Need::force);
  there_ = false;  // the film is asked on its own from here on
  return film_->summary(motion, states_);
}

std::vector<NodalField> Condensed::fields(const JournalMotion& motion, std::span<const double> /*states*/) {
  solve(motion, Need::force);
  there_ = false;
  return film_->fields(motion, states_);
}

double Condensed::least_thickness(const JournalMotion& motion, std::span<const double> /*states*/) {
  if (film_->thickness_of_states()) solve(motion, Need::force);
  return film_->least_thickness(motion, states_);
}

void Condensed::start_from(const Film& other) {
  const auto* film = dynamic_cast<const Condensed*>(&other);
  if (!film || film->film_->states() != film_->states()) return;
  found_ = film->found_;
  states_ = film->states_;
  there_ = false;
}

std::unique_ptr<Film> condense(std::unique_ptr<Film> film) {
  if (film->states() == 0) return film;
  return std::make_unique<Condensed>(std::move(film));
}

}  // namespace whirl::film
