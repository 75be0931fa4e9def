// What is asked of a film of any kind.
#include "whirl/film/contract/film.hpp"

namespace whirl::film {

std::unique_ptr<Film> make_film(const Geometry& geometry, const Options& options, const Lubricant& lubricant) {
  return std::visit([&](const auto& k) { return make(geometry, k, lubricant); }, options.kind);
}

Facts facts(const Options& options, const Geometry& geometry) {
  return std::visit([&](const auto& k) { return facts_of(k, geometry); }, options.kind);
}

Options refined(Options options, const std::array<double, 2>& factor) {
  std::visit(
      [&](auto& k) {
        if constexpr (requires { refine(k, factor); }) refine(k, factor);
      },
      options.kind);
  return options;
}

std::optional<Options> tilting(Options options) {
  const bool can = std::visit(
      [](auto& k) {
        if constexpr (requires { k.tilt; }) {
          k.tilt = true;
          return true;
        } else {
          return false;
        }
      },
      options.kind);
  return can ? std::optional(std::move(options)) : std::nullopt;
}

bool same_kind(const Options& a, const Options& b) {
  return a.kind.index() == b.kind.index();
}

}  // namespace whirl::film
