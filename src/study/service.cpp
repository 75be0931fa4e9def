#include "service.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "service_vibration.hpp"
#include "study/linear/linear_brief.hpp"
#include "study/linear/separation.hpp"
#include "study/sense.hpp"
#include "study/service_speeds.hpp"

namespace whirl::study {
namespace {

using doubt::rank_of, doubt::stable, doubt::undetermined, doubt::unstable, doubt::words;
using io::Quantity;
using io::ServiceFact;
using io::StudySummary;

constexpr double damped = std::numbers::pi / 2.5;  // log decrement of an amplification factor of 2.5 (API 684)

std::string joined(const std::string& a, const std::string& b) {
  return a + (a.empty() || b.empty() ? "" : ", ") + b;
}

// Of a resonance that is too near to the operating speeds of its study.
std::string near_words(const std::string& verdict, const Quantity& required) {
  if (verdict == not_excited) return "which unbalance does not excite on these supports";
  return verdict != "too near" ? "" : fmt::format("TOO NEAR: {:.0f} % required", 100 * required.value);
}

class Collector {
public:
  Collector(const deck::Quantity& speed, const io::Group& results, bool films)
      : speed_(speed.value), results_(results), films_(films) {
    service_.speed = {deck::from_si(speed.value, speed.unit), speed.unit};
  }

  void look_at(const StudySummary& s) {
    if (s.kind == "equilibrium_branch") take_branch(s);
    if (s.kind == "modes") take_modes(s);
    if (s.kind == "unbalance_response") take_response(s);
    if (s.kind == "static") take_static(s);
    if (s.kind == "cycle_branch") take_cycles(s);
    if (s.kind == "motion") take_motion(s);
    if (s.kind == "frequency_response") take_transfers(s);
    if (s.kind == "run_up") take_run_up(s);
    if (s.kind == "thd") take_thd(s);
  }

  io::Service finish() {
    put_stability();
    // Peaks of a response stand for critical speeds where no modes were computed.
    if (!below_) below_ = std::move(peak_below_);
    if (!above_) above_ = std::move(peak_above_);
    // What a film has no room for is no vibration where another study gives one.
    if (!vibration_) vibration_ = std::move(beyond_films_);
    for (const auto* fact : {&threshold_, &whirl_, &decrement_, &below_, &above_, &lifted_, &film_, &pressure_,
                             &temperature_, &vibration_})
      if (*fact) service_.facts.push_back(**fact);
    std::vector<std::string> unknown;
    const auto look = [&](const std::optional<ServiceFact>& fact, const char* what, const char* how) {
      if (!fact) unknown.push_back(fmt::format("{} (by {})", what, how));
    };
    if (films_) look(film_, "thinnest film", "`static` or `cycle_branch`");
    if (films_) look(temperature_, "highest film temperature", "`thd` or a film with heat");
    look(vibration_, "largest vibration", "`unbalance_response`, `cycle_branch`, `motion` or `run_up`");
    if (!unknown.empty())
      service_.facts.push_back({"not known at this speed", {}, {}, fmt::format("{}", fmt::join(unknown, ", ")), {}});
    return std::move(service_);
  }

private:
  [[nodiscard]] bool is_service(double speed) const { return std::abs(speed - speed_) <= same_speed * speed_; }
  [[nodiscard]] const io::Group* group_of(const StudySummary& s) const {
    const std::string name = io::safe_name(s.name);
    return results_.has_group(name) ? &results_.group(name) : nullptr;
  }
  // The same of a study at the service speed, and of one over the speed; else null.
  [[nodiscard]] const io::Group* at_service(const StudySummary& s) const {
    const io::Group* group = group_of(s);
    return group && group->has_attribute("speed") && is_service(group->real("speed")) ? group : nullptr;
  }
  [[nodiscard]] const io::Group* over_speed(const StudySummary& s) const {
    const io::Group* group = group_of(s);
    return group && group->has_attribute("parameter") && group->text("parameter") == "speed" ? group : nullptr;
  }
  static void keep(std::optional<ServiceFact>& kept, ServiceFact fact, bool largest) {
    if (kept && (largest ? fact.value.value <= kept->value.value : fact.value.value >= kept->value.value)) return;
    kept = std::move(fact);
  }
  void vote(const std::string& verdict, const std::string& study) {
    if (verdict.empty()) return;
    verdicts_.push_back(verdict);
    voters_.push_back(study);
  }

  // By the number of eigenvalues that grow; negative: some may be missing.
  void vote_of(std::int64_t count, const std::string& study) {
    vote(count > 0 ? "unstable" : count == 0 ? "stable" : "undetermined", study);
  }

  // The stretches over the speed in which the machine runs: their word, and its distance from the nearest limit of
  // stability, positive on the stable side. Empty: the study does not reach the speed.
  std::string take_ranges(const StudySummary& s) {
    std::string verdict;
    bool within = false, below = false, above = false;
    for (const io::StabilityRange& r : s.ranges) {
      const double here = deck::from_si(speed_, r.unit), low = std::min(r.from, r.to), high = std::max(r.from, r.to);
      below |= low <= here * (1 + same_speed);
      above |= high >= here * (1 - same_speed);
      if (low > here * (1 + same_speed) || here > high * (1 + same_speed)) continue;
      verdict = !within || verdict == r.stability ? r.stability : "undetermined";
      within = true;
    }
    if (!within && below && above) verdict = "undetermined";  // in a gap
    const SpeedLimit* nearest = nullptr;
    const std::vector<SpeedLimit> limits = limits_of(s);
    for (const SpeedLimit& l : limits) {
      if (!verdict.empty() && std::abs(l.at - speed_) <= l.error) verdict = "undetermined";
      if (!nearest || std::abs(l.at - speed_) < std::abs(nearest->at - speed_)) nearest = &l;
    }
    if (nearest) {
      const double margin = 100 * (nearest->stable_below ? 1 : -1) * (nearest->at - speed_) / speed_;
      const Quantity q{margin, "%", bar(100 * nearest->error / speed_)};
      // Of one limit that two studies located, the smaller bar.
      const double kept = threshold_ && threshold_->value.bar() > 0 ? threshold_->value.bar() : 0;
      const bool same = kept > 0 && q.bar() > 0 && std::abs(threshold_->value.value - margin) <= kept + q.bar();
      if (!same || q.bar() < kept) {
        if (same) threshold_.reset();
        keep(threshold_,
             {"margin in speed to the threshold of stability",
              {},
              q,
              nearest->stable_below ? "" : "the machine is unstable below it",
              s.name},
             false);
      }
    }
    return verdict;
  }

  void take_branch(const StudySummary& s) {
    if (over_speed(s)) vote(take_ranges(s), s.name);
  }

  // At the speed, or between the computed speeds beside it: there the limits of stability that were located decide, and
  // the least log decrement is taken in a straight line.
  void take_modes(const StudySummary& s) {
    const std::vector<ModesAt> all = modes_by_speed(s);
    std::string verdict = take_ranges(s);
    bool computed = false;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const ModesAt &b = all[k], &a = k > 0 ? all[k - 1] : b;
      const bool here = computed = is_service(b.speed);
      if (!here && !(a.speed < speed_ && speed_ < b.speed)) continue;
      const double w = here ? 1 : (speed_ - a.speed) / (b.speed - a.speed);
      const double decrement = here ? b.decrement : (1 - w) * a.decrement + w * b.decrement;
      const double error = here ? b.error : std::max(a.error, b.error);
      if (here)
        verdict = verdict == words[undetermined] ? verdict : words[b.worst];
      else if (verdict.empty())
        verdict = words[a.worst == b.worst ? a.worst : undetermined];
      else if (verdict != words[unstable] && std::max(a.worst, b.worst) == undetermined)
        verdict = words[undetermined];
      if (verdict == words[stable] && decrement <= (std::isfinite(error) ? error : 0)) verdict = words[undetermined];
      // Between two speeds a straight line may lie on the wrong side of the border that was located.
      const bool at_odds = !here && (verdict == words[stable] || verdict == words[unstable]) &&
                           (decrement > 0) != (verdict == words[stable]);
      if (std::isfinite(decrement) && !at_odds) {
        const std::string mark =
            here ? ""
                 : joined(between_words({decrement, a.speed, b.speed}, s.modes.front().speed_unit), "without a bar");
        keep(decrement_, {"smallest log decrement", {}, {decrement, "1", here ? bar(error) : bar(0)}, mark, s.name},
             false);
      }
      break;
    }
    if (computed || !s.ranges.empty())
      vote(verdict, s.name);
    else if (!verdict.empty())
      beside_ = {verdict, s.name + " at the speeds beside it"};
    for (const CriticalSpeed& c : critical_speeds_of(s)) {
      const Quantity& delta = c.log_decrement;
      if (!std::isfinite(c.speed.value) || delta.value - delta.bar() > damped) continue;
      const std::string more = std::isfinite(delta.value) ? fmt::format("log decrement {:.3g}", delta.value) : "";
      const std::string whirl = c.whirl == "backward" ? "backward whirl" : "";
      take_critical(c.speed, joined(joined(more, whirl), near_words(c.verdict, c.required_margin)), "critical speed",
                    "", s.name);
    }
  }
  // The nearest one on either side of the service speed.
  void take_critical(const Quantity& q, const std::string& more, const std::string& what, const std::string& place,
                     const std::string& study) {
    const double at = deck::number_to_si(q.value, q.unit), margin = (at - speed_) / speed_;
    ServiceFact fact{what + (at <= speed_ ? " below" : " above"), place, q, {}, study};
    fact.mark =
        fmt::format("{:.1f} % from the service speed{}{}", 100 * std::abs(margin), more.empty() ? "" : ", ", more);
    const bool peak = what == "peak";
    auto& kept = at <= speed_ ? (peak ? peak_below_ : below_) : (peak ? peak_above_ : above_);
    if (kept && std::abs(deck::number_to_si(kept->value.value, kept->value.unit) - speed_) <= std::abs(at - speed_))
      return;
    kept = std::move(fact);
  }

  void take_response(const StudySummary& s) {
    for (const io::PeakEntry& p : s.peaks)
      if (p.place.starts_with("node ") && p.verdict != "damped, not critical" && std::isfinite(p.speed.value)) {
        const double factor = p.amplification_factor.value;
        std::string more = std::isfinite(factor) ? "amplification " + factor_words(factor) : "";
        more = joined(more, p.verdict == words[undetermined] ? p.verdict : near_words(p.verdict, p.required_margin));
        if (std::ranges::any_of(p.notes, [](const std::string& note) { return note.starts_with("no answer"); }))
          more = joined(more, "no answer: the motion leaves a bearing too little film");
        take_critical(p.speed, more, "peak", p.place, s.name);
      }
    // Beside a range of operating speeds, too.
    const io::Group* group = group_of(s);
    double speed = io::no_value;
    if (group && group->has_attribute("operating_at"))
      speed = group->real("operating_at");
    else if (const Quantity* at = find(s, "operating_speed"))
      speed = deck::number_to_si(at->value, at->unit);
    if (!is_service(speed)) return;
    std::string mark = "linear response, 0-peak";
    const Quantity* answer = find(s, "operating_speed.answer");
    const bool touches = answer && answer->value == 0;
    if (touches) mark += ", no answer: it leaves a bearing too little film";
    if (const Quantity* count = find(s, "operating_speed.unstable_count")) {
      vote_of(static_cast<std::int64_t>(count->value), s.name);
      if (count->value > 0) mark += ", about an unstable equilibrium";
    }
    for (const auto& [name, q] : s.values)
      if (const auto node = between(name, "operating.node.", ".semi_major"))
        keep(touches ? beyond_films_ : vibration_, {"largest vibration", "node " + *node, q, mark, s.name}, true);
  }

  void take_static(const StudySummary& s) {
    const io::Group* group = at_service(s);
    if (!group) return;
    if (group->has_attribute("stability")) vote(group->text("stability"), s.name);
    for (const auto& [bearing, load] : lifted_journals(s))
      keep(lifted_, {"load that points upwards", bearing, load, "the shaft lifts the journal", s.name}, false);
    for (const auto& [name, q] : s.values) {
      if (!std::isfinite(q.value)) continue;
      if (const auto b = between(name, "bearing.", ".min_thickness")) {
        const Quantity* least = find(s, "bearing." + *b + ".minimum_film");
        const bool thin = least && q.value < least->value;
        keep(film_, {"thinnest film", *b, q, thin ? "below minimum_film" : "", s.name}, false);
      }
      if (const auto b = between(name, "bearing.", ".max_pressure"))
        keep(pressure_, {"highest film pressure", *b, q, {}, s.name}, true);
      if (const auto b = between(name, "bearing.", ".max_temperature"))
        keep(temperature_, {"highest film temperature", *b, q, {}, s.name}, true);
    }
  }

  void take_transfers(const StudySummary& s) {
    if (at_service(s)) vote(s.stability, s.name);
  }

  // Stable whirl without unbalance: where it exists, a disturbance can start it although the position is stable.
  void take_whirl(const StudySummary& s) {
    const io::StabilityRange* first = nullptr;
    const auto ends = [](const io::StabilityRange& r) {
      const auto [low, high] = std::minmax(r.from, r.to);
      return std::pair{deck::number_to_si(low, r.unit), deck::number_to_si(high, r.unit)};
    };
    for (const io::StabilityRange& r : s.ranges)
      if (r.stability == "stable" && ends(r).second >= speed_ * (1 - same_speed) &&
          (!first || ends(r).first < ends(*first).first))
        first = &r;
    if (!first) return;
    const double low = ends(*first).first, error = error_at(s, low);
    const Quantity from{deck::from_si(low, first->unit), first->unit, bar(deck::from_si(error, first->unit))};
    const double margin = 100 * (low - speed_) / speed_;
    keep(whirl_,
         {"stable whirl, which a disturbance can start, from",
          {},
          from,
          low > speed_ * (1 + same_speed) ? fmt::format("{:.1f} % above the service speed", margin)
                                          : "the service speed is within its range",
          s.name},
         false);
  }

  void take_cycles(const StudySummary& s) {
    const io::Group* group = over_speed(s);
    if (!group) return;
    if (group->has_attribute("unbalance") && group->text("unbalance").empty()) take_whirl(s);
    take_facts(facts_of_cycles(s, *group, speed_));
  }
  void take_motion(const StudySummary& s) {
    if (const io::Group* group = at_service(s)) take_facts(facts_of_motion(s, *group));
  }
  void take_run_up(const StudySummary& s) {
    const io::Group* group = group_of(s);
    if (!group || !group->has_group("run_up") || !group->has_attribute("acceleration")) return;
    if (const Quantity* grows = find(s, "operating_speed.unstable_count"))
      vote_of(static_cast<std::int64_t>(grows->value), s.name);
    take_facts(facts_of_run_up(s, *group, speed_));
  }
  void take_facts(std::vector<ServiceFact> facts) {
    for (ServiceFact& fact : facts) {
      const bool vibration = fact.what == "largest vibration";
      keep(vibration ? vibration_ : film_, std::move(fact), vibration);
    }
  }

  // Temperature of one film with heat: with a bar at the last speed of the study that has a film.
  void take_thd(const StudySummary& s) {
    const io::Group* group = group_of(s);
    if (!group || !group->has_group("budget") || !group->has_attribute("bearing")) return;
    const io::Group& table = group->group("budget");
    const std::vector<double>& speeds = table.reals("parameter");
    const std::string& bearing = group->text("bearing");
    const std::vector<double>& hottest = table.reals("maximum_temperature");
    // Values are those at the last speed with a film.
    const auto last = std::find_if(hottest.rbegin(), hottest.rend(), [](double t) { return std::isfinite(t); });
    if (last != hottest.rend() && is_service(speeds[static_cast<std::size_t>(hottest.rend() - last) - 1])) {
      if (const Quantity* q = find(s, "temperature.maximum"))
        return keep_film(temperature_, "highest film temperature", bearing, *q, "", s);
    }
    const auto at = at_speed(
        speeds, [&](std::size_t k) { return hottest[k]; }, speed_, 0);
    if (at)
      keep_film(temperature_, "highest film temperature", bearing, {at->value, "K"},
                joined(between_words(*at, "rad/s"), "without a bar"), s);
  }
  void keep_film(std::optional<ServiceFact>& fact, const char* what, const std::string& bearing, const Quantity& q,
                 const std::string& mark, const StudySummary& s) {
    const bool cold = s.status != "completed";
    keep(fact, {what, bearing, q, joined(mark, cold ? "the study did not complete" : ""), s.name}, true);
  }

  void put_stability() {
    ServiceFact fact{"stability", {}, {}, "not known: `modes` or `equilibrium_branch` over the speed give it", {}};
    if (verdicts_.empty()) vote(beside_.first, beside_.second);
    if (!verdicts_.empty()) {
      const auto said = [&](const char* word) { return std::ranges::find(verdicts_, word) != verdicts_.end(); };
      const bool grows = said("unstable"), decays = said("stable") || said("undamped");
      // A count of what grows does not tell undamped from stable.
      fact.mark =
          grows && decays ? "undetermined: the studies differ" : *std::ranges::max_element(verdicts_, {}, rank_of);
      fact.study = fmt::format("{}", fmt::join(voters_, ", "));
    }
    service_.facts.push_back(std::move(fact));
  }

  double speed_;
  const io::Group& results_;
  bool films_;
  io::Service service_;
  std::vector<std::string> verdicts_, voters_;
  std::pair<std::string, std::string> beside_;  // verdict and voter of listed speeds on either side: for want of others
  std::optional<ServiceFact> threshold_, whirl_, decrement_, below_, above_, peak_below_, peak_above_, lifted_, film_,
      pressure_, temperature_, vibration_, beyond_films_;
};

}  // namespace

io::Service service_of(const deck::Quantity& speed, std::span<const StudySummary> studies, const io::Group& results,
                       bool films) {
  Collector facts(speed, results, films);
  for (const StudySummary& s : studies) facts.look_at(s);
  return facts.finish();
}

}  // namespace whirl::study
