#pragma once
// Words for eigenvalues and mode shapes of rotors.

#include <array>
#include <complex>
#include <optional>
#include <vector>

namespace whirl::spectral {

/// `either`: of equal eigenvalues, any combination of whose shapes is a mode.
enum class Sense { planar, forward, backward, mixed, either };
[[nodiscard]] const char* name_of(Sense sense);

/// How the kinetic energy of a shape divides. x + i y of a node is f exp(i omega t) + conj(b) exp(-i omega t) with
/// |f|, |b| = |x +- i y|/2, and the energy goes with E = sum m (|f|^2 + |b|^2).
struct WhirlEnergy {
  double whirl = 0;    ///< sum m | |f|^2 - |b|^2 |/E in [0, 1]: 0 if every node moves on a line, 1 if on a circle
  double forward = 0;  ///< sum m (|f|^2 - |b|^2)/E in [-whirl, whirl]: negative if backward motion carries more
};
/// Of a shape given by x and y at the shaft's nodes (same length, for exp(+i omega t), omega > 0) with the nodes'
/// masses [kg]; equal ones if `mass` is empty.
[[nodiscard]] WhirlEnergy whirl_energy(const std::vector<std::complex<double>>& x,
                                       const std::vector<std::complex<double>>& y,
                                       const std::vector<double>& mass = {});

/// Whether all nodes of a shape (x at the nodes, then y) turn on backward circles, but for rounding: as a rotor with
/// supports alike in both directions does. Its forces have no forward part then, and those of unbalance, which turn
/// forward, do no work on it.
[[nodiscard]] bool turns_backward(const std::vector<std::complex<double>>& shape);

/// In a word: planar if `whirl` is below 0.1, an orbit of half-axes 20 to 1; else forward or backward if at least nine
/// tenths of the whirling energy turn so; mixed if neither.
[[nodiscard]] Sense sense_of_whirl(const WhirlEnergy& energy);
[[nodiscard]] Sense sense_of_whirl(const std::vector<std::complex<double>>& x,
                                   const std::vector<std::complex<double>>& y, const std::vector<double>& mass = {});

/// Of all combinations c[0] a + c[1] b of two shapes (each x at the nodes, then y) the two whose `forward` is least and
/// largest: W c = t E c with the Hermitian forms W = Im(y* M x) and E = (x* M x + y* M y)/2 of a and b. Nothing where
/// the shapes are dependent.
using Combination = std::array<std::complex<double>, 2>;
[[nodiscard]] std::optional<std::array<Combination, 2>> extremes_of_whirl(const std::vector<std::complex<double>>& a,
                                                                          const std::vector<std::complex<double>>& b,
                                                                          const std::vector<double>& mass = {});

/// How each node turns: sin of the phase by which y lags behind x, weighted by both, 2 Im(conj(y) x)/(|x|^2 + |y|^2) in
/// [-1, 1]: 1 on a forward circle, -1 on a backward one, 0 on a line; 0 for a node that moves less than 1e-6 of the one
/// that moves most, of which rounding decides.
[[nodiscard]] std::vector<double> turning(const std::vector<std::complex<double>>& x,
                                          const std::vector<std::complex<double>>& y);

/// The kind of a mode by the nodes alone, whatever their motion weighs: planar if all move on lines, forward or
/// backward if all that turn do so one way, mixed if some turn one way and some the other. An orbit counts as a line
/// while |turning| <= `straight`. Source: Skarolek (2011), appendix B, where nodes on lines among turning ones have no
/// rule: they say nothing here.
inline constexpr double straight = 1e-6;
[[nodiscard]] Sense sense_by_nodes(const std::vector<double>& turning);

/// Whether lambda is an oscillation. Two equal real eigenvalues part by rounding into a pair that is none: its
/// imaginary part is below 1e-7 of the modulus.
[[nodiscard]] bool vibrates(std::complex<double> lambda);
/// delta = -2 pi Re(lambda)/|Im(lambda)|; infinite for a real eigenvalue.
[[nodiscard]] double log_decrement(std::complex<double> lambda);
/// zeta = -Re(lambda)/|lambda| in [-1, 1]: 1 and -1 for real eigenvalues that decay and grow, 0 for lambda = 0.
[[nodiscard]] double damping_ratio(std::complex<double> lambda);
/// Damping ratio above which a motion is overdamped here: it falls to 2e-6 of its size in one oscillation.
inline constexpr double overdamped_above = 0.9;
/// nu = 10^-delta; unstable above 1. Source: Gavalas (2022), Sec. 4.1, errata 12.
[[nodiscard]] double stability_factor(std::complex<double> lambda);
/// Modal assurance criterion |a* b|^2/(|a|^2 |b|^2) in [0, 1] of two shapes of the same length.
[[nodiscard]] double mac(const std::vector<std::complex<double>>& a, const std::vector<std::complex<double>>& b);

}  // namespace whirl::spectral
