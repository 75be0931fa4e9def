// The points of a curve of bifurcations in results and summary.

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "study/bars/beyond.hpp"
#include "study/bars/mesh_wave.hpp"
#include "study/bars/shaft_mesh.hpp"
#include "study/bifurcation.hpp"
#include "study/locus/locus_follower.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/brief.hpp"
#include "whirl/io/table.hpp"

namespace whirl::study {

// With a warning where the curve is no border of stability.
void LocusFollower::put_curve(const std::vector<Row>& rows, const std::vector<RowBar>& bars) {
  const std::string &first = first_range_.unit, &second = options_.second.range.unit;
  io::Table table(
      {{"parameter", first, "first parameter, that of the branch"},
       {"second", second, "second parameter"},
       {"period", "s", "period of the cycle, or 2 pi/omega at Hopf points"},
       {"angle", "rad", "angle of the critical multiplier"},
       {"amplitude", "1", "of a self-excited cycle, per clearance of the place that moves most; else 0"},
       {"others_unstable", "1", "unstable eigenvalues or multipliers beside the critical ones"},
       {"parameter_uncertainty", first,
        fmt::format("bar of the first parameter at a fixed second one, from other meshes; none where the curve runs "
                    "within {:.2g} rad along the first parameter",
                    least_share)},
       {"second_uncertainty", second, "bar of the second parameter at a fixed first one, likewise"},
       {"normal_uncertainty", "1",
        fmt::format("bar of the distance normal to the curve, parameters in units of {:.6g} {} and {:.6g} {} (widths "
                    "of the ranges)",
                    deck::from_si(first_scale_, first), first, deck::from_si(second_scale_, second), second)},
       {"uncertainty_computed", "1", "1: from solutions on other meshes; 0: between those, linear in the arclength"}});
  double low = std::numeric_limits<double>::infinity(), high = -low;
  int marked = 0;
  MeshWaves waves;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Row& row = rows[k];
    const double there = deck::from_si(row.second, second);
    table.append({deck::from_si(row.first, first), there, row.period, row.angle, row.amplitude,
                  static_cast<double>(row.others_unstable), bars[k].first / deck::number_to_si(1, first),
                  bars[k].second / deck::number_to_si(1, second), bars[k].normal, bars[k].computed ? 1.0 : 0.0});
    if (row.mesh_wave != 0) waves.add(there, {{0, std::max(0.0, row.mesh_wave)}});
    if (row.others_unstable == 0) continue;
    ++marked;
    low = std::min(low, there);
    high = std::max(high, there);
  }
  auto& summary = context_.results.summary();
  if (marked > 0)
    summary.warnings.push_back(
        fmt::format("at {} of {} points, {} from {} to {} {}, {}", marked, rows.size(),
                    parameter_word(options_.second.path), io::reading(low), io::reading(high), second,
                    options_.limit ? "the cycle is unstable: the machine does not keep this motion"
                                   : "the curve is no border of stability: something else is unstable there already"));
  waves.warn(summary, second);
  warn_curve_without_shaft_mesh(summary, context_.machine, context_.layout);
  for (const io::Table::Column& column : table.columns())
    summary.curve.push_back({column.name, column.unit, table.column(column.name)});
  table.write(context_.results.group().child("locus"));
}

void LocusFollower::put_kind() {
  auto& group = context_.results.group();
  if (options_.limit) {
    const deck::Quantity& value = options_.limit->value;
    group.set("bifurcation", "limit");
    group.set("limit", words_of(*options_.limit));
    group.set("limit_value", deck::from_si(value.value, value.unit));
    group.set("limit_unit", value.unit);
    group.set("larger_side", seed_.sensitivity > 0 ? "above" : "below");
    return;
  }
  const BranchKind kind{of_cycles_.has_value(), of_cycles_ && of_cycles_->origin == CycleBranchOptions::Origin::hopf,
                        of_cycles_ ? of_cycles_->period : 1, true};
  group.set("bifurcation", solve::name_of(seed_.event));
  group.set("born", born_at(type_of(seed_.event), kind));
  // Of a fold both sides depend on the motion.
  if (seed_.event != solve::Event::fold && seed_.event != solve::Event::cyclic_fold && seed_.sensitivity != 0)
    group.set("stable_side", seed_.sensitivity > 0 ? "below" : "above");
}

}  // namespace whirl::study
