#include "study/locus/curve_points.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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
