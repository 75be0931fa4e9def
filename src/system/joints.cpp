// Pedestals and elements: K, C and M between few coordinates of the hub.

#include <algorithm>

#include "rotor_part.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

using core::check;

// Coordinates of both ends of all elements.
void RotorPart::join() {
  using enum rotor::Freedom;
  for (const Element& e : train_.elements) {
    std::vector<Ends>& ends = ends_.emplace_back();
    const auto end = [&](int node, rotor::Freedom freedom) {
      const PetscInt q = rotor_->coordinate(node, freedom);
      if (q < 0) throw core::InputError("element " + e.name + " acts on what is no coordinate of the rotor");
      return q;
    };
    for (const rotor::Freedom f : {x, y, slope_x, slope_y}) {
      if (rotor::is_slope(f) && !sees_slopes(e)) continue;
      ends.push_back({{end(e.node, f), 1.0}});
      if (e.to_node) ends.back().emplace_back(end(*e.to_node, f), -1.0);
      if (!e.to_pedestal || rotor::is_slope(f)) continue;  // pedestals do not tilt
      const auto at = std::find_if(train_.supports.begin(), train_.supports.end(),
                                   [&](const Support& s) { return s.name == *e.to_pedestal; });
      core::require(at != train_.supports.end() && at->has_pedestal, "a pedestal that was not there was not refused");
      const auto& rows = pedestals_[static_cast<std::size_t>(at - train_.supports.begin())];
      ends.back().emplace_back(rows[static_cast<std::size_t>(f)], -1.0);
    }
  }
}

HubRows RotorPart::joints_of(const Train& train, std::optional<double> speed, bool by_speed) const {
  std::vector<HubRows::Entry> all;
  const auto add = [&](PetscInt i, PetscInt j, double stiffness, double damping, double mass) {
    all.push_back({2 * i, 2 * j, stiffness});
    all.push_back({2 * i, 2 * j + 1, damping, 0, mass});
  };
  for (std::size_t i = 0; i < pedestals_.size(); ++i)
    for (std::size_t d = 0; d < 2; ++d) {
      const Support& s = train.supports[i];
      const double held = by_speed ? 0 : 1;
      if (const PetscInt row = pedestals_[i][d]; row >= 0 && owns(row))
        add(row, row, held * s.stiffness[d], held * s.damping[d], held * s.mass[d]);
    }
  for (std::size_t e = 0; e < ends_.size(); ++e) {
    ElementCurve::At at;
    if (speed) at = ElementCurve(train.elements[e]).at(*speed);
    const ElementCoefficients& c = by_speed ? at.by_speed : at.value;
    for (std::size_t d = 0; d < ends_[e].size(); ++d)
      for (const auto& [row, to] : ends_[e][d])
        for (std::size_t f = 0; owns(row) && f < ends_[e].size(); ++f)
          for (const auto& [column, side] : ends_[e][f]) {
            const std::size_t k = 4 * d + f;
            add(row, column, to * side * c.stiffness[k], to * side * c.damping[k], to * side * c.mass[k]);
          }
  }
  return HubRows(std::move(all));
}

bool RotorPart::follow(double speed) {
  if (speed_ && (*speed_ == speed || !varies_)) return false;
  const HubRows joints = joints_of(train_, speed, false);
  varies_ = std::any_of(train_.elements.begin(), train_.elements.end(),
                        [](const Element& e) { return ElementCurve(e).varies(); });
  linear_.set(base_, joints);
  if (varies_) by_speed_ = joints_of(train_, speed, true);
  speed_ = speed;
  update_load();
  return true;
}

void RotorPart::add_rest(const Train& train, const Motions& rest, bool by_speed, double factor,
                         std::vector<double>& rows) const {
  for (std::size_t e = 0; e < rest.size(); ++e) {
    if (carries_static_load(train.elements[e])) continue;
    const ElementCurve::At at = ElementCurve(train.elements[e]).at(*speed_);
    const ElementCoefficients::Matrix& k = by_speed ? at.by_speed.stiffness : at.value.stiffness;
    for (std::size_t d = 0; d < ends_[e].size(); ++d)
      for (const auto& [row, to] : ends_[e][d])
        for (std::size_t f = 0; owns(row) && f < ends_[e].size(); ++f)
          rows[static_cast<std::size_t>(2 * (row - begin_))] += factor * to * k[4 * d + f] * rest[e][f];
  }
}

void RotorPart::set_rest(Motions rest) {
  rest_ = std::move(rest);
  update_load();
}

void RotorPart::update_load() {
  load_ = weights_;
  if (speed_) add_rest(train_, rest_, false, 1, load_);
}

std::vector<double> RotorPart::load_by_speed() const {
  if (rest_.empty()) return {};
  std::vector<double> out(load_.size(), 0.0);
  add_rest(train_, rest_, true, 1, out);
  add_rest(train_, rest_rate_, false, 1, out);
  return out;
}

RotorPart::Motions RotorPart::motions(const double* states) const {
  Motions out;
  for (const std::vector<Ends>& ends : ends_) {
    std::array<double, 4>& to = out.emplace_back();
    for (std::size_t d = 0; d < ends.size(); ++d)
      for (const auto& [q, side] : ends[d]) to[d] += side * states[2 * q];
  }
  return out;
}

std::array<double, 4> RotorPart::force(std::size_t element, const std::array<double, 4>& motion,
                                       const std::array<double, 4>& velocity) const {
  const Element& e = train_.elements[element];
  const ElementCoefficients c = ElementCurve(e).at(*speed_).value;
  const bool moved = !carries_static_load(e) && !rest_.empty();
  std::array<double, 4> out{};
  for (std::size_t d = 0; d < 4; ++d)
    for (std::size_t f = 0; f < 4; ++f) {
      const std::size_t k = 4 * d + f;
      out[d] -= c.stiffness[k] * (motion[f] - (moved ? rest_[element][f] : 0)) + c.damping[k] * velocity[f];
    }
  return out;
}

}  // namespace whirl::system
