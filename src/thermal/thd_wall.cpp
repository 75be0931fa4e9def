#include "thermal/thd_wall.hpp"

#include <algorithm>
#include <cmath>

#include "thermal/bush.hpp"
#include "thermal/journal.hpp"

namespace whirl::thermal {

using core::check;

namespace {

// Between the rounds film and solid meet in Robin conditions, p of the film's and q of the solid's (Gander 2006,
// optimized Schwarz methods). To a change along the wall of the wave number w the film answers with F >= k/h, the more
// the faster it is carried past, and the solid with S = k w; a round leaves |p - S|/(p + F) |q - F|/(q + S) of it. q =
// k/h, that of the film from wall to wall, ends what changes slowly. p is S from node to node: of metal that is as good
// as the solid's temperature itself, and a solid that conducts less than the film takes no more rounds. p = q = 8 k/h
// took 31 rounds of a gas film and 20 of an oil film of 1e5 cells, growing with the mesh; this 18 and 13.
double solid_answers(double conductivity, const Mesh& mesh) {
  return 0.5 * conductivity * mesh.nodes_around() / mesh.radius;
}

// The solid behind the wall: a ring as long as the film, or a shaft that may be longer.
Solid solid_of(const Rows& rows, const WallOptions& o, bool is_journal) {
  const auto free = [&o](double coefficient) { return Surface{Surface::Kind::convection, coefficient, o.ambient}; };
  const auto common = [&](auto part) {
    part.material.conductivity = o.conductivity;
    part.material.expansion = o.expansion;
    part.layers = o.layers;
    const Surface surface = free(o.convection);
    part.surfaces = {surface, surface, surface, surface};
    return part;
  };
  if (!is_journal) {
    Bush bush = common(Bush());
    bush.outer_radius = o.radius;
    return make_solid(rows, bush);
  }
  Journal journal = common(Journal());
  journal.bore_radius = o.radius;
  journal.length = o.shaft_length > 0 ? o.shaft_length : rows.mesh().length;
  journal.before = o.shaft_before;
  journal.surfaces.inner = free(o.bore_convection.value_or(o.convection));
  return make_solid(rows, journal);
}

}  // namespace

ThdWall::ThdWall(const Rows& rows, const WallOptions& o, bool is_journal, double film_conductivity,
                 const std::vector<double>& cold, const std::vector<double>& half,
                 const std::vector<double>& temperature)
    : options(o),
      behind(half.size(), o.temperature),
      half_(half),
      temperature_(temperature),
      across_(static_cast<std::size_t>(rows.mesh().across)),
      layer_(is_journal ? across_ - 1 : 0),
      conductance_(half) {
  if (is_adiabatic()) conductance_.assign(half.size(), 0.0);
  if (o.type != WallOptions::Type::solid) return;
  solid.emplace(solid_of(rows, o, is_journal));
  solid->join(half);
  conductance_ = solid->joined();
  for (std::size_t c = 0; c < half.size(); ++c) {
    resistance_.push_back(1 / conductance_[c] - 1 / half[c]);
    const double own = half[c] / (2 * rows.mesh().across);
    robin_.push_back(std::min(own, 0.5 * conductance_[c]));
    // A journal that turns has one temperature around: no wave there moves it.
    beyond_.push_back(
        resistance_[c] == 0 ? 0 : film_conductivity / (solid_answers(o.conductivity, rows.mesh()) * own * cold[c]));
  }
  seen.assign(half.size(), o.ambient);
  behind = seen;
  solid_temperature = solid->temperature(o.ambient);
  rhs_ = core::duplicate(solid_temperature.get());
  if (!o.growth || o.expansion <= 0) return;
  rise.assign(static_cast<std::size_t>(rows.count()), 0.0);
  grows_ = (is_journal ? -1 : 1) * o.expansion * solid->shape().wall_radius();
}

void ThdWall::follow() {
  if (is_adiabatic()) return;
  conductance_ = half_;
  if (!solid) return;
  for (std::size_t c = 0; c < half_.size(); ++c) conductance_[c] = 1 / (1 / half_[c] + resistance_[c]);
}

Wall ThdWall::beside_film() const {
  Wall wall{conductance_, solid ? seen : behind};
  for (std::size_t c = 0; c < robin_.size(); ++c) wall.conductance[c] = 1 / (1 / conductance_[c] + beyond_[c]);
  return wall;
}

double ThdWall::surface(std::size_t c) const {
  if (is_adiabatic()) return own(c);  // no gradient
  if (!solid) return behind[c];
  return own(c) + through(c) / (half_[c] * (factor_.empty() ? 1.0 : factor_[c])) * (behind[c] - own(c));
}

void ThdWall::join(bool rounds) {
  if (!solid) return;
  std::vector<double> film_half(half_.size());
  for (std::size_t c = 0; c < half_.size(); ++c)
    film_half[c] = 1 / (1 / (rounds ? robin_[c] : through(c)) - resistance_[c]);
  solid->join(film_half);
}

int ThdWall::conduct(double left) {
  if (!solid) return 0;
  std::vector<double> meets(half_.size());
  for (std::size_t c = 0; c < meets.size(); ++c) {
    const double over = 1 / through(c), more = 1 / robin_[c];
    meets[c] = own(c) + (own(c) - seen[c]) / (over + beyond_[c]) * (more - over);
  }
  solid->load(meets, rhs_.get());
  const int iterations = solid->solve(rhs_.get(), solid_temperature.get(), left);
  PetscInt first = 0;
  check(VecGetOwnershipRange(solid_temperature.get(), &first, nullptr));
  const core::ReadArray t(solid_temperature.get());
  for (std::size_t c = 0; c < meets.size(); ++c) {
    behind[c] = t[solid->wall()[c] - first];
    seen[c] = behind[c] - (meets[c] - behind[c]) * robin_[c] * beyond_[c];
  }
  if (rise.empty()) return iterations;
  rise = solid->growth(solid_temperature.get(), options.reference.value_or(options.ambient));
  for (double& r : rise) r /= std::abs(grows_);
  return iterations;
}

}  // namespace whirl::thermal
