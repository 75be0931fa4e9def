#include "whirl/study/deck.hpp"

#include <fmt/core.h>

#include <map>

#include "cost.hpp"
#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"
#include "whirl/io/record.hpp"

namespace whirl::study {

namespace {

// Files are named by studies, with endings such as ` flip 12.checkpoint.h5`, and most file systems take 255 bytes.
constexpr std::size_t longest_name = 150;

void check_names(const Deck& deck, std::size_t i, const std::string& path, std::map<std::string, std::size_t>& taken,
                 const deck::Report& r) {
  const Study& s = *deck.studies[i];
  if (s.name().size() > longest_name)
    return r.fail(path + ".name", fmt::format("the name of a study has at most {} bytes, since files are named by it; "
                                              "this one has {}",
                                              longest_name, s.name().size()));
  const auto [first, fresh] = taken.emplace(io::safe_name(s.name()), i);
  if (!fresh)
    r.fail(path + ".name", fmt::format("study {} is called '{}' already: give each a name of its own",
                                       first->second + 1, deck.studies[first->second]->name()));
}

}  // namespace

void describe(deck::Description<Limits>& d) {
  d.add("memory", &Limits::memory, "byte", deck::positive,
        "of all ranks together, above which a study is refused before it begins; its need is estimated from counts");
}

void describe(deck::Description<Deck>& d) {
  d.embed(&Deck::machine);
  d.choices("studies", &Deck::studies, kinds(), "what to compute, in this order");
  d.add("limits", &Deck::limits, "what a run may take");
  d.check([](const Deck& deck, const deck::Report& r) {
    std::map<std::string, std::size_t> taken;
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
      check_names(deck, i, path, taken, r);
      if (const double bytes = s.memory(deck.machine); bytes > deck.limits.memory)
        r.fail(path, fmt::format("'{}' needs about {} of memory, and limits.memory is {}", s.name(),
                                 deck::write_memory(bytes), deck::write_memory(deck.limits.memory)));
    }
  });
}

Deck load(MPI_Comm comm, const std::string& path, const std::vector<std::string>& overrides) {
  const deck::Files files(comm);
  std::vector<deck::Change> changes;
  const deck::Node root = deck::load(path, overrides, files, deck::structure_of<Deck>(), &changes);
  deck::Problems problems;
  auto d = deck::read<Deck>(root, files, problems);
  try {
    problems.raise();
  } catch (core::InputError& e) {
    e.mark_agreed();  // every rank read the same bytes
    throw;
  }
  d.changes = std::move(changes);
  return d;
}

std::string resolved_text(const Deck& d) {
  return deck::to_yaml(deck::write(d));
}

}  // namespace whirl::study
