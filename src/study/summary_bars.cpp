#include "summary_bars.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace whirl::study {
namespace {

constexpr double share_of_kin = 0.25;

std::vector<double> values_of(const io::StudySummary& summary) {
  std::vector<double> out;
  for (const auto& entry : summary.values) out.push_back(entry.second.value);
  return out;
}

}  // namespace

std::string stem_of(const std::string& name) {
  const std::size_t end = name.find_last_not_of("xy");
  return end == std::string::npos ? name : name.substr(0, end + 1);
}

SummaryBars::SummaryBars(io::StudySummary& summary, MeshLaw law)
    : summary_(summary), values_(values_of(summary)), moved_(values_.size(), false), bars_(values_, law) {
  for (const auto& entry : summary.values) names_.push_back(entry.first);
}

void SummaryBars::add(Axis axis, double spacing, const io::StudySummary& there) {
  std::map<std::string, double> known;
  for (const auto& [name, q] : there.values) known[name] = q.value;
  std::vector<double> values;
  for (std::size_t k = 0; k < names_.size(); ++k) {
    const auto at = known.find(names_[k]);
    values.push_back(at == known.end() ? io::no_value : at->second);
    if (values.back() != values_[k]) moved_[k] = true;
  }
  bars_.add(axis, spacing, values);
  with_time_ |= axis == Axis::time;
  any_ = true;
}

void SummaryBars::write(const Location& location) {
  if (!any_) return;
  std::map<std::string, Bar> largest;
  std::vector<Bar> bars;
  for (std::size_t k = 0; k < names_.size(); ++k) {
    bars.push_back(bars_[k]);
    bars[k].location = location(names_[k], values_[k]);
    Bar& kin = largest[stem_of(names_[k])];
    kin.film_mesh = std::max(kin.film_mesh, bars[k].film_mesh);
    kin.time_mesh = std::max(kin.time_mesh, bars[k].time_mesh);
    kin.kinks = std::max(kin.kinks, bars[k].kinks);
  }
  for (std::size_t k = 0; k < names_.size(); ++k) {
    const auto at = std::find_if(summary_.values.begin(), summary_.values.end(),
                                 [&](const auto& entry) { return entry.first == names_[k]; });
    const Bar& kin = largest[stem_of(names_[k])];
    if (!moved_[k] && kin.total() == 0) continue;
    Bar& bar = bars[k];
    bar.film_mesh = std::max(bar.film_mesh, share_of_kin * kin.film_mesh);
    bar.time_mesh = std::max(bar.time_mesh, share_of_kin * kin.time_mesh);
    bar.kinks = std::max(bar.kinks, share_of_kin * kin.kinks);
    at->second.more = bar.parts(with_time_);
    at->second.more["uncertainty"] = bar.total();
  }
}

}  // namespace whirl::study
