#include "study/convergence/mesh_convergence.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "study/bars/branch_brief.hpp"
#include "study/bars/summary_bars.hpp"
#include "study/bifurcation.hpp"
#include "study/common.hpp"
#include "study/convergence/shared_convergence.hpp"
#include "study/cycle/cycle_follower.hpp"
#include "study/located.hpp"
#include "study/packed.hpp"
#include "study/pieces.hpp"
#include "whirl/core/error.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"

namespace whirl::study {
namespace {

// Machine and solver at one level: film meshes doubled `level` times.
struct Level {
  Level(Context& context, const CycleBranchOptions& options, int level)
      : machine(context.machine), here(context.with(machine)) {
    const double factor = 1 << level;
    for (auto& b : machine.bearings) b.film = film::refined(b.film, {factor, factor});
    follower = std::make_unique<CycleFollower>(here, options);
  }
  system::Machine machine;
  Context here;
  std::unique_ptr<CycleFollower> follower;
};

// What is known of one bifurcation: a value per level, in the unit of the branch.
struct History {
  Located last;
  std::vector<double> value, bracket, seconds;
  double time_error = io::no_value;
  void members(auto& archive) { archive(value, bracket, seconds, time_error); }  // the last one is stored by rows
};

// The options of a branch by its name in the results.
CycleBranchOptions options_of(const Context& context, const std::string& name) {
  for (const auto& s : context.studies)
    if (auto branch = branch_called(*s, name)) return *branch;
  throw core::Bug("validate_among lets no other name pass");
}

}  // namespace

io::Table convergence_table(const std::string& unit) {
  return io::Table({{"bifurcation", "1", "which one of the branch, from 1"},
                    {"refinement", "1", "cells in each direction per cells of the deck"},
                    {"parameter", unit, "where"},
                    {"bracket", unit, "what the location left"},
                    {"seconds", "s", "wall time"}});
}

MeshLimit mesh_limit(const std::vector<double>& values, double theory, bool kinks) {
  constexpr double least_order = 0.5;
  MeshLimit out;
  const std::size_t n = values.size();
  if (n == 0) return out;
  out.limit = values.back();
  if (n == 1) return out;
  const double last = values[n - 1] - values[n - 2], before = n > 2 ? values[n - 2] - values[n - 3] : 0;
  if (n > 2) out.order = std::log2(std::abs(before / last));
  const bool regular = before * last > 0;
  const double order = regular ? std::clamp(out.order, least_order, theory) : theory,
               factor = regular && !kinks && out.order >= least_order ? 1.25 : 3.0;
  // What the last difference would be by theory.
  const double foretold = std::abs(before) * std::exp2(-order);
  out.limit += last / (std::exp2(order) - 1);
  out.error = std::max(factor * std::abs(last), foretold) / (std::exp2(order) - 1);
  return out;
}

StudyResult MeshConvergence::run(Context& context) {
  if (!context.earlier.has_group(io::safe_name(options.of)))
    throw core::NotConverged(fmt::format("there is no branch '{}': fewer flips were found than that", options.of));
  const io::Group& of = context.earlier.group(io::safe_name(options.of));
  if (!of.has_group("located"))
    throw core::NotConverged(
        fmt::format("the results of '{}' hold no bifurcations to start from: compute it again", options.of));
  const EquilibriumBranch* const rest = equilibria_called(context, options.of);
  const auto located = [&] {
    if (rest) return read_located(of.group("located"));
    // Cycles are read on the machine of the deck.
    return Level(context, options_of(context, options.of), 0).follower->read(of.group("located"));
  };
  const std::vector<Located> all = located();
  std::vector<int> chosen = options.bifurcations;
  if (chosen.empty()) {
    chosen.resize(all.size());
    std::iota(chosen.begin(), chosen.end(), 1);
  }
  if (chosen.empty()) throw core::NotConverged(fmt::format("'{}' has no bifurcations", options.of));
  for (const int k : chosen)
    if (static_cast<std::size_t>(k) > all.size())
      throw core::NotConverged(fmt::format("'{}' has {} bifurcations, number {} is wanted", options.of, all.size(), k));

  if (rest) return converge(context, options, rest->given(), all, chosen);
  const CycleBranchOptions branch = options_of(context, options.of);
  auto& results = context.results;
  const std::string& unit = branch.parameter.range.unit;
  const double scale = deck::number_to_si(1, unit);
  io::Table rows = convergence_table(unit);
  History now;
  std::size_t first = 0;
  std::string trouble;
  const auto note = [&](const std::string& text) { trouble += (trouble.empty() ? "" : "; ") + text; };
  Pieces pieces(results, context.resume, true, core::size_of(context.comm));
  if (const io::Group& state = pieces.state(); state.has_group("rows")) {
    rows.read(state.group("rows"));
    first = static_cast<std::size_t>(state.integer("bifurcation"));
    unpack(state.reals("history"), now);
    read_summary(state.group("summary"), results.summary());
    trouble = state.text("trouble");
  }
  for (std::size_t i = first; i < chosen.size(); ++i) {
    const Located& origin = all[static_cast<std::size_t>(chosen[i]) - 1];
    if (origin.event == solve::Event::branch_point) {  // for one a Hopf point, where there is no cycle yet
      note(fmt::format("bifurcation {} is not one of cycles, or it was not located", chosen[i]));
      continue;
    }
    if (now.value.empty()) now = {origin, {origin.cycle.parameter / scale}, {0}, {0}, io::no_value};
    auto coarse = std::make_unique<Level>(context, branch, static_cast<int>(now.value.size()) - 1);
    if (pieces.state().has_group("rows") && i == first && now.value.size() > 1)
      now.last = coarse->follower->read(pieces.state().group("located")).front();
    if (now.value.size() == 1)
      now.time_error =
          pieces.number(fmt::format("time error {}", i), [&] { return coarse->follower->time_error(origin); });
    for (int level = static_cast<int>(now.value.size()); level <= options.doublings; ++level) {
      const double begin = results.seconds();
      auto fine = std::make_unique<Level>(context, branch, level);
      std::string reason;
      const bool found = has_answer(
          [&] {
            const Relocated there = fine->follower->relocate(now.last, *coarse->follower, pieces.replay_log());
            now.last = there.found;
            now.bracket.push_back(there.bracket);
          },
          &reason);
      if (!found) {
        note(
            fmt::format("bifurcation {} stopped at {} times the cells of the deck: {}", chosen[i], 1 << level, reason));
        break;
      }
      now.value.push_back(now.last.cycle.parameter / scale);
      now.seconds.push_back(results.seconds() - begin);
      coarse = std::move(fine);
      io::Group state;
      rows.write(state.child("rows"));
      state.set("bifurcation", static_cast<int>(i));
      coarse->follower->write(state.child("located"), {now.last});
      put_packed(state, "history", now, "per level");
      write_summary(state.child("summary"), results.summary());
      state.set("trouble", trouble);
      pieces.save(std::move(state));
    }
    const MeshLaw law = law_of(context.machine, context.layout);
    const MeshLimit limit = mesh_limit(now.value, law.film_order, law.kinks);
    io::Bifurcation b = bifurcation_at(type_of(now.last.event), limit.limit, branch.parameter.path, unit,
                                       context.machine, branch.unbalance, coarse->follower->system());
    b.period_s = now.last.cycle.period;
    b.uncertainty = limit.error + now.time_error + now.bracket.back();
    b.criticality_by = "see the branch";
    b.more["uncertainty_film_mesh"] = limit.error;
    b.more["uncertainty_time_mesh"] = now.time_error;
    b.more["uncertainty_location"] = now.bracket.back();
    b.more["observed_order"] = limit.order;
    for (std::size_t k = 0; k < now.value.size(); ++k) {
      b.more[fmt::format("refined_{}", 1 << k)] = now.value[k];
      rows.append({static_cast<double>(chosen[i]), std::exp2(k), now.value[k], now.bracket[k], now.seconds[k]});
    }
    results.summary().bifurcations.push_back(b);
    now = {};
  }
  return finish_convergence(context, options, rows, branch.parameter, trouble);
}

io::Brief MeshConvergence::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const std::vector<io::Bifurcation>& all = result.summary.bifurcations;
  if (all.empty()) return {};
  const std::string& unit = all.front().unit;
  const auto refined = [](const io::Bifurcation& b, int times) { return more_of(b, fmt::format("refined_{}", times)); };
  io::BriefTable table{
      fmt::format("Bifurcations of '{}' on finer film meshes", options.of),
      {{"what"}, {"deck's mesh", unit}},
      {},
      "finer: cells in both directions; limit: Richardson's extrapolation, bar of film mesh, time mesh and location; "
      "order: that the last three meshes show"};
  for (int level = 1; level <= options.doublings; ++level)
    table.columns.push_back({fmt::format("{} x finer", 1 << level), unit});
  table.columns.insert(table.columns.end(), {{"limit", unit}, {"order", "1"}, {"deck off by", "%"}});
  io::Brief brief;
  const io::Bifurcation* farthest = nullptr;
  const auto off = [&](const io::Bifurcation& b) { return 100 * (refined(b, 1) - b.value) / std::abs(b.value); };
  for (const io::Bifurcation& b : all) {
    auto& row = table.rows.emplace_back();
    row.emplace_back(words_of(b.type));
    for (int level = 0; level <= options.doublings; ++level)
      row.emplace_back(io::Quantity{refined(b, 1 << level), unit});
    row.emplace_back(io::Quantity{b.value, unit, {{"uncertainty", b.uncertainty}}});
    row.emplace_back(io::Quantity{more_of(b, "observed_order"), "1"});
    row.emplace_back(io::Quantity{off(b), "%"});
    if (!(std::abs(off(b)) <= (farthest ? std::abs(off(*farthest)) : -1))) farthest = &b;
  }
  const std::string moved = fmt::format(
      "from {} on the mesh of the deck to the limit {}, by {:.2g} %", io::reading({refined(*farthest, 1), unit}),
      io::reading({farthest->value, unit, {{"uncertainty", farthest->uncertainty}}}), std::abs(off(*farthest)));
  brief.sentences.push_back(
      all.size() == 1 ? fmt::format("On finer film meshes the {} moves {}.", short_words_of(farthest->type), moved)
                      : fmt::format("On finer film meshes the {} moves the farthest of {} bifurcations: {}.",
                                    short_words_of(farthest->type), all.size(), moved));
  brief.tables.push_back(std::move(table));
  return brief;
}

StudyResult finish_convergence(Context& context, const MeshConvergenceOptions& options, const io::Table& rows,
                               const Parameter& parameter, const std::string& trouble) {
  auto& results = context.results;
  auto& group = results.group();
  rows.write(group.child("convergence"));
  put_bifurcations(group, results.summary().bifurcations);
  group.set("of", options.of);
  group.set("parameter", parameter.path);
  group.set("parameter_unit", parameter.range.unit);
  results.summary().points = static_cast<long>(rows.rows());
  return results.finish(trouble.empty() ? "completed" : trouble, !results.summary().bifurcations.empty());
}

}  // namespace whirl::study
