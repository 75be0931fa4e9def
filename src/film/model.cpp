#include "whirl/film/model.hpp"

#include "film/kinds.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

std::unique_ptr<Model> make_model(const Geometry& geometry, const Options& options, const Lubricant& lubricant) {
  switch (options.kind) {
    case Options::Kind::reynolds:
      return make_reynolds(geometry, options, lubricant);
    case Options::Kind::short_bearing:
    case Options::Kind::long_bearing:
    case Options::Kind::long_inlet:
    case Options::Kind::finite_approximate:
      return make_rigid(geometry, options, lubricant);
    case Options::Kind::linear:
      return make_linear(options);
    case Options::Kind::compliant_short:
    case Options::Kind::compliant_long:
    case Options::Kind::compliant_finite:
      break;
  }
  throw core::Bug("film kind without a maker");
}

bool has_liner(Options::Kind kind) {
  using enum Options::Kind;
  return kind == compliant_short || kind == compliant_long || kind == compliant_finite;
}

bool has_states(const Options& o) {
  return has_liner(o.kind) ||
         (o.kind == Options::Kind::reynolds && o.cavitation == Options::Cavitation::mass_conserving &&
          o.states == Options::States::dynamic);
}

bool has_mesh(Options::Kind kind) {
  return kind == Options::Kind::reynolds || has_liner(kind);
}

bool has_mesh_along(Options::Kind kind) {
  return kind == Options::Kind::reynolds || kind == Options::Kind::compliant_finite;
}

int estimated_states(const Geometry& geometry, const Options& o) {
  if (!has_states(o)) return 0;
  if (!has_mesh_along(o.kind)) return o.cells[0];
  if (has_liner(o.kind)) return o.cells[0] * o.cells[1];
  return (geometry.type == Geometry::Bore::lemon_bore ? 2 : 1) * o.cells[0] * (o.tilt ? o.cells[1] : o.cells[1] / 2);
}

std::unique_ptr<StateModel> make_state_model(const Geometry& geometry, const Options& options,
                                             const Lubricant& lubricant) {
  if (!has_states(options)) throw core::Bug("this kind of film has no states");
  if (options.kind == Options::Kind::reynolds) return make_content(geometry, options, lubricant);
  if (options.kind == Options::Kind::compliant_finite) return make_compliant_finite(geometry, options, lubricant);
  return make_compliant(geometry, options, lubricant);
}

}  // namespace whirl::film
