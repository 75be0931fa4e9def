#include "layout.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "cost.hpp"
#include "findings.hpp"
#include "pieces.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/film/contract/options.hpp"
#include "whirl/study/layout_options.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

std::span<const deck::Name<BarsFrom>> names(BarsFrom) {
  using enum BarsFrom;
  static constexpr deck::Name<BarsFrom> table[] = {
      {meshes, "meshes", "from the same number on other meshes of films, time and shaft"},
      {none, "none",
       "no other meshes and no bars, in a fraction of the time; whether a bifurcation is supercritical is not "
       "decided"}};
  return table;
}

std::span<const deck::Name<LayoutOptions::Machine>> names(LayoutOptions::Machine) {
  using enum LayoutOptions::Machine;
  static constexpr deck::Name<LayoutOptions::Machine> table[] = {
      {automatic, "automatic", "each rank, unless its states are too many by the counts below"},
      {one_rank, "one_rank", "each rank, whatever the size"},
      {all_ranks, "all_ranks",
       "all ranks share the states of one; cycles by collocation at Radau points only where films have states: the "
       "others want whole machines"}};
  return table;
}

void describe(deck::Description<LayoutOptions>& d) {
  using enum LayoutOptions::Machine;
  d.add("machine", &LayoutOptions::machine,
        "who holds one machine. Where each rank holds a whole one, they share speeds and the intervals of cycles");
  d.add("shaft_freedoms", &LayoutOptions::shaft_freedoms, deck::positive,
        "freedoms of a shaft, before its reduction, from which all ranks share one machine")
      .only(&LayoutOptions::machine, {automatic});
  d.add("film_states", &LayoutOptions::film_states, deck::positive,
        "states of all films together from which all ranks share one machine")
      .only(&LayoutOptions::machine, {automatic});
  d.add(
      "time_groups", &LayoutOptions::time_groups, deck::positive,
      "groups of ranks, each of which holds a machine, that share the intervals of a cycle whose states are spread; as "
      "many of them as divide the number of ranks. If absent, so many that each rank has a thousand states of films");
  d.add(
       "cycle_memory", &LayoutOptions::cycle_memory, "byte", deck::positive,
       "memory, as estimated for the deck's intervals, that a cycle by collocation at Radau points may take on whole "
       "machines, whose intervals the ranks share; films that fill and empty, of film_states and more, are spread over "
       "the ranks only above it. Films on liners are spread from film_states on")
      .only(&LayoutOptions::machine, {automatic});
  d.add(
      "refined_states", &LayoutOptions::refined_states, deck::positive,
      "states of all films together up to which error bars take finer film meshes too, of up to twice as many; beyond, "
      "coarser ones only");
}

namespace {

// What makes the machine large, or nothing.
std::string reason_to_share(const LayoutOptions& options, const system::Machine& machine) {
  using enum LayoutOptions::Machine;
  if (options.machine == all_ranks) return "by the deck";
  if (options.machine == one_rank) return {};
  if (!system::is_rotor(machine))
    return n_states(machine) < 2.0 * options.shaft_freedoms ? "" : fmt::format("{:.0f} states", n_states(machine));
  const auto freedoms = 4 * (machine.rotor.segments.size() + 1);
  if (freedoms >= static_cast<std::size_t>(options.shaft_freedoms)) return fmt::format("{} freedoms", freedoms);
  const double own = n_film_states(machine);
  return own < options.film_states ? "" : fmt::format("{:.0f} states of films", own);
}

}  // namespace

bool spreads_cycles(const LayoutOptions& options, const system::Machine& machine, double intervals, double stages) {
  using enum LayoutOptions::Machine;
  if (!system::is_rotor(machine) || options.machine == one_rank) return false;
  const double own = n_film_states(machine);
  if (own == 0 || options.machine == all_ranks) return own > 0;
  if (own < options.film_states) return false;
  // Whole machines have films settle that fill and empty, but none that lie on a liner.
  const bool liners = std::any_of(machine.bearings.begin(), machine.bearings.end(), [](const system::Bearing& b) {
    const film::Facts f = film::facts(b.film);
    return f.own_states && f.gives_way;
  });
  return liners || memory_of_cycles(machine, intervals, stages, true) > options.cycle_memory;
}

namespace {

// Messages within a solve cost more than its halves save where a rank has fewer states (docs/speed.md).
constexpr double states_of_a_rank = 1000;

// Of `size` ranks, groups of equal size that share the intervals of a cycle: as many as the deck says, or as fill
// ranks.
int time_groups(const Context& context, int size, std::size_t intervals) {
  const double ranks_to_fill = std::max(1.0, n_film_states(context.machine) / states_of_a_rank);
  const double wanted = context.layout.time_groups ? *context.layout.time_groups : std::ceil(size / ranks_to_fill);
  int groups = static_cast<int>(std::min({wanted, static_cast<double>(size), static_cast<double>(intervals)}));
  while (size % groups != 0) --groups;
  return groups;
}

}  // namespace

Layout plan(const Context& context, Sharing sharing, std::size_t intervals) {
  const std::string reason = reason_to_share(context.layout, context.machine);
  const int size = core::size_of(context.comm);
  Layout out;
  out.world = context.comm;
  out.large = !reason.empty();
  out.spread = sharing == Sharing::cycles;
  const bool in_time = sharing == Sharing::intervals;
  const bool whole = in_time || sharing == Sharing::nothing || sharing == Sharing::films;  // on every rank
  out.shared = out.large && !whole;
  int groups = 1;
  if (out.shared) {
    out.space = context.comm;
    if (out.spread) groups = time_groups(context, size, intervals);
    if (groups > 1) {
      out.space = context.results.rank_groups(groups).space;
      out.time = context.results.rank_groups(groups).time;
    }
  } else {
    out.space = MPI_COMM_SELF;
    out.count = size;
    out.index = core::rank_of(context.comm);
  }
  const bool share_time = in_time && intervals >= static_cast<std::size_t>(size);
  if (share_time) out.time = context.comm;
  std::string& text = context.results.summary().layout;
  if (size > 1 && text.empty())
    text = groups > 1 ? fmt::format("intervals shared by {} groups, a machine on each one's {} ranks ({})", groups,
                                    size / groups, reason)
           : out.space != MPI_COMM_SELF ? fmt::format("one machine on {} ranks ({})", size, reason)
           : sharing == Sharing::speeds ? fmt::format("speeds shared by {} ranks, a machine on each", size)
           : sharing == Sharing::meshes
               ? fmt::format("meshes of error bars shared by {} ranks, a machine on each", size)
           : sharing == Sharing::films ? fmt::format("points and meshes shared by {} ranks, a film on each", size)
           : share_time                ? fmt::format("intervals shared by {} ranks, a machine on each", size)
                                       : fmt::format("{} ranks compute the same", size);
  return out;
}

int Layout::order() const {
  constexpr int most_ranks = 1 << 20;
  return core::size_of(space) + (spread ? most_ranks * (core::size_of(time) - 1) : 0);
}

namespace {

using Answers = std::vector<std::vector<double>>;
using Work = std::function<std::vector<double>(std::size_t)>;

// Of n items, the first that a group has.
std::size_t first_of(const Layout& layout, std::size_t n, std::size_t group) {
  return n * group / static_cast<std::size_t>(layout.count);
}

// The items from `begin` on of each group's run of `wanted`, `most` of them, into `all` on every rank.
void round(const Layout& layout, const std::vector<std::size_t>& wanted, std::size_t begin, std::size_t most,
           const Work& work, Answers& all) {
  const auto run = [&](std::size_t group, const std::function<void(std::size_t)>& visit) {
    const std::size_t from = first_of(layout, wanted.size(), group) + begin,
                      to = std::min(from + most, first_of(layout, wanted.size(), group + 1));
    for (std::size_t i = from; i < to; ++i) visit(wanted[i]);
  };
  const auto own = [&] {
    run(static_cast<std::size_t>(layout.index), [&](std::size_t item) { all[item] = work(item); });
  };
  if (layout.count == 1) return own();
  core::agree(layout.world, own);
  for (int group = 0; group < layout.count; ++group)
    run(static_cast<std::size_t>(group), [&](std::size_t item) {
      auto length = static_cast<unsigned long>(all[item].size());
      MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, group, layout.world);
      all[item].resize(length);
      MPI_Bcast(all[item].data(), static_cast<int>(length), MPI_DOUBLE, group, layout.world);
    });
}

}  // namespace

Answers distribute_rows(const Layout& layout, std::size_t n, const Work& answer, Pieces& kept, const std::string& name,
                        const Trail& trail) {
  // The trail stands before the answer, behind its own length.
  const Work work = [&](std::size_t item) {
    const std::vector<double> own = answer(item);
    std::vector<double> both = trail.leave();
    both.insert(both.begin(), static_cast<double>(both.size()));
    both.insert(both.end(), own.begin(), own.end());
    return both;
  };
  const auto split = [](const std::vector<double>& both) {
    return both.begin() + 1 + static_cast<std::ptrdiff_t>(both.front());
  };
  const auto piece = [&](std::size_t item) { return fmt::format("{} {}", name, item + 1); };
  const auto known = [] { return std::vector<double>(); };
  Answers all(n);
  std::vector<std::size_t> wanted;
  for (std::size_t item = 0; item < n; ++item)
    if (kept.known(piece(item))) {
      all[item] = kept.numbers(piece(item), known);
      trail.take({all[item].cbegin() + 1, split(all[item])});
    } else
      wanted.push_back(item);
  const std::size_t longest =
      (wanted.size() + static_cast<std::size_t>(layout.count) - 1) / static_cast<std::size_t>(layout.count);
  unsigned long most = 1;
  for (std::size_t begin = 0, size = 1; begin < longest; begin += size) {
    size = most;
    const auto started = std::chrono::steady_clock::now();
    round(layout, wanted, begin, size, work, all);
    for (std::size_t group = 0; group < static_cast<std::size_t>(layout.count); ++group) {
      const std::size_t from = first_of(layout, wanted.size(), group) + begin,
                        to = std::min(from + size, first_of(layout, wanted.size(), group + 1));
      for (std::size_t i = from; i < to; ++i) kept.keep(piece(wanted[i]), all[wanted[i]]);
    }
    kept.save_if_due();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    most = std::clamp<unsigned long>(
        static_cast<unsigned long>(0.25 * static_cast<double>(size) / std::max(seconds, 1e-6)), 1, 2 * size);
    MPI_Bcast(&most, 1, MPI_UNSIGNED_LONG, 0, layout.world);
  }
  for (auto& both : all) both.erase(both.cbegin(), split(both));
  return all;
}

Answers distribute_numbers(const Layout& layout, std::size_t n, const Work& work, Pieces& kept,
                           const std::string& name) {
  if (layout.count > 1) return distribute(layout, n, work, kept, name, no_trail);
  Answers out;
  for (std::size_t k = 0; k < n; ++k)
    out.push_back(kept.numbers(fmt::format("{} {}", name, k + 1), [&] { return work(k); }));
  return out;
}

}  // namespace whirl::study
