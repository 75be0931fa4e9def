#include "study/locus/limit.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "study/locus/locus.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/brief.hpp"
#include "whirl/io/hdf5.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {
namespace {

using Kept = LimitOptions::Quantity;

// The place of a limit in states of which this rank has its rows.
class Seen {
public:
  Seen(const LimitOptions& limit, system::Plant& plant)
      : system_(dynamic_cast<system::RotorSystem&>(plant)), states_(plant), node_(limit.node.value_or(0)) {
    if (!limit.bearing) return;
    const system::ShownPlaces places = plant.places();
    const auto at = std::ranges::find(places.names, *limit.bearing);
    core::require(at != places.names.end(), "the bearing of a limit was checked");
    bearing_ = static_cast<std::size_t>(at - places.names.begin());
    if (limit.quantity == Kept::eccentricity) unit_ = places.clearances[bearing_];
  }
  [[nodiscard]] Eigen::Vector2d at(const Eigen::VectorXd& rows) {
    if (node_ > 0) {
      const std::vector<double> shaft = system_.shaft(states_.vector(rows), 0, false);
      const auto first = static_cast<std::size_t>(4 * (node_ - 1));
      return {shaft[first], shaft[first + 1]};
    }
    const std::array<double, 2> p = states_.shown(rows)[bearing_].position;
    return {p[0] / unit_, p[1] / unit_};
  }

private:
  system::RotorSystem& system_;
  StateRows states_;
  int node_;
  std::size_t bearing_ = 0;
  double unit_ = 1;
};

std::string place_words(const LimitOptions& limit) {
  return limit.node ? fmt::format("node {}", *limit.node) : limit.bearing.value_or("");
}

}  // namespace

bool has_place(const LimitOptions& limit) {
  return limit.quantity != Kept::period && limit.quantity != Kept::whirl_ratio;
}

std::string words_of(const LimitOptions& limit) {
  const char* direction = limit.direction == LimitOptions::Direction::x ? "x" : "y";
  switch (limit.quantity) {
    case Kept::amplitude:
      return fmt::format("0-peak amplitude in {} at {}", direction, place_words(limit));
    case Kept::peak_to_peak:
      return fmt::format("peak-to-peak amplitude in {} at {}", direction, place_words(limit));
    case Kept::eccentricity:
      return fmt::format("largest eccentricity at {}", place_words(limit));
    case Kept::period:
      return "period";
    case Kept::whirl_ratio:
      return "whirl ratio";
  }
  return {};
}

solve::CycleQuantity quantity_of(const LimitOptions& limit) {
  using Kind = solve::CycleQuantity::Kind;
  if (limit.quantity == Kept::period) return {Kind::period, {}, 1};
  if (limit.quantity == Kept::whirl_ratio) return {Kind::whirl_ratio, {}, 1};
  if (limit.quantity == Kept::eccentricity) return {Kind::peaks, {Eigen::Vector2d::Zero()}, 1};
  const Eigen::Vector2d along = Eigen::Vector2d::Unit(limit.direction == LimitOptions::Direction::x ? 0 : 1);
  return {Kind::peaks, {along, -along}, limit.quantity == Kept::amplitude ? 0.5 : 1.0};
}

// The place is linear in the states of rotor and pedestals, and the films' own ones have no part in it.
solve::LinearPlace place_of(const LimitOptions& limit, system::Plant& system) {
  solve::LinearPlace place;
  place.speed = system.speed();
  if (!has_place(limit)) return place;
  Seen seen(limit, system);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(system.size());
  place.b = seen.at(x);
  place.a = Eigen::Matrix2Xd::Zero(2, x.size());
  for (Eigen::Index k = 0; k < 2 * dynamic_cast<system::RotorSystem&>(system).coordinates(); ++k) {
    x(k) = 1;
    place.a.col(k) = seen.at(x) - place.b;
    x(k) = 0;
  }
  return place;
}

LimitsOnBranch::LimitsOnBranch(const Context& context, const std::string& name) {
  for (const auto& s : context.studies)
    if (const auto* locus = dynamic_cast<const Locus*>(s.get()); locus && locus->given().limit)
      if (locus->starts_from() == name) limits_.push_back({io::safe_name(locus->name()), &*locus->given().limit});
}

std::vector<double> LimitsOnBranch::of(const CycleOrbit& orbit) const {
  std::vector<double> out;
  for (const Limit& l : limits_) {
    const LimitOptions& limit = *l.options;
    solve::Cycle path{orbit.cycle.mesh, {}, orbit.cycle.period, orbit.cycle.parameter};
    if (has_place(limit)) {
      Seen seen(limit, orbit.system);
      path.x.resize(2, orbit.cycle.x.cols());
      for (Eigen::Index k = 0; k < orbit.cycle.x.cols(); ++k) path.x.col(k) = seen.at(orbit.cycle.x.col(k));
    }
    out.push_back(quantity_of(limit).of(orbit.scheme, path, orbit.system.speed()).value / limit.value.value - 1);
  }
  return out;
}

void LimitsOnBranch::see(const std::vector<double>& at_point) {
  for (std::size_t k = 0; k < std::min(limits_.size(), at_point.size()); ++k) {
    limits_[k].least = std::min(limits_[k].least, 1 + at_point[k]);
    limits_[k].most = std::max(limits_[k].most, 1 + at_point[k]);
  }
}

void LimitsOnBranch::pass(std::size_t limit, const solve::Cycle& cycle) {
  limits_[limit].passings.push_back({solve::Event::branch_point, 0, cycle});
}

void LimitsOnBranch::write(io::Group& group, const SharedRows& like) const {
  for (const Limit& l : limits_) {
    io::Group& mine = group.child("limits").child(l.name);
    mine.set("least", l.least);
    mine.set("most", l.most);
    write_located(mine, l.passings, like);
  }
}

void LimitsOnBranch::read(const io::Group& group, const SharedRows& like) {
  for (Limit& l : limits_) {
    const io::Group& mine = group.group("limits").group(l.name);
    l.least = mine.real("least");
    l.most = mine.real("most");
    l.passings = read_located(mine, like);
  }
}

Located passing_of(const LocusOptions& options, const std::string& name, const io::Group& branch, MPI_Comm comm) {
  const LimitOptions& limit = *options.limit;
  const std::string key = io::safe_name(name), unit = limit.value.unit, words = words_of(limit);
  if (!branch.has_group("limits") || !branch.group("limits").has_group(key))
    throw core::NotConverged(
        fmt::format("the results of '{}' do not say where it passes this limit: compute it again", options.of));
  io::Group mine = branch.group("limits").group(key);
  io::make_whole(mine, comm);
  const std::vector<Located> all = read_located(mine);
  const auto said = [&](double si) { return io::reading({deck::from_si(si, unit), unit}); };
  const double value = limit.value.value;
  if (all.empty())
    throw core::NotConverged(fmt::format("the {} runs from {} to {} along '{}' and never passes {}", words,
                                         said(mine.real("least") * value), said(mine.real("most") * value), options.of,
                                         said(value)));
  if (static_cast<std::size_t>(limit.passing) > all.size())
    throw core::NotConverged(fmt::format("'{}' passes a {} of {} {} times, passing {} is wanted", options.of, words,
                                         said(value), all.size(), limit.passing));
  return all[static_cast<std::size_t>(limit.passing) - 1];
}

}  // namespace whirl::study
