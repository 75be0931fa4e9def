#include "blocks.hpp"

#include <cmath>
#include <span>

#include "film_part.hpp"
#include "hub_rows.hpp"
#include "rotor_part.hpp"
#include "slope.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {
namespace {

using core::check;

using Entries = std::vector<Eigen::Triplet<double>>;

problem::SparseBlock block(Eigen::Index rows, Eigen::Index columns, const Entries& entries) {
  problem::SparseBlock out(rows, columns);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// One component of the hub's rows, zeros left out.
problem::SparseBlock block(Eigen::Index n, const HubRows& rows, double HubRows::Entry::*of) {
  Entries entries;
  for (const HubRows::Entry& e : rows.entries())
    if (e.*of != 0) entries.emplace_back(e.row, e.column, e.*of);
  return block(n, n, entries);
}

}  // namespace

RotorSystem::MachineBlocks::MachineBlocks(RotorSystem& system) : system_(system) {
  rebuild();
  find_own_states();
}

void RotorSystem::MachineBlocks::rebuild() {
  const RotorSystem& system = system_;
  const HubRows& linear = system.hub_->linear();
  const Eigen::Index n = 2 * system.coordinates(), bearings = system.n_bearings();
  Entries b, c;
  Eigen::Index ports = 0;
  ports_.clear();
  for (int i = 0; i < bearings; ++i) {
    const std::vector<PortEnds>& of = system.bearings_[static_cast<std::size_t>(i)].part->ports();
    const auto k = static_cast<Eigen::Index>(of.size());
    ports_.push_back({ports, k});
    for (Eigen::Index d = 0; d < k; ++d)
      for (const auto& [q, side] : of[static_cast<std::size_t>(d)]) {
        b.emplace_back(2 * q, ports + d, side);
        c.emplace_back(2 * ports + d, 2 * q, side);
        c.emplace_back(2 * ports + k + d, 2 * q + 1, side);
      }
    ports += k;
  }
  by_speed_.clear();
  if (const HubRows* slope = system.hub_->by_speed())
    for (const auto of : {&HubRows::Entry::at_rest, &HubRows::Entry::rates}) by_speed_.push_back(block(n, *slope, of));
  l1_ = block(n, linear, &HubRows::Entry::rates);
  l0_at_rest_ = block(n, linear, &HubRows::Entry::at_rest);
  gyroscopic_ = block(n, linear, &HubRows::Entry::turning);
  // All of L0 with one pattern, so that it follows the speed by its values alone.
  l0_ = l0_at_rest_ + gyroscopic_;
  l0_at_rest_ = problem::SparseBlock(0.0 * l0_ + l0_at_rest_);
  l0_by_speed_ = 0.0 * l0_ + gyroscopic_;
  b_ = block(n, ports, b);
  c_ = block(2 * ports, n, c);
  l0_speed_ = -1;
}

void RotorSystem::MachineBlocks::find_own_states() {
  for (std::size_t i = 0; i < system_.bearings_.size(); ++i) {
    const FilmPart& part = *system_.bearings_[i].part;
    if (part.count() == 0) continue;
    const auto [first, k] = ports_[i];
    problem::OwnStates own{part.first(), part.count(), 2 * first, 2 * k, first, k, {}, {}};
    const film::Share& all = part.film().whole();
    for (const auto& [from, to] : {std::pair{&all.d_states, &own.states}, std::pair{&all.d_rates, &own.rates}})
      film::for_entries(all, *from, {}, [to = to](int row, int column, double) { to->push_back({row, column}); });
    own.settles = part.settles();
    own_.push_back(std::move(own));
  }
}

const problem::SparseBlock& RotorSystem::MachineBlocks::l1() {
  system_.prepare();
  return l1_;
}

const problem::SparseBlock& RotorSystem::MachineBlocks::l0() {
  system_.prepare();
  if (l0_speed_ != system_.speed_) {
    l0_speed_ = system_.speed_;
    l0_.coeffs() = l0_at_rest_.coeffs() + l0_speed_ * l0_by_speed_.coeffs();
  }
  return l0_;
}

void RotorSystem::MachineBlocks::load(double angle, Eigen::VectorXd& load) {
  system_.prepare_loads(false);
  const RotorPart& hub = *system_.hub_;
  const auto [c, s] = RotorPart::unbalance_factors(system_.instant(angle, nullptr, nullptr));
  load.setZero(size());
  for (Eigen::Index i = 0; i < size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    load(i) = hub.load()[k] + c * hub.unbalance().cosine[k] + s * hub.unbalance().sine[k];
  }
}

void RotorSystem::MachineBlocks::films(const Eigen::VectorXd& inputs, const double* own, const double* rates,
                                       bool tangents, problem::Films& films) {
  const int bearings = system_.n_bearings();
  const Eigen::Index r = b_.cols();
  films.forces.resize(r);
  films.residual.resize(system_.n_own_);
  films.own.resize(own_.size());
  if (tangents) {
    films.d_inputs.setZero(r, 2 * r);
    films.d_speed.resize(r + system_.n_own_);
  }
  const film::Need need = tangents ? film::Need::tangents : film::Need::force;
  std::size_t next = 0;  // among the films with own states
  for (int i = 0; i < bearings; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto [first, ports] = ports_[k];
    const double* at = inputs.data() + 2 * first;
    const auto n = static_cast<std::size_t>(ports);
    const film::JournalMotion motion = system_.motion(k, {at, n}, {at + ports, n});
    const FilmPart& part = *system_.bearings_[k].part;
    film::StateResponse& here = part.count() > 0 ? films.own[next++] : without_states_;
    system_.at_bearing(k, [&] { part.evaluate(motion, own, rates, need, here); });
    const film::Response& response = here.journal;
    for (Eigen::Index d = 0; d < ports; ++d) films.forces(first + d) = response.force[static_cast<std::size_t>(d)];
    const auto values = [&](const std::vector<double>& v) {
      return Eigen::Map<const Eigen::VectorXd>(v.data(), part.count());
    };
    films.residual.segment(part.first(), part.count()) = values(here.residual);
    if (!tangents) continue;
    for (Eigen::Index d = 0; d < ports; ++d) {
      const auto row = static_cast<std::size_t>(d);
      for (Eigen::Index e = 0; e < ports; ++e) {
        films.d_inputs(first + d, 2 * first + e) = response.d_position[row][static_cast<std::size_t>(e)];
        films.d_inputs(first + d, 2 * first + ports + e) = response.d_velocity[row][static_cast<std::size_t>(e)];
      }
      films.d_speed(first + d) = response.d_speed[row];
    }
    films.d_speed.segment(r + part.first(), part.count()) = values(here.d_speed);
  }
}

void RotorSystem::MachineBlocks::parameter_derivative(double angle, const Eigen::VectorXd& x,
                                                      const Eigen::VectorXd& xdot, const problem::Films& films,
                                                      Eigen::VectorXd& out) {
  const Eigen::Index n = size(), k = system_.n_own_;
  if (!system_.parameter_is_speed()) {
    out.resize(n + k);
    const auto vector = [&](const Eigen::VectorXd& v) {
      core::Vector wrapped;
      check(VecCreateSeqWithArray(system_.comm_, 1, static_cast<PetscInt>(v.size()), v.data(), wrapped.put()));
      return wrapped;
    };
    system_.prepare_loads(true);
    return system_.slope().derivative(angle, vector(x).get(), vector(xdot).get(), vector(out).get());
  }
  system_.prepare_loads(true);
  out.resize(n + k);
  out.head(n).noalias() = gyroscopic_ * x.head(n);
  if (!by_speed_.empty()) out.head(n) += by_speed_[0] * x.head(n) + by_speed_[1] * xdot.head(n);
  if (const std::vector<double> lacking = system_.hub_->load_by_speed(); !lacking.empty())
    out.head(n) -= Eigen::Map<const Eigen::VectorXd>(lacking.data(), n);
  out.head(n).noalias() -= b_ * films.d_speed.head(b_.cols());
  out.tail(k) = films.d_speed.tail(k);
  if (!system_.forcing_) return;
  const double c = 2 * system_.speed_ * std::cos(angle), s = 2 * system_.speed_ * std::sin(angle);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    out(i) -= c * system_.forcing_cosine()[row] + s * system_.forcing_sine()[row];
  }
}

}  // namespace whirl::system
