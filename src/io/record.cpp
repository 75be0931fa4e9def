#include "whirl/io/record.hpp"

#include <bit>

#include "whirl/core/error.hpp"

namespace whirl::io {
namespace {

void check_name(const std::string& name) {
  if (name.empty() || name == "." || name.find('/') != std::string::npos)
    throw core::Bug("internal error: '" + name + "' is no name for a record");
}

template <class T>
const T& find(const std::map<std::string, T>& map, const std::string& name, const char* kind) {
  const auto it = map.find(name);
  if (it == map.end()) throw core::Error(std::string("record has no ") + kind + " '" + name + "'");
  return it->second;
}

template <class T, class V>
const T& get(const V& value, const std::string& name, const char* type) {
  const T* p = std::get_if<T>(&value);
  if (!p) throw core::Error("record '" + name + "' is not of type " + type);
  return *p;
}

class Fnv {
public:
  void byte(unsigned char b) { hash_ = (hash_ ^ b) * 0x100000001b3ULL; }
  void word(std::uint64_t w) {
    for (int shift = 0; shift < 64; shift += 8) byte(static_cast<unsigned char>(w >> shift));
  }
  void text(const std::string& s) {
    word(s.size());
    for (char c : s) byte(static_cast<unsigned char>(c));
  }
  void value(const std::string& s) { text(s); }
  void value(double d) { word(std::bit_cast<std::uint64_t>(d)); }
  void value(std::int64_t i) { word(static_cast<std::uint64_t>(i)); }
  void value(const Dataset& d) {
    word(d.shape.size());
    for (std::size_t n : d.shape) word(n);
    word(d.values.index());
    std::visit(
        [&](const auto& v) {
          for (const auto& x : v) value(x);
        },
        d.values);
    text(d.unit);
    text(d.description);
  }
  void value(const Attribute& a) {
    word(a.index());
    std::visit([&](const auto& x) { value(x); }, a);
  }
  void value(const Group& g) {
    all(g.attributes());
    all(g.datasets());
    all(g.groups());
  }
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

private:
  template <class T>
  void all(const std::map<std::string, T>& map) {
    word(map.size());
    for (const auto& [name, x] : map) text(name), value(x);
  }
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace

std::size_t Dataset::size() const {
  return std::visit([](const auto& v) { return v.size(); }, values);
}

void Group::set(const std::string& name, std::string value) {
  check_name(name);
  attributes_[name] = std::move(value);
}

void Group::set(const std::string& name, double value) {
  check_name(name);
  attributes_[name] = value;
}

void Group::set(const std::string& name, std::int64_t value) {
  check_name(name);
  attributes_[name] = value;
}

const std::string& Group::text(const std::string& name) const {
  return get<std::string>(find(attributes_, name, "attribute"), name, "text");
}

double Group::real(const std::string& name) const {
  return get<double>(find(attributes_, name, "attribute"), name, "real");
}

std::int64_t Group::integer(const std::string& name) const {
  return get<std::int64_t>(find(attributes_, name, "attribute"), name, "integer");
}

void Group::put(const std::string& name, Dataset data) {
  check_name(name);
  core::require(!groups_.contains(name), "a dataset and a group of one name");
  std::size_t n = 1;
  for (std::size_t extent : data.shape) n *= extent;
  core::require(n == data.size(), "the shape of a dataset does not fit its values");
  datasets_[name] = std::move(data);
}

void Group::put(const std::string& name, std::vector<double> values, std::string unit, std::string description) {
  const std::size_t n = values.size();
  put(name, Dataset{{n}, std::move(values), std::move(unit), std::move(description)});
}

void Group::put(const std::string& name, Shape shape, std::vector<double> values, std::string unit,
                std::string description) {
  put(name, Dataset{std::move(shape), std::move(values), std::move(unit), std::move(description)});
}

void Group::put(const std::string& name, std::vector<std::int64_t> values, std::string description) {
  const std::size_t n = values.size();
  put(name, Dataset{{n}, std::move(values), "", std::move(description)});
}

void Group::put(const std::string& name, std::vector<std::string> values, std::string description) {
  const std::size_t n = values.size();
  put(name, Dataset{{n}, std::move(values), "", std::move(description)});
}

const Dataset& Group::dataset(const std::string& name) const {
  return find(datasets_, name, "dataset");
}

const std::vector<double>& Group::reals(const std::string& name) const {
  return get<std::vector<double>>(dataset(name).values, name, "real");
}

const std::vector<std::int64_t>& Group::integers(const std::string& name) const {
  return get<std::vector<std::int64_t>>(dataset(name).values, name, "integer");
}

const std::vector<std::string>& Group::strings(const std::string& name) const {
  return get<std::vector<std::string>>(dataset(name).values, name, "text");
}

Group& Group::child(const std::string& name) {
  check_name(name);
  core::require(!datasets_.contains(name), "a dataset and a group of one name");
  return groups_[name];
}

const Group& Group::group(const std::string& name) const {
  return find(groups_, name, "group");
}

std::string safe_name(const std::string& text) {
  if (text.empty() || text == "." || text == "..") return "_";
  std::string name = text;
  for (char& c : name)
    if (c == '/' || c == '\0') c = '_';
  return name;
}

std::string plain_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '+' || c == '-' || c == '.';
    if (plain)
      name += c;
    else if (!name.ends_with('_'))
      name += '_';
  }
  const auto first = name.find_first_not_of("_."), last = name.find_last_not_of("_.");
  return first == std::string::npos ? "study" : name.substr(first, last - first + 1);
}

std::uint64_t checksum(const Group& group) {
  Fnv fnv;
  fnv.value(group);
  return fnv.hash();
}

}  // namespace whirl::io
