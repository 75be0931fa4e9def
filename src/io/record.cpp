#include "whirl/io/record.hpp"

#include <fmt/core.h>

#include <algorithm>
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

void visit_shared(const Group& group, const std::string& path,
                  const std::function<void(const std::string&, const Dataset&)>& visit) {
  for (const auto& [name, data] : group.datasets())
    if (data.share) visit(path + name, data);
  for (const auto& [name, sub] : group.groups()) visit_shared(sub, path + name + "/", visit);
}

// One number at its place; the finaliser of splitmix64 (Steele, Lea, Flood 2014) mixes all bits.
std::uint64_t hash_at(std::uint64_t place, std::uint64_t bits) {
  std::uint64_t z = bits + (place + 1) * 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

// That part of a shared dataset's sum that stands on this rank.
std::uint64_t sum_here(const Dataset& d) {
  std::size_t row = 1;
  for (std::size_t axis = 1; axis < d.shape.size(); ++axis) row *= d.shape[axis];
  std::uint64_t place = d.share->begin * row, sum = 0;
  const auto add = [&](const auto& numbers) {
    for (const auto x : numbers) sum += hash_at(place++, std::bit_cast<std::uint64_t>(x));
  };
  if (const auto* x = std::get_if<std::vector<double>>(&d.values))
    add(*x);
  else
    add(std::get<std::vector<std::int64_t>>(d.values));
  return sum;
}

class Fnv {
public:
  // Sums of the shared datasets over all ranks, in their order.
  explicit Fnv(const std::vector<std::uint64_t>& sums) : sum_(sums.begin()) {}
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
    const Shape shape = d.whole_shape();
    word(shape.size());
    for (std::size_t n : shape) word(n);
    word(d.values.index());
    if (d.share)
      word(*sum_++);
    else
      std::visit(
          [&](const auto& v) {
            for (const auto& x : v) value(x);
          },
          d.values);
    text(d.unit);
    text(d.description);
    for (const auto& axis : d.labels)
      for (const std::string& label : axis) text(label);
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
  std::vector<std::uint64_t>::const_iterator sum_;
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

std::vector<std::uint64_t> sums_here(const Group& group) {
  std::vector<std::uint64_t> sums;
  visit_shared(group, "", [&](const std::string&, const Dataset& d) { sums.push_back(sum_here(d)); });
  return sums;
}

}  // namespace

std::size_t Dataset::size() const {
  return std::visit([](const auto& v) { return v.size(); }, values);
}

Shape Dataset::whole_shape() const {
  Shape whole = shape;
  if (share) whole.front() = share->total;
  return whole;
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
  if (data.share)
    core::require(!data.shape.empty() && data.share->begin + data.shape[0] <= data.share->total &&
                      !std::holds_alternative<std::vector<std::string>>(data.values),
                  "a shared dataset holds rows of numbers");
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

void Group::label(const std::string& name, std::vector<std::vector<std::string>> labels) {
  Dataset data = dataset(name);
  core::require(labels.size() < std::max<std::size_t>(data.shape.size(), 1), "labels of axes that a dataset lacks");
  for (std::size_t k = 0; k < labels.size(); ++k)
    core::require(labels[k].empty() || labels[k].size() == data.shape[k + 1], "as many labels as places along an axis");
  data.labels = std::move(labels);
  datasets_[name] = std::move(data);
}

void Group::label_each(const std::vector<std::vector<std::string>>& labels) {
  std::vector<std::string> names;
  for (const auto& [name, data] : datasets_)
    if (data.shape.size() == labels.size() + 1) names.push_back(name);
  for (const std::string& name : names) label(name, labels);
}

std::vector<std::string> labels_of(const std::vector<double>& values, const std::string& word) {
  std::vector<std::string> labels;
  for (const double x : values) labels.push_back(fmt::format("{}{}{:.10g}", word, word.empty() ? "" : " ", x));
  return labels;
}

std::vector<std::string> node_labels(const std::vector<int>& nodes) {
  std::vector<std::string> labels;
  for (const int n : nodes) labels.push_back(fmt::format("node {}", n));
  return labels;
}

std::vector<std::string> numbered(std::size_t count, const std::string& word) {
  std::vector<std::string> labels;
  for (std::size_t k = 1; k <= count; ++k) labels.push_back(fmt::format("{}{}{}", word, word.empty() ? "" : " ", k));
  return labels;
}

const Dataset& Group::dataset(const std::string& name) const {
  return find(datasets_, name, "dataset");
}

namespace {

template <class T>
const std::vector<T>& values_of(const Dataset& data, const std::string& name, const char* type) {
  if (data.share) throw core::Error("record '" + name + "' is shared: no rank has all of it");
  return get<std::vector<T>>(data.values, name, type);
}

}  // namespace

const std::vector<double>& Group::reals(const std::string& name) const {
  return values_of<double>(dataset(name), name, "real");
}

const std::vector<std::int64_t>& Group::integers(const std::string& name) const {
  return values_of<std::int64_t>(dataset(name), name, "integer");
}

const std::vector<std::string>& Group::strings(const std::string& name) const {
  return values_of<std::string>(dataset(name), name, "text");
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

void each_shared(const Group& group, const std::function<void(const std::string& path, const Dataset&)>& visit) {
  visit_shared(group, "", visit);
}

bool is_shared(const Group& group) {
  bool any = false;
  each_shared(group, [&any](const std::string&, const Dataset&) { any = true; });
  return any;
}

std::uint64_t checksum(const Group& group) {
  const std::vector<std::uint64_t> sums = sums_here(group);
  Fnv fnv(sums);
  fnv.value(group);
  return fnv.hash();
}

std::uint64_t checksum(const Group& group, MPI_Comm comm) {
  std::vector<std::uint64_t> sums = sums_here(group);
  if (!sums.empty())
    MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_UINT64_T, MPI_SUM, comm);
  Fnv fnv(sums);
  fnv.value(group);
  return fnv.hash();
}

void describe_results(Group& root, const std::string& title, const std::string& version) {
  root.set("title", title);
  root.set("version", version);
  root.set("program", "whirl");
  root.set("format", 1);
  root.set(
      "frames",
      "x right, y up, z along the shaft, rotation from x to y; theta from +x counter-clockwise; gravity along -y "
      "unless the deck gives its components. "
      "Journal positions are journal minus pedestal minus elevation, relative to the bearing centre. "
      "K = -dF_journal/dx, C = -dF_journal/d(dx/dt). Loads are journal on bearing, positive down. Nodes are 1-based.");
  root.set("amplitudes", "0-peak unless the name says peak_to_peak");
  root.set("units", "attribute `unit` of each dataset; SI unless the study's range has a unit of its own");
}

}  // namespace whirl::io
