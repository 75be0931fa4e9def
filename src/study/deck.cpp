#include "whirl/study/deck.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <unordered_map>

#include "common.hpp"
#include "make_plant.hpp"
#include "premises.hpp"
#include "sense.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/film/contract/describe.hpp"
#include "whirl/io/record.hpp"
#include "whirl/rotor/advice.hpp"
#include "whirl/rotor/hinges.hpp"
#include "whirl/study/sweep/sweep.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {
namespace {

// Branches that a study adds have names of their own, which no other study may have.
void check_added(const Deck& deck, std::size_t i, const std::vector<std::string>& files, const deck::Report& report) {
  const Study& later = *deck.studies[i];
  for (std::size_t j = 0; j < i; ++j) {
    const Study& earlier = *deck.studies[j];
    if (earlier.may_add(files[i]))
      report.fail("name", fmt::format("study {}, '{}', adds a branch that it calls so: give each a name of its own",
                                      j + 1, earlier.name()));
    else if (later.may_add(files[j]))
      report.fail("name", fmt::format("'{}' adds a branch that it calls '{}', as study {} is called: give each a "
                                      "name of its own",
                                      later.name(), earlier.name(), j + 1));
  }
}

// Each study has files, a group and pictures of its own, and so has each branch that it adds: what those are called
// must differ where only what may stand in the name of a file is left.
void check_names(const Deck& deck, const deck::Report& r) {
  constexpr std::size_t longest = 120;
  std::vector<std::string> files;
  std::unordered_map<std::string, std::size_t> first_with;  // that file
  for (std::size_t i = 0; i < deck.studies.size(); ++i) {
    const Study& s = *deck.studies[i];
    const deck::Report report = r.below(fmt::format("studies.{}.{}", i + 1, s.kind()));
    const std::string name = s.name();
    const std::string& file = files.emplace_back(io::plain_name(name));
    if (name.size() > longest)
      report.fail("name", fmt::format("a name of {} bytes; files are called after it, it has {} at most", name.size(),
                                      longest));
    if (std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }))
      report.fail("name", "a name has no tabulators, line ends or other control characters");
    const auto [same, fresh] = first_with.emplace(file, i);
    const std::size_t j = same->second;
    if (!fresh && deck.studies[j]->name() == name)
      report.fail("name", fmt::format("study {} is called '{}' already: give each a name of its own", j + 1, name));
    else if (!fresh)
      report.fail("name",
                  fmt::format("study {} is called '{}', and the files of both are '{}': give each a name of its own",
                              j + 1, deck.studies[j]->name(), file));
    else
      check_added(deck, i, files, report);
  }
}

// A shaft in two bearings or other supports at least, which leave no part of it free to move.
void check_supports(const system::Machine& machine, const deck::Report& r) {
  const std::vector<int> nodes = system::support_nodes(machine);
  if (nodes.size() < 2)
    return r.fail("bearings", "a shaft needs bearings, or elements that are supports, at two nodes at least");
  std::vector<int> slopes;
  for (const system::Bearing& b : machine.bearings)
    if (film::facts(b.film).tilts) slopes.push_back(b.node);
  if (const auto loose = rotor::loose_part(machine.rotor, nodes, slopes))
    r.fail(fmt::format("rotor.couplings.{}.tilt_stiffness", loose->coupling + 1),
           rotor::words(*loose, machine.rotor, "by its bearings"));
}

// From where it rested last, else as studies find an equilibrium.
class ByNewton : public system::RestFinder {
public:
  void find(system::RotorSystem& machine, Vec x, bool near) const override {
    if (near) {
      const core::Vector trial = core::duplicate(x);
      core::check(VecCopy(x, trial.get()));
      if (find_rest(machine, trial.get()).converged) return core::check(VecCopy(trial.get(), x));
    }
    core::check(VecCopy(find_rest(machine).get(), x));
  }
};

}  // namespace

Deck::Deck() {
  static const ByNewton by_newton;
  machine.rest = &by_newton;
}

void describe(deck::Description<Limits>& d) {
  d.add("memory", &Limits::memory, "byte", deck::positive,
        "of all ranks together, above which a study is refused before it begins; its need is estimated from counts");
}

namespace {

void check_memory(const Study& study, const Deck& deck, std::string_view path, const deck::Report& report) {
  const double bytes = study.memory(deck.machine, layout_of(deck));
  if (bytes > deck.limits.memory)
    report.fail(path, fmt::format("'{}' needs about {} of memory, and limits.memory is {}", study.name(),
                                  deck::write_memory(bytes), deck::write_memory(deck.limits.memory)));
}

}  // namespace

void describe(deck::Description<Deck>& d) {
  d.embed(&Deck::machine);
  d.choices("studies", &Deck::studies, kinds(), "what to compute, in this order");
  d.add("limits", &Deck::limits, "what a run may take");
  d.add("layout", &Deck::layout, "how ranks share the work, and how much of it error bars may take");
  d.add("bars", &Deck::bars, "where the error bars of results come from");
  d.check([](const Deck& deck, const deck::Report& r) {
    const auto holds = [](const auto& s) { return s->needs_bearings(); };
    const bool shaft = system::is_rotor(deck.machine) && deck.machine.rotor.type != rotor::Options::Type::rigid;
    if (shaft && std::any_of(deck.studies.begin(), deck.studies.end(), holds)) check_supports(deck.machine, r);
    for (std::size_t i = 0; i < deck.studies.size(); ++i) {
      const Study& s = *deck.studies[i];
      const std::string path = fmt::format("studies.{}.{}", i + 1, s.kind());
      if (s.needs_rotor() && !system::is_rotor(deck.machine)) {
        r.fail(path, fmt::format("'{}' asks about a rotor in bearings, and the system of this deck is a {}", s.kind(),
                                 deck.machine.system.name));
        continue;
      }
      if (deck.machine.rotor.loss_factor > 0 && !s.takes_hysteresis())
        r.fail(path, fmt::format(
                         "'{}' cannot take a 'loss_factor': its force is defined of vibration with one frequency, not "
                         "in time. 'modes', 'unbalance_response' and 'frequency_response' take it; here use "
                         "'internal_damping'",
                         s.kind()));
      s.validate(deck.machine, r.below(path));
      s.validate_among({deck.studies.data(), i}, r.below(path));
      check_memory(s, deck, path, r);
    }
    check_names(deck, r);
  });
}

LayoutOptions layout_of(const Deck& deck) {
  LayoutOptions layout = deck.layout;
  layout.bars = deck.bars;
  return layout;
}

Deck load(MPI_Comm comm, const std::string& path, const std::vector<std::string>& overrides) {
  const deck::Files files(comm);
  std::vector<deck::Change> changes;
  const deck::Node root = deck::load(path, overrides, files, deck::structure_of<Deck>(), &changes);
  deck::Problems problems;
  auto d = deck::read<Deck>(root, files, problems);
  // Variants of a deck with errors would only repeat them, and those with errors have no decks.
  for (std::size_t i = 0; i < d.studies.size() && problems.empty(); ++i)
    if (auto* sweep = dynamic_cast<Sweep*>(d.studies[i].get())) {
      sweep->prepare(root, {d.studies.data(), i}, files, problems);
      if (problems.empty()) check_memory(*sweep, d, fmt::format("studies.{}.sweep", i + 1), {root, problems});
    }
  try {
    problems.raise();
  } catch (core::InputError& e) {
    e.mark_agreed();  // every rank read the same bytes
    throw;
  }
  d.changes = std::move(changes);
  return d;
}

std::vector<std::string> unusual(const system::Machine& machine, BarsFrom bars) {
  std::vector<std::string> all = unusual_lubricants(machine);
  for (std::string& line : unusual_material(machine)) all.push_back(std::move(line));
  for (std::string& line : negative_damping(machine)) all.push_back(std::move(line));
  const auto add = [&all](std::vector<std::string> lines) { all.insert(all.end(), lines.begin(), lines.end()); };
  add(rotor::impossible_inertias(machine.rotor));
  add(rotor::advice(machine.rotor));
  add(machine_warnings(machine));
  constexpr std::size_t enough = 5;
  for (const system::Element& e : machine.elements)
    if (!e.table.empty() && e.table.size() < enough)
      all.push_back(
          fmt::format("element {}: its table has {} rows; with fewer than {} the curve between them is a guess", e.name,
                      e.table.size(), enough));
  if (bars == BarsFrom::none)
    all.emplace_back(
        "bars: none: the errors of the meshes are not estimated. Stability and margins are those of the meshes in use; "
        "whether a bifurcation is supercritical is undetermined");
  return all;
}

std::vector<std::string> warnings(const Deck& d) {
  std::vector<std::string> all = unusual(d.machine, d.bars);
  for (const auto& s : d.studies)
    for (std::string& line : table_warnings(d.machine, *s)) all.push_back(std::move(line));
  const std::vector<std::string> own = all;
  for (const auto& s : d.studies) {
    const auto* sweep = dynamic_cast<const Sweep*>(s.get());
    if (!sweep) continue;
    for (const Variant& v : sweep->variants())
      for (const std::string& line : warnings(*v.deck))
        if (std::find(own.begin(), own.end(), line) == own.end())
          all.push_back(fmt::format("variant '{}' of '{}': {}", v.name, sweep->name(), line));
  }
  return all;
}

std::string resolved_text(const Deck& d) {
  return deck::to_yaml(deck::write(d));
}

}  // namespace whirl::study
