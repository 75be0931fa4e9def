#include "study/motion/run_up.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "study/bars/film_limit.hpp"
#include "study/bars/open_bore.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/common.hpp"
#include "study/evenly.hpp"
#include "study/growth.hpp"
#include "study/layout.hpp"
#include "study/linear/stable_speeds.hpp"
#include "study/motion/motion_start.hpp"
#include "study/motion/revolution.hpp"
#include "study/motion/run_up_rows.hpp"
#include "study/motion/short_time.hpp"
#include "study/packed.hpp"
#include "study/service_speeds.hpp"
#include "study/stored_vector.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/transient/steps/integrator.hpp"

namespace whirl::study {
namespace {

problem::Drive drive_of(const RunUpOptions& o) {
  const double change = o.range.to - o.range.from;
  return {o.range.from, o.duration ? change / o.duration->value : std::copysign(o.acceleration->value, change)};
}

// The run revolution by revolution; samples lie at equal angles.
class Runner {
public:
  Runner(Context& context, const RunUpOptions& options)
      : context_(context),
        options_(options),
        unit_(options.range.unit),
        drive_(drive_of(options)),
        layout_(plan(context, sharing_of(options.start))),
        system_(layout_.space, system::train_of(context.machine, options.unbalance), drive_.speed),
        x_(start_state(system_, options.start).x),
        forces_(make_forces(options.forces, context.machine, system_)),
        integrator_(system_, drive_, x_.get(),
                    {.scheme = options.integrator.scheme, .tolerance = options.tolerance, .forces = acting(forces_)}),
        places_(system_.places()),
        films_(places_),
        bores_(context.machine),
        table_(run_up_columns(unit_, places_.names, options.nodes)) {
    system_.set_acceleration(drive_.acceleration);
    const double from = options.range.from, to = options.range.to,
                 turned = (to * to - from * from) / (2 * drive_.acceleration);
    total_ = static_cast<int>(turned / (2 * std::numbers::pi) * (1 + 1e-12));
    if (total_ < 1) throw core::NotConverged("the shaft does not even turn once on the way");
  }

  StudyResult run() {
    count_growth();
    if (context_.resume && context_.results.has_checkpoint()) restore(context_.results.load_checkpoint());
    std::string status = "completed";
    try {
      integrator_.state(x_.get());
      margin_ = films_.margin(system_.observe(x_.get()).film_thickness);
      for (; done_ < total_; ++done_) {
        revolve();
        save();
      }
    } catch (const core::DomainError& e) {
      status = ended(e.what());
    } catch (const core::NotConverged& e) {
      status = ended(e.what() + thinnest(films_, system_, integrator_, x_.get()));
    }
    return report(status);
  }

private:
  [[nodiscard]] double speed_at(double revolutions) const {
    return deck::from_si(drive_.speed_at(drive_.time_of(2 * std::numbers::pi * revolutions)), unit_);
  }
  [[nodiscard]] std::string ended(const std::string& why) const {
    const double time = thin_at_.value_or(integrator_.time());
    return fmt::format("ended at {:.6g} {} (t = {:.6g} s): {}", deck::from_si(drive_.speed_at(time), unit_), unit_,
                       time, why);
  }
  // Ends the run where a film becomes too thin: on a straight line between two samples.
  void look_at_films(const std::vector<double>& thickness, double before, double now) {
    const double margin = films_.margin(thickness), last = std::exchange(margin_, margin);
    if (margin > 0) return;
    thin_at_ = last > 0 && std::isfinite(last) ? before + (now - before) * last / (last - margin) : now;
    throw core::DomainError(films_.ends(thickness));
  }

  void revolve() {
    Revolution r;
    const std::size_t n = places_.names.size();
    std::vector<double> thinnest(n, std::numeric_limits<double>::quiet_NaN());
    r.samples.resize(n + options_.nodes.size());
    const auto at = [&](int k) {
      return drive_.time_of(2 * std::numbers::pi * (done_ + static_cast<double>(k) / options_.samples));
    };
    for (int k = 1; k <= options_.samples; ++k) {
      integrator_.advance(at(k), at(options_.samples));
      integrator_.state(x_.get());
      const system::Observed seen = system_.observe(x_.get());
      look_at_films(seen.film_thickness, at(k - 1), at(k));
      const std::vector<double> films = film_column(seen.film_thickness, n);
      for (std::size_t b = 0; b < n; ++b) thinnest[b] = std::fmin(thinnest[b], films[b]);
      for (std::size_t b = 0; b < n; ++b) {
        const auto& position = seen.shown[b].position;
        r.samples[b].push_back(position);
        bores_.see(b, position[0], position[1], speed_at(done_ + static_cast<double>(k) / options_.samples));
      }
      if (options_.nodes.empty()) continue;
      const std::vector<double> shaft = system_.shaft(x_.get(), 0, false);
      for (std::size_t i = 0; i < options_.nodes.size(); ++i) {
        const auto from = static_cast<std::size_t>(4 * (options_.nodes[i] - 1));
        r.samples[n + i].push_back({shaft[from], shaft[from + 1]});
      }
    }
    // Where a checkpoint may lie nothing is remembered but what it holds.
    integrator_.close_revolution(0);
    keep(r);
    thinnest_.insert(thinnest_.end(), thinnest.begin(), thinnest.end());
    neighbours_.add(std::move(r));
    record(neighbours_.ready());
    if (!context_.results.shows_progress()) return;
    double film = std::numeric_limits<double>::quiet_NaN();
    for (const double t : thinnest) film = std::fmin(film, t);
    context_.results.progress(
        fmt::format("{}: revolution {} of {}, {:.1f} {}{}{}, step {:.3g} of a revolution, {:.1f} s",
                    context_.results.summary().name, done_ + 1, total_, speed_at(done_ + 1), unit_,
                    context_.results.left(static_cast<double>(done_ + 1) / total_),
                    std::isfinite(film) ? fmt::format(", film {:.3g} um", 1e6 * film) : "",
                    integrator_.step() * system_.speed() / (2 * std::numbers::pi), context_.results.seconds()));
  }

  // What grows about the equilibria at constant speed: at both ends of the range, at the service speed, and where that
  // differs at speeds between. At the start also what fades most slowly.
  void count_growth() {
    const double from = options_.range.from, to = options_.range.to, low = std::min(from, to),
                 high = std::max(from, to);
    std::vector<double> first{low, high}, all = evenly(low, high, 13);
    const auto& service = context_.machine.service_speed;
    if (service && low < service->value && service->value < high) {
      put_between(all, service->value);
      first.push_back(service->value);
    }
    system_.set_acceleration(0);
    Walker walker(system_);
    const auto count = [&](double speed) {
      solve::Stability there;
      if (!has_answer([&] { there = equilibrium_stability(system_, walker.at(speed)); })) return StableSpeeds::unknown;
      if (speed == from) slowest_ = slowest_of(there);
      const Growth growth = growth_of(there);
      if (growth.any() && growth.count() >= fastest_.first.count()) fastest_ = {growth, speed};
      return growth.known_count();
    };
    stable_ = StableSpeeds(std::move(all), first, [&](const std::vector<double>& speeds) {
      std::vector<int> out;
      for (const double speed : speeds) out.push_back(count(speed));
      return out;
    });
    system_.set_parameter(drive_.speed);
    system_.set_acceleration(drive_.acceleration);
  }

  // Real part of the least damped vibration about the equilibrium at the start [1/s]: its free vibration fades from the
  // start on. Not negative: it does not fade, or nothing starts.
  [[nodiscard]] double slowest_of(const solve::Stability& at_start) const {
    if (options_.start.from == MotionStart::From::cycle) return 0;
    double slowest = -std::numeric_limits<double>::infinity();
    for (const auto& s : at_start.values)
      if (s.imag() != 0) slowest = std::max(slowest, s.real());
    return slowest;
  }

  void put_stability(io::StudySummary& summary) const {
    const auto& [growth, speed] = fastest_;
    put_verdict(summary, stable_, unit_,
                fmt::format("at {} {} {}. Small vibration grows there by itself, so that amplitudes may depend on the "
                            "duration of the run",
                            number_text(speed, unit_), unit_, growth.words()));
    const auto& service = context_.machine.service_speed;
    if (!service) return;
    if (const int n = stable_.at(service->value); n != StableSpeeds::unknown)
      summary.set("operating_speed.unstable_count", n, "1");
  }

  // Rows of the revolutions before `end` that have none yet.
  void record(long end) {
    for (auto k = static_cast<long>(table_.rows()); k < end; ++k) append(k);
    neighbours_.forget_before(static_cast<long>(table_.rows()));
  }

  void append(long revolution) {
    const Revolution& r = neighbours_.at(revolution);
    const std::size_t n = places_.names.size();
    // Of the journals, or of the nodes behind them.
    const auto each = [&](bool journals, const auto& value) {
      std::vector<double> out;
      for (std::size_t i = journals ? 0 : n; i < (journals ? n : r.samples.size()); ++i) out.push_back(value(i));
      return out;
    };
    const auto about_mean = [&](std::size_t i) { return r.distance(i, neighbours_.centre(revolution, i)); };
    const auto extreme = [&](std::size_t direction, double sign) {
      return each(true, [&](std::size_t b) { return r.extreme(b, direction, sign); });
    };
    const auto travel = [&](std::size_t direction) {
      return each(false, [&](std::size_t i) { return (r.extreme(i, direction, 1) - r.extreme(i, direction, -1)) / 2; });
    };
    const double time = drive_.time_of(2 * std::numbers::pi * (static_cast<double>(revolution) + 1));
    const std::vector<double> amplitude = each(true, about_mean);
    std::vector<std::vector<double>> row{{static_cast<double>(revolution + 1)},
                                         {time},
                                         {speed_at(static_cast<double>(revolution) + 0.5)},
                                         {in_transient(time, amplitude) ? 1.0 : 0.0},
                                         amplitude};
    for (const std::size_t direction : {0U, 1U})
      for (const double sign : {1.0, -1.0}) row.push_back(extreme(direction, sign));
    row.push_back(each(true, [&](std::size_t b) {
      const double c = places_.clearances[b];
      return c > 0 ? r.distance(b, {0, 0}) / c : 0;
    }));
    const auto films = thinnest_.begin() + revolution * static_cast<std::ptrdiff_t>(n);
    row.emplace_back(films, films + static_cast<std::ptrdiff_t>(n));
    if (!options_.nodes.empty()) row.insert(row.end(), {each(false, about_mean), travel(0), travel(1)});
    table_.append(row);
  }

  // The free vibration of the start is as large as the first revolution at most, and fades with the least damped mode.
  [[nodiscard]] bool in_transient(double time, const std::vector<double>& amplitude) const {
    if (!(slowest_ < 0)) return false;
    if (table_.rows() == 0) return true;
    if (table_.column("start_transient").back() == 0) return false;
    const auto& all = table_.column("amplitude");
    for (std::size_t b = 0; b < amplitude.size(); ++b)
      if (all[b] * std::exp(slowest_ * time) > 0.05 * amplitude[b]) return true;
    return false;
  }

  // Samples of all places, where spectra of them are wanted.
  void keep(const Revolution& r) {
    if (!options_.orders && !options_.waterfall) return;
    for (std::size_t k = 0; k < static_cast<std::size_t>(options_.samples); ++k)
      for (const auto& place : r.samples) kept_.insert(kept_.end(), place[k].begin(), place[k].end());
  }

  void save() {
    if (options_.checkpoint) context_.results.save_each_second([this] { return state(); });
  }

  [[nodiscard]] io::Group state() const {
    io::Group state;
    state.set("done", done_ + 1);
    state.put("kept", kept_, "m", "samples [sample][place][x, y]");
    put_packed(state, "near_revolutions", neighbours_, "samples of the last revolutions");
    state.put("thinnest", thinnest_, "m", "films [revolution][bearing]");
    put_packed(state, "bores", bores_, "farthest places outside open bores, and where");
    state.set("time", integrator_.time());
    state.set("step", integrator_.step());
    put_vector(state, "u", integrator_.scaled(), layout_.shared, "scaled state");
    table_.write(state.child("run_up"));
    return state;
  }

  void restore(const io::Group& state) {
    done_ = static_cast<int>(state.integer("done"));
    take_vector(state, "u", integrator_.scaled());
    integrator_.restart(state.real("time"), state.real("step"));
    table_.read(state.group("run_up"));
    kept_ = state.reals("kept");
    thinnest_ = state.reals("thinnest");
    unpack(state.reals("bores"), bores_);
    unpack(state.reals("near_revolutions"), neighbours_);
    context_.results.add_earlier_seconds(state.real("seconds"));
  }

  void write_spectra(io::Group& group) const {
    if (!options_.orders && !options_.waterfall) return;
    AngleRecord r{places_.names,
                  "m",
                  options_.samples,
                  kept_,
                  [this](double n) { return speed_at(n); },
                  [this](double n) { return drive_.time_of(2 * std::numbers::pi * n); },
                  unit_};
    for (const int node : options_.nodes) r.names.push_back(fmt::format("node {}", node));
    if (options_.orders) write_orders(group, r, *options_.orders);
    if (options_.waterfall) write_waterfall(group, r, *options_.waterfall);
  }

  StudyResult report(const std::string& status) {
    auto& results = context_.results;
    auto& summary = results.summary();
    put_groups(summary, system_.groups());
    summary.set("acceleration", drive_.acceleration, "rad/s^2");
    record(neighbours_.added());
    if (table_.rows() > 0) {
      const auto& transient = table_.column("start_transient");
      const auto settled = std::find(transient.begin(), transient.end(), 0.0) - transient.begin();
      if (slowest_ < 0) summary.set("start_transient.revolutions", static_cast<double>(settled), "1");
      if (settled == static_cast<std::ptrdiff_t>(transient.size())) summary.warnings.emplace_back(not_faded);
      std::vector<std::string> bearings, nodes;
      for (const auto& name : places_.names) bearings.push_back("bearing." + name);
      for (const int node : options_.nodes) nodes.push_back(fmt::format("node.{}", node));
      put_peaks(summary, table_, "amplitude", bearings, unit_);
      put_thinnest(summary, table_, places_.names, unit_);
      if (!nodes.empty()) put_peaks(summary, table_, "node_amplitude", nodes, unit_);
    }
    bores_.warn(summary, unit_);
    put_stability(summary);
    auto& group = results.group();
    table_.write(group.child("run_up"));
    write_spectra(group);
    group.put("node", std::vector<std::int64_t>(options_.nodes.begin(), options_.nodes.end()), "shaft nodes, 1-based");
    group.set("acceleration", drive_.acceleration);
    group.set("speed_unit", unit_);
    group.set("unbalance", fmt::format("{}", fmt::join(options_.unbalance, ", ")));
    put_bearings(group, context_.machine);
    summary.points = static_cast<long>(table_.rows());
    return results.finish(status, table_.rows() > 0);
  }

  Context& context_;
  const RunUpOptions& options_;
  std::string unit_;
  problem::Drive drive_;
  Layout layout_;
  system::RotorSystem system_;
  core::Vector x_;
  transient::Forces forces_;
  transient::Integrator integrator_;
  system::ShownPlaces places_;
  FilmLimit films_;
  OpenBores bores_;
  io::Table table_;
  std::vector<double> kept_;  // [sample][place and node][x, y]
  NearRevolutions neighbours_;
  double slowest_ = io::no_value;      // see slowest_of(); not a number: not known
  StableSpeeds stable_;                // equilibria at constant speed
  std::pair<Growth, double> fastest_;  // of the most unstable one of these, and its speed
  std::vector<double> thinnest_;       // [revolution][place]; not a number without a film
  double margin_ = 0;                  // of the films at the last sample
  std::optional<double> thin_at_;
  int total_ = 0, done_ = 0;
};

}  // namespace

StudyResult RunUp::run(Context& context) {
  return Runner(context, options).run();
}

}  // namespace whirl::study
