#pragma once
// Values that a deck may give in any form: they are kept as the tree that was written.

#include "whirl/deck/codecs.hpp"

namespace whirl::deck {

/// Keeps a map as it stands, `words` say what it may hold. Tables that it names are read and take the place of their
/// names, so that the resolved deck needs no other file.
[[nodiscard]] CodecPtr raw_map_codec(std::string words);

template <>
struct CodecOf<Node> {
  static CodecPtr make(const Spec&) { return raw_map_codec("a map"); }
};

}  // namespace whirl::deck
