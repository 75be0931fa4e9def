#pragma once
// A law of viscosity that is asked for millions of times.

#include <array>
#include <vector>

#include "whirl/thermal/fluid.hpp"

namespace whirl::thermal {

/// A law as polynomials of seventh degree on pieces of 2 K, each made where it is first asked for. They agree with the
/// law within 1e-13 of the value and 1e-10 of the slope; where they would not, at a kink, the law itself answers.
/// The slope is that of the polynomial. A copy of its own for each owner: asking changes it.
class ViscosityTable {
public:
  explicit ViscosityTable(const Viscosity& law);
  /// Viscosity [Pa s] at a temperature [K] and its derivative [Pa s/K]. Between 200 and 1000 K by the table.
  [[nodiscard]] Valued at(double temperature) {
    const double place = (temperature - from) * per_kelvin;
    if (!(place >= 0.0 && place < pieces)) return viscosity(law_, temperature);
    Piece& piece = table_[static_cast<std::size_t>(place)];
    if (piece.kind != Kind::good && !prepare(piece, static_cast<int>(place))) return viscosity(law_, temperature);
    const double x = 2.0 * (place - static_cast<int>(place)) - 1.0;
    double value = piece.by[degree], slope = 0.0;
    for (int k = degree - 1; k >= 0; --k) {
      slope = slope * x + value;
      value = value * x + piece.by[static_cast<std::size_t>(k)];
    }
    return {value, 2.0 * per_kelvin * slope};
  }

private:
  static constexpr int degree = 7, pieces = 400;
  static constexpr double from = 200.0, per_kelvin = 0.5;
  enum class Kind { unknown, good, law };
  struct Piece {
    Kind kind = Kind::unknown;
    std::array<double, degree + 1> by{};  // coefficients of x in [-1, 1]
  };
  [[nodiscard]] bool prepare(Piece& piece, int number) const;

  Viscosity law_;
  std::vector<Piece> table_;
};

}  // namespace whirl::thermal
