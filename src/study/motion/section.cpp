#include "study/motion/section.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "study/stored_vector.hpp"
#include "whirl/core/error.hpp"
#include "whirl/io/table.hpp"

namespace whirl::study {

namespace {

constexpr std::array<std::string_view, 4> coordinate_words{"x", "y", "vx", "vy"};

}  // namespace

StateAt state_at(std::string_view name, const std::vector<std::string>& places, PetscInt states) {
  constexpr std::string_view numbered = "state.";
  if (states > 0 && name.starts_with(numbered)) {
    const std::string_view digits = name.substr(numbered.size());
    int k = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), k);
    if (error != std::errc() || end != digits.data() + digits.size() || k < 1 || k > states)
      throw core::InputError(fmt::format("there is no '{}': the states are state.1 to state.{}", name, states));
    return {-1, k - 1};
  }
  std::vector<std::string> all;
  for (std::size_t p = 0; p < places.size(); ++p)
    for (std::size_t d = 0; d < coordinate_words.size(); ++d) {
      all.push_back(fmt::format("{}.{}", places[p], coordinate_words[d]));
      if (all.back() == name) return {static_cast<int>(p), static_cast<int>(d)};
    }
  throw core::InputError(fmt::format("there is no coordinate '{}'{}", name, deck::did_you_mean_one_of(name, all)));
}

double SectionPlane::height(system::Plant& system, Vec x) const {
  const bool by_number = std::any_of(terms_.begin(), terms_.end(), [](const Term& t) { return t.of.place < 0; });
  const bool by_place = std::any_of(terms_.begin(), terms_.end(), [](const Term& t) { return t.of.place >= 0; });
  const std::vector<double> whole = by_number ? system.gather(x) : std::vector<double>();
  const std::vector<system::PlaceState> shown = by_place ? system.shown_at(x) : std::vector<system::PlaceState>();
  double sum = -value_;
  for (const Term& t : terms_) {
    const auto w = static_cast<std::size_t>(t.of.which);
    if (t.of.place < 0) {
      sum += t.factor * whole[w];
      continue;
    }
    const auto& at = shown[static_cast<std::size_t>(t.of.place)];
    sum += t.factor * (w < 2 ? at.position[w] : at.velocity[w - 2]);
  }
  return sum;
}

std::string SectionPlane::text(const system::ShownPlaces& places) const {
  std::string sum, unit = "1";
  for (const Term& t : terms_) {
    if (!sum.empty()) sum += " + ";
    if (t.factor != 1) sum += fmt::format("{:.6g} ", t.factor);
    if (t.of.place < 0) {
      sum += fmt::format("state.{}", t.of.which + 1);
    } else {
      sum += fmt::format("{}.{}", places.names[static_cast<std::size_t>(t.of.place)],
                         coordinate_words[static_cast<std::size_t>(t.of.which)]);
      unit = t.of.which < 2 ? places.unit : places.rate_unit;
    }
  }
  return fmt::format("{} = {:.6g}{}", sum, value_, unit == "1" ? "" : " " + unit);
}

SectionPlane plane_of(const SectionOptions& options, const system::ShownPlaces& places, PetscInt states) {
  std::vector<SectionPlane::Term> terms;
  for (const PlaneTerm& t : options.terms()) terms.push_back({state_at(t.of, places.names, states), t.factor});
  return {std::move(terms), options.value.value};
}

void Watch::see(const std::vector<system::PlaceState>& shown) {
  const std::size_t n = 2 * shown.size();
  if (count_ == 0) {
    sum_.assign(n, 0.0);
    low_.assign(n, std::numeric_limits<double>::max());
    high_.assign(n, std::numeric_limits<double>::lowest());
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double value = shown[i / 2].position[i % 2];
    sum_[i] += value;
    low_[i] = std::min(low_[i], value);
    high_[i] = std::max(high_[i], value);
  }
  ++count_;
}

SectionPlane Watch::choose(const system::ShownPlaces& places) const {
  std::size_t best = 0;
  double most = -1;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const double clearance = places.clearances[i / 2], travel = (high_[i] - low_[i]) / (clearance > 0 ? clearance : 1);
    if (travel > most) {
      most = travel;
      best = i;
    }
  }
  return {{{{static_cast<int>(best / 2), static_cast<int>(best % 2)}, 1}}, sum_[best] / count_};
}

void SectionRecord::add(double time, const std::vector<system::PlaceState>& shown, std::vector<double> scaled) {
  Crossing c{time, {}, std::move(scaled)};
  for (const auto& p : shown) {
    c.shown.insert(c.shown.end(), p.position.begin(), p.position.end());
    c.shown.insert(c.shown.end(), p.velocity.begin(), p.velocity.end());
  }
  open_.push_back(std::move(c));
}

void SectionRecord::close() {
  for (Crossing& c : open_) {
    times_.push_back(c.time);
    shown_.insert(shown_.end(), c.shown.begin(), c.shown.end());
    states_.push_back(std::move(c.state));
  }
  open_.clear();
}

std::vector<std::array<double, 2>> SectionRecord::points(std::size_t place, std::size_t places) const {
  std::vector<std::array<double, 2>> out;
  for (std::size_t k = 0; k < times_.size(); ++k) {
    const std::size_t at = 4 * (k * places + place);
    out.push_back({shown_[at], shown_[at + 1]});
  }
  return out;
}

std::array<double, 2> SectionRecord::interval(int k) const {
  const auto step = static_cast<std::size_t>(k);
  if (times_.size() <= step) return {0, 0};
  double sum = 0, low = 0, high = 0;
  for (std::size_t i = 0; i + step < times_.size(); ++i) {
    const double t = times_[i + step] - times_[i];
    low = i == 0 ? t : std::min(low, t);
    high = i == 0 ? t : std::max(high, t);
    sum += t;
  }
  return {sum / static_cast<double>(times_.size() - step), (high - low) / 2};
}

void SectionRecord::write(io::Group& group, const system::ShownPlaces& places, const std::string& text) const {
  const std::size_t n = places.names.size();
  const std::vector<std::string>& row = places.names;
  const auto wide = io::Table::wide;
  io::Table table({{"time", "s", "since the record began"},
                   wide("x", places.unit, places.text, row),
                   wide("y", places.unit, places.text, row),
                   wide("vx", places.rate_unit, "its rate", row),
                   wide("vy", places.rate_unit, "its rate", row)});
  for (std::size_t k = 0; k < times_.size(); ++k) {
    std::vector<std::vector<double>> p(4, std::vector<double>(n));
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t i = 0; i < 4; ++i) p[i][b] = shown_[4 * (k * n + b) + i];
    table.append({{times_[k]}, p[0], p[1], p[2], p[3]});
  }
  auto& g = group.child("section");
  table.write(g);
  g.set("plane", text);
}

void SectionRecord::save(io::Group& group, bool shared, Vec like) const {
  group.put("times", times_, "s", "of crossings");
  group.put("shown", shown_, "SI", "what is shown there");
  const auto rows = static_cast<Eigen::Index>(entries_here(like).size());
  Eigen::MatrixXd columns(rows, static_cast<Eigen::Index>(states_.size()));
  for (Eigen::Index k = 0; k < columns.cols(); ++k)
    columns.col(k) = Eigen::Map<const Eigen::VectorXd>(states_[static_cast<std::size_t>(k)].data(), rows);
  put_columns(group, "states", columns, shared ? like : nullptr, "1", "scaled states there");
}

void SectionRecord::load(const io::Group& group, Vec like) {
  times_ = group.reals("times");
  shown_ = group.reals("shown");
  states_.clear();
  const Eigen::MatrixXd columns = take_columns(group, "states", like);
  for (const auto& column : columns.colwise()) states_.emplace_back(column.begin(), column.end());
  open_.clear();
}

}  // namespace whirl::study
