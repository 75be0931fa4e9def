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
  }
  throw core::Bug("film kind without a maker");
}

}  // namespace whirl::film
