// Pedestals and elements: K, C and M between few coordinates of the hub.

#include <algorithm>

#include "rotor_part.hpp"
#include "states.hpp"
#include "whirl/core/error.hpp"

namespace whirl::system {

using core::check;

namespace {

void assemble(std::initializer_list<Mat> all) {
  for (Mat m : all) {
    check(MatAssemblyBegin(m, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(m, MAT_FINAL_ASSEMBLY));
  }
}

}  // namespace

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

RotorPart::Joints RotorPart::joints_of(const Train& train, double speed, bool by_speed) const {
  Joints out;
  for (std::size_t i = 0; i < pedestals_.size(); ++i)
    for (std::size_t d = 0; d < 2; ++d) {
      const Support& s = train.supports[i];
      if (const PetscInt row = pedestals_[i][d]; row >= 0 && owns(row)) {
        auto& at = out[{row, row}];
        if (!by_speed) at = {s.stiffness[d], s.damping[d], s.mass[d]};
      }
    }
  for (std::size_t e = 0; e < ends_.size(); ++e) {
    const ElementCurve::At at = ElementCurve(train.elements[e]).at(speed);
    const ElementCoefficients& c = by_speed ? at.by_speed : at.value;
    for (std::size_t d = 0; d < ends_[e].size(); ++d)
      for (const auto& [row, to] : ends_[e][d])
        for (std::size_t f = 0; owns(row) && f < ends_[e].size(); ++f)
          for (const auto& [column, side] : ends_[e][f]) {
            auto& sum = out[{row, column}];
            const std::size_t k = 4 * d + f;
            sum[0] += to * side * c.stiffness[k];
            sum[1] += to * side * c.damping[k];
            sum[2] += to * side * c.mass[k];
          }
  }
  return out;
}

void RotorPart::find_base() {
  base_ = places();
  for (auto& [place, base] : base_) {
    const auto [i, j] = place;
    check(MatGetValue(matrices_.at_rest.get(), 2 * i, 2 * j, &base[0]));
    check(MatGetValue(matrices_.at_rest.get(), 2 * i, 2 * j + 1, &base[1]));
    check(MatGetValue(matrices_.rates.get(), 2 * i, 2 * j + 1, &base[2]));
  }
}

RotorPart::Joints RotorPart::places() const {
  Joints out;
  for (const auto& rows : pedestals_)
    for (const PetscInt row : rows)
      if (row >= 0 && owns(row)) out[{row, row}] = {};
  for (const std::vector<Ends>& ends : ends_)
    for (const Ends& to : ends)
      for (const auto& [row, by] : to)
        for (std::size_t f = 0; owns(row) && f < ends.size(); ++f)
          for (const auto& [column, side] : ends[f]) out[{row, column}] = {};
  return out;
}

bool RotorPart::follow(double speed) {
  if (speed_ && (*speed_ == speed || !varies_)) return false;
  Joints joints = joints_of(train_, speed, false);
  varies_ = std::any_of(train_.elements.begin(), train_.elements.end(),
                        [](const Element& e) { return ElementCurve(e).varies(); });
  joints_ = std::move(joints);
  if (varies_) by_speed_ = matrices_of(joints_of(train_, speed, true), 1);
  speed_ = speed;
  set_joints(matrices_.at_rest.get(), matrices_.rates.get());
  update_load();
  return true;
}

void RotorPart::set_joints(Mat at_rest, Mat rates) const {
  for (const auto& [place, joint] : joints_) {
    const auto [i, j] = place;
    const std::array<double, 3>& base = base_.at(place);
    check(MatSetValue(at_rest, 2 * i, 2 * j, base[0] + joint[0], INSERT_VALUES));
    check(MatSetValue(at_rest, 2 * i, 2 * j + 1, base[1] + joint[1], INSERT_VALUES));
    check(MatSetValue(rates, 2 * i, 2 * j + 1, base[2] + joint[2], INSERT_VALUES));
  }
  assemble({at_rest, rates});
}

RotorPart::Matrices RotorPart::matrices_of(const Joints& joints, double factor) const {
  StateEntries rates, at_rest;
  for (const auto& [place, joint] : joints) {
    const auto [i, j] = place;
    at_rest.add(2 * i, 2 * j, factor * joint[0]);
    at_rest.add(2 * i, 2 * j + 1, factor * joint[1]);
    rates.add(2 * i, 2 * j + 1, factor * joint[2]);
  }
  Matrices out;
  out.at_rest = at_rest.matrix(comm_, end_ - begin_);
  out.rates = rates.matrix(comm_, end_ - begin_);
  return out;
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
