#include "whirl/study/deck.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"
#include "whirl/io/record.hpp"
#include "whirl/rotor/advice.hpp"
#include "whirl/study/sweep.hpp"

namespace whirl::study {
namespace {

// Each study has files, a group and pictures of its own, and so has each branch that it adds: what those are called
// must differ where only what may stand in the name of a file is left.
void check_name(const Deck& deck, std::size_t i, const deck::Report& report) {
  constexpr std::size_t longest = 120;
  const std::string name = deck.studies[i]->name(), file = io::plain_name(name);
  if (name.size() > longest)
    report.fail("name",
                fmt::format("a name of {} bytes; files are called after it, it has {} at most", name.size(), longest));
  if (std::any_of(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; }))
    report.fail("name", "a name has no tabulators, line ends or other control characters");
  for (std::size_t j = 0; j < i; ++j) {
    const Study &earlier = *deck.studies[j], &later = *deck.studies[i];
    if (earlier.name() == name)
      report.fail("name", fmt::format("study {} is called '{}' already: give each a name of its own", j + 1, name));
    else if (io::plain_name(earlier.name()) == file)
      report.fail("name",
                  fmt::format("study {} is called '{}', and the files of both are '{}': give each a name of its own",
                              j + 1, earlier.name(), file));
    else if (earlier.may_add(file))
      report.fail("name", fmt::format("study {}, '{}', adds a branch that it calls so: give each a name of its own",
                                      j + 1, earlier.name()));
    else if (later.may_add(io::plain_name(earlier.name())))
      report.fail("name", fmt::format("'{}' adds a branch that it calls '{}', as study {} is called: give each a "
                                      "name of its own",
                                      name, earlier.name(), j + 1));
  }
}

}  // namespace

void describe(deck::Description<Deck>& d) {
  d.embed(&Deck::machine);
  d.choices("studies", &Deck::studies, kinds(), "what to compute, in this order");
  d.check([](const Deck& deck, const deck::Report& r) {
    const auto holds = [](const auto& s) { return s->needs_bearings(); };
    const bool shaft = system::is_rotor(deck.machine) && deck.machine.rotor.type != rotor::Options::Type::rigid;
    if (shaft && deck.machine.bearings.size() < 2 && std::any_of(deck.studies.begin(), deck.studies.end(), holds))
      r.fail("bearings", "a shaft needs at least two bearings");
    for (std::size_t i = 0; i < deck.studies.size(); ++i) {
      const Study& s = *deck.studies[i];
      const std::string path = fmt::format("studies.{}.{}", i + 1, s.kind());
      if (s.needs_rotor() && !system::is_rotor(deck.machine)) {
        r.fail(path, fmt::format("'{}' asks about a rotor in bearings, and the system of this deck is a {}", s.kind(),
                                 deck.machine.system.name));
        continue;
      }
      s.validate(deck.machine, r.below(path));
      s.validate_among({deck.studies.data(), i}, r.below(path));
      check_name(deck, i, r.below(path));
    }
  });
}

Deck load(MPI_Comm comm, const std::string& path, const std::vector<std::string>& overrides) {
  const deck::Files files(comm);
  std::vector<deck::Change> changes;
  const deck::Node root = deck::load(path, overrides, files, deck::structure_of<Deck>(), &changes);
  deck::Problems problems;
  auto d = deck::read<Deck>(root, files, problems);
  // Variants of a deck with errors would only repeat them.
  for (std::size_t i = 0; i < d.studies.size() && problems.empty(); ++i)
    if (auto* sweep = dynamic_cast<Sweep*>(d.studies[i].get()))
      sweep->prepare(root, {d.studies.data(), i}, files, problems);
  try {
    problems.raise();
  } catch (core::InputError& e) {
    e.mark_agreed();  // every rank read the same bytes
    throw;
  }
  d.changes = std::move(changes);
  return d;
}

std::vector<std::string> warnings(const Deck& d) {
  std::vector<std::string> all = rotor::advice(d.machine.rotor);
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
