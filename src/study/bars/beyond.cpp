#include "study/bars/beyond.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "study/bifurcation.hpp"

namespace whirl::study {
namespace {

using Type = io::BifurcationType;

bool is_fold(const io::Bifurcation& b) {
  return b.type == Type::fold || b.type == Type::cyclic_fold;
}

std::string place(const io::Bifurcation& b) {
  return "this " + parameter_word(b.parameter);
}

// As many digits as the bar supports, to its first one; three to six.
std::string brief(double value, double bar, const std::string& unit) {
  int digits = 4;
  if (std::isfinite(bar) && bar > 0 && value != 0)
    digits =
        std::clamp(static_cast<int>(std::floor(std::log10(std::abs(value))) - std::floor(std::log10(bar))) + 1, 3, 6);
  if (value == 0) return "0 " + unit;
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(value))) + 1 - digits);
  std::string text = fmt::format("{:.10g}", std::round(value / step) * step);
  return unit.empty() || unit == "1" ? text : text + " " + unit;
}

// "to large whirl", "to a large oscillation".
std::string large(const std::string& born) {
  return with_article(born) == born ? "large " + born : "a large " + born;
}

std::string last_word(const std::string& born) {
  return born.find("whirl") != std::string::npos ? "whirl" : "oscillation";
}

const char* other(const std::string& side) {
  return side == "above" ? "below" : "above";
}

std::string of_fold(const io::Bifurcation& b, const BranchKind& kind, int before, int after) {
  const bool known = b.criticality == "above" || b.criticality == "below";
  const char* what = kind.cycles ? "motion" : "position";
  if (std::min(before, after) > 0)
    return fmt::format("the branch turns back here; the {} is unstable on both halves", what);
  if (before == after) return "the branch turns back here";
  if (!known) return fmt::format("the stable {} ends here and the branch turns back", what);
  return fmt::format("the stable {} ends here: {} {} the {} jumps to another one", what, other(b.criticality), place(b),
                     kind.shaft ? "rotor" : "system");
}

// Something is unstable on both sides.
std::string of_further(const io::Bifurcation& b, const BranchKind& kind, int below, int above) {
  const bool pair = b.type == Type::hopf || b.type == Type::neimark_sacker;
  const char* what = pair ? "pair" : kind.cycles ? "multiplier" : "eigenvalue";
  if (above > below) return fmt::format("another {} becomes unstable", what);
  // Both of each pair are counted, and the others need not be pairs.
  return fmt::format("one {} becomes stable again with rising {}; {} {}{} remain{} unstable", what, place(b).substr(5),
                     above, kind.cycles ? "multiplier" : "eigenvalue", above == 1 ? "" : "s", above == 1 ? "s" : "");
}

std::string of_loss(const io::Bifurcation& b, const BranchKind& kind) {
  const std::string at = place(b);
  if (kind.linear) return fmt::format("above {} {} sets in", at, with_article(b.born));
  if (b.criticality == "supercritical") return fmt::format("above {} {} grows from nothing", at, with_article(b.born));
  if (b.criticality == "subcritical")
    return fmt::format("above {} the {} jumps to {}; just below it a disturbance can trigger the same {}", at,
                       kind.shaft ? "rotor" : "system", large(b.born), last_word(b.born));
  return fmt::format("above {} {} sets in. It is not known whether it grows from nothing or the {} jumps to it", at,
                     with_article(b.born), kind.shaft ? "rotor" : "system");
}

std::string of_gain(const io::Bifurcation& b, const BranchKind& kind, bool again) {
  const std::string where =
      fmt::format("stable{} above {}", again ? " again" : "", brief(b.value, b.uncertainty, b.unit));
  const std::string born = with_article(b.born) == b.born ? b.born : "the " + b.born;
  if (kind.linear) return fmt::format("{}: {} ends there", where, born);
  if (b.criticality == "supercritical") return fmt::format("{}: {} shrinks to nothing there", where, born);
  if (b.criticality == "subcritical")
    return fmt::format("{}: just above it a disturbance can still trigger {}", where, large(b.born));
  return fmt::format("{}: {} ends there. It is not known whether it does so gradually or by a jump", where, born);
}

}  // namespace

std::string with_article(const std::string& born) {
  if (born == "whirl" || born == "half-frequency whirl" || born == "whirl of twice the period") return born;
  return (born.starts_with('o') ? "an " : "a ") + born;
}

std::string parameter_word(std::string path) {
  while (!path.empty()) {
    const auto dot = path.rfind('.');
    std::string word = dot == std::string::npos ? path : path.substr(dot + 1);
    if (!word.empty() && !std::isdigit(static_cast<unsigned char>(word.front()))) {
      std::replace(word.begin(), word.end(), '_', ' ');
      return word;
    }
    path = dot == std::string::npos ? "" : path.substr(0, dot);
  }
  return "value";
}

std::string born_at(io::BifurcationType type, const BranchKind& kind) {
  switch (type) {
    case io::BifurcationType::hopf:
      return kind.shaft ? "whirl" : "oscillation";
    case io::BifurcationType::flip:
      if (!kind.shaft) return "oscillation of twice the period";
      return kind.self_excited || kind.turns != 1 ? "whirl of twice the period" : "half-frequency whirl";
    case io::BifurcationType::neimark_sacker:
      return kind.shaft ? "second whirl" : "second oscillation";
    default:
      return {};
  }
}

void put_counts(io::Bifurcation& b, const BranchChange& c) {
  b.more["others_unstable"] = std::min(c.before, c.behind);
  if (c.fold) {
    b.more["unstable_before"] = c.before;
    b.more["unstable_after"] = c.behind;
  } else {
    b.more["unstable_below"] = c.below();
    b.more["unstable_above"] = c.above();
  }
}

void tell(io::Bifurcation& b, const BranchKind& kind, bool again) {
  const auto count = [&](const char* name) -> std::optional<int> {
    const double n = more_of(b, name);
    return std::isfinite(n) ? std::optional(static_cast<int>(n)) : std::nullopt;
  };
  b.born = born_at(b.type, kind);
  if (is_fold(b)) {
    const auto before = count("unstable_before"), after = count("unstable_after");
    if (!before || !after) return;
    const bool one_half = std::min(*before, *after) == 0 && *before != *after;
    b.stable_side = one_half ? b.criticality == "undetermined" ? "" : b.criticality : "neither";
    b.sentence = of_fold(b, kind, *before, *after);
    return;
  }
  const auto below = count("unstable_below"), above = count("unstable_above");
  if (!below || !above || *below == *above) return;
  b.stable_side = *below == 0 ? "below" : *above == 0 ? "above" : "neither";
  if (b.stable_side == "neither")
    b.sentence = of_further(b, kind, *below, *above);
  else if (b.type == Type::branch_point)
    b.sentence = fmt::format("stable {} {}; another branch crosses here", b.stable_side, place(b));
  else
    b.sentence = b.stable_side == "below" ? of_loss(b, kind) : of_gain(b, kind, again);
}

void conclude(io::StudySummary& summary, const BranchVerdict& verdict, const BranchKind& kind,
              const std::string& unit) {
  summary.stability = verdict.text();
  summary.ranges = verdict.ranges(unit);
  for (std::size_t k = 0; k < summary.bifurcations.size(); ++k) {
    io::Bifurcation& b = summary.bifurcations[k];
    if (verdict.open_at(static_cast<int>(k))) {
      b.criticality = "undetermined";
      b.criticality_by = "the film is not resolved here";
      continue;
    }
    // The Hopf point that cycles are born at is one of the equilibria.
    const bool on_branch = !(kind.cycles && b.type == Type::hopf);
    const bool again = std::any_of(summary.ranges.begin(), summary.ranges.end(), [&](const io::StabilityRange& r) {
      return r.stability == "stable" && std::max(r.from, r.to) <= b.value;
    });
    tell(b, kind, on_branch && again);
  }
}

}  // namespace whirl::study
