#pragma once
// Resonances of a linear response that may hide between the speeds at which it is known.

#include <complex>
#include <cstddef>
#include <functional>
#include <map>
#include <vector>

#include "whirl/rotor/options.hpp"

namespace whirl::study {

/// Eigenvalues [1/s] about the equilibria over the speed [rad/s].
using Spectra = std::map<double, std::vector<std::complex<double>>>;

/// An eigenvalue that vibrates with abs(lambda) = speed. A single resonance f = f_top/(1 + ((s - speed)/width)^2)^(1/2)
/// falls to 0.707 of its height at a distance of its width abs(Re lambda).
struct Resonance {
  double speed = 0, width = 0;  ///< [rad/s]
  bool undamped = false;        ///< no narrower one has a height that could be told
};

/// What is looked for, and how far.
struct ResonanceSearch {
  double limit = 0;           ///< [rad/s]
  std::size_t most = 0;       ///< spectra that `more` is asked for
  double least_width = 3e-5;  ///< of the speed, of what has no damping: nearer speeds say nothing new
  bool lossless = true;       ///< eigenvalues know of all damping
};
/// Up to resolved_to(). A loss factor, which eigenvalues know nothing of, makes resonances wider: a tenth of what it
/// does to the shaft alone is the least.
[[nodiscard]] ResonanceSearch search_of(const rotor::Options& rotor, std::size_t most);

/// Damping ratio below which a resonance is as good as undamped: rounding of eigenvalues is no more than that.
inline constexpr double no_damping = 1e-8;

/// Of a frequency: what rounding leaves of an eigenvalue. At an undamped resonance no farther away there is no answer.
inline constexpr double at_pole = 1e-9;

/// Damping ratio from which on a resonance has no peak: abs(1 - r^2 + 2 i zeta r) has no minimum over r any more.
inline constexpr double no_peak = 0.7071;

/// Undamped resonances among eigenvalues [1/s] (both of each pair) between two frequencies and below the limit, by
/// rising frequency; equal ones once. Where there is a loss factor, none is known.
[[nodiscard]] std::vector<Resonance> undamped_resonances(const std::vector<std::complex<double>>& eigenvalues,
                                                         double from, double to, const ResonanceSearch& search);

/// Whether the mode whose modulus is nearest to a speed is undamped. Where no spectrum and no modulus is known near it,
/// or there is a loss factor, none is.
[[nodiscard]] bool undamped_at(const Spectra& known, double speed, const ResonanceSearch& search);

/// Whether the rising speeds (or frequencies) stand so near each other about `at` that a resonance of this width shows.
[[nodiscard]] bool shows(const std::vector<double>& computed, double at, double width);

/// Resonances among eigenvalues [1/s] (both of each pair) that do not show at the rising frequencies `computed`, by
/// rising frequency up to the limit.
[[nodiscard]] std::vector<Resonance> narrow_resonances(const std::vector<std::complex<double>>& eigenvalues,
                                                       const std::vector<double>& computed,
                                                       const ResonanceSearch& search);

/// Whether a resonance with a peak, at most `below` of `speed` below it or `above` of it above it, stands among the
/// eigenvalues [1/s] there.
[[nodiscard]] bool resonance_near(const std::vector<std::complex<double>>& eigenvalues, double speed, double below,
                                  double above);

/// Speeds around a resonance at which a response shows it: on either side, and just beside its top. At the top itself
/// an undamped machine has no response.
[[nodiscard]] std::vector<double> around(const Resonance& resonance);

/// Resonances between known speeds that do not show in a response at the rising speeds `computed`, by rising speed.
/// Two neighbours of `known` enclose as many as the number of eigenvalues with abs(lambda) below the speed differs by:
/// eigenvalues in the order of their moduli are continuous over the speed, whatever they do. A mode that comes and goes
/// between two known speeds is seen by the parabola through three of them. Each resonance is enclosed further, by
/// secants and halves, to a tenth of its width, with the eigenvalues that `more` puts into `known`, unless it shows:
/// where `computed` stand near enough, or at one of `tops`, speeds among `known`. Those beyond the limit are left out,
/// and jumps of the spectrum, where no modulus meets the speed.
///
/// Cost: about four spectra a resonance.
struct HiddenResonances {
  std::vector<Resonance> found;
  bool gave_up = false;  ///< some may be missing: they need more spectra than `most`, or one that `more` did not put
};
[[nodiscard]] HiddenResonances hidden_resonances(Spectra& known, const std::vector<double>& computed,
                                                 const std::vector<double>& tops, const ResonanceSearch& search,
                                                 const std::function<void(const std::vector<double>& speeds)>& more);

/// Speeds at which, by parabolas through three neighbours, a vibration grows that falls away at all of them; `known` in
/// the order of their moduli, as hidden_resonances() leaves them.
[[nodiscard]] std::vector<double> where_growth_may_hide(const Spectra& known, const ResonanceSearch& search);

}  // namespace whirl::study
