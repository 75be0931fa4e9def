#include <fmt/core.h>

#include "study/cost.hpp"
#include "study/linear/frequency_response.hpp"

namespace whirl::study {

std::span<const deck::Name<Along>> names(Along) {
  using enum Along;
  static constexpr deck::Name<Along> table[] = {
      {x, "x", "to the right"},
      {y, "y", "upwards"},
      {slope_x, "slope_x", "slope dx/dz, with the moment that does work with it"},
      {slope_y, "slope_y", "slope dy/dz, likewise"}};
  return table;
}

std::span<const deck::Name<TransferOutput::Quantity>> names(TransferOutput::Quantity) {
  using enum TransferOutput::Quantity;
  static constexpr deck::Name<TransferOutput::Quantity> table[] = {{displacement, "displacement", "receptance"},
                                                                   {velocity, "velocity", "mobility"},
                                                                   {acceleration, "acceleration", "accelerance"}};
  return table;
}

std::span<const deck::Name<FrequencyResponseOptions::Spacing>> names(FrequencyResponseOptions::Spacing) {
  using enum FrequencyResponseOptions::Spacing;
  static constexpr deck::Name<FrequencyResponseOptions::Spacing> table[] = {{linear, "linear", "equal differences"},
                                                                            {log, "log", "equal ratios"}};
  return table;
}

namespace {

template <class Point>
void check_place(deck::Description<Point>& d) {
  d.check([](const Point& p, const deck::Report& r) {
    if (p.node.has_value() == !p.bearing.empty()) r.fail("", "give either 'node' or 'bearing'");
    if (!p.bearing.empty() && (p.direction == Along::slope_x || p.direction == Along::slope_y))
      r.fail("direction", "bearings are x or y; give the node of the journal for its slopes");
  });
}

// Problems of the places of inputs or outputs on this machine.
template <class Point>
void check_points(const std::string& key, const std::vector<Point>& points, const system::Machine& machine,
                  const deck::Report& report) {
  const int nodes = static_cast<int>(machine.rotor.segments.size()) + 1;
  const bool rigid = machine.rotor.type == rotor::Options::Type::rigid;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string path = fmt::format("{}.{}", key, i + 1);
    if (points[i].node.value_or(0) > nodes)
      report.fail(path + ".node",
                  fmt::format("node {} does not exist: the shaft has nodes 1 to {}", *points[i].node, nodes));
    if (!points[i].bearing.empty() && !system::find_bearing(machine, points[i].bearing))
      report.fail(path + ".bearing", fmt::format("there is no bearing '{}'", points[i].bearing));
    if (rigid && (points[i].direction == Along::slope_x || points[i].direction == Along::slope_y))
      report.fail(path + ".direction", "a rigid rotor does not tilt");
  }
}

}  // namespace

void describe(deck::Description<TransferInput>& d) {
  using P = TransferInput;
  d.add("node", &P::node, deck::positive, "node of the shaft on which a force or moment acts");
  d.add("bearing", &P::bearing, "instead of a node: a force on its journal, and the opposite one on its pedestal");
  d.add("direction", &P::direction, "along which it acts");
  check_place(d);
}

void describe(deck::Description<TransferOutput>& d) {
  using P = TransferOutput;
  d.add("node", &P::node, deck::positive, "node of the shaft whose motion is the answer");
  d.add("bearing", &P::bearing, "instead of a node: the motion of its journal relative to its pedestal");
  d.add("direction", &P::direction, "along which it is measured");
  d.add("quantity", &P::quantity, "which motion is the answer");
  check_place(d);
}

void describe(deck::Description<CoefficientsAt>& d) {
  using P = CoefficientsAt;
  d.add("frequency", &P::frequency, std::string(deck::frequency), deck::non_negative, "at which they hold").required();
  d.add("k_xx", &P::k_xx, "N/m", deck::any, "stiffness, force along x by a motion along x").required();
  d.add("k_xy", &P::k_xy, "N/m", deck::any, "force along x by a motion along y");
  d.add("k_yx", &P::k_yx, "N/m", deck::any, "force along y by a motion along x");
  d.add("k_yy", &P::k_yy, "N/m", deck::any, "force along y by a motion along y").required();
  d.add("c_xx", &P::c_xx, "N s/m", deck::any, "damping, likewise").alias("b_xx");
  d.add("c_xy", &P::c_xy, "N s/m", deck::any, "likewise").alias("b_xy");
  d.add("c_yx", &P::c_yx, "N s/m", deck::any, "likewise").alias("b_yx");
  d.add("c_yy", &P::c_yy, "N s/m", deck::any, "likewise").alias("b_yy");
}

void describe(deck::Description<GivenCoefficients>& d) {
  using P = GivenCoefficients;
  d.table("table", &P::table, "stiffness and damping over the frequency, linear between the rows").required();
  d.check([](const P& p, const deck::Report& r) {
    for (std::size_t i = 1; i < p.table.size(); ++i)
      if (!(p.table[i].frequency > p.table[i - 1].frequency))
        return r.fail("table", fmt::format("frequencies rise: row {} does not", i + 1));
    if (p.table.empty()) r.fail("table", "'table' is empty");
  });
}

CoefficientsAt interpolated(const std::vector<CoefficientsAt>& table, double frequency) {
  std::size_t i = 1;
  while (i + 1 < table.size() && table[i].frequency < frequency) ++i;
  if (table.size() == 1) return table.front();
  const CoefficientsAt &a = table[i - 1], &b = table[i];
  const double part = (frequency - a.frequency) / (b.frequency - a.frequency);
  CoefficientsAt out{.frequency = frequency};
  for (const auto member : {&CoefficientsAt::k_xx, &CoefficientsAt::k_xy, &CoefficientsAt::k_yx, &CoefficientsAt::k_yy,
                            &CoefficientsAt::c_xx, &CoefficientsAt::c_xy, &CoefficientsAt::c_yx, &CoefficientsAt::c_yy})
    out.*member = a.*member + part * (b.*member - a.*member);
  return out;
}

void describe(deck::Description<FrequencyResponseOptions>& d) {
  using O = FrequencyResponseOptions;
  d.add("name", &O::name, "name in the results; the kind if not given");
  d.add("speed", &O::speed, "rad/s", deck::non_negative, "shaft speed, which is constant").required().alias("speeds");
  d.add("range", &O::range, std::string(deck::frequency), deck::positive,
        "range of the frequency; results carry its unit")
      .required();
  d.add("points", &O::points, deck::in(2, 1e7), "frequencies in the range, with both ends");
  d.add("spacing", &O::spacing, "how they are spaced");
  d.add("inputs", &O::inputs, "forces and moments, each of which acts by itself").required();
  d.add("outputs", &O::outputs, "motions that answer; displacements along the inputs if empty");
  d.add("coefficients", &O::coefficients,
        "also the response of a machine whose films are stiffness and damping at each frequency, which is the same");
  d.add("constant_at", &O::constant_at, std::string(deck::frequency), deck::positive,
        "also the responses of machines whose films are stiffness and damping at these frequencies");
  d.named(
      "given", &O::given, &GivenCoefficients::bearing,
      "a map BEARING: {table: CSV}: also the response with these coefficients in place of the films of the bearings");
  d.check([](const O& o, const deck::Report& r) {
    if (o.inputs.empty()) r.fail("inputs", "'inputs' is empty");
    if (!(o.range.from < o.range.to)) r.fail("range", "the range rises: give the lower frequency as 'from'");
  });
}

void FrequencyResponse::validate(const system::Machine& machine, const deck::Report& report) const {
  if (machine.rotor.reduction.type == rotor::Reduction::Type::craig_bampton_state)
    return report.fail("",
                       "forces on nodes of a shaft that is reduced in state space are not known here: take another "
                       "rotor.reduction, craig_bampton say");
  check_points("inputs", options.inputs, machine, report);
  check_points("outputs", options.outputs, machine, report);
  for (const GivenCoefficients& g : options.given) {
    const std::string path = "given." + g.bearing;
    if (!system::find_bearing(machine, g.bearing))
      return report.fail(path, fmt::format("there is no bearing '{}'", g.bearing));
    if (g.table.size() > 1 &&
        (options.range.from < g.table.front().frequency || options.range.to > g.table.back().frequency))
      return report.fail(
          path + ".table",
          fmt::format("the table reaches from {:.6g} to {:.6g} rad/s and the frequencies of the study from "
                      "{:.6g} to {:.6g} rad/s",
                      g.table.front().frequency, g.table.back().frequency, options.range.from, options.range.to));
  }
  if (options.speed.value <= 0) check_carried_at_rest("speed", machine, report);
  if (!options.coefficients && options.constant_at.empty() && options.given.empty()) return;
  for (const system::Bearing& b : machine.bearings)
    if (film::facts(b.film).tilts)
      return report.fail(
          options.coefficients ? "coefficients" : "constant_at",
          fmt::format("the film of bearing {} tilts: a linear film has no moments to take its place", b.name));
}

double FrequencyResponse::memory(const system::Machine& machine, const LayoutOptions& /*layout*/) const {
  const double pairs = static_cast<double>(options.inputs.size() * std::max<std::size_t>(1, options.outputs.size()));
  return memory_of_equilibria(machine) +
         64 * pairs * options.points * (2 + static_cast<double>(options.constant_at.size()));
}

}  // namespace whirl::study
