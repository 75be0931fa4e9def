#include <fmt/core.h>

#include <cmath>

#include "highlights.hpp"

namespace whirl::app {

std::string of_transfers(const io::StudySummary& s, const Values& v) {
  std::string out;
  for (const auto& [name, q] : s.values)
    if (name.ends_with(".difference"))
      out += fmt::format("  {}: at most {:.3g} of the matrix apart, at {} {}\n", name.substr(0, name.size() - 11),
                         q.value, v.cell(name + "_at"), v.unit(name + "_at"));
  Grid grid({"largest answer", "amplitude", "unit",
             fmt::format("at [{}]", s.values.empty() ? "" : v.unit(s.values[1].first))});
  // The file of a run that goes on has null for infinity, too.
  const auto endless = [&](double value) {
    return std::isinf(value) || (std::isnan(value) && s.stability == "undamped");
  };
  for (const auto& [name, q] : s.values)
    if (name.ends_with(".largest"))
      grid.add({name.substr(0, name.size() - 8), endless(q.value) ? "without limit" : v.cell(name), q.unit,
                v.cell(name + "_at")});
  return out + grid.text();
}

}  // namespace whirl::app
