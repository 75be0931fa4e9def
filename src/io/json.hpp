#pragma once
// Numbers and quantities as JSON: NaN and infinity are null.

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "whirl/io/brief.hpp"
#include "whirl/io/quantity.hpp"

namespace whirl::io {

using Json = nlohmann::ordered_json;

inline Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

inline double number(const Json& j) {
  return j.is_null() ? no_value : j.get<double>();
}

inline Json text_or_null(const std::string& s) {
  return s.empty() ? Json(nullptr) : Json(s);
}

// The numbers of an object under keys that are not `known`.
inline std::map<std::string, double> others(const Json& j, const std::set<std::string>& known) {
  std::map<std::string, double> out;
  for (const auto& [key, value] : j.items())
    if (!known.contains(key)) out[key] = number(value);
  return out;
}

inline Json quantity_to_json(const Quantity& q) {
  Json j = {{"value", number(q.value)}, {"unit", q.unit}};
  for (const auto& [key, value] : q.more) j[key] = number(value);
  return j;
}

inline Quantity quantity(const Json& j) {
  return {number(j.at("value")), j.at("unit"), others(j, {"value", "unit"})};
}

[[nodiscard]] Json brief_to_json(const Brief& b);
/// What brief_to_json() made.
[[nodiscard]] Brief brief_of(const Json& j);

}  // namespace whirl::io
