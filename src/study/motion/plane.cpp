#include "study/motion/plane.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "whirl/core/error.hpp"

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

}  // namespace whirl::study
