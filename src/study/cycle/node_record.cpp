#include "study/cycle/node_record.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/rotor/shaft.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {
namespace {

constexpr int samples_per_turn = 128;
constexpr std::size_t samples_in_space = 64;

std::vector<io::Table::Column> columns(const std::string& unit, const std::vector<int>& nodes) {
  const std::vector<std::string> n = io::node_labels(nodes);
  const auto wide = io::Table::wide;
  return {{"parameter", unit, "parameter of the branch"},
          wide("amplitude", "m", "largest distance of the shaft's node from its mean position over the cycle", n),
          wide("x", "m", "half the travel of the node in x", n),
          wide("y", "m", "half the travel of the node in y", n)};
}

}  // namespace

NodeRecord::NodeRecord(std::vector<int> nodes, std::string unit)
    : nodes_(std::move(nodes)), unit_(std::move(unit)), table_(columns(unit_, nodes_)) {}

NodeRecord::NodeSizes NodeRecord::sizes(const CycleOrbit& orbit) const {
  const auto* rotor = dynamic_cast<const system::RotorSystem*>(&orbit.system);
  if (nodes_.empty() || !rotor) return {};
  StateRows states(orbit.system);
  std::vector<std::vector<double>> x(nodes_.size()), y(nodes_.size());
  for (int k = 0; k < samples_per_turn; ++k) {
    Vec state = states.vector(orbit.at(static_cast<double>(k) / samples_per_turn));
    const std::vector<double> shaft = rotor->shaft(state, 0, false);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const auto at = static_cast<std::size_t>(4 * (nodes_[i] - 1));
      x[i].push_back(shaft[at]);
      y[i].push_back(shaft[at + 1]);
    }
  }
  const auto mean = [](const std::vector<double>& v) {
    double sum = 0;
    for (double one : v) sum += one;
    return sum / static_cast<double>(v.size());
  };
  const auto half_travel = [](const std::vector<double>& v) {
    const auto [low, high] = std::minmax_element(v.begin(), v.end());
    return (*high - *low) / 2;
  };
  NodeSizes out{std::vector<double>(nodes_.size(), 0.0), {}, {}};
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const double mx = mean(x[i]), my = mean(y[i]);
    for (std::size_t k = 0; k < x[i].size(); ++k)
      out.amplitude[i] = std::max(out.amplitude[i], std::hypot(x[i][k] - mx, y[i][k] - my));
    out.x.push_back(half_travel(x[i]));
    out.y.push_back(half_travel(y[i]));
  }
  return out;
}

void NodeRecord::append(double parameter, const CycleOrbit& orbit) {
  const NodeSizes now = sizes(orbit);
  if (!now.x.empty()) table_.append({{parameter}, now.amplitude, now.x, now.y});
}

void NodeRecord::drop_last() {
  if (table_.rows() > 0) table_.truncate(table_.rows() - 1);
}

void NodeRecord::write(io::Group& group) const {
  if (nodes_.empty()) return;
  auto& mine = group.child("nodes");
  table_.write(mine);
  mine.put("node", std::vector<std::int64_t>(nodes_.begin(), nodes_.end()), "shaft nodes, 1-based");
}

void NodeRecord::read(const io::Group& group) {
  if (!nodes_.empty()) table_.read(group.group("nodes"));
}

void ShaftOrbits::append(const std::string& what, double parameter, const CycleOrbit& orbit) {
  const auto* rotor = dynamic_cast<const system::RotorSystem*>(&orbit.system);
  if (!rotor || rotor->train().rotor.type == rotor::Options::Type::rigid) return;
  z_ = rotor::node_positions(rotor->train().rotor);
  StateRows states(orbit.system);
  for (std::size_t k = 0; k < samples_in_space; ++k) {
    const double s = static_cast<double>(k) / samples_in_space;
    const std::vector<double> shaft = rotor->shaft(states.vector(orbit.at(s)), 0, true);
    for (std::size_t i = 0; i < z_.size(); ++i) {
      x_.push_back(shaft[4 * i]);
      y_.push_back(shaft[4 * i + 1]);
    }
  }
  what_.push_back(what);
  parameter_.push_back(parameter);
  period_.push_back(orbit.cycle.period);
}

void ShaftOrbits::write(io::Group& group) const {
  if (what_.empty()) return;
  auto& mine = group.child("shaft");
  const io::Shape shape{what_.size(), samples_in_space, z_.size()};
  mine.put("x", shape, x_, "m", "horizontal position of the shaft over a period [cycle][time][node]");
  mine.put("y", shape, y_, "m", "vertical position of the shaft over a period, positive up [cycle][time][node]");
  mine.label_each({{}, io::numbered(z_.size(), "node")});
  mine.put("z", z_, "m", "axial position of the nodes");
  mine.put("what", what_, "'at': a cycle asked for; else the bifurcation that lies there");
  mine.put("parameter", parameter_, unit_, "where on the branch");
  mine.put("period", period_, "s", "period of the cycle");
}

void ShaftOrbits::read(const io::Group& group) {
  if (!group.has_group("shaft")) return;
  const io::Group& mine = group.group("shaft");
  what_ = mine.strings("what");
  for (auto& [name, to] :
       {std::pair{"x", &x_}, {"y", &y_}, {"z", &z_}, {"parameter", &parameter_}, {"period", &period_}})
    *to = mine.reals(name);
}

}  // namespace whirl::study
