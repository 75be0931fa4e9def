#pragma once
// What a fluid film is made of: bore, lubricant, and how its pressure is computed. Plain data, SI and radians.

#include <concepts>
#include <optional>
#include <type_traits>

#include "whirl/core/error.hpp"
#include "whirl/film/contract/kinds.hpp"

namespace whirl::film {

/// True of the kinds in the list.
template <class K, class... Ks>
[[nodiscard]] constexpr bool is_one_of(const std::variant<Ks...>* /*list*/) {
  return (std::same_as<K, Ks> || ...);
}

/// The options of a film of one kind; by default of the first in the list.
struct Options {
  Kinds kind;

  Options() = default;
  /// A film of kind K: `Options film = Short{};`
  template <class K>
  requires(is_one_of<K>(static_cast<const Kinds*>(nullptr))) Options(K options) : kind(std::move(options)) {}
  friend bool operator==(const Options&, const Options&) = default;
};

/// The options as T, which is a kind or what several kinds have in common (Compliant); null if they are none.
template <class T>
[[nodiscard]] const T* find(const Options& options) {
  return std::visit(
      [](const auto& k) -> const T* {
        if constexpr (std::derived_from<std::remove_cvref_t<decltype(k)>, T>)
          return &k;
        else
          return nullptr;
      },
      options.kind);
}
/// The same; core::Bug if they are none.
template <class T>
[[nodiscard]] T& as(Options& options) {
  const T* found = find<T>(options);
  core::require(found != nullptr, "a film of another kind");
  return const_cast<T&>(*found);
}

/// What others may ask of the film; nothing is made or checked. Only the estimate of `states` needs the bore.
[[nodiscard]] Facts facts(const Options& options, const Geometry& geometry = {});

/// The film with `factor` times as many cells around and along the bearing, at least 4 and even where its quadrature
/// asks for it; itself if it has no mesh.
[[nodiscard]] Options refined(Options options, const std::array<double, 2>& factor);

/// The same film where it follows the tilt of its journal; empty if films of this kind cannot.
[[nodiscard]] std::optional<Options> tilting(Options options);

/// True if both are of the same kind, whatever their options.
[[nodiscard]] bool same_kind(const Options& a, const Options& b);

}  // namespace whirl::film
