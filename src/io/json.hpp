#pragma once
// Structs as JSON, both ways; NaN and infinity are null.

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "whirl/core/error.hpp"
#include "whirl/io/brief.hpp"
#include "whirl/io/quantity.hpp"

namespace whirl::io {

using Json = nlohmann::ordered_json;

/// Writes the members of a struct as an object; JsonReader reads them back. Both are shown the members under their keys
/// by one function, in the order of the file:
///
///     void members(auto& json, StabilityRange& r) {
///       json("from", r.from);
///       json("stability", r.stability);
///     }
///
/// Members are numbers, texts, vectors, pairs of a name and a value (a vector of these is an object), and structs with
/// such a function.
class JsonWriter {
public:
  Json object = Json::object();
  template <class T>
  void operator()(const char* key, const T& x) {
    object[key] = value_of(x);
  }
  /// A text; null if it is empty.
  void or_null(const char* key, const std::string& text) { object[key] = text.empty() ? Json(nullptr) : Json(text); }
  /// One of `names`, by the place of its name among them.
  void word(const char* key, const auto& x, const auto& names) { object[key] = names[static_cast<std::size_t>(x)]; }
  /// Left out if it is empty.
  void if_any(const char* key, const auto& x) {
    if (!x.empty()) (*this)(key, x);
  }
  /// The same of structs with a name, each under that.
  void if_any_by_name(const char* key, const auto& all) {
    for (const auto& x : all) object[key][x.name] = value_of(x);
  }
  /// Whether members that may be left out are there: on writing as `wanted`, on reading whether their first key is.
  [[nodiscard]] bool has(const char* /*key*/, bool wanted) const { return wanted; }
  /// Numbers under all keys that are not shown otherwise.
  void rest(const std::map<std::string, double>& more) {
    for (const auto& [key, number] : more) object[key] = value_of(number);
  }

  template <class T>
  static Json value_of(const T& x) {
    if constexpr (std::same_as<T, double>) {
      return std::isfinite(x) ? Json(x) : Json(nullptr);
    } else if constexpr (std::integral<T> || std::same_as<T, std::string>) {
      return x;
    } else {
      JsonWriter out;
      members(out, const_cast<T&>(x));  // reading alone changes it
      return std::move(out.object);
    }
  }
  template <class T>
  static Json value_of(const std::vector<T>& all) {
    Json out = Json::array();
    for (const T& x : all) out.push_back(value_of(x));
    return out;
  }
  template <class T>
  static Json value_of(const std::vector<std::pair<std::string, T>>& named) {
    Json out = Json::object();
    for (const auto& [name, x] : named) out[name] = value_of(x);
    return out;
  }
  static Json value_of(const BriefCell& cell);
};

class JsonReader {
public:
  explicit JsonReader(const Json& object) : object_(object) {}
  template <class T>
  void operator()(const char* key, T& x) {
    known_.insert(key);
    read(object_.at(key), x);
  }
  void or_null(const char* key, std::string& text) {
    known_.insert(key);
    if (const Json& j = object_.at(key); !j.is_null()) j.get_to(text);
  }
  template <class T>
  void word(const char* key, T& x, const auto& names) {
    std::string name;
    (*this)(key, name);
    const auto at = std::ranges::find(names, name);
    if (at == names.end()) throw core::Error("unknown " + std::string(key) + " \"" + name + "\"");
    x = static_cast<T>(at - names.begin());
  }
  void if_any(const char* key, auto& x) {
    if (object_.contains(key)) (*this)(key, x);
  }
  void if_any_by_name(const char* key, auto& all) {
    if (!object_.contains(key)) return;
    for (const auto& [name, one] : object_.at(key).items()) {
      all.emplace_back().name = name;
      read(one, all.back());
    }
  }
  [[nodiscard]] bool has(const char* key, bool /*wanted*/) const { return object_.contains(key); }
  void rest(std::map<std::string, double>& more) { more_ = &more; }

  template <class T>
  static void read(const Json& j, T& x) {
    if constexpr (std::same_as<T, double>) {
      x = j.is_null() ? no_value : j.get<double>();
    } else if constexpr (std::integral<T> || std::same_as<T, std::string>) {
      j.get_to(x);
    } else {
      JsonReader in(j);
      members(in, x);
      in.take_rest();
    }
  }
  template <class T>
  static void read(const Json& j, std::vector<T>& all) {
    for (const Json& one : j) read(one, all.emplace_back());
  }
  template <class T>
  static void read(const Json& j, std::vector<std::pair<std::string, T>>& named) {
    for (const auto& [name, one] : j.items()) read(one, named.emplace_back(name, T{}).second);
  }
  static void read(const Json& j, BriefCell& cell);

private:
  void take_rest() {
    if (!more_) return;
    for (const auto& [key, value] : object_.items())
      if (!known_.contains(key)) read(value, (*more_)[key]);
  }

  const Json& object_;
  std::set<std::string> known_;
  std::map<std::string, double>* more_ = nullptr;
};

}  // namespace whirl::io
