#include "study/bars/summary_bars.hpp"

#include <algorithm>
#include <map>

#include "whirl/core/error.hpp"

namespace whirl::study {
namespace {

constexpr double share_of_kin = 0.25;

bool is_exact(const std::string& name) {
  return name.ends_with(".node") || name.ends_with(".minimum_film") || name.starts_with("nondimensional.");
}

}  // namespace

bool has_answer(const std::function<void()>& compute, std::string* reason) {
  const auto none = [&](const core::Error& error) {
    if (reason) *reason = error.what();
    return false;
  };
  try {
    compute();
    return true;
  } catch (const core::NotConverged& e) {
    return none(e);
  } catch (const core::DomainError& e) {
    return none(e);
  } catch (const core::InputError& e) {
    return none(e);
  }
}

std::string stem_of(const std::string& name) {
  const std::size_t end = name.find_last_not_of("xy");
  return end == std::string::npos ? name : name.substr(0, end + 1);
}

SummaryBars::SummaryBars(io::StudySummary& summary, MeshLaw law) : summary_(summary), bars_({}, law) {
  for (const auto& [name, q] : summary.values) {
    if (is_exact(name)) continue;
    names_.push_back(name);
    values_.push_back(q.value);
  }
  moved_.assign(values_.size(), false);
  bars_ = Bars(values_, law);
}

std::vector<double> SummaryBars::row(const io::StudySummary& there) const {
  std::map<std::string, double> known;
  for (const auto& [name, q] : there.values) known[name] = q.value;
  std::vector<double> values;
  for (const std::string& name : names_) {
    const auto at = known.find(name);
    values.push_back(at == known.end() ? io::no_value : at->second);
  }
  return values;
}

void SummaryBars::add(Axis axis, double spacing, const std::vector<double>& row) {
  for (std::size_t k = 0; k < row.size(); ++k)
    if (row[k] != values_[k]) moved_[k] = true;
  bars_.add(axis, spacing, row);
  with_time_ |= axis == Axis::time;
  any_ = true;
}

void SummaryBars::add(Axis axis, double spacing, const std::function<void(io::StudySummary& there)>& compute) {
  io::StudySummary there;
  if (!has_answer([&] { compute(there); })) there = {};
  add(axis, spacing, there);
}

void SummaryBars::add(const Layout& layout, Pieces& pieces, const std::vector<FilmMesh>& meshes,
                      const std::function<void(const FilmMesh&, io::StudySummary&)>& compute) {
  const auto on = [&](std::size_t i) {
    io::StudySummary there;
    if (!has_answer([&] { compute(meshes[i], there); })) there = {};
    return row(there);
  };
  const auto rows = distribute(layout, meshes.size(), on, pieces, "other mesh", no_trail);
  for (std::size_t i = 0; i < meshes.size(); ++i) add(meshes[i].axis, meshes[i].spacing, rows[i]);
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
