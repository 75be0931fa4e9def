// What a motion is called beside its verdict: returns to its section, rotation number, orders and waterfalls.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "study/motion/motion_record.hpp"
#include "study/motion/short_time.hpp"
#include "study/stored_vector.hpp"
#include "whirl/transient/analysis/rotation.hpp"
#include "whirl/transient/analysis/spectrum.hpp"

namespace whirl::study {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

double fraction(double x) {
  return x - std::floor(x);
}

// Distance of two numbers of turns, of which whole ones do not count.
double apart(double a, double b) {
  const double f = fraction(a - b);
  return std::min(f, 1 - f);
}

}  // namespace

void MotionRecord::cross(double time, const std::vector<system::PlaceState>& shown, Vec scaled) {
  section_.add(revolutions() * period_ + time, shown, entries_here(scaled));
}

void MotionRecord::write_section(io::Group& group, io::StudySummary& summary, const transient::Verdict& verdict) const {
  if (section_text_.empty()) return;
  section_.write(group, places_, section_text_);
  summary.set("section.points", static_cast<double>(section_.count()), "1");
  // What is at rest crosses none.
  if (const auto e = evidence();
      section_.count() == 0 && e.size >= e.rest && verdict.kind != transient::MotionKind::fixed_point)
    summary.warnings.push_back(fmt::format("the motion never crosses its section {}", section_text_));
  if (section_.count() > 1) summary.set("section.interval", section_.interval(1)[0], "s");
  if (verdict.kind != transient::MotionKind::limit_cycle || verdict.period == 0) return;
  const auto [time, scatter] = section_.interval(verdict.period);
  summary.set("period.time", time, "s", {{"uncertainty", scatter}});
}

std::vector<std::array<double, 2>> MotionRecord::returning_points(std::size_t place) const {
  const std::size_t n = places_.names.size();
  if (!forced_) return section_.points(place, n);
  std::vector<std::array<double, 2>> out;
  for (std::size_t k = 0; k < points_.size(); ++k)
    out.push_back({ends_[4 * (k * n + place)], ends_[4 * (k * n + place) + 1]});
  return out;
}

// The loudest tone that is no multiple of the returns' frequency, in turns per return and on the side of `rotation`,
// and how far it moves between the record and its halves.
std::array<double, 2> MotionRecord::whirl_tone(std::size_t place, double rotation, double interval) const {
  const std::vector<double> all = signal(place, 0);
  const std::size_t half = all.size() / 2;
  const double step = period_ / options_.samples;
  const auto whole = transient::amplitude_spectrum(all, step, options_.window);
  const double lobe = transient::facts(options_.window).main_lobe * whole.resolution;
  constexpr int looked_at = 12;
  for (const auto& tone : transient::tones(whole, looked_at)) {
    const double turns = tone.frequency * interval;
    if (apart(turns, 0) < 2 * lobe * interval) continue;
    double moved = 0;
    for (const auto part : {std::span(all).first(half), std::span(all).last(half)}) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& t : transient::tones(transient::amplitude_spectrum(part, step, options_.window), looked_at))
        nearest = std::min(nearest, std::abs(t.frequency - tone.frequency));
      moved = std::max(moved, nearest * interval);
    }
    const double f = fraction(turns);
    return {apart(f, rotation) <= apart(1 - f, rotation) ? f : 1 - f, moved};
  }
  return {none, none};
}

void MotionRecord::write_rotation(io::Group& group, io::StudySummary& summary,
                                  const transient::Verdict& verdict) const {
  const bool torus = verdict.kind == transient::MotionKind::quasi_periodic, locked = verdict.period > 1;
  if ((!torus && !locked) || (!forced_ && section_text_.empty())) return;
  std::vector<double> value, uncertainty, disorder;
  std::vector<std::string> reason;
  std::size_t best = 0;
  transient::RotationNumber chosen;
  chosen.value = chosen.uncertainty = none;
  for (std::size_t p = 0; p < places_.names.size(); ++p) {
    const auto points = returning_points(p);
    const auto r = torus ? transient::rotation_number(points) : transient::locked_rotation(points, verdict.period);
    value.push_back(r.value);
    uncertainty.push_back(r.uncertainty);
    disorder.push_back(r.disorder);
    reason.push_back(r.reason);
    if (std::isfinite(r.value) && !(chosen.uncertainty <= r.uncertainty)) {
      chosen = r;
      best = p;
    }
  }
  auto& g = group.child("rotation");
  g.put("place", places_.names, "whose points go round");
  g.put("value", value, "1",
        "rotation number: turns of the points per return, without whole ones; NaN: no circle is seen");
  g.put("uncertainty", uncertainty, "1", "half the interval that holds it");
  g.put("disorder", disorder, "1", "share of neighbours whose images are in another order");
  g.put("reason", reason, "why there is no number");
  if (!std::isfinite(chosen.value)) return;
  summary.set("rotation", chosen.value, "1", {{"uncertainty", chosen.uncertainty}});
  if (chosen.locked.q > 0) {
    summary.set("rotation.locked.numerator", chosen.locked.p, "1");
    summary.set("rotation.locked.denominator", chosen.locked.q, "1");
  }
  group.set("rotation_place", places_.names[best]);
  if (!torus) return;
  const double interval = forced_ ? period_ : section_.interval(1)[0];
  const auto [tone, moved] = whirl_tone(best, chosen.value, interval);
  if (!std::isfinite(tone)) return;
  summary.set("rotation.tone", tone, "1", {{"uncertainty", moved}});
}

void MotionRecord::write_short_time(io::Group& group) const {
  const double speed = options_.speed.value;
  const AngleRecord r{places_.names,
                      places_.unit,
                      options_.samples,
                      samples_,
                      [speed](double) { return speed; },
                      [this](double n) { return n * period_; },
                      "rad/s"};
  if (options_.orders) write_orders(group, r, *options_.orders);
  if (options_.waterfall) write_waterfall(group, r, *options_.waterfall);
}

}  // namespace whirl::study
