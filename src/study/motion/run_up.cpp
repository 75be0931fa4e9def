#include "whirl/study/motion/run_up.hpp"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/bars/film_limit.hpp"
#include "study/common.hpp"
#include "study/layout.hpp"
#include "study/motion/motion_start.hpp"
#include "study/motion/short_time.hpp"
#include "study/stored_vector.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/transient/integrator.hpp"

namespace whirl::study {
namespace {

using core::check;

problem::Drive drive_of(const RunUpOptions& o) {
  const double change = o.range.to - o.range.from;
  return {o.range.from, o.duration ? change / o.duration->value : std::copysign(o.acceleration->value, change)};
}

// What one revolution was, at each place: extremes in x and y, and the largest distance from the mean of the samples.
struct Revolution {
  std::vector<std::vector<std::array<double, 2>>> samples;  // [place][sample]

  [[nodiscard]] double extreme(std::size_t place, std::size_t direction, double sign) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const auto& s : samples[place]) most = std::max(most, sign * s[direction]);
    return sign * most;
  }
  [[nodiscard]] double amplitude(std::size_t place) const {
    std::array<double, 2> mean{};
    for (const auto& s : samples[place])
      for (std::size_t d = 0; d < 2; ++d) mean[d] += s[d] / static_cast<double>(samples[place].size());
    double most = 0;
    for (const auto& s : samples[place]) most = std::max(most, std::hypot(s[0] - mean[0], s[1] - mean[1]));
    return most;
  }
  [[nodiscard]] double eccentricity(std::size_t place, double clearance) const {
    double most = 0;
    for (const auto& s : samples[place]) most = std::max(most, std::hypot(s[0], s[1]));
    return clearance > 0 ? most / clearance : 0;
  }
};

std::vector<io::Table::Column> columns(const std::string& unit, std::size_t bearings, std::size_t nodes) {
  const io::Shape b{bearings}, n{nodes};
  std::vector<io::Table::Column> all{
      {"revolution", "1", "since the beginning"},
      {"time", "s", "at its end"},
      {"speed", unit, "in its middle"},
      {"amplitude", "m", "largest distance of the journal from its mean position in this revolution", b},
      {"x_max", "m", "largest x of the journal relative to the bearing centre", b},
      {"x_min", "m", "smallest", b},
      {"y_max", "m", "largest y of the journal relative to the bearing centre", b},
      {"y_min", "m", "smallest", b},
      {"eccentricity_max", "1", "largest eccentricity per clearance; zero for a bearing without clearance", b}};
  if (nodes > 0) {
    all.push_back({"node_amplitude", "m", "largest distance of the shaft's node from its mean position", n});
    all.push_back({"node_x", "m", "half the travel of the node in x", n});
    all.push_back({"node_y", "m", "half the travel of the node in y", n});
  }
  return all;
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
        table_(columns(unit_, places_.names.size(), options.nodes.size())) {
    system_.set_acceleration(drive_.acceleration);
    const double from = options.range.from, to = options.range.to,
                 turned = (to * to - from * from) / (2 * drive_.acceleration);
    total_ = static_cast<int>(turned / (2 * std::numbers::pi) * (1 + 1e-12));
    if (total_ < 1) throw core::NotConverged("the shaft does not even turn once on the way");
  }

  StudyResult run() {
    if (context_.resume && context_.results.has_checkpoint()) restore(context_.results.load_checkpoint());
    std::string status = "completed";
    try {
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
    return fmt::format("ended at {:.6g} {}: {}", speed_at(done_), unit_, why);
  }

  void revolve() {
    Revolution r;
    const std::size_t n = places_.names.size();
    r.samples.resize(n + options_.nodes.size());
    const auto at = [&](int k) {
      return drive_.time_of(2 * std::numbers::pi * (done_ + static_cast<double>(k) / options_.samples));
    };
    for (int k = 1; k <= options_.samples; ++k) {
      integrator_.advance(at(k), at(options_.samples));
      integrator_.state(x_.get());
      const system::Observed seen = system_.observe(x_.get());
      if (!(films_.margin(seen.film_thickness) > 0)) throw core::DomainError(films_.reason(seen.film_thickness));
      for (std::size_t b = 0; b < n; ++b) r.samples[b].push_back(seen.shown[b].position);
      if (options_.nodes.empty()) continue;
      const std::vector<double> shaft = system_.shaft(x_.get(), 0, false);
      for (std::size_t i = 0; i < options_.nodes.size(); ++i) {
        const auto from = static_cast<std::size_t>(4 * (options_.nodes[i] - 1));
        r.samples[n + i].push_back({shaft[from], shaft[from + 1]});
      }
    }
    // Where a checkpoint may lie nothing is remembered but what it holds.
    integrator_.close_revolution(0);
    record(r);
    keep(r);
    context_.results.progress(fmt::format("{}: revolution {} of {}, {:.1f} {}, step {:.3g} of a revolution, {:.1f} s",
                                          context_.results.summary().name, done_ + 1, total_, speed_at(done_ + 1),
                                          unit_, integrator_.step() * system_.speed() / (2 * std::numbers::pi),
                                          context_.results.seconds()));
  }

  void record(const Revolution& r) {
    const std::size_t n = places_.names.size();
    std::vector<double> amplitude, x_max, x_min, y_max, y_min, eccentricity, node, node_x, node_y;
    for (std::size_t b = 0; b < n; ++b) {
      amplitude.push_back(r.amplitude(b));
      x_max.push_back(r.extreme(b, 0, 1));
      x_min.push_back(r.extreme(b, 0, -1));
      y_max.push_back(r.extreme(b, 1, 1));
      y_min.push_back(r.extreme(b, 1, -1));
      eccentricity.push_back(r.eccentricity(b, places_.clearances[b]));
    }
    for (std::size_t i = n; i < r.samples.size(); ++i) {
      node.push_back(r.amplitude(i));
      node_x.push_back((r.extreme(i, 0, 1) - r.extreme(i, 0, -1)) / 2);
      node_y.push_back((r.extreme(i, 1, 1) - r.extreme(i, 1, -1)) / 2);
    }
    std::vector<std::vector<double>> row{{static_cast<double>(done_ + 1)},
                                         {integrator_.time()},
                                         {speed_at(done_ + 0.5)},
                                         amplitude,
                                         x_max,
                                         x_min,
                                         y_max,
                                         y_min,
                                         eccentricity};
    if (!node.empty()) row.insert(row.end(), {node, node_x, node_y});
    table_.append(row);
  }

  // Samples of all places, where spectra of them are wanted.
  void keep(const Revolution& r) {
    if (!options_.orders && !options_.waterfall) return;
    for (std::size_t k = 0; k < static_cast<std::size_t>(options_.samples); ++k)
      for (const auto& place : r.samples) kept_.insert(kept_.end(), place[k].begin(), place[k].end());
  }

  void save() {
    if (!options_.checkpoint) return;
    // At most once a second; rank 0 decides for all.
    int due = context_.results.seconds() - last_saved_ >= 1;
    MPI_Bcast(&due, 1, MPI_INT, 0, context_.comm);
    if (!due) return;
    io::Group state;
    state.set("done", done_ + 1);
    state.put("kept", kept_, "m", "samples [sample][place][x, y]");
    state.set("time", integrator_.time());
    state.set("step", integrator_.step());
    state.set("seconds", context_.results.seconds());
    put_vector(state, "u", integrator_.scaled(), layout_.shared, "scaled state");
    table_.write(state.child("run_up"));
    context_.results.save_checkpoint(state);
    last_saved_ = context_.results.seconds();
  }

  void restore(const io::Group& state) {
    done_ = static_cast<int>(state.integer("done"));
    take_vector(state, "u", integrator_.scaled());
    integrator_.restart(state.real("time"), state.real("step"));
    table_.read(state.group("run_up"));
    kept_ = state.reals("kept");
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

  // The largest amplitude of each place and where it was.
  void put_peaks(io::StudySummary& summary, const std::string& column, const std::vector<std::string>& names) const {
    const auto& speed = table_.column("speed");
    const auto& all = table_.column(column);
    for (std::size_t p = 0; p < names.size(); ++p) {
      std::size_t best = 0;
      for (std::size_t k = 1; k < speed.size(); ++k)
        if (all[k * names.size() + p] > all[best * names.size() + p]) best = k;
      summary.set(names[p] + ".peak.amplitude", all[best * names.size() + p], "m");
      summary.set(names[p] + ".peak.speed", speed[best], unit_);
    }
  }

  StudyResult report(const std::string& status) {
    auto& results = context_.results;
    auto& summary = results.summary();
    put_groups(summary, system_.groups());
    summary.set("acceleration", drive_.acceleration, "rad/s^2");
    if (table_.rows() > 0) {
      std::vector<std::string> bearings, nodes;
      for (const auto& name : places_.names) bearings.push_back("bearing." + name);
      for (const int node : options_.nodes) nodes.push_back(fmt::format("node.{}", node));
      put_peaks(summary, "amplitude", bearings);
      if (!nodes.empty()) put_peaks(summary, "node_amplitude", nodes);
    }
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
  io::Table table_;
  std::vector<double> kept_;  // [sample][place and node][x, y]
  int total_ = 0, done_ = 0;
  double last_saved_ = -1e9;
};

}  // namespace

StudyResult RunUp::run(Context& context) {
  return Runner(context, options).run();
}

}  // namespace whirl::study
