#include "study/motion/motion.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "study/bars/film_limit.hpp"
#include "study/bars/open_bore.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/brief.hpp"
#include "study/common.hpp"
#include "study/growth.hpp"
#include "study/layout.hpp"
#include "study/make_plant.hpp"
#include "study/motion/motion_record.hpp"
#include "study/motion/motion_start.hpp"
#include "study/motion/section.hpp"
#include "study/packed.hpp"
#include "study/stored_vector.hpp"
#include "whirl/core/error.hpp"
#include "whirl/transient/steps/integrator.hpp"

namespace whirl::study {
namespace {

using core::check;

// There are as many exponents as states.
MotionOptions limited(MotionOptions options, const system::Plant& system) {
  options.exponents = std::min(options.exponents, static_cast<int>(system.size()));
  return options;
}

// A motion revolution by revolution. Time begins anew with each one, so that the equations repeat themselves to the
// bit; but where external forces act it goes on.
class Player {
public:
  Player(Context& context, const MotionOptions& given)
      : context_(context),
        layout_(plan(context, sharing_of(given.start))),
        plant_(make_plant(layout_.space, context.machine, {.unbalance = given.unbalance, .value = given.speed.value})),
        system_(*plant_),
        options_(limited(given, system_)),
        start_(start_state(system_, options_.start)),
        forces_(make_forces(options_.forces, context.machine, system_)),
        integrator_(system_, {options_.speed.value}, start_.x.get(),
                    {.scheme = options_.integrator.scheme,
                     .tolerance = options_.tolerance,
                     .forces = acting(forces_),
                     .after_step = [this](double time, double step) { progress(time, step); }}),
        forced_(system_.forced() || !options_.unbalance.empty()),
        record_(options_, system_.places(), forced_, integrator_.scaled(), driven()),
        films_(system_.places()) {
    if (options_.exponents > 0) tangents_.emplace(integrator_.scaled(), options_.exponents);
  }

  StudyResult run() {
    if (context_.resume && context_.results.has_checkpoint()) restore(context_.results.load_checkpoint());
    const int total = options_.discard + options_.revolutions;
    std::string status = "completed";
    try {
      integrator_.state(start_.x.get());
      margin_ = films_.margin(system_.observe(start_.x.get()).film_thickness);
      for (; done_ < total; ++done_) {
        if (tangents_ && done_ >= first_carried()) carried_ = &*tangents_;
        integrator_.carry(carried_);
        if (done_ >= options_.discard && !section_) cut();
        revolve(done_ >= options_.discard);
        save();
      }
    } catch (const core::DomainError& e) {
      status = ended(e.what());
      if (record_.revolutions() < 2) throw core::DomainError(status);
    } catch (const core::NotConverged& e) {
      status = ended(e.what() + thinnest(films_, system_, integrator_, start_.x.get()));
      if (record_.revolutions() < 2) throw core::NotConverged(status);
    }
    return report(status);
  }

private:
  [[nodiscard]] std::string ended(const std::string& why) const {
    return fmt::format("ended in revolution {}: {}", done_ + 1, why);
  }
  [[nodiscard]] double period() const { return 2 * std::numbers::pi / options_.speed.value; }
  // Directions need time to turn to those that grow most, before their growth counts.
  [[nodiscard]] int first_carried() const { return options_.discard - std::max(2, options_.discard / 4); }
  [[nodiscard]] double turns_before() const { return forces_.empty() ? 0 : done_; }
  // External forces change while the motion is recorded.
  [[nodiscard]] bool driven() const {
    return !forces_.constant(period() * options_.discard, period() * (options_.discard + options_.revolutions));
  }

  // Ends the motion where a film becomes too thin: on a straight line between two samples.
  void look_at_films(const std::vector<double>& thickness, int sample) {
    const double margin = films_.margin(thickness), last = std::exchange(margin_, margin);
    if (margin > 0) return;
    const double missing = last > 0 && std::isfinite(last) ? margin / (margin - last) : 0,
                 turned = (sample - missing) / options_.samples;
    throw core::DomainError(fmt::format("at {:.4g} deg of it (t = {:.6g} s) {}", 360 * turned,
                                        (done_ + turned) * period(), films_.ends(thickness)));
  }

  void revolve(bool record) {
    std::vector<double> growth(tangents_ ? static_cast<std::size_t>(tangents_->count()) : 0, 0.0);
    for (int k = 1; k <= options_.samples; ++k) {
      const auto at = [&](int sample) {
        return period() * (turns_before() * options_.samples + sample) / options_.samples;
      };
      if (record && section_)
        section_->advance(at(k));
      else
        integrator_.advance(at(k), at(options_.samples));
      if (tangents_) {
        const std::vector<double> more = tangents_->orthonormalise();
        for (std::size_t i = 0; i < growth.size(); ++i) growth[i] += more[i];
      }
      integrator_.state(start_.x.get());
      const system::Observed seen = system_.observe(start_.x.get());
      look_at_films(seen.film_thickness, k);
      if (record) record_.sample(seen.shown, integrator_.scaled());
      if (!record && !forced_ && done_ >= options_.discard - std::max(1, options_.discard / 4)) watch_.see(seen.shown);
    }
    if (record) record_.close(growth, period());
    integrator_.close_revolution(forces_.empty() ? period() : 0);
  }

  // Sets up the section, if there is one.
  void cut() {
    if (plane_ || (!options_.section && (forced_ || !watch_.seen()))) return;
    const system::ShownPlaces places = system_.places();
    plane_ = options_.section ? plane_of(*options_.section, places, system_.size()) : watch_.choose(places);
    record_.set_section(plane_->text(places));
    const auto here = [this] {
      integrator_.state(start_.x.get());
      return start_.x.get();
    };
    section_.emplace(
        integrator_, [this, here] { return plane_->height(system_, here()); },
        options_.section ? options_.section->direction : transient::CrossingSense::rising,
        [this, here](double time) {
          record_.cross(time - turns_before() * period(), system_.shown_at(here()), integrator_.scaled());
        });
  }

  // A revolution may take minutes: each step says where it ended.
  void progress(double time, double step) {
    if (!context_.results.shows_progress()) return;
    const int total = options_.discard + options_.revolutions;
    const double turn = options_.speed.value * 180 / std::numbers::pi,
                 degrees = turn * (time - period() * turns_before());
    context_.results.progress(fmt::format(
        "{}: revolution {} of {}{}{}, {:.1f} deg, step {:.3g} deg, {:.1f} s", context_.results.summary().name,
        done_ + 1, total, done_ < options_.discard ? " (discarded)" : "",
        context_.results.left((done_ + degrees / 360) / total), degrees, turn * step, context_.results.seconds()));
  }

  void save() {
    if (options_.checkpoint) context_.results.save_each_second([this] { return state(); });
  }

  [[nodiscard]] io::Group state() const {
    io::Group state;
    state.set("done", done_ + 1);
    state.set("time", integrator_.time());
    state.set("step", integrator_.step());
    put_vector(state, "u", integrator_.scaled(), layout_.shared, "scaled state");
    for (int k = 0; tangents_ && k < tangents_->count(); ++k)
      put_vector(state, fmt::format("tangent_{}", k + 1), tangents_->column(k), layout_.shared, "deviation");
    record_.save(state.child("record"), layout_.shared);
    put_packed(state, "watched", watch_, "where the motion was");
    return state;
  }

  void restore(const io::Group& state) {
    done_ = static_cast<int>(state.integer("done"));
    take_vector(state, "u", integrator_.scaled());
    integrator_.restart(state.real("time"), state.real("step"));
    for (int k = 0; tangents_ && k < tangents_->count(); ++k)
      take_vector(state, fmt::format("tangent_{}", k + 1), tangents_->column(k));
    if (tangents_ && done_ > first_carried()) tangents_->were_carried();
    record_.load(state.group("record"));
    unpack(state.reals("watched"), watch_);
    context_.results.add_earlier_seconds(state.real("seconds"));
  }

  // What grows about the place where the motion rests; of one that does not settle about the equilibrium, which may be
  // why.
  void look_for_growth(io::StudySummary& summary) {
    const transient::MotionKind kind = record_.verdict().kind;
    const bool rests = kind == transient::MotionKind::fixed_point;
    if (!rests && kind != transient::MotionKind::unsettled) return;
    std::string reason;
    std::optional<Growth> growth;
    if (rests) {
      integrator_.state(start_.x.get());
      growth = growth_at(system_, start_.x.get(), &reason);
    } else {
      (void)has_answer([&] { growth = growth_at(system_, find_rest(system_).get()); });
    }
    if (growth && growth->any()) record_.set_growth(growth->words());
    if (growth) warn_of_waves(*growth, rests ? "about the fixed point" : "about the equilibrium", summary);
    if (rests && !growth)
      summary.warnings.push_back("it is not known whether the place where the motion rests is stable: " + reason);
  }

  StudyResult report(const std::string& status) {
    auto& results = context_.results;
    auto& summary = results.summary();
    put_groups(summary, system_.groups());
    summary.set("speed", options_.speed.value, "rad/s");
    for (std::size_t k = 0; k < start_.multipliers.size() && k < static_cast<std::size_t>(options_.exponents); ++k) {
      const double modulus = std::abs(start_.multipliers[k]);
      summary.set(fmt::format("cycle.multiplier.{}.modulus", k + 1), modulus, "1");
      summary.set(fmt::format("cycle.multiplier.{}.angle", k + 1), std::abs(std::arg(start_.multipliers[k])), "rad");
      summary.set(fmt::format("cycle.exponent.{}", k + 1), std::log(modulus) / period(), "1/s");
    }
    look_for_growth(summary);
    auto& group = results.group();
    group.set("speed", options_.speed.value);
    group.set("unbalance", fmt::format("{}", fmt::join(options_.unbalance, ", ")));
    put_places(group, context_.machine, system_);
    record_.write(group, summary);
    if (const auto verdict = record_.verdict(); verdict.kind == transient::MotionKind::unsettled)
      warn_first(summary, "the motion has not settled: " + verdict.reason);
    if (OpenBores bores(context_.machine); !bores.empty()) {
      record_.for_samples([&](std::size_t place, double x, double y) { bores.see(place, x, y, 0); });
      bores.warn(summary, "");
    }
    summary.points = record_.revolutions();
    return results.finish(status, true);
  }

  Context& context_;
  Layout layout_;
  std::unique_ptr<system::Plant> plant_;
  system::Plant& system_;
  MotionOptions options_;
  StartState start_;
  transient::Forces forces_;
  transient::Integrator integrator_;
  std::optional<transient::Tangents> tangents_;
  transient::Tangents* carried_ = nullptr;
  bool forced_;
  MotionRecord record_;
  Watch watch_;
  std::optional<SectionPlane> plane_;
  std::optional<transient::Section> section_;
  FilmLimit films_;
  double margin_ = 0;  // of the films at the last sample
  int done_ = 0;
};

// "The motion is periodic and repeats after 2 revolutions: returns within 1e-6 of its size".
std::string kind_in_words(const std::string& kind, const Values& v) {
  const auto period = v.get("period"), time = v.get("period.time");
  if (kind == "fixed_point") return "The machine comes to rest (a fixed point)";
  if (kind == "unsettled") return "The motion has not settled, so that its kind is open";
  if (kind == "driven") return "External forces drive the motion";
  if (kind == "quasi_periodic") return "The motion is quasi-periodic";
  if (kind == "limit_cycle")
    return "The motion is a limit cycle" + (time ? " of " + io::reading(v["period.time"]) : std::string()) +
           (time && *period > 1 ? fmt::format(", which crosses its section {:.0f} times", *period) : std::string());
  if (kind.starts_with("period-") && period)
    return *period == 1 ? std::string("The motion is periodic and repeats after each revolution")
                        : fmt::format("The motion is periodic and repeats after {:.0f} revolutions", *period);
  return "The motion is " + kind;
}

// Of the last `count` samples of a place.
io::Quantity mean_of(const io::Group& orbit, const std::string& axis, std::size_t place, std::size_t places,
                     std::size_t count, const std::string& unit) {
  const auto& all = orbit.reals(axis);
  const std::size_t rows = all.size() / places, n = std::min(count, rows);
  double sum = 0;
  for (std::size_t k = rows - n; k < rows; ++k) sum += all[k * places + place];
  return {sum / static_cast<double>(n), unit};
}

// The unit of time of a motion. Nothing turns in another system than a rotor, which shows numbers as x and y.
std::string turn_of(const Values& v) {
  const std::vector<std::string> places = v.between("peak_to_peak.", ".x");
  return !places.empty() && v["peak_to_peak." + places.front() + ".x"].unit == "1" ? "period" : "revolution";
}

io::BriefTable table_of_places(const Values& v, const io::Group& group, int samples) {
  const std::vector<std::string> places = v.between("peak_to_peak.", ".x");
  // At rest there are no tones.
  if (places.empty() || v.between("tone.", ".frequency").empty()) return {};
  const std::string length = v["peak_to_peak." + places.front() + ".x"].unit;
  io::BriefTable table{"Motion of the places shown, peak to peak",
                       {{"place"},
                        {"x", length},
                        {"y", length},
                        {"mean x", length},
                        {"mean y", length},
                        {"strongest tone in y", "Hz"},
                        {"tone per " + turn_of(v), "1"},
                        {"amplitude of the tone", length}},
                       {},
                       "mean: over the last " + turn_of(v) + (length == "1" ? ", 2 pi over the speed" : "")};
  const bool known = group.has_group("orbit") && group.group("orbit").has_dataset("x") &&
                     group.group("orbit").reals("x").size() >= places.size();
  const auto mean = [&](const char* axis) {
    return known ? mean_of(group.group("orbit"), axis, table.rows.size(), places.size(),
                           static_cast<std::size_t>(samples), length)
                 : io::Quantity{};
  };
  for (const std::string& p : places) {
    const std::string tone = "tone." + p + ".y.1.";
    table.rows.push_back({p, v["peak_to_peak." + p + ".x"], v["peak_to_peak." + p + ".y"], mean("x"), mean("y"),
                          v[tone + "frequency"], v[tone + "order"], v[tone + "amplitude"]});
  }
  return table;
}

io::BriefTable table_of_exponents(const Values& v) {
  io::BriefTable table{"Lyapunov exponents",
                       {{"exponent"}, {"value", "1/s"}, {"per " + turn_of(v), "1"}},
                       {},
                       "positive: neighbouring motions part"};
  bool barred = false;
  for (int k = 1; v.get(fmt::format("lyapunov.{}", k)); ++k) {
    const std::string head = fmt::format("lyapunov.{}", k);
    io::Quantity rate = v[head], turn = v[head + ".per_revolution"];
    if (const auto bar = v.get(head + ".uncertainty")) {
      barred = true;
      rate.more["uncertainty"] = *bar;
      if (rate.value != 0) turn.more["uncertainty"] = std::abs(*bar * turn.value / rate.value);
    }
    table.rows.push_back({std::to_string(k), rate, turn});
  }
  table.note +=
      barred ? "; bar: the interval that holds it with 99 % probability" : "; the motion is too short for bars";
  return table;
}

}  // namespace

StudyResult Motion::run(Context& context) {
  return Player(context, options).run();
}

io::Brief Motion::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  io::Brief brief{{}, {table_of_places(v, result.group, options.samples), table_of_exponents(v)}};
  for (const std::string& kind : v.between("motion.", ""))
    // What has not settled has its evidence among the warnings.
    brief.sentences.push_back(kind == "unsettled"
                                  ? kind_in_words(kind, v) + "."
                                  : fmt::format("{}: {}.", kind_in_words(kind, v), result.group.text("evidence")));
  if (const io::Quantity turns = v["rotation"]; std::isfinite(turns.value)) {
    std::string words = fmt::format("The rotation number is {} turns per return", io::reading(turns));
    if (const auto p = v.get("rotation.locked.numerator"), q = v.get("rotation.locked.denominator"); p && q)
      words += fmt::format(", locked at {:.0f}/{:.0f}", *p, *q);
    brief.sentences.push_back(words + ".");
  }
  return brief;
}

}  // namespace whirl::study
