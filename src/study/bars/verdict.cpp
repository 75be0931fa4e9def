#include "study/bars/verdict.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "whirl/io/table.hpp"

namespace whirl::study {

const char* name_of(StabilityClass c) {
  static constexpr const char* names[] = {"stable", "undamped", "unstable"};
  return names[static_cast<std::size_t>(c)];
}

StabilityClass class_of(const solve::Stability& s) {
  if (s.unstable() > 0) return StabilityClass::unstable;
  return s.neutral > 0 ? StabilityClass::undamped : StabilityClass::stable;
}

BranchChange change_at(const solve::LocatedEvent& found, int bifurcation) {
  return {found.after,
          found.parameter,
          found.unstable_before,
          found.unstable_after,
          found.slope,
          found.event == solve::Event::fold || found.event == solve::Event::cyclic_fold,
          bifurcation};
}

void put_changes(io::Group& group, const std::vector<BranchChange>& changes, const std::string& unit) {
  io::Table table({{"after", "1", "row of the last point before it in the table of the branch, from 0"},
                   {"parameter", unit, "where"},
                   {"unstable_before", "1", "unstable eigenvalues or multipliers before it along the branch"},
                   {"unstable_after", "1", "and behind it"},
                   {"slope", "1", "its sign is that of the parameter's change along the branch"},
                   {"fold", "1", "1 where the parameter turns"},
                   {"bifurcation", "1",
                    "row in the table of bifurcations, from 0; -1: not asked for; -2: a wave of a film's mesh"}});
  for (const BranchChange& c : changes)
    table.append({static_cast<double>(c.after), c.parameter, static_cast<double>(c.before),
                  static_cast<double>(c.behind), c.slope, c.fold ? 1.0 : 0.0, static_cast<double>(c.bifurcation)});
  table.write(group);
}

void BranchVerdict::add(double parameter, StabilityClass c, int unstable) {
  points_.push_back({parameter, c, unstable});
}

// In the order of the branch. A closer look may find a change later than another one behind it, and a fold comes before
// what lies in its step: each change begins with the count that the one before it left.
std::vector<BranchChange> BranchVerdict::between(std::size_t point) const {
  std::vector<BranchChange> open, out;
  for (const BranchChange& c : changes_)
    if (c.after == static_cast<int>(point)) open.push_back(c);
  const bool turns = std::any_of(open.begin(), open.end(), [](const auto& c) { return c.fold; });
  if (!turns && point + 1 < points_.size()) {
    const bool rising = points_[point + 1].parameter > points_[point].parameter;
    std::stable_sort(open.begin(), open.end(), [rising](const auto& a, const auto& b) {
      return rising ? a.parameter < b.parameter : a.parameter > b.parameter;
    });
  }
  for (int count = points_[point].unstable; !open.empty();) {
    auto next = std::find_if(open.begin(), open.end(), [count](const auto& c) { return c.before == count; });
    if (next == open.end()) next = open.begin();
    count = next->behind;
    out.push_back(*next);
    open.erase(next);
  }
  return out;
}

bool BranchVerdict::open_at(const BranchChange& change) const {
  return unresolved_.contains(change.after) || unresolved_.contains(change.after + 1);
}

bool BranchVerdict::open_at(int bifurcation) const {
  return std::any_of(changes_.begin(), changes_.end(),
                     [&](const BranchChange& c) { return c.bifurcation == bifurcation && open_at(c); });
}

std::vector<bool> BranchVerdict::doubtful() const {
  const int n = static_cast<int>(points_.size());
  std::vector<bool> out(points_.size());
  for (const int at : doubts_) {
    int k = at;
    while (k > 0 && !settled_.contains(k)) --k;
    for (; k < n && (k <= at || !settled_.contains(k)); ++k) out[static_cast<std::size_t>(k)] = true;
  }
  return out;
}

std::vector<BranchVerdict::Stretch> BranchVerdict::cut(const std::vector<bool>& doubtful) const {
  std::vector<Stretch> out;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& here = points_[i];
    const bool open = unresolved_.contains(static_cast<int>(i));
    if (out.empty() || out.back().stability != here.stability || (!unresolved_.empty() && out.back().of_mesh != open))
      out.push_back({here.parameter, here.parameter, here.stability, doubtful[i], open});
    out.back().to = here.parameter;
    if (out.back().doubtful != doubtful[i] && i + 1 < points_.size())
      out.push_back({here.parameter, here.parameter, here.stability, doubtful[i], open});
    const std::vector<BranchChange> inside = between(i);
    for (std::size_t k = 0; k < inside.size(); ++k) {
      const BranchChange& c = inside[k];
      const bool last = i + 1 == points_.size();
      // Nobody went on behind a fold there. Others belong to a new mesh of the last point.
      if (last && c.fold) continue;
      out.back().to = c.parameter;
      // Undamped solutions are so up to the next change.
      const bool reaches = k + 1 == inside.size() && i + 1 < points_.size() && points_[i + 1].unstable == 0;
      const StabilityClass next = c.behind > 0 ? StabilityClass::unstable
                                  : reaches    ? points_[i + 1].stability
                                               : StabilityClass::stable;
      const double end = last ? here.parameter : c.parameter;
      if (c.fold || next != out.back().stability) out.push_back({c.parameter, end, next, doubtful[i], open_at(c)});
    }
  }
  return out;
}

std::vector<BranchVerdict::Stretch> BranchVerdict::stretches() const {
  std::vector<Stretch> out = cut(std::vector<bool>(points_.size()));
  std::optional<StabilityClass> first;
  bool one = true;
  for (const Stretch& s : out) {
    if (s.of_mesh) continue;
    one = one && s.stability == first.value_or(s.stability);
    first = s.stability;
  }
  if (one && !doubts_.empty()) out = cut(doubtful());
  for (Stretch& s : out) s.doubtful = s.doubtful || s.of_mesh;
  return out;
}

std::vector<io::StabilityRange> BranchVerdict::ranges(const std::string& unit) const {
  std::vector<io::StabilityRange> out;
  for (const Stretch& s : stretches())
    out.push_back({s.from, s.to, unit, s.doubtful ? "undetermined" : name_of(s.stability)});
  return out;
}

std::string BranchVerdict::text() const {
  const std::vector<Stretch> all = stretches();
  if (all.empty()) return {};
  std::array<bool, 3> met{};
  bool doubtful = false;
  std::optional<StabilityClass> begins;
  for (const Stretch& s : all) {
    doubtful = doubtful || s.doubtful;
    if (s.of_mesh) continue;
    met[static_cast<std::size_t>(s.stability)] = true;
    if (!begins) begins = s.stability;
  }
  const StabilityClass first = begins.value_or(StabilityClass::unstable);
  if (met[0] + met[1] + met[2] <= 1) return doubtful ? "undetermined" : std::string(name_of(first)) + " throughout";
  if (first == StabilityClass::unstable) return "unstable from its start";
  if (!met[static_cast<std::size_t>(StabilityClass::unstable)]) return "stable or undamped";
  return first == StabilityClass::stable ? "loses stability" : "undamped, then unstable";
}

// The branch lies on the side from which it comes to its fold.
bool BranchVerdict::turns_below(const BranchChange& fold) const {
  const auto at = static_cast<std::size_t>(std::max(fold.after, 0));
  return at < points_.size() && points_[at].parameter < fold.parameter;
}

std::vector<StabilityLimit> BranchVerdict::limits() const {
  std::vector<StabilityLimit> out;
  for (std::size_t k = 0; k < changes_.size(); ++k) {
    const BranchChange& c = changes_[k];
    if (std::min(c.before, c.behind) > 0 || c.before == c.behind || open_at(c)) continue;
    out.push_back({k, c.fold ? turns_below(c) : c.below() == 0});
  }
  std::stable_sort(out.begin(), out.end(), [&](const auto& a, const auto& b) {
    return changes_[a.change].parameter < changes_[b.change].parameter;
  });
  return out;
}

int threshold_among(const std::vector<StabilityLimit>& limits) {
  const auto first = std::find_if(limits.begin(), limits.end(), [](const auto& l) { return l.stable_below; });
  return first == limits.end() ? -1 : static_cast<int>(first->change);
}

}  // namespace whirl::study
