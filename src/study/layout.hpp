#pragma once
// How the ranks of a run share the work.

#include <mpi.h>

#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "study/packed.hpp"
#include "study/pieces.hpp"
#include "whirl/system/options.hpp"

namespace whirl::study {

struct Context;
struct LayoutOptions;

/// How an analysis can be shared.
enum class Sharing {
  machine,    ///< one state after another: motions in time, Newton-Picard's cycles
  meshes,     ///< the same of equilibria and their branches, which other meshes of their error bars do not wait for
  films,      ///< independent problems of one film of the machine
  speeds,     ///< independent problems of one machine: modes, responses
  intervals,  ///< pieces of a cycle in time, each of which needs the whole machine on its rank
  cycles,     ///< the states at all points of time: cycles by collocation where spreads_cycles() says so
  nothing,    ///< neither: single shooting
};

/// Groups of ranks, each of which holds a whole machine on its `space` communicator; independent work is shared between
/// the groups.
///
/// Counts decide, never clocks, so that a decision repeats itself: a shaft or films with fewer states than
/// LayoutOptions says fit one rank's cache, and their solves are over before a message arrives, so that every rank is a
/// group of its own. A larger machine is spread over all ranks as one group; for a cycle whose states are spread the
/// deck may ask for several such groups, which share its intervals (solve::TimeGroups).
struct Layout {
  MPI_Comm world = MPI_COMM_NULL, space = MPI_COMM_NULL;
  MPI_Comm time = MPI_COMM_SELF;  ///< ranks that share the intervals of a cycle, with the same rows of a state
  int count = 1;                  ///< number of groups that share independent work
  int index = 0;                  ///< of this rank's group among them
  bool large = false;             ///< the machine is one that several ranks share where there are several
  bool shared = false;            ///< and it is shared here: by the ranks of `space`, which may be one
  bool spread = false;            ///< cycles are solved with the states of the films apart, be it on one rank

  /// Vectors stand in the same order where this number is the same.
  [[nodiscard]] int order() const;
};

/// The one place where the world is split. The first plan of a study on several ranks says in its summary what was
/// chosen. `intervals`: of the time mesh, for Sharing::intervals and ::cycles; with more ranks than intervals each rank
/// computes all of them.
[[nodiscard]] Layout plan(const Context& context, Sharing sharing, std::size_t intervals = 1);

/// Whether cycles by collocation at Radau points, on `intervals` intervals of `stages` points, are solved with the
/// states of the films apart, on all ranks (see Layout::spread). A long shaft alone has its own way, modes in time on
/// whole machines.
[[nodiscard]] bool spreads_cycles(const LayoutOptions& options, const system::Machine& machine, double intervals,
                                  double stages);

/// What an item leaves behind from which the next one starts, as numbers: to be read after an item, and to be put back
/// where a resumed run takes an item as it was kept.
struct Trail {
  std::function<std::vector<double>()> leave;
  std::function<void(const std::vector<double>&)> take;
};
/// Of items that start anew.
inline const Trail no_trail{[] { return std::vector<double>{}; }, [](const std::vector<double>&) {}};

/// Runs work(0), ..., work(n - 1), shared between the groups in contiguous runs, and gives all answers to all ranks.
/// `work` is collective on the space communicator. If one item throws, all ranks throw. After rounds of about a quarter
/// of a second the answers are `kept` as pieces `name 1`, ..., `name n`: those of an interrupted run are not computed
/// again, and on one rank the others start from what they would have started from. Collective on the world.
[[nodiscard]] std::vector<std::vector<double>> distribute_rows(
    const Layout& layout, std::size_t n, const std::function<std::vector<double>(std::size_t)>& work, Pieces& kept,
    const std::string& name, const Trail& trail);
/// The same with answers that pack() takes.
template <class Work>
[[nodiscard]] auto distribute(const Layout& layout, std::size_t n, const Work& work, Pieces& kept,
                              const std::string& name, const Trail& trail) {
  using Answer = std::invoke_result_t<const Work&, std::size_t>;
  const auto row = [&](std::size_t item) { return pack(work(item)); };
  std::vector<Answer> out;
  for (const auto& each : distribute_rows(layout, n, row, kept, name, trail)) out.push_back(unpack<Answer>(each));
  return out;
}

/// Rows work(0), ..., work(n - 1) that start anew, each a piece `name 1`, ...; where one rank does all, what the work
/// itself keeps goes with its piece.
[[nodiscard]] std::vector<std::vector<double>> distribute_numbers(
    const Layout& layout, std::size_t n, const std::function<std::vector<double>(std::size_t)>& work, Pieces& kept,
    const std::string& name);
/// The same with work(own, k) that keeps pieces of itself: in the checkpoint where one rank does all, else until it has
/// ended. Items start anew.
template <class Work>
[[nodiscard]] auto distribute_pieces(const Context& context, const Layout& layout, std::size_t n, const Work& work,
                                     Pieces& kept, const std::string& name) {
  const auto row = [&](std::size_t item) {
    if (layout.count == 1) return work(kept, item);
    Pieces unsaved(context.results, false, false);
    return work(unsaved, item);
  };
  return distribute(layout, n, row, kept, name, no_trail);
}

}  // namespace whirl::study
