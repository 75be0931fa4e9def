#pragma once
// What every analysis is to the rest of the program.

#include <mpi.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "whirl/deck/description.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/io/xdmf.hpp"
#include "whirl/system/options.hpp"

namespace whirl::study {

class Findings;
class Study;
struct LayoutOptions;

/// What a study found; the same on all ranks.
struct StudyResult {
  io::Group group;                                 ///< tables and fields, with units
  io::StudySummary summary;                        ///< named values, bifurcations, how it ended
  std::vector<io::StructuredGrid> grids;           ///< meshes for ParaView; dataset paths are relative to `group`
  std::vector<std::filesystem::path> checkpoints;  ///< of its parts; they go when the result is written
  bool delivered = true;                           ///< false: nothing but the reason in summary.status
};

/// What a study gets to work with.
struct Context {
  MPI_Comm comm;
  const system::Machine& machine;
  const LayoutOptions& layout;                      ///< what the deck says of sharing it
  Findings& results;                                ///< what the study has found so far
  const io::Group& earlier;                         ///< results of the studies before, by io::safe_name of their names
  std::span<const io::StudySummary> summaries;      ///< of those
  bool resume = false;                              ///< go on from the checkpoint of this study, if there is one
  std::span<const std::unique_ptr<Study>> studies;  ///< of the deck
  /// Where a part of this study keeps a checkpoint of its own. Collective.
  std::function<std::filesystem::path(const std::string& part)> checkpoint_of;

  /// The same work on another machine, which has to outlive it.
  [[nodiscard]] Context with(const system::Machine& other) const {
    return {comm, other, layout, results, earlier, summaries, resume, studies, checkpoint_of};
  }
};

/// One analysis of a deck.
class Study {
public:
  Study() = default;
  Study(const Study&) = delete;
  Study& operator=(const Study&) = delete;
  virtual ~Study() = default;
  /// Its key in decks.
  [[nodiscard]] virtual std::string_view kind() const = 0;
  /// Its name in results: that of the deck, or the kind.
  [[nodiscard]] virtual std::string name() const = 0;
  /// True if a study `other` may be one that this one adds to the results, under the name of its files
  /// (io::plain_name).
  [[nodiscard]] virtual bool may_add(std::string_view /*other*/) const { return false; }
  /// True if it asks about a rotor in bearings, so that a deck of another system cannot have it.
  [[nodiscard]] virtual bool needs_rotor() const { return true; }
  /// True if the shaft of a rotor has to stand in bearings for it.
  [[nodiscard]] virtual bool needs_bearings() const { return true; }
  /// True if it may look at a rotor with a loss factor: at rest, or at vibration with one frequency.
  [[nodiscard]] virtual bool takes_hysteresis() const { return false; }
  /// Reports options that do not fit the machine; `report` starts at the study's options. Solves nothing.
  virtual void validate(const system::Machine& machine, const deck::Report& report) const = 0;
  /// The same for what does not fit the studies before it in the deck.
  virtual void validate_among(std::span<const std::unique_ptr<Study>> /*before*/,
                              const deck::Report& /*report*/) const {}
  /// Memory that it takes in all ranks together, estimated from counts [bytes]; what is always small counts as nothing.
  /// The deck was read but may still be wrong.
  [[nodiscard]] virtual double memory(const system::Machine& /*machine*/, const LayoutOptions& /*layout*/) const {
    return 0;
  }
  /// Names of the unbalances that it applies to the machine.
  [[nodiscard]] virtual std::vector<std::string> unbalances() const { return {}; }
  /// Speeds of the shaft that it asks for, in no order; of a range both ends [rad/s].
  [[nodiscard]] virtual std::vector<double> speeds() const { return {}; }
  /// Name of the study whose bifurcations this one goes on from; empty if it needs none.
  [[nodiscard]] virtual std::string starts_from() const { return {}; }
  /// True if that study is `earlier`, or one that `earlier` adds to the results.
  [[nodiscard]] bool goes_on_from(const Study& earlier) const;
  /// Computes; ends with `return context.results.finish(...)`. Throws core::NotConverged or core::DomainError if it can
  /// deliver nothing. Collective.
  [[nodiscard]] virtual StudyResult run(Context& context) = 0;
  /// What a reader wants to know of its result first; `before` are the studies that ended earlier. It solves nothing.
  [[nodiscard]] virtual io::Brief brief(const StudyResult& /*result*/,
                                        std::span<const io::StudySummary> /*before*/) const {
    return {};
  }
  /// Studies that its result calls for, each with results of its own: the branches born at the flips it found.
  [[nodiscard]] virtual std::vector<std::unique_ptr<Study>> further(const io::Group& /*result*/) const { return {}; }
};

/// Runs `study`; what it cannot deliver is a result with a reason. Collective.
[[nodiscard]] StudyResult result_of(Study& study, Context& context);

/// `unbalance` of options that have it.
template <class Options>
std::vector<std::string> unbalances_of(const Options& o) {
  if constexpr (requires { o.unbalance.front().size(); })
    return o.unbalance;
  else if constexpr (requires { o.orbits->unbalance; })
    return o.orbits ? o.orbits->unbalance : std::vector<std::string>();
  else
    return {};
}

/// Those of `speed`, `speeds` and `operating_speed`, and the ends of `range` and of the range of the parameter where
/// that is the speed. Options with one `speed` have a `range` of something else.
template <class Options>
std::vector<double> speeds_of(const Options& o) {
  std::vector<double> all;
  const auto add = [&all](const auto& x) {
    if constexpr (requires { x.from; }) {
      all.push_back(x.from);
      all.push_back(x.to);
    } else if constexpr (requires { x.value; })
      all.push_back(x.value);
    else
      all.push_back(x);
  };
  const auto each = [&add](const auto& x) {
    if constexpr (requires { x.has_value(); }) {
      if (x) add(*x);
    } else if constexpr (requires { x.begin(); }) {
      for (const auto& one : x) add(one);
    } else {
      add(x);
    }
  };
  if constexpr (requires { o.parameter.path; })
    if (o.parameter.path == "speed") add(o.parameter.range);
  if constexpr (requires { o.speed; })
    each(o.speed);
  else if constexpr (requires { o.range; })
    each(o.range);
  if constexpr (requires { o.speeds; }) each(o.speeds);
  if constexpr (requires { o.operating_speed; }) each(o.operating_speed);
  return all;
}

/// A text as the argument of a template.
template <std::size_t n>
struct Key {
  constexpr Key(const char (&from)[n]) { std::copy_n(from, n, text); }
  char text[n];
};

/// What all kinds share: a key in decks, and options with a `name`.
template <class Options, Key of_kind>
class StudyWith : public Study {
public:
  static constexpr std::string_view key = of_kind.text;
  [[nodiscard]] std::string_view kind() const override { return key; }
  using Given = Options;
  /// As the deck gives them.
  [[nodiscard]] const Options& given() const { return options; }
  /// Where the options of a study of this kind are read to.
  [[nodiscard]] static void* place(Study& study) { return &static_cast<StudyWith&>(study).options; }
  [[nodiscard]] std::string name() const override { return options.name.empty() ? std::string(kind()) : options.name; }
  [[nodiscard]] std::vector<std::string> unbalances() const override { return unbalances_of(options); }
  [[nodiscard]] std::vector<double> speeds() const override { return speeds_of(options); }

protected:
  Options options;
};

/// All kinds, in the order in which they are listed.
[[nodiscard]] const std::vector<deck::Kind<Study>>& kinds();

// Checks that several studies share.

/// Names of unbalances must exist in the machine.
void check_unbalance(const std::vector<std::string>& names, const system::Machine& machine, const deck::Report& report);
/// Nodes must exist in the shaft.
void check_nodes(const std::string& key, const std::vector<int>& nodes, const system::Machine& machine,
                 const deck::Report& report);
/// No film carries a load at rest, but linear ones, which have coefficients there: `key` asks for the speed zero.
void check_carried_at_rest(const std::string& key, const system::Machine& machine, const deck::Report& report);
/// Springs or rigid supports at the nodes of the bearings must hold every part of a shaft with hinges.
void check_held(const system::Machine& machine, const deck::Report& report);

}  // namespace whirl::study
