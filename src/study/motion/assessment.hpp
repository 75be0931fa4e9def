#pragma once
// What decks ask of a motion beside its course: Poincare sections, orders of the shaft's speed, waterfalls.

#include <string>
#include <vector>

#include "whirl/study/study.hpp"
#include "whirl/transient/analysis/orders.hpp"
#include "whirl/transient/steps/section.hpp"

namespace whirl::study {

/// One term of a plane: a coordinate and its factor.
struct PlaneTerm {
  std::string of;     ///< PLACE.x, .y, .vx or .vy, or state.K
  double factor = 1;  ///< dimensionless
};
void describe(deck::Description<PlaneTerm>& d);

/// sum factor x coordinate = value.
struct SectionOptions {
  std::string of;                ///< a single coordinate,
  std::vector<PlaneTerm> plane;  ///< or several
  deck::Quantity value;          ///< in the unit of the coordinates
  transient::CrossingSense direction = transient::CrossingSense::rising;
  /// The terms, whichever way they were given.
  [[nodiscard]] std::vector<PlaneTerm> terms() const;
};
void describe(deck::Description<SectionOptions>& d);

struct OrderOptions {
  std::vector<double> track;  ///< orders
  int revolutions = 8, advance = 2;
  transient::Window window = transient::Window::hann;
};
void describe(deck::Description<OrderOptions>& d);

struct WaterfallOptions {
  double highest = 4;  ///< order
  int revolutions = 32, advance = 8;
  transient::Window window = transient::Window::hann;
};
void describe(deck::Description<WaterfallOptions>& d);

/// The coordinates of a plane must exist in the machine and have one unit, which the value has too.
void check_section(const std::string& key, const SectionOptions& section, const system::Machine& machine,
                   const deck::Report& report);
/// Pieces must fit a record of `revolutions` with so many `samples` a revolution.
void check_orders(const std::string& key, const OrderOptions& orders, double revolutions, int samples,
                  const deck::Report& report);
void check_waterfall(const std::string& key, const WaterfallOptions& waterfall, double revolutions, int samples,
                     const deck::Report& report);

}  // namespace whirl::study
