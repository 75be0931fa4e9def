#include "whirl/spectral/follow.hpp"

#include <algorithm>

#include "whirl/spectral/whirl.hpp"

namespace whirl::spectral {
namespace {

// A pair that may be one mode, and one that certainly is: where modes approach each other and part again their shapes
// mix, and only a shorter step tells which is which.
constexpr double possible_mac = 0.4, possible_apart = 0.25, sure_mac = 0.9, sure_apart = 0.01, sure_likeness = 0.6;

struct Match {
  double mac, apart;
  std::size_t a, b;
  [[nodiscard]] double score() const { return mac - 2 * apart; }
  [[nodiscard]] bool sure() const {
    return (mac > sure_mac && apart < 0.2) || (mac > sure_likeness && apart < sure_apart);
  }
};

}  // namespace

ModeMatching match_modes(const std::vector<ModePoint>& first, const std::vector<ModePoint>& second, std::size_t count) {
  std::vector<Match> pairs;
  for (std::size_t a = 0; a < first.size(); ++a)
    for (std::size_t b = 0; b < second.size(); ++b) {
      const double size = std::max({std::abs(first[a].lambda), std::abs(second[b].lambda), 1e-300});
      const double apart = std::abs(first[a].lambda - second[b].lambda) / size;
      if (apart > possible_apart) continue;
      const double likeness = mac(first[a].shape, second[b].shape);
      if (likeness > possible_mac || apart < sure_apart) pairs.push_back({likeness, apart, a, b});
    }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Match& p, const Match& q) { return p.score() > q.score(); });
  ModeMatching out;
  out.before.assign(second.size(), -1);
  std::vector<bool> taken(first.size(), false), settled(first.size(), false), found(second.size(), false);
  for (const Match& p : pairs) {
    if (taken[p.a] || out.before[p.b] >= 0) continue;
    taken[p.a] = true;
    out.before[p.b] = static_cast<int>(p.a);
    settled[p.a] = found[p.b] = p.sure();
  }
  const auto all = [count](const std::vector<bool>& flags) {
    return std::all_of(flags.begin(), flags.begin() + static_cast<std::ptrdiff_t>(std::min(count, flags.size())),
                       [](bool f) { return f; });
  };
  out.sure = all(settled) && all(found);
  return out;
}

}  // namespace whirl::spectral
