#include "study/linear/modes.hpp"

#include <fmt/core.h>

#include <functional>
#include <map>

#include "study/bars/shaft_mesh.hpp"
#include "study/bars/verdict.hpp"
#include "study/layout.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/rotor/divide.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/lines.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::study {
namespace {

// Shafts in question, and how their frequencies are found.
struct Alone {
  const char* whirl;         // as a summary names the modes
  const char* text;          // of the column
  std::string element;       // as a warning names it, if it is not that of the rotor
  double order;              // at which frequencies converge
  std::vector<int> at_rest;  // nodes
  std::function<std::vector<double>(const rotor::Options&, const std::vector<int>& at_rest)> frequencies;
};

// Everything but the shapes.
StudyResult finish(Context& context, const rotor::Options& shaft, const Alone& alone, const std::vector<double>& here) {
  auto& summary = context.results.summary();
  auto& spectrum = context.results.group().child("spectrum");
  spectrum.put("frequency", here, "rad/s", alone.text);
  std::vector<double> bars;
  if (has_shaft_mesh(context.machine, context.layout)) {
    bars = bars_of_shaft(here, shaft, alone.order, [&](int parts) {
      std::vector<int> at_rest;
      for (const int node : alone.at_rest) at_rest.push_back(rotor::node_after(shaft, node, parts));
      return alone.frequencies(rotor::divided(shaft, parts), at_rest);
    });
    spectrum.put("frequency_uncertainty", bars, "rad/s", "estimated error from the mesh of the shaft");
  }
  for (std::size_t k = 0; k < here.size(); ++k) {
    std::map<std::string, double> bar, of_mode;
    if (!bars.empty()) bar["uncertainty"] = of_mode["imag_uncertainty"] = bars[k];
    summary.set(fmt::format("frequency.{}", k + 1), here[k], "rad/s", bar);
    summary.modes.push_back({0, 0, here[k], 0, alone.whirl, "rad/s", of_mode, name_of(StabilityClass::undamped)});
  }
  put_shaft_error(summary, shaft, largest_part(bars, here), alone.element);
  summary.points = 1;
  return context.results.finish("completed", true);
}

// Small: every rank computes the same.
StudyResult line_modes(Context& context, const ModesOptions& options, const rotor::Options& shaft) {
  const bool torsion = options.motion == ModesOptions::Motion::torsion;
  const auto modes_of = [&](const rotor::Options& of, const std::vector<int>& held) {
    rotor::LineModes modes;
    core::agree(context.comm, [&] {
      modes = rotor::line_modes(of, torsion ? rotor::Line::torsion : rotor::Line::axial, held, options.count);
    });
    return modes;
  };
  const Alone alone{
      torsion ? "torsion" : "axial",
      torsion ? "undamped natural frequencies of torsion" : "undamped natural frequencies along the shaft",
      "linear bar elements",
      rotor::line_order,
      options.held,
      [&](const auto& of, const auto& held) { return modes_of(of, held).frequencies; }};
  const rotor::LineModes modes = modes_of(shaft, options.held);
  std::vector<double> flat;
  for (const auto& shape : modes.shapes) flat.insert(flat.end(), shape.begin(), shape.end());
  const std::vector<double> z = rotor::node_positions(context.machine.rotor);
  auto& line = context.results.group().child("line");
  line.put("z", z, "m", "axial position of the nodes");
  line.put(
      "shape", {modes.frequencies.size(), z.size()}, flat, "1",
      torsion ? "angle of twist [mode][node], largest one" : "displacement along the shaft [mode][node], largest one");
  return finish(context, shaft, alone, modes.frequencies);
}

}  // namespace

bool of_shaft_alone(const ModesOptions& options) {
  return options.motion != ModesOptions::Motion::bending || options.supports != ModesOptions::Supports::films;
}

// At rest bending is the same in both planes.
StudyResult modes_of_shaft_alone(Context& context, const ModesOptions& options) {
  rotor::Options shaft = context.machine.rotor;
  shaft.reduction = {};
  if (options.motion != ModesOptions::Motion::bending) return line_modes(context, options, shaft);
  const bool pinned = options.supports == ModesOptions::Supports::pinned;
  const Layout layout = plan(context, Sharing::machine);
  const Alone alone{"planar",
                    "undamped natural frequencies in one plane",
                    "",
                    order_of_shaft(shaft.element),
                    pinned ? system::support_nodes(context.machine) : std::vector<int>{},
                    [&](const auto& of, const auto& pins) {
                      return rotor::natural_frequencies(layout.space, of, pins, options.count);
                    }};
  return finish(context, shaft, alone, alone.frequencies(shaft, alone.at_rest));
}

}  // namespace whirl::study
