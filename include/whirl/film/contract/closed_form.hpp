#pragma once
// Films of a full, rigid, aligned bearing in closed form. They have no options.
// Source: van de Vrande (2001) sec. 4.1 and (4.42) with the errata kept by this project; Moes and Bosma (1981).

#include "whirl/film/contract/bore.hpp"
#include "whirl/film/contract/facts.hpp"

namespace whirl::deck {
template <class S>
class Description;
}

namespace whirl::film {

struct Short {
  static constexpr std::string_view key = "short", text = "closed form without flow around the bearing (L/D below 1/2)";
  friend bool operator==(const Short&, const Short&) = default;
};
struct Long {
  static constexpr std::string_view key = "long",
                                    text = "closed form without side flow, periodic pressure, half of it positive";
  friend bool operator==(const Long&, const Long&) = default;
};
struct LongInlet {
  static constexpr std::string_view key = "long_inlet",
                                    text = "closed form without side flow, pressure zero at the top (90 deg)";
  friend bool operator==(const LongInlet&, const LongInlet&) = default;
};
struct FiniteApproximate {
  static constexpr std::string_view key = "finite_approximate",
                                    text =
                                        "harmonic sum of the short and the long film, along and across the "
                                        "eccentricity";
  friend bool operator==(const FiniteApproximate&, const FiniteApproximate&) = default;
};

void describe(deck::Description<Short>& d);
[[nodiscard]] Facts facts_of(const Short& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const Short& options, const Lubricant& lubricant);

void describe(deck::Description<Long>& d);
[[nodiscard]] Facts facts_of(const Long& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const Long& options, const Lubricant& lubricant);

void describe(deck::Description<LongInlet>& d);
[[nodiscard]] Facts facts_of(const LongInlet& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const LongInlet& options,
                                         const Lubricant& lubricant);

void describe(deck::Description<FiniteApproximate>& d);
[[nodiscard]] Facts facts_of(const FiniteApproximate& options, const Geometry& geometry);
[[nodiscard]] std::unique_ptr<Film> make(const Geometry& geometry, const FiniteApproximate& options,
                                         const Lubricant& lubricant);

}  // namespace whirl::film
