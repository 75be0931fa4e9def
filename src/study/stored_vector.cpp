#include "stored_vector.hpp"

#include <utility>

namespace whirl::study {

using core::check;

namespace {

constexpr const char* unit = "1";  // of scaled entries

// Where this rank's entries stand.
io::RowRange place_of(Vec v) {
  PetscInt begin = 0, size = 0;
  check(VecGetOwnershipRange(v, &begin, nullptr));
  check(VecGetSize(v, &size));
  return {static_cast<std::size_t>(begin), static_cast<std::size_t>(size)};
}

}  // namespace

std::vector<double> entries_here(Vec v) {
  const core::ReadArray a(v);
  return {a.data(), a.data() + a.size()};
}

void put_vector(io::Group& group, const std::string& name, Vec v, bool shared, const std::string& description) {
  if (!shared) return group.put(name, core::gather(v), unit, description);
  std::vector<double> rows = entries_here(v);
  const std::size_t n = rows.size();
  group.put(name, io::Dataset{{n}, std::move(rows), unit, description, place_of(v)});
}

void take_vector(const io::Group& group, const std::string& name, Vec v) {
  const io::Dataset& data = group.dataset(name);
  if (data.share)
    core::fill(v, data.share->begin, std::get<std::vector<double>>(data.values));
  else
    core::fill(v, group.reals(name));
}

// Whole ones stand one after the other; shared ones side by side, so that a rank's rows are rows of the array.
void put_vectors(io::Group& group, const std::string& name, const std::vector<std::vector<double>>& vectors, Vec like,
                 bool shared, const std::string& description) {
  const std::size_t count = vectors.size();
  std::vector<double> flat;
  if (!shared) {
    PetscInt size = 0;
    check(VecGetSize(like, &size));
    for (const auto& v : vectors) {
      core::require(v.size() == static_cast<std::size_t>(size), "whole vectors, or shared ones");
      flat.insert(flat.end(), v.begin(), v.end());
    }
    return group.put(name, {count, static_cast<std::size_t>(size)}, std::move(flat), unit, description);
  }
  const std::size_t n = entries_here(like).size();
  for (std::size_t i = 0; i < n; ++i)
    for (const auto& v : vectors) flat.push_back(v[i]);
  group.put(name, io::Dataset{{n, count}, std::move(flat), unit, description + ", side by side", place_of(like)});
}

std::vector<std::vector<double>> take_vectors(const io::Group& group, const std::string& name, Vec like) {
  const io::Dataset& data = group.dataset(name);
  const core::Vector v = core::duplicate(like);
  std::vector<std::vector<double>> out;
  if (!data.share) {
    const auto& flat = group.reals(name);
    for (std::size_t k = 0; k < data.shape.at(0); ++k) {
      const auto begin = flat.begin() + static_cast<std::ptrdiff_t>(k * data.shape.at(1));
      core::fill(v.get(), {begin, begin + static_cast<std::ptrdiff_t>(data.shape.at(1))});
      out.push_back(entries_here(v.get()));
    }
    return out;
  }
  const auto& flat = std::get<std::vector<double>>(data.values);
  const std::size_t n = data.shape.at(0), count = data.shape.at(1);
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> rows(n);
    for (std::size_t i = 0; i < n; ++i) rows[i] = flat[i * count + k];
    core::fill(v.get(), data.share->begin, rows);
    out.push_back(entries_here(v.get()));
  }
  return out;
}

}  // namespace whirl::study
