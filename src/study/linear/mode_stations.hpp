#pragma once
// Modes over the speed: which is which, and where one crosses a border.

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "study/linear/shaft_modes.hpp"
#include "whirl/spectral/follow.hpp"

namespace whirl::study {

/// The modes at one speed [rad/s], as shaft_modes() orders them.
struct Station {
  double speed = 0;
  bool reported = false;  ///< asked for; others only help to follow the modes
  std::vector<ShaftMode> modes{};
  std::size_t listed = 0;  ///< of them, the first
  std::vector<std::complex<double>> overdamped{};
};

[[nodiscard]] std::vector<spectral::ModePoint> points_of(const std::vector<ShaftMode>& modes);

/// Puts stations between those whose modes cannot be told apart, as many at most as were asked for; then a few more
/// where a mode may cross a border unseen: where the numbers of modes below the speed at two stations differ by others
/// than those that are followed across it, and where a mode nears a border at three stations and leaves it again.
/// Then it gives each mode an identity: numbers from one in the order in which the results show the modes, next for
/// modes that cross a border, and negative ones for all others. Of each station the first `count` modes must be told
/// apart.
void follow(std::vector<Station>& stations, std::size_t count,
            const std::function<std::vector<Station>(const std::vector<double>&)>& modes_at);

/// What a mode crosses: its frequency the speed, or its real part zero.
enum class Border { critical, stability };

/// How far lambda is from the border at a speed: positive above the speed, or where it grows.
[[nodiscard]] double beyond(Border border, std::complex<double> lambda, double speed);

/// A mode on both sides of a border, at the speeds s0 and s1 with its distances f0 and f1 from it. Stations are in the
/// order of their speeds, and so are crossings.
struct Crossing {
  Border border = Border::critical;
  double s0 = 0, s1 = 0, f0 = 0, f1 = 0;
  ShaftMode guide{};        ///< the mode at s1
  std::size_t station = 0;  ///< at s1
  bool outside = false;     ///< where the mode does not grow it is not among those asked for
  ShaftMode before{};       ///< the mode at s0
};
[[nodiscard]] std::vector<Crossing> crossings_of(const std::vector<Station>& stations);

/// Two stations between which critical speeds may be missing.
struct LostCrossings {
  double from = 0, to = 0;  // [rad/s]
  int count = 0;
};
/// Modes above the speed end at the first one, and as many below it begin at the second, since they could not be
/// followed. Modes damped too much for a critical speed (API 684) do not count.
[[nodiscard]] std::vector<LostCrossings> lost_crossings(const std::vector<Station>& stations);

/// A mode that grows at one station and is not listed at the next or the one before: where it does not grow it may lie
/// outside what was asked for.
struct LostMode {
  ShaftMode guide{};
  std::size_t station = 0;  ///< where it is not listed
};
/// Those of `stations` that `grows` for sure at their speeds.
[[nodiscard]] std::vector<LostMode> lost_modes(const std::vector<Station>& stations,
                                               const std::function<bool(const ShaftMode&, double)>& grows);
/// Puts the mode among `found`, all of that station, which is like the lost one there, behind those that are listed.
void put_back(const LostMode& lost, const std::vector<ShaftMode>& found, std::vector<Station>& stations);

/// Where the crossing is, and the eigenvalue there.
struct CrossingPoint {
  double speed = 0;
  std::complex<double> lambda = 0;
  std::vector<std::complex<double>> shape{};  ///< as ShaftMode::both()
  double left = 0;                            ///< how far the border may be from there [rad/s]
  bool followed = true;  ///< false: between two stations, and the mode was not found nearer to the border
  void members(auto& archive) { archive(speed, lambda, shape, left, followed); }
};
/// Secants between both ends, each with the modes at that speed, of which the one like the mode found last is taken,
/// beginning with that at s1; where this loses it, with that at s0.
[[nodiscard]] CrossingPoint locate(const Crossing& crossing,
                                   const std::function<std::vector<ShaftMode>(double)>& modes_at);

/// Which of the critical speeds at `points`, as many as `crossings`, was found twice: between two stations modes of
/// like shapes may have been taken for one another. `lost`: where by the numbers of modes below the speed another one
/// is missing for it.
[[nodiscard]] std::vector<bool> found_twice(const std::vector<Station>& stations,
                                            const std::vector<Crossing>& crossings,
                                            const std::vector<CrossingPoint>& points, std::vector<LostCrossings>& lost);

/// Speeds over which one mode grows.
struct UnstableRange {
  int id = 0;
  double from = 0, to = 0;                  ///< [rad/s]
  bool begins = false, ends = false;        ///< at a crossing; else where the mode is first or last seen
  bool from_start = false, to_end = false;  ///< that is at the first, at the last speed of all
  std::complex<double> lambda = 0;          ///< at the crossing, else where it grows fastest
  std::optional<std::size_t> begin_crossing{}, end_crossing{};  ///< their places; none where it is undamped beside it
  ShaftMode fastest{};                                          ///< where it grows fastest of all stations
  double fastest_at = 0;                                        ///< [rad/s]
};
/// Of all modes with a number, by rising speed. `points` as many as `crossings`.
[[nodiscard]] std::vector<UnstableRange> unstable_ranges(const std::vector<Station>& stations,
                                                         const std::vector<Crossing>& crossings,
                                                         const std::vector<CrossingPoint>& points);

}  // namespace whirl::study
