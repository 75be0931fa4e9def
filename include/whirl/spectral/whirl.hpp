#pragma once
// Words for eigenvalues and mode shapes of rotors.

#include <complex>
#include <vector>

namespace whirl::spectral {

enum class Sense { forward, backward, mixed };
[[nodiscard]] const char* name_of(Sense sense);

/// Sense of whirl of a shape given by x and y at the shaft's nodes (same length): forward where |x + i y| > |x - i y|
/// for exp(+i omega t), omega > 0. Nodes that move less than a twentieth of the largest do not vote; mixed if the
/// others disagree.
[[nodiscard]] Sense sense_of_whirl(const std::vector<std::complex<double>>& x,
                                   const std::vector<std::complex<double>>& y);

/// delta = -2 pi Re(lambda)/|Im(lambda)|; infinite for a real eigenvalue.
[[nodiscard]] double log_decrement(std::complex<double> lambda);
/// nu = 10^-delta; unstable above 1. Source: Gavalas (2022), Sec. 4.1, errata 12.
[[nodiscard]] double stability_factor(std::complex<double> lambda);
/// Modal assurance criterion |a* b|^2/(|a|^2 |b|^2) in [0, 1] of two shapes of the same length.
[[nodiscard]] double mac(const std::vector<std::complex<double>>& a, const std::vector<std::complex<double>>& b);

}  // namespace whirl::spectral
