#pragma once
// Stiffness and damping of one film by enforced harmonic motions of its journal, amplitude by amplitude.

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "study/bearing/film_at_rest.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"

namespace whirl::study {

/// By motions of one amplitude along each port; not numbers where there is no such motion.
struct EnforcedAt {
  film::PortCoefficients coefficients;
  std::array<double, 4> tail{};        ///< of the motion along each port: what the highest harmonics are of the first
  std::array<std::string, 4> lost{};   ///< why there is none along a port; else empty
  std::array<double, 4> distortion{};  ///< of the forces by the motion along each port: what K and B leave of them
  double apart = 0;                    ///< largest difference from the perturbation, of the largest entry of its block
  void members(auto& archive) { archive(coefficients, tail, lost, distortion, apart); }
};

/// About `at` at the frequency omega [rad/s], of `amplitudes` in clearances, slopes' over twice the length:
/// [amplitude].
[[nodiscard]] std::vector<EnforcedAt> enforced_at(film::Film& film, const film::Geometry& bore, const JournalPlace& at,
                                                  double omega, std::span<const double> amplitudes,
                                                  const film::PortCoefficients& perturbation);

/// Values of one speed and frequency under names that begin with `head`.
void put_enforced(io::StudySummary& summary, const std::string& head, std::span<const double> amplitudes,
                  const std::vector<EnforcedAt>& found);

/// What motions have no values and why, one line a reason with the first of them; speeds in words, [speed].
[[nodiscard]] std::vector<std::string> lost_motions(const std::vector<std::vector<std::vector<EnforcedAt>>>& found,
                                                    const std::vector<std::string>& speeds,
                                                    const std::vector<double>& ratios,
                                                    const std::vector<double>& amplitudes);

/// How many motions have no values, of how many.
[[nodiscard]] std::array<std::size_t, 2> motions_without_values(
    const std::vector<std::vector<std::vector<EnforcedAt>>>& found);

/// Tables [speed][frequency][amplitude].
void put_enforced_tables(io::Group& group, const std::vector<double>& speeds, const std::vector<double>& ratios,
                         const std::vector<double>& amplitudes,
                         const std::vector<std::vector<std::vector<EnforcedAt>>>& found);
/// Largest difference from the entries of b in the same block, shifts by shifts and slopes by slopes, of the largest
/// of these, over the first `ports`. Not a number where an entry is none.
[[nodiscard]] double difference(const film::PortCoefficients& a, const film::PortCoefficients& b, std::size_t ports);

/// xx, xy, ..., and with slopes x.slope_x, ...; what stands `between` only there.
inline constexpr std::array<const char*, 4> port_words = {"x", "y", "slope_x", "slope_y"};
[[nodiscard]] constexpr std::size_t slopes_in(std::size_t i, std::size_t j) {
  return (i > 1 ? 1U : 0U) + (j > 1 ? 1U : 0U);
}
[[nodiscard]] inline std::string pair_name(std::size_t i, std::size_t j, const char* between) {
  return std::string(port_words[i]) + (slopes_in(i, j) == 0 ? "" : between) + port_words[j];
}
/// By the number of slopes in a pair.
inline constexpr std::array<const char*, 3> stiffness_units = {"N/m", "N", "N m"},
                                            damping_units = {"N s/m", "N s", "N m s"};
/// K.xx, C.xx, ... under `head`, but for motions along ports that `skip` says.
void put_matrices(io::StudySummary& summary, const std::string& head, const film::PortCoefficients& c,
                  const std::function<bool(std::size_t port)>& skip = {});
/// Columns k_xx, c_xx, ... of `all`, in the order of the shape, whose axes the descriptions name.
void put_matrices(io::Group& table, const io::Shape& shape, const std::string& axes,
                  const std::vector<film::PortCoefficients>& all);

}  // namespace whirl::study
