#include "study/linear/linear_brief.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace whirl::study {

io::Quantity to_digits(io::Quantity q, int count) {
  if (!std::isfinite(q.value) || q.value == 0) return q;
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(q.value))) + 1 - count);
  q.value = std::round(q.value / step) * step;
  return q;
}

io::BriefCell compact(const io::Quantity& q) {
  constexpr double hidden = 2e-3;
  if (q.bar() > hidden * std::abs(q.value)) return q;
  return to_digits({q.value, q.unit}, 4);
}

io::BriefCell compact_percent(const io::Quantity& q) {
  return compact(scaled(q, 100, "%"));
}

std::string factor_words(double factor) {
  return io::reading(to_digits({factor, "1"}, 3).value);
}

std::string margin_mark(const std::string& verdict) {
  return verdict == "too near" ? "TOO NEAR" : verdict.starts_with("damped") ? "" : verdict;
}

std::string operating_words(const Values& v) {
  const io::Quantity one = v["operating_speed"], low = v["operating_range.from"], high = v["operating_range.to"];
  if (std::isfinite(one.value)) return "operating speed " + io::reading(one);
  if (!std::isfinite(low.value) || !std::isfinite(high.value)) return {};
  return fmt::format("operating speeds {} to {}", io::reading(low.value), io::reading(high));
}

std::string margin_note(const Values& v) {
  const std::string operating = operating_words(v);
  if (operating.empty()) return {};
  return fmt::format("margin to the {}; need: by API 617 and API 684 (2005), 2.5", operating);
}

std::string in_words(const std::vector<std::string>& items, std::size_t most, const std::string& unit) {
  const std::size_t shown = std::min(most, items.size());
  std::string text;
  for (std::size_t k = 0; k < shown; ++k) text += (k == 0 ? "" : k + 1 == items.size() ? " and " : ", ") + items[k];
  if (!unit.empty()) text += " " + unit;
  return shown < items.size() ? text + fmt::format(" and {} more", items.size() - shown) : text;
}

}  // namespace whirl::study
