#include "whirl/film/model.hpp"

#include "whirl/core/error.hpp"
#include "whirl/film/state_model.hpp"

namespace whirl::film {
namespace {

template <class Wanted>
std::unique_ptr<Wanted> made(const Geometry& geometry, const Options& options, const Lubricant& lubricant) {
  Made film = make_film(geometry, options, lubricant);
  auto* wanted = std::get_if<std::unique_ptr<Wanted>>(&film);
  core::require(wanted != nullptr, "a film is made with own states if and only if it has any");
  return std::move(*wanted);
}

}  // namespace

Made make_film(const Geometry& geometry, const Options& options, const Lubricant& lubricant) {
  return std::visit([&](const auto& k) { return make(geometry, k, lubricant); }, options.kind);
}

std::unique_ptr<Model> make_model(const Geometry& geometry, const Options& options, const Lubricant& lubricant) {
  return made<Model>(geometry, options, lubricant);
}

std::unique_ptr<StateModel> make_state_model(const Geometry& geometry, const Options& options,
                                             const Lubricant& lubricant) {
  return made<StateModel>(geometry, options, lubricant);
}

Facts facts(const Options& options, const Geometry& geometry) {
  return std::visit([&](const auto& k) { return facts_of(k, geometry); }, options.kind);
}

bool has_states(const Options& options) {
  return facts(options).own_states;
}

Options refined(Options options, const std::array<double, 2>& factor) {
  std::visit(
      [&](auto& k) {
        if constexpr (requires { refine(k, factor); }) refine(k, factor);
      },
      options.kind);
  return options;
}

bool same_kind(const Options& a, const Options& b) {
  return a.kind.index() == b.kind.index();
}

}  // namespace whirl::film
