#include "study/motion/linearity.hpp"

#include <fmt/core.h>

#include <cmath>

#include "study/brief.hpp"
#include "study/linear/linear_brief.hpp"
#include "study/motion/linearity_run.hpp"
#include "study/pieces.hpp"

namespace whirl::study {

StudyResult Linearity::run(Context& context) {
  auto& results = context.results;
  const Layout layout = plan(context, Sharing::speeds);
  LinearityRunner runner(context, layout, options);
  Pieces pieces(results, context.resume, options.checkpoint);
  const auto level = [&](std::size_t k) {
    return runner.record(options.levels[k], [&](double share) {
      results.progress(fmt::format("{}: {:.4g} N, {:.0f} %, {:.1f} s", results.summary().name, options.levels[k],
                                   100 * share, results.seconds()));
    });
  };
  const std::vector<LinearityRecord> records =
      distribute(layout, options.levels.size(), level, pieces, "level", no_trail);
  const double resolution = records.front().spectra.resolution;
  const auto lines = static_cast<std::size_t>(std::floor(options.highest / resolution * (1 + 1e-12)));
  const auto linear = distribute(
      layout, lines, [&](std::size_t k) { return runner.linear(resolution * (static_cast<double>(k) + 1)); }, pieces,
      "line", no_trail);
  // Equilibria know of no loss factor: of such shafts nothing is asked.
  if (context.machine.rotor.loss_factor == 0) {
    const auto one_machine = [&](std::size_t) { return runner.growing(); };
    put_growth(distribute(layout, 1, one_machine, pieces, "stability", no_trail).front(),
               fmt::format("at {:.6g} {}", deck::from_si(options.speed.value, options.speed.unit), options.speed.unit),
               "No vibration settles into the linear transfer functions that the motion is compared with",
               results.summary());
  }
  put_linearity(context, options, records, linear, runner.node());
  results.summary().points = static_cast<long>(lines);
  return results.finish("completed", true);
}

io::Brief Linearity::brief(const StudyResult& result, std::span<const io::StudySummary> /*before*/) const {
  const Values v(result.summary);
  const std::vector<std::string> levels = v.between("level.", ".force");
  if (levels.empty()) return {};
  const auto percent = [&](const std::string& name) { return scaled(v[name], 100, "%"); };
  // Numbers of one record: another seed changes the third digit.
  const auto sample = [](const io::Quantity& q) { return to_digits(q, 3); };
  const double sure = 100 * options.probability;
  io::BriefTable table{"Levels of the random force",
                       {{"force, rms", "N"},
                        {"largest displacement", "m"},
                        {"rms x", "m"},
                        {"rms y", "m"},
                        {"mean x", "m"},
                        {"mean y", "m"},
                        {"H1 within bounds", "%"},
                        {"deviation", "%"},
                        {"least coherence", "1"},
                        {"at", "Hz"},
                        {"at the resonance", "1"}},
                       {},
                       fmt::format("H1 within bounds: share of its entries whose bounds of {:.4g} % hold the linear "
                                   "transfer function; deviation: root mean square of H1 less the linear one, over "
                                   "the largest gain; both off the resonance, as the least coherence. By chance alone "
                                   "the coherence reaches {}",
                                   sure, io::reading(sample(v["coherence.chance"])))};
  for (const std::string& k : levels) {
    const std::string head = "level." + k + ".";
    std::vector<io::BriefCell>& row = table.rows.emplace_back();
    row.emplace_back(v[head + "force"]);
    for (const char* name : {"peak", "rms.x", "rms.y", "mean.x", "mean.y"}) row.emplace_back(sample(v[head + name]));
    for (const char* name : {"within", "deviation"}) row.emplace_back(sample(percent(head + name)));
    for (const char* name : {"coherence.least", "coherence.least_at", "coherence.resonance"})
      row.emplace_back(sample(v[head + name]));
  }
  io::Brief brief{{}, {std::move(table)}};
  const auto at_level = [&](const std::string& k) {
    const std::string head = "level." + k + ".";
    return fmt::format(
        "With {} rms of force the largest displacement is {}: off the resonance {:.0f} % of the entries of H1 lie "
        "within their bounds of the linear transfer functions ({:.4g} % would if all were linear), and the "
        "coherence is {:.3f} at least, at the resonance {:.3f}.",
        io::reading(v[head + "force"]), io::reading(sample(v[head + "peak"])), percent(head + "within").value, sure,
        v[head + "coherence.least"].value, v[head + "coherence.resonance"].value);
  };
  brief.sentences.push_back(at_level(levels.front()));
  if (levels.size() > 1) brief.sentences.push_back(at_level(levels.back()));
  brief.sentences.push_back(fmt::format("The resonance at {} reaches from {:.5g} to {}.",
                                        io::reading(v["resonance.frequency"]), v["resonance.from"].value,
                                        io::reading(v["resonance.to"])));
  return brief;
}

}  // namespace whirl::study
