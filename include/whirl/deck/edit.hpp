#pragma once
// Changes of a deck's values: what `--set` does, and what a study does that asks the same of several variants.
//
//   PATH = VALUE     PATH leads to a value: `bearings.B2.geometry.clearance`, list items count from 1.
//                    Wildcards stand for several: `bearings.{B2,B3}.geometry.clearance`, `bearings.*.node`, `B*`.
//   VALUE   264 um   replaces what is there (any YAML: quantities, lists, maps, names of tables)
//           -20 um   the same: a sign is part of the value
//           x1.2     multiplies it, each item where it is a list
//           +20 %    raises it by a part of itself, -20 % lowers it
//           by +500 um, by -20 um    adds to it
//           =-20 um  is -20 um itself, where a length with a sign is refused (see apply)
//           (empty)  takes the key away, so that the default holds
//   PATH += VALUE    appends to a list (the items of VALUE if that is a list), joins a map, adds to a number
//
// Factors and offsets work on the value that the deck gives, or on the default of the option where it is silent.

#include <string>
#include <string_view>
#include <vector>

#include "whirl/deck/node.hpp"

namespace whirl::deck {

class Files;
class Structure;

/// One change, not yet applied to a deck.
struct Edit {
  std::string path;     ///< as written, wildcards and all
  bool append = false;  ///< PATH += VALUE
  Node value;
  Place place;  ///< that errors cite
};

/// What an edit did to one value.
struct Change {
  std::string path;    ///< without wildcards
  std::string before;  ///< as the deck had it, or the default, on one line; empty if there was none
  std::string after;   ///< empty if the key was taken away
};

/// How the text of a scalar is to be read: a value, a factor (`x1.2`) or a change (`by -20 um`, `+20 %`); `rest` is
/// what stands behind the `x` or the `by`.
struct Written {
  enum class As { value, factor, change };
  As as = As::value;
  std::string_view rest;
};
[[nodiscard]] Written written_as(std::string_view text);

/// `PATH=VALUE` or `PATH+=VALUE`; VALUE is YAML. Errors, now and later, cite `cited` and the argument (`--set a.b=1`).
/// Names of tables in it are relative to the working directory. Throws core::InputError.
[[nodiscard]] Edit parse_edit(const std::string& argument, std::string_view cited = "--set");

/// The same of a path and a value that stand in a deck; errors cite the place of the value, and names of tables in it
/// are relative to that deck.
[[nodiscard]] Edit make_edit(std::string path, Node value);

/// Applies `edit` to the tree of a deck whose options `structure` describes; reads tables on its way. Every value that
/// it wrote has the edit's place, so that later errors cite it. One Change per value, in the order of the deck.
/// Throws core::InputError if the path leads nowhere or a factor or an offset does not suit the value; whether a plain
/// value suits its option is found when the tree is read. For one version it also refuses a length with a sign on a
/// value that is not zero, which earlier versions added. Collective (tables).
std::vector<Change> apply(const Edit& edit, Node& root, const Structure& structure, const Files& files);

}  // namespace whirl::deck
