#pragma once
// The kinds of film that make_model() chooses from.

#include <memory>

#include "whirl/film/model.hpp"
#include "whirl/film/state_model.hpp"

namespace whirl::film {

/// Throws core::InputError on values outside the range of films on rigid pads.
void check_pads(const Geometry& geometry, const Options& options, const Lubricant& lubricant);
/// Reynolds' equation on the pads of a bore; throws core::InputError on values outside their range.
std::unique_ptr<Model> make_reynolds(const Geometry& geometry, const Options& options, const Lubricant& lubricant);
/// Short, long or approximate finite-length film of a cylindrical bore; throws core::InputError alike.
std::unique_ptr<Model> make_rigid(const Geometry& geometry, const Options& options, const Lubricant& lubricant);
/// force = -K d - C d' in x and y.
std::unique_ptr<Model> make_linear(const Options& options);

/// Short or long film of a cylindrical bore with an elastic liner; throws core::InputError alike.
std::unique_ptr<StateModel> make_compliant(const Geometry& geometry, const Options& options,
                                           const Lubricant& lubricant);
/// The same of finite length, on a mesh around and along the bearing.
std::unique_ptr<StateModel> make_compliant_finite(const Geometry& geometry, const Options& options,
                                                  const Lubricant& lubricant);
/// Film on rigid pads that conserves its mass, with what its gap holds as states; throws core::InputError alike.
std::unique_ptr<StateModel> make_content(const Geometry& geometry, const Options& options, const Lubricant& lubricant);

}  // namespace whirl::film
