#include "whirl/study/motion/linearity.hpp"

#include <fmt/core.h>

#include <cmath>

#include "study/common.hpp"
#include "study/growth.hpp"
#include "study/motion/linearity_run.hpp"
#include "study/pieces.hpp"

namespace whirl::study {

StudyResult Linearity::run(Context& context) {
  auto& results = context.results;
  const Layout layout = plan(context, Sharing::speeds);
  LinearityRunner runner(context, layout, options);
  Pieces pieces(results, context.resume, options.checkpoint);
  const Trail nothing{[] { return std::vector<double>{}; }, [](const std::vector<double>&) {}};
  const auto level = [&](std::size_t k) {
    return runner.record(options.levels[k], [&](double share) {
      results.progress(fmt::format("{}: {:.4g} N, {:.0f} %, {:.1f} s", results.summary().name, options.levels[k],
                                   100 * share, results.seconds()));
    });
  };
  std::vector<LinearityRecord> records;
  for (const auto& flat : distribute(layout, options.levels.size(), level, pieces, "level", nothing))
    records.push_back(LinearityRunner::unpack(flat, options));
  const double resolution = records.front().spectra.resolution;
  const auto lines = static_cast<std::size_t>(std::floor(options.highest / resolution * (1 + 1e-12)));
  const auto linear = distribute(
      layout, lines, [&](std::size_t k) { return runner.linear(resolution * (static_cast<double>(k) + 1)); }, pieces,
      "line", nothing);
  // Equilibria know of no loss factor: of such shafts nothing is asked.
  if (context.machine.rotor.loss_factor == 0)
    put_growth(distribute(
                   layout, 1, [&](std::size_t) { return runner.growing(); }, pieces, "stability", nothing)
                   .front(),
               fmt::format("at {:.6g} {}", deck::from_si(options.speed.value, options.speed.unit), options.speed.unit),
               "No vibration settles into the linear transfer functions that the motion is compared with",
               results.summary());
  put_linearity(context, options, records, linear, runner.node());
  results.summary().points = static_cast<long>(lines);
  return results.finish("completed", true);
}

}  // namespace whirl::study
