#include "study/brief.hpp"

#include <algorithm>
#include <cmath>

namespace whirl::study {

Values::Values(const io::StudySummary& s) : study_(s) {}

io::Quantity Values::operator[](const std::string& name) const {
  const auto at = std::ranges::find(study_.values, name, [](const auto& named) { return named.first; });
  return at == study_.values.end() ? io::Quantity{} : at->second;
}

std::optional<double> Values::get(const std::string& name) const {
  const double value = (*this)[name].value;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::vector<std::string> Values::between(const std::string& head, const std::string& tail) const {
  std::vector<std::string> found;
  for (const auto& [name, quantity] : study_.values)
    if (name.size() > head.size() + tail.size() && name.starts_with(head) && name.ends_with(tail))
      found.push_back(name.substr(head.size(), name.size() - head.size() - tail.size()));
  return found;
}

io::Quantity scaled(io::Quantity q, double factor, const std::string& unit) {
  q.value *= factor;
  for (auto& [name, value] : q.more) value *= factor;
  q.unit = unit;
  return q;
}

io::Quantity in_celsius(io::Quantity kelvin) {
  kelvin.value -= 273.15;
  kelvin.unit = "degC";
  return kelvin;
}

}  // namespace whirl::study
