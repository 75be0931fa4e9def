#include "study/locus/curve_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "study/cycle/cycle_record.hpp"

namespace whirl::study {

void SpreadPoints::add(CurvePoint point) {
  if (!spread_.empty() && point.arclength - spread_.back().arclength < apart_) {
    last_ = {std::move(point)};
    return;
  }
  last_.clear();
  spread_.push_back(std::move(point));
  if (spread_.size() <= most_) return;
  const CurvePoint end = spread_.back();
  apart_ = 2 * (end.arclength - spread_.front().arclength) / static_cast<double>(most_);
  std::vector<CurvePoint> fewer;
  for (CurvePoint& p : spread_)
    if (fewer.empty() || p.arclength - fewer.back().arclength >= apart_) fewer.push_back(std::move(p));
  spread_ = std::move(fewer);
  if (spread_.back().row != end.row) last_ = {end};
}

void SpreadPoints::clear() {
  apart_ = 0;
  spread_.clear();
  last_.clear();
}

std::vector<CurvePoint> SpreadPoints::all() const {
  std::vector<CurvePoint> out = spread_;
  out.insert(out.end(), last_.begin(), last_.end());
  return out;
}

void SpreadPoints::write(io::Group& group) const {
  group.set("apart", apart_);
  group.set("spread", static_cast<std::int64_t>(spread_.size()));
  const std::vector<CurvePoint> points = all();
  group.set("points", static_cast<std::int64_t>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) {
    io::Group& one = group.child(std::to_string(k));
    write_cycle(one.child("cycle"), points[k].cycle);
    one.put("inner", std::vector<double>(points[k].inner.begin(), points[k].inner.end()), "1", "inner unknowns");
    one.set("second", points[k].second);
    one.set("arclength", points[k].arclength);
    one.set("row", static_cast<std::int64_t>(points[k].row));
  }
}

void SpreadPoints::read(const io::Group& group) {
  clear();
  apart_ = group.real("apart");
  const long points = group.integer("points"), spread = group.integer("spread");
  for (long k = 0; k < points; ++k) {
    const io::Group& one = group.group(std::to_string(k));
    const std::vector<double>& inner = one.reals("inner");
    CurvePoint point{read_cycle(one.group("cycle")),
                     Eigen::Map<const Eigen::VectorXd>(inner.data(), static_cast<Eigen::Index>(inner.size())),
                     one.real("second"), one.real("arclength"), static_cast<std::size_t>(one.integer("row"))};
    (k < spread ? spread_ : last_).push_back(std::move(point));
  }
}

std::vector<CurvePoint> evenly_spread(std::vector<CurvePoint> points, std::size_t count) {
  if (points.size() <= count) return points;
  const double from = points.front().arclength, length = points.back().arclength - from;
  std::vector<CurvePoint> out;
  std::size_t next = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double wanted = from + length * static_cast<double>(k) / static_cast<double>(count - 1);
    // As many must be left as are still wanted.
    const std::size_t latest = points.size() - (count - k);
    std::size_t best = next;
    for (std::size_t i = next; i <= latest; ++i)
      if (std::abs(points[i].arclength - wanted) < std::abs(points[best].arclength - wanted)) best = i;
    out.push_back(std::move(points[best]));
    next = best + 1;
  }
  return out;
}

}  // namespace whirl::study
