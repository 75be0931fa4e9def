#include "study/linear/line_modes.hpp"

#include <fmt/core.h>

#include "study/bars/verdict.hpp"
#include "study/common.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/rotor/lines.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::study {

// Small: every rank computes the same.
StudyResult line_modes(Context& context, const ModesOptions& options) {
  const bool torsion = options.motion == ModesOptions::Motion::torsion;
  rotor::Options shaft = context.machine.rotor;
  shaft.reduction = {};
  rotor::LineModes modes;
  core::agree(context.comm, [&] {
    modes = rotor::line_modes(shaft, torsion ? rotor::Line::torsion : rotor::Line::axial, options.held, options.count);
  });
  auto& summary = context.results.summary();
  std::vector<double> flat;
  for (std::size_t k = 0; k < modes.frequencies.size(); ++k) {
    summary.set(fmt::format("frequency.{}", k + 1), modes.frequencies[k], "rad/s");
    summary.modes.push_back(
        {0, 0, modes.frequencies[k], 0, torsion ? "torsion" : "axial", "rad/s", {}, name_of(StabilityClass::undamped)});
    flat.insert(flat.end(), modes.shapes[k].begin(), modes.shapes[k].end());
  }
  const std::vector<double> z = rotor::node_positions(context.machine.rotor);
  auto& spectrum = context.results.group().child("spectrum");
  spectrum.put("frequency", modes.frequencies, "rad/s",
               torsion ? "undamped natural frequencies of torsion" : "undamped natural frequencies along the shaft");
  auto& line = context.results.group().child("line");
  line.put("z", z, "m", "axial position of the nodes");
  line.put(
      "shape", {modes.frequencies.size(), z.size()}, flat, "1",
      torsion ? "angle of twist [mode][node], largest one" : "displacement along the shaft [mode][node], largest one");
  summary.points = 1;
  return context.results.finish("completed", true);
}

}  // namespace whirl::study
