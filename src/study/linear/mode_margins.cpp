#include "study/linear/mode_margins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "whirl/study/linear/separation.hpp"

namespace whirl::study {

void put_margins(io::StudySummary& summary, const std::string& head, double speed, double speed_error, double decrement,
                 double decrement_error, const std::optional<deck::Range>& operating) {
  if (!(decrement >= 0)) return;  // it grows
  const auto bar = [](double x) {
    return std::isfinite(x) ? std::map<std::string, double>{{"uncertainty", x}} : std::map<std::string, double>{};
  };
  // Both ends of the decrement's bar; where that contains zero nothing bounds the factor.
  const double none = std::numeric_limits<double>::quiet_NaN(), factor = std::numbers::pi / decrement,
               most = decrement > decrement_error ? std::numbers::pi / (decrement - decrement_error) : none,
               least = std::numbers::pi / (decrement + decrement_error);
  const bool exact = !std::isfinite(decrement_error);  // no mesh
  // Without damping there is no bound of it.
  if (decrement > 0)
    summary.set(head + "amplification_factor", factor, "1",
                bar(exact ? none : std::max(most - factor, factor - least)));
  if (!operating) return;
  const auto margin = [&](double s, double af) { return separation(s, af, operating->from, operating->to); };
  const Separation here = margin(speed, factor);
  const auto doubt = [&](double Separation::*which, double s, double af) {
    return std::abs(margin(s, af).*which - here.*which);
  };
  const double moved = std::max(doubt(&Separation::actual, speed - speed_error, factor),
                                doubt(&Separation::actual, speed + speed_error, factor));
  summary.set(head + "separation_margin", here.actual, "1", bar(std::isfinite(speed_error) ? moved : none));
  const double required =
      std::max(doubt(&Separation::required, speed, most), doubt(&Separation::required, speed, least));
  summary.set(head + "required_margin", here.required, "1", bar(exact || !std::isfinite(most) ? none : required));
}

}  // namespace whirl::study
