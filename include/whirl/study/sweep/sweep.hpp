#pragma once
// The same studies for variants of the machine: one table of all values, with trends.

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "whirl/deck/node.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

struct Deck;

struct SweepOptions {
  std::string name;
  std::vector<std::string> of;  ///< earlier studies of the deck that are repeated; all of them if empty
  deck::Node variants;          ///< NAME: {PATH: VALUE, ...}
  deck::Node grid;              ///< PATH: [VALUE, ...] or {from, to, points, spacing}
  std::optional<double> at;     ///< of the deck as it stands, beside the `at` of the variants
  bool as_given = true;         ///< also run the studies for the deck as it stands
  int ranks = 1;                ///< that share a variant
};
void describe(deck::Description<SweepOptions>& d);

/// A quantity that tells the variants of one line of the sweep apart.
struct Coordinate {
  std::string quantity;  ///< path as written, or `at`; of what is no number its name: "lemon", "lubricant cold"
  double value = 0;      ///< of the variant: SI, or a ratio to the deck as it stands; NaN: no number
  double given = 0;      ///< of the deck as it stands
  std::string unit;      ///< "1" for ratios
};

/// One variant: what it changes and the deck that this makes.
struct Variant {
  std::string name;
  std::vector<std::pair<std::string, std::string>> changes;  ///< path without wildcards, value as text
  std::vector<Coordinate> coordinates;  ///< of what changes as a number; the others of a grid are constant meanwhile
  std::shared_ptr<const Deck> deck;     ///< its studies are those that the sweep repeats
};

class Sweep final : public StudyWith<SweepOptions, "sweep"> {
public:
  [[nodiscard]] bool takes_hysteresis() const override { return true; }
  [[nodiscard]] bool needs_rotor() const override { return false; }
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  void validate_among(std::span<const std::unique_ptr<Study>> before, const deck::Report& report) const override;
  /// What the dearest study of a variant takes, and what is kept of each variant until the end. One variant at a time.
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;

  /// Makes and checks the deck of each variant from the tree of the whole one; `before` are the studies before this
  /// one. Problems cite the line of the sweep and the variant. Solves nothing. Collective (tables).
  void prepare(const deck::Node& root, std::span<const std::unique_ptr<Study>> before, const deck::Files& files,
               deck::Problems& problems);
  [[nodiscard]] const std::vector<Variant>& variants() const { return variants_; }
  /// Whether it repeats the study `name`, which stands before it.
  [[nodiscard]] bool repeats(const std::string& name) const;

private:
  std::vector<Variant> variants_;
};

}  // namespace whirl::study
