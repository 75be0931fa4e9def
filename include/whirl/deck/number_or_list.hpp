#pragma once
// A number that a deck may give as a list of components.

#include <array>
#include <functional>
#include <variant>

#include "whirl/deck/description.hpp"

namespace whirl::deck {

struct NumberOrListAccess {
  std::function<void*(void*)> set_number, set_list;
  std::function<void*(void*)> number, list;  ///< null if it holds the other
};
[[nodiscard]] CodecPtr number_or_list_codec(CodecPtr number, CodecPtr list, NumberOrListAccess access);

/// The bounds apply to the single number. Entries of the list have no bounds.
template <std::size_t N>
struct CodecOf<std::variant<double, std::array<double, N>>> {
  using A = std::array<double, N>;
  using V = std::variant<double, A>;
  static CodecPtr make(const Spec& s) {
    return number_or_list_codec(
        real_codec(s), CodecOf<A>::make({s.unit, any}),
        {.set_number = [](void* v) -> void* { return &static_cast<V*>(v)->template emplace<double>(); },
         .set_list = [](void* v) -> void* { return &static_cast<V*>(v)->template emplace<A>(); },
         .number = [](void* v) -> void* { return std::get_if<double>(static_cast<V*>(v)); },
         .list = [](void* v) -> void* { return std::get_if<A>(static_cast<V*>(v)); }});
  }
};

}  // namespace whirl::deck
