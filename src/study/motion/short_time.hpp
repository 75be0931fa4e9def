#pragma once
// Orders and waterfalls of what a study has sampled at equal angles of the shaft.

#include <functional>
#include <string>
#include <vector>

#include "study/motion/assessment.hpp"
#include "whirl/io/record.hpp"

namespace whirl::study {

/// What was sampled: x and y of places, at equal angles since the record began.
struct AngleRecord {
  std::vector<std::string> names;
  std::string unit;
  int per_revolution = 0;
  std::vector<double> samples;                ///< [sample][place][x, y]
  std::function<double(double)> speed, time;  ///< speed in speed_unit and time [s] over revolutions since it began
  std::string speed_unit;
  [[nodiscard]] int revolutions() const;
};

/// Amplitude and phase of each order in every piece: group `orders`.
void write_orders(io::Group& group, const AngleRecord& record, const OrderOptions& options);
/// Spectra over the orders in every piece: group `waterfall`.
void write_waterfall(io::Group& group, const AngleRecord& record, const WaterfallOptions& options);

}  // namespace whirl::study
