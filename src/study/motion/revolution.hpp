#pragma once
// What one revolution of a run-up was, about a mean position that holds still under whirl.

#include <array>
#include <cstddef>
#include <vector>

namespace whirl::study {

/// Samples of all places at equal angles over one revolution, [place][sample], x and y.
struct Revolution {
  std::vector<std::vector<std::array<double, 2>>> samples;

  /// Largest (sign 1) or smallest (-1) coordinate of a place.
  [[nodiscard]] double extreme(std::size_t place, std::size_t direction, double sign) const;
  /// Largest distance of a place from `centre`.
  [[nodiscard]] double distance(std::size_t place, const std::array<double, 2>& centre) const;
  void members(auto& archive) { archive(samples); }
};

/// The revolutions about the one that is looked at, in the order in which they came.
///
/// A journal that whirls at about half the speed goes half around in a revolution: the mean of one revolution is half
/// way out on its orbit, and the distance from there is too large. The mean position is therefore that of nine
/// revolutions, weighted by Hann's window: whole orders leave nothing in it, whirl at 0.4 to 0.6 of the speed at most 1
/// % of its amplitude, at 0.25 of the speed nothing, and a mean position that drifts evenly is that of the middle.
class NearRevolutions {
public:
  static constexpr std::size_t width = 9;  // revolutions of the mean

  void add(Revolution next);
  /// Revolutions that were added, and those whose neighbours on both sides are all here.
  [[nodiscard]] long added() const { return first_ + static_cast<long>(all_.size()); }
  [[nodiscard]] long ready() const;
  [[nodiscard]] const Revolution& at(long revolution) const;
  /// Mean position of a place about a revolution; near an end of the record the window stays inside it.
  [[nodiscard]] std::array<double, 2> centre(long revolution, std::size_t place) const;
  /// Lets go of what no revolution from `revolution` on needs.
  void forget_before(long revolution);

  void members(auto& archive) { archive(first_, all_); }

private:
  [[nodiscard]] long window_begin(long revolution) const;
  std::vector<Revolution> all_;
  long first_ = 0;  // number of all_.front(), from 0
};

}  // namespace whirl::study
