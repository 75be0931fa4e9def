// What all compliant films share.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "film/wall/compliant.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/pivoted_lu.hpp"

namespace whirl::film {
namespace {

using std::numbers::pi;

// Flexibility U/p of the liner [m/Pa].
double flexibility(const Geometry& g, const Compliant& o, const Lubricant& lubricant) {
  if (o.liner)
    return o.liner->thickness * (1.0 + o.liner->poisson) * (1.0 - 2.0 * o.liner->poisson) /
           (o.liner->modulus * (1.0 - o.liner->poisson));
  return *o.compliance * g.clearance * g.clearance * g.clearance /
         (6.0 * lubricant.viscosity * o.reference_speed * g.radius * g.radius);
}

// Throws core::InputError unless bore, lubricant and liner make a compliant film.
const Geometry& checked(const Geometry& g, const Compliant& options, int along, const Lubricant& lubricant) {
  if (g.type != Geometry::Bore::cylindrical) throw core::InputError("film: a compliant film needs a cylindrical bore");
  if (!(g.radius > 0.0 && g.length > 0.0 && g.clearance > 0.0))
    throw core::InputError("film: radius, length and clearance must be positive");
  if (!(lubricant.viscosity > 0.0)) throw core::InputError("film: the viscosity must be positive");
  if (options.liner.has_value() == options.compliance.has_value())
    throw core::InputError("film: a compliant film has either a liner or a compliance");
  if (options.compliance && !(*options.compliance > 0.0 && options.reference_speed > 0.0))
    throw core::InputError("film: the compliance and its reference speed must be positive");
  if (options.liner && !(options.liner->thickness > 0.0 && options.liner->modulus > 0.0 &&
                         options.liner->poisson >= 0.0 && options.liner->poisson < 0.5))
    throw core::InputError("film: thickness and modulus of the liner must be positive, Poisson's ratio below 1/2");
  if (!(options.liner_damping >= 0.0)) throw core::InputError("film: the damping of the liner must not be negative");
  if (options.rubber_thickness && !(*options.rubber_thickness > 0.0))
    throw core::InputError("film: the thickness of the rubber must be positive");
  if (options.contact && !(options.contact->roughness > 0.0 && options.contact->pressure > 0.0))
    throw core::InputError("film: roughness and pressure of the contact must be positive");
  if (options.cells[0] < 4 || (along != 0 && along < 2))
    throw core::InputError("film: a compliant film needs at least 4 cells around and 2 along the bearing");
  if (options.quadrature == Compliant::Quadrature::simpson && (options.cells[0] % 2 != 0 || along % 2 != 0))
    throw core::InputError("film: Simpson's rule needs even numbers of cells");
  return g;
}

}  // namespace

CompliantScales::CompliantScales(const Geometry& g, const Compliant& options, const Lubricant& lubricant) {
  const double ratio = g.radius / g.clearance;
  pressure = 6.0 * lubricant.viscosity * ratio * ratio;
  force = pressure * g.length * g.radius;
  liner = flexibility(g, options, lubricant) * pressure / g.clearance;
}

Neighbours::Neighbours(Compliant::Differences which) {
  switch (which) {
    case Compliant::Differences::central:
      slope = {0.0, -0.5, 0.0, 0.5};
      face = {0.0, 0.5, 0.5, 0.0};
      return;
    case Compliant::Differences::upwind:
      slope = {0.5, -2.0, 1.5, 0.0};
      face = {-0.125, 0.75, 0.375, 0.0};
      reach = 2;
      return;
    case Compliant::Differences::third_order:
      slope = {1.0 / 6.0, -1.0, 0.5, 1.0 / 3.0};
      face = {0.0, 0.5, 0.5, 0.0};
      reach = 2;
      return;
  }
  throw core::Bug("differences without weights");
}

CompliantModel::CompliantModel(const Geometry& geometry, const Compliant& options, int along,
                               const Lubricant& lubricant)
    : g_(checked(geometry, options, along, lubricant)),
      viscosity_(lubricant.viscosity),
      scales_(geometry, options, lubricant),
      liner_(geometry, options, scales_.liner, scales_.pressure),
      neighbours_(options.differences),
      ring_(options.cells[0], options.quadrature) {}

std::vector<double> CompliantModel::balanced_rates(const JournalMotion& motion, std::span<const double> states) {
  const auto n = static_cast<Eigen::Index>(states.size());
  std::vector<double> rates(states.size(), 0.0);
  if (constant_rates()) return rates;
  StateResponse at;
  evaluate(motion, states, rates, Need::tangents, at);
  std::vector<Eigen::Triplet<double>> entries;
  for_entries(whole(), whole().d_rates, at.d_rates, [&](int i, int j, double v) { entries.emplace_back(i, j, v); });
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const core::PivotedLu<double> lu(matrix);
  if (!lu.regular()) throw core::NotConverged("the rates of the film are singular");
  Eigen::Map<Eigen::VectorXd>(rates.data(), n) = -lu.solve(Eigen::Map<const Eigen::VectorXd>(at.residual.data(), n));
  return rates;
}

// unloaded() gives the thickness over a liner without deflection, which is linear in the place of the journal.
PortColumns CompliantModel::carried_rates() const {
  PortColumns out;
  std::vector<double> centred(states());
  unloaded({}, centred);
  for (std::size_t port = 0; port < ports().size(); ++port) {
    JournalMotion moved;
    moved.position[port] = g_.clearance;
    std::vector<double>& column = out.emplace_back(states());
    unloaded(moved, column);
    for (std::size_t k = 0; k < column.size(); ++k) column[k] = (column[k] - centred[k]) / g_.clearance;
  }
  return out;
}

void CompliantModel::resize(const Share& share, Need need, StateResponse& response) const {
  const bool tangents = need == Need::tangents;
  const auto rows = static_cast<std::size_t>(share.rows()), n = tangents ? rows : 0;
  const auto k = std::ssize(ports());
  response.journal = {};
  response.residual.resize(rows);
  response.d_states.resize(tangents ? share.d_states.size() : 0);
  response.d_rates.resize(tangents ? share.d_rates.size() : 0);
  response.d_speed.resize(n);
  response.resize(tangents, k, share.rows());
  if (liner_.damped()) response.force_rates.resizeLike(response.forces);
  response.inputs.bottomRows(k).setZero();
}

std::array<NodalField, 4> CompliantModel::empty_fields(std::size_t along) const {
  const std::size_t around = static_cast<std::size_t>(ring_.nodes()) + 1;
  NodalField theta{0, "theta", "rad", {around}, {}}, z{0, "z", "m", {along}, {}};
  for (int k = 0; k <= ring_.nodes(); ++k) theta.values.push_back(ring_.angle(k));
  for (std::size_t j = 0; j < along; ++j)
    z.values.push_back(g_.length * (static_cast<double>(j) / static_cast<double>(along - 1) - 0.5));
  return {theta, z, NodalField{0, "pressure", "Pa", {around, along}, {}},
          NodalField{0, "thickness", "m", {around, along}, {}}};
}

RingQuadrature::RingQuadrature(int n, Compliant::Quadrature rule)
    : n_(n), simpson_(rule == Compliant::Quadrature::simpson), step_(2.0 * pi / n) {
  for (int k = 0; k < n; ++k) {
    cos_.push_back(std::cos(angle(k)));
    sin_.push_back(std::sin(angle(k)));
  }
  for (int k = 0; k < n; ++k) {
    if (!simpson_) {
      full_.push_back(part(k, 1.0, 1.0));
      continue;
    }
    // Half of the two-sided weight of each node on either side of it.
    const double left = (k % 2 == 0 ? 1.0 : 2.0) / 3.0 * step_, right = step_ - left;
    full_.push_back({{-left * cosine(k), -left * sine(k)}, {-right * cosine(k + 1), -right * sine(k + 1)}});
  }
}

double RingQuadrature::angle(int k) const {
  return 0.5 * pi + step_ * k;
}

// Gauss's rule of three points on the positive part of the cell, about its middle.
RingQuadrature::Weights RingQuadrature::part(int k, double a, double b) const {
  constexpr double root = 0.7745966692414834;  // sqrt(3/5)
  constexpr std::array<double, 3> place = {0.5 - 0.5 * root, 0.5, 0.5 + 0.5 * root},
                                  weight = {5. / 18, 4. / 9, 5. / 18};
  const double from = a < 0.0 ? a / (a - b) : 0.0, to = b < 0.0 ? a / (a - b) : 1.0;
  const double middle = 0.5 * (from + to), turn = step_ * (to - from) * root * 0.5, theta = angle(k) + step_ * middle,
               c = std::cos(theta), s = std::sin(theta), ct = std::cos(turn), st = std::sin(turn);
  const std::array<double, 3> cosine = {c * ct + s * st, c, c * ct - s * st},
                              sine = {s * ct - c * st, s, s * ct + c * st};
  Weights out;
  for (std::size_t q = 0; q < 3; ++q) {
    const double x = from + (to - from) * place[q], w = step_ * (to - from) * weight[q];
    const std::array<double, 2> direction = {-w * cosine[q], -w * sine[q]};
    for (std::size_t i = 0; i < 2; ++i) {
      out.left[i] += direction[i] * (1.0 - x);
      out.right[i] += direction[i] * x;
    }
  }
  return out;
}

}  // namespace whirl::film
