#pragma once
// Systems beside the rotor that a deck may describe.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "whirl/system/brusselator.hpp"
#include "whirl/system/flows.hpp"

namespace whirl::system {

template <class Options>
struct Slot {
  Options options;
};
template <class... Options>
struct Slots : Slot<Options>... {};

/// All of them, by their options. A new one has a header with options (`key`, `text`, describe()) and make_system(), a
/// .cpp, and its name here.
using Others = Slots<Brusselator, Lorenz, Rossler, Duffing>;

/// What the equations of a deck are those of: `rotor`, or the key of one of Others.
struct SystemName {
  std::string name = "rotor";
};
[[nodiscard]] inline std::string_view name_of(const SystemName& s) {
  return s.name;
}

struct Machine;

/// The speed [rad/s] at which a machine that is no rotor forces itself; nothing if it does not, and of rotors.
[[nodiscard]] std::optional<double> own_forcing(const Machine& machine);

/// The system named by a machine that is no rotor, as a function of a parameter. Collective.
[[nodiscard]] std::unique_ptr<Plant> make_other(MPI_Comm comm, const OptionsAlong<Machine>& along);

}  // namespace whirl::system

namespace whirl::deck {
template <>
struct CodecOf<system::SystemName> {
  static std::shared_ptr<const Codec> make(const Spec&);
};
}  // namespace whirl::deck
