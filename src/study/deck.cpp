#include "whirl/study/deck.hpp"

#include <fmt/core.h>

#include "whirl/deck/load.hpp"
#include "whirl/deck/output.hpp"
#include "whirl/io/record.hpp"

namespace whirl::study {

void describe(deck::Description<Deck>& d) {
  d.embed(&Deck::machine);
  d.choices("studies", &Deck::studies, kinds(), "what to compute, in this order");
  d.check([](const Deck& deck, const deck::Report& r) {
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
      for (std::size_t j = 0; j < i; ++j)
        if (io::safe_name(deck.studies[j]->name()) == io::safe_name(s.name()))
          r.fail(path + ".name", fmt::format("study {} is called '{}' already: give each a name of its own", j + 1,
                                             deck.studies[j]->name()));
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
