#pragma once
// All kinds of film, in the order in which help lists them. The first is the default.
//
// A kind is a struct of options K with the names `K::key` (in decks) and `K::text` (in help), and beside it
//
//   describe(Description<K>&)             one line per option
//   facts_of(const K&, const Geometry&)   what others may ask (Facts); of the geometry only the estimate of states
//   make(Geometry, K, Lubricant)          the film; throws core::InputError on values outside their range
//   refine(K&, factor)                    of a kind with a mesh: that many times as many cells around and along
//
// Nobody outside this room asks for the kind of a film. One line of the program names one: the first guess of a static
// position stands a train on springs (`Linear`).

#include <variant>

#include "whirl/film/contract/closed_form.hpp"
#include "whirl/film/contract/elastic.hpp"
#include "whirl/film/contract/gas.hpp"
#include "whirl/film/contract/linear.hpp"
#include "whirl/film/contract/reynolds.hpp"
#include "whirl/film/contract/thd.hpp"

namespace whirl::film {

// clang-format off
using Kinds = std::variant<
    Reynolds,
    Thd,
    Gas,
    Linear,
    Short,
    Long,
    LongInlet,
    FiniteApproximate,
    CompliantShort,
    CompliantLong,
    CompliantFinite>;
// clang-format on

}  // namespace whirl::film
