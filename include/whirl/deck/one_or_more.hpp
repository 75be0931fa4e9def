#pragma once
// A list of numbers that a deck may give as one number.

#include <vector>

#include "whirl/deck/description.hpp"

namespace whirl::deck {

/// `load: 6 kN` is a list of one, `load: [1 kN, -6 kN]` one of two; empty if the deck is silent.
struct OneOrMore {
  std::vector<double> values;
};

template <>
struct CodecOf<OneOrMore> {
  static CodecPtr make(const Spec& s) {
    return list_codec(real_codec(s),
                      {.resize =
                           [](void* v, std::size_t n) {
                             static_cast<OneOrMore*>(v)->values.assign(n, 0.0);
                             return true;
                           },
                       .size = [](const void* v) { return static_cast<const OneOrMore*>(v)->values.size(); },
                       .at = [](void* v, std::size_t i) -> void* { return &static_cast<OneOrMore*>(v)->values[i]; }});
  }
};

}  // namespace whirl::deck
