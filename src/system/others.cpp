#include "whirl/system/others.hpp"

#include "whirl/core/error.hpp"
#include "whirl/system/options.hpp"

namespace whirl::system {
namespace {

// Calls visit(options of a default-constructed K) for every kind.
template <class... K, class Visit>
void for_each(const Slots<K...>* /*all*/, const Visit& visit) {
  (visit(K{}), ...);
}
constexpr const Others* all = nullptr;

}  // namespace

void describe_others(deck::Description<Machine>& d) {
  for_each(all, [&d]<class K>(const K&) {
    d.add(std::string(K::key), static_cast<K Machine::*>(&Slot<K>::options), std::string(K::text))
        .only(&Machine::system, {SystemName{std::string(K::key)}});
  });
}

std::optional<double> own_forcing(const Machine& machine) {
  std::optional<double> speed;
  for_each(all, [&]<class K>(const K&) {
    if constexpr (requires(const K& k) { k.forced_at(); })
      if (K::key == machine.system.name) speed = static_cast<const Slot<K>&>(machine).options.forced_at();
  });
  return speed;
}

std::unique_ptr<Plant> make_other(MPI_Comm comm, const OptionsAlong<Machine>& along) {
  const std::string wanted = along.at(along.value).system.name;
  std::unique_ptr<Plant> made;
  for_each(all, [&]<class K>(const K&) {
    if (K::key != wanted) return;
    OptionsAlong<K> own{[at = along.at](double p) { return static_cast<const Slot<K>&>(at(p)).options; }, along.value,
                        along.magnitude};
    made = make_system(comm, std::move(own));
  });
  core::require(made != nullptr, "a rotor is made elsewhere");
  return made;
}

}  // namespace whirl::system

namespace whirl::deck {

std::shared_ptr<const Codec> CodecOf<system::SystemName>::make(const Spec&) {
  std::vector<Choice> choices{{"rotor", "a shaft or a rigid mass in bearings"}};
  system::for_each(system::all, [&]<class K>(const K&) {
    choices.push_back({std::string(K::key), std::string(K::text)});
  });
  return choice_codec(
      choices,
      [choices](const void* v) {
        const auto& name = static_cast<const system::SystemName*>(v)->name;
        std::size_t i = 0;
        while (i + 1 < choices.size() && choices[i].name != name) ++i;
        return i;
      },
      [choices](void* v, std::size_t i) { static_cast<system::SystemName*>(v)->name = choices[i].name; });
}

}  // namespace whirl::deck
