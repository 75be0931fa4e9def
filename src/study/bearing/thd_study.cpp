#include "study/bearing/thd_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "study/bearing/thd_load.hpp"
#include "study/bearing/thd_results.hpp"
#include "study/findings.hpp"
#include "study/pieces.hpp"
#include "study/sense.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"

namespace whirl::study {
namespace {

// What a sweep has done: rows of its table, the reasons of those without a film (empty: there is one), and the last
// state to go on from, in rows shared by the ranks.
struct SpeedSweep {
  io::Table table = thd_table();
  std::vector<std::string> reasons;
  std::vector<std::string> unsettled;

  [[nodiscard]] bool any() const { return std::ranges::find(reasons, "") != reasons.end(); }
  void lose(double speed, const std::string& reason) {
    std::vector<std::vector<double>> row(table.columns().size(), {io::no_value});
    row.front() = {speed};
    table.append(row);
    reasons.push_back(reason);
  }
  [[nodiscard]] io::Group kept(const ThdAtSpeed& film, std::vector<double> state) const {
    io::Group out;
    table.write(out.child("table"));
    out.put("reasons", reasons, "why there is no film at a speed");
    out.put("unsettled", unsettled, "speeds at which the temperatures did not settle");
    const thermal::Rows& r = film.rows();
    const auto here = static_cast<std::size_t>(r.count());
    io::Dataset data{{here, state.size() / here}, std::move(state), "1", "temperatures and pressure at the last speed"};
    if (core::size_of(r.comm()) > 1)
      data.share = {static_cast<std::size_t>(r.begin()), static_cast<std::size_t>(r.mesh().nodes_along())};
    out.put("last", std::move(data));
    return out;
  }
  // The last speed with a film, by its place.
  [[nodiscard]] std::size_t last() const {
    std::size_t out = reasons.size() - 1;
    while (!reasons[out].empty()) --out;
    return out;
  }
  // Of the journal there, in clearances.
  [[nodiscard]] std::array<double, 2> place() const {
    const double e = table.column("eccentricity")[last()], angle = table.column("attitude")[last()];
    return {e * std::cos(angle), e * std::sin(angle)};
  }
  void read(const io::Group& from) {
    table.read(from.group("table"));
    reasons = from.strings("reasons");
    unsettled = from.strings("unsettled");
  }
};

// Whether there is a film; `reason` says why not. An error that only some ranks have is no answer.
bool found(MPI_Comm comm, const std::function<void()>& solve, std::string& reason) {
  try {
    solve();
    return true;
  } catch (const core::NotConverged& error) {
    if (core::size_of(comm) > 1 && !error.agreed()) throw;
    reason = error.what();
  } catch (const core::DomainError& error) {
    if (core::size_of(comm) > 1 && !error.agreed()) throw;
    reason = error.what();
  }
  return false;
}

// The state of a checkpoint, on whatever ranks it was written.
std::vector<double> last_state(const io::Group& from, const thermal::Rows& rows) {
  const io::Dataset& data = from.dataset("last");
  const auto& values = std::get<std::vector<double>>(data.values);
  const std::size_t width = data.shape.at(1), begin = data.share ? data.share->begin : 0;
  const core::Vector all = core::make_vector(
      rows.comm(), static_cast<PetscInt>(static_cast<std::size_t>(rows.count()) * width), PETSC_DETERMINE);
  if (data.share)
    core::fill(all.get(), begin * width, values);
  else
    core::fill(all.get(), values);
  const core::ReadArray a(all.get());
  return {a.data(), a.data() + a.size()};
}

// Warns of the largest Reynolds number, of fluid at the mean temperature of the film, that is computed as laminar.
void warn_of_vortices(io::StudySummary& summary, const ThdOptions& options, const system::Bearing& bearing,
                      const SpeedSweep& sweep) {
  if (options.turbulence != thermal::Turbulence::laminar) return;
  const thermal::Fluid fluid = thermal::make_fluid(options.fluid);
  const film::Geometry& g = *bearing.geometry;
  double most = 0, speed = 0;
  for (std::size_t k = 0; k < sweep.table.rows(); ++k) {
    const double t = sweep.table.column("mean_temperature")[k], omega = options.speeds[k].value;
    const double reynolds = fluid.rho(options.ambient.pressure, t) * std::abs(omega) * g.radius * g.clearance /
                            thermal::viscosity(fluid.viscosity, t).value;
    if (reynolds > most) {
      most = reynolds;
      speed = omega;
    }
  }
  warn_of_reynolds(summary, bearing.name, g, most, speed);
}

}  // namespace

StudyResult ThdStudy::run(Context& context) {
  const std::size_t which = options.bearing.empty() ? 0 : *system::find_bearing(context.machine, options.bearing);
  const film::Geometry& geometry = *context.machine.bearings[which].geometry;
  auto& results = context.results;
  auto& summary = results.summary();
  io::Group& group = results.group();
  group.set("bearing", context.machine.bearings[which].name);
  group.set("parameter", "speed");
  group.set("parameter_unit", "rad/s");

  // Writes values, bars and fields of one speed.
  const auto put_film = [&](const SolvedFilm& solved, double speed, const std::array<double, 2>& place,
                            Pieces& pieces) {
    ThdAtSpeed& film = *solved.film;
    put_thd_values(summary, film, options);
    const double residual = film.thd().budget().residual();
    put_thd_bars(context, film, options, geometry, speed, {place, {}}, residual, pieces);
    put_lumped(summary, film, options, geometry);
    put_effective(group, summary, film, options.ambient.temperature);
    put_properties(group, options, film.fluid(), geometry);
    const thermal::ThdSolve& cost = film.cost();
    summary.set("energy_residual", residual, "W");
    summary.set("iterations", cost.iterations, "1");
    summary.set("iterations.pressure", cost.pressure, "1");
    if (!options.load.values.empty()) summary.set("iterations.position", solved.films, "1");
    summary.set("iterations.energy_newton", cost.energy_newton, "1");
    summary.set("iterations.energy_krylov", cost.energy_krylov, "1");
    auto& rounds = group.child("iterations");
    rounds.put("field", std::vector<std::string>{"temperature"}, "what the residual is of");
    rounds.put("residual", io::Shape{cost.largest.size(), 1}, cost.largest, "K",
               "greatest change of a temperature in each round [iteration][field]");
    put_thd_fields(context, film, geometry);
  };

  Pieces pieces(results, context.resume, true, core::size_of(context.comm));
  SpeedSweep sweep;
  std::vector<double> last;
  if (pieces.state().has_group("table")) sweep.read(pieces.state());
  SolvedFilm solved;  // at the last speed
  for (std::size_t k = sweep.reasons.size(); k < options.speeds.size(); ++k) {
    const double speed = options.speeds[k].value;
    results.progress(fmt::format("speed {:.6g} rad/s", speed));
    FilmStart start;
    if (sweep.any() && last.empty())
      last = last_state(pieces.state(), ThdAtSpeed(context.comm, options, geometry, speed).rows());
    if (sweep.any()) start = {sweep.place(), last};
    if (std::string reason; !found(
            context.comm,
            [&] {
              solved = solve_film(context.comm, options, geometry, speed, start);
              append_thd(sweep.table, *solved.film, speed);
            },
            reason)) {
      sweep.lose(speed, reason);
      solved = {};
      continue;
    }
    sweep.reasons.emplace_back();
    ThdAtSpeed& film = *solved.film;
    if (!solved.converged)
      sweep.unsettled.push_back(fmt::format("{:.6g} rad/s ({} rounds)", speed, film.cost().iterations));
    if (k + 1 == options.speeds.size()) break;
    last = film.thd().state();
    if (pieces.state_due()) pieces.save(sweep.kept(film, last));
  }
  if (sweep.any()) {
    const std::size_t shown = sweep.last();
    const double speed = options.speeds[shown].value;
    std::string reason;
    bool there = solved.film != nullptr;
    if (!there) {
      // The last speeds have no film: the last one that there is, from where it was.
      if (last.empty()) last = last_state(pieces.state(), ThdAtSpeed(context.comm, options, geometry, speed).rows());
      there = found(
          context.comm,
          [&] {
            solved = solve_film(context.comm, options, geometry, speed, {sweep.place(), last});
          },
          reason);
      summary.warnings.push_back(
          fmt::format("values, bars and fields are those at {:.6g} {}, the last speed with a film",
                      deck::from_si(speed, options.speeds[shown].unit), options.speeds[shown].unit));
    }
    if (there) put_film(solved, speed, sweep.place(), pieces);
  }
  auto& table = group.child("budget");
  for (const io::Table::Column& c : sweep.table.columns())
    table.put(c.name, sweep.table.column(c.name), c.unit, c.description);
  if (std::ranges::any_of(sweep.reasons, [](const std::string& why) { return !why.empty(); }))
    table.put("reason", sweep.reasons, "why there is no film at the speed; empty: there is one");
  summary.points = static_cast<long>(std::ranges::count(sweep.reasons, ""));
  warn_of_vortices(summary, options, context.machine.bearings[which], sweep);
  // A speed without its film was asked for in vain: what there is of the others is kept, and the run says so.
  std::vector<std::string> lost;
  for (std::size_t k = 0; k < sweep.reasons.size(); ++k)
    if (!sweep.reasons[k].empty())
      lost.push_back(fmt::format("no film at {:.6g} rad/s: {}", options.speeds[k].value, sweep.reasons[k]));
  if (!lost.empty()) return results.finish(fmt::format("{}", fmt::join(lost, "; ")), false);
  if (!sweep.unsettled.empty())
    return results.finish(
        fmt::format("temperatures did not settle at {}: their changes fall no more; values and bars there are those of "
                    "the last round",
                    fmt::join(sweep.unsettled, ", ")),
        false);
  return results.finish("completed", true);
}

}  // namespace whirl::study
