#pragma once
// A linear response to unbalance: the motion at its places over the speed, their peaks, and what it leaves in the
// results.

#include <complex>
#include <string>
#include <vector>

#include "study/linear/resonances.hpp"
#include "study/linear/response_peaks.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

/// x = Re(z exp(i angle)) of one place.
struct NodeMotion {
  std::complex<double> x, y;

  // z = x + i y is the sum of a forward circle |f| and a backward circle |g|.
  [[nodiscard]] double forward() const { return std::abs(x + std::complex<double>(0, 1) * y) / 2; }
  [[nodiscard]] double backward() const { return std::abs(x - std::complex<double>(0, 1) * y) / 2; }
  [[nodiscard]] double semi_major() const { return forward() + backward(); }
  [[nodiscard]] double semi_minor() const { return forward() - backward(); }  ///< negative: backward orbit
  void members(auto& archive) { archive(x, y); }
};

/// At one speed [rad/s].
struct ResponseAtSpeed {
  double speed = 0;
  double largest = 0;  ///< displacement anywhere on the shaft [m]
  std::vector<NodeMotion> nodes, bearings;
  std::vector<double> films;  ///< smallest thickness that the linear motion leaves each bearing [m]

  /// All but the speed not a number.
  [[nodiscard]] static ResponseAtSpeed without_answer(double speed, std::size_t n_nodes, std::size_t n_bearings);
  void members(auto& archive) { archive(speed, largest, nodes, bearings, films); }
};
using Places = std::vector<NodeMotion> ResponseAtSpeed::*;

/// Semi-major axes of one place over the speeds; zero below 1e-12 of the largest displacement, where they are rounding.
[[nodiscard]] ResponseCurve curve_at(const std::vector<ResponseAtSpeed>& curve, Places places, std::size_t at);

/// Puts amplitudes at the operating speed as operating.*.
void put_operating(const std::vector<std::string>& bearings, const std::vector<int>& nodes, const ResponseAtSpeed& r,
                   io::StudySummary& summary);
/// Puts columns of amplitudes and phases [speed][place].
void put_motion(io::Group& g, const std::vector<ResponseAtSpeed>& curve, Places places, const std::string& text);

/// The bearing in which the linear motion leaves less film than the surfaces bear; empty where all have enough.
[[nodiscard]] std::string touched(const ResponseAtSpeed& r, const system::ShownPlaces& places);
/// Puts what the motions leave of the films, marks the speeds at which they leave too little, and warns of these.
/// Linear motions know no bore: there they are none.
void put_films(io::Group& group, io::StudySummary& summary, const system::ShownPlaces& places,
               const std::vector<ResponseAtSpeed>& curve, const std::string& unit);

/// A shaft node, or the journal of a bearing.
struct ResponsePlace {
  std::string label, head;  ///< in the list of peaks, and of its values
  Places of;
  std::size_t at;
};
[[nodiscard]] std::vector<ResponsePlace> places_of(const std::vector<int>& nodes,
                                                   const std::vector<std::string>& bearings);

/// The peaks of a curve by falling height; those without a height are the highest.
[[nodiscard]] std::vector<std::size_t> tops_of(const ResponseCurve& curve);

/// Adds the speeds of the peaks of all places, of one resonance one; where `settled` only those whose place is.
void add_tops(std::vector<double>& speeds, const std::vector<ResponseAtSpeed>& curve,
              const std::vector<ResponsePlace>& places, bool settled);

/// Why the numbers of a peak are not settled; empty if they are, and of one that is too narrow for a height, which says
/// so itself. `refined`: speeds were added.
[[nodiscard]] std::string unsettled(const ResponseCurve& curve, std::size_t top, const Peak& peak, bool refined,
                                    const std::string& unit);

/// In words the resonances of `hidden` at which the response has a peak at one of `more` speeds, with the height that
/// it has there if it is damped.
[[nodiscard]] std::vector<std::string> shown_by(std::vector<ResponseAtSpeed> curve,
                                                const std::vector<ResponseAtSpeed>& more,
                                                const std::vector<Resonance>& hidden,
                                                const std::vector<ResponsePlace>& places, const std::string& unit);

}  // namespace whirl::study
