#include "whirl/thermal/viscosity_table.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace whirl::thermal {

ViscosityTable::ViscosityTable(const Viscosity& law) : law_(law), table_(pieces) {}

// Through the law at Chebyshev's nodes, and tried between them and at the ends.
bool ViscosityTable::prepare(Piece& piece, int number) const {
  if (piece.kind == Kind::law) return false;
  constexpr double of_value = 1e-13, of_slope = 1e-10;
  constexpr int n = degree + 1;
  const auto temperature = [&](double x) { return from + (number + 0.5 * (x + 1.0)) / per_kelvin; };
  const auto node = [](double k) { return std::cos((k + 0.5) * std::numbers::pi / n); };
  Eigen::Matrix<double, n, n> powers;
  Eigen::Matrix<double, n, 1> values;
  for (int r = 0; r < n; ++r) {
    const double x = node(r);
    powers(r, 0) = 1.0;
    for (int c = 1; c < n; ++c) powers(r, c) = powers(r, c - 1) * x;
    values(r) = viscosity(law_, temperature(x)).value;
  }
  const Eigen::Matrix<double, n, 1> by = powers.partialPivLu().solve(values);
  bool good = by.allFinite();
  for (int r = -1; good && r < n; ++r) {
    const double x = node(r + 0.5);
    double value = by(degree), slope = 0.0;
    for (int k = degree - 1; k >= 0; --k) {
      slope = slope * x + value;
      value = value * x + by(k);
    }
    const Valued law = viscosity(law_, temperature(x));
    good = std::abs(value - law.value) <= of_value * std::abs(law.value) &&
           std::abs(2.0 * per_kelvin * slope - law.slope) <=
               of_slope * std::abs(law.slope) + of_value * per_kelvin * std::abs(law.value);
  }
  for (int k = 0; k < n; ++k) piece.by[static_cast<std::size_t>(k)] = by(k);
  piece.kind = good ? Kind::good : Kind::law;
  return good;
}

}  // namespace whirl::thermal
