#pragma once
// Tabled values between the rows of their table.

#include <cstddef>
#include <span>
#include <vector>

namespace whirl::core {

/// Several columns over rising abscissae, each cubic between the rows with a continuous slope and without overshooting
/// (where the rows rise the curve rises), or linear. Beyond the first and the last row the values there hold. One row
/// holds everywhere. Source: Fritsch and Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300.
class Curve {
public:
  enum class Between { cubic, linear };

  /// `values` are rows one after the other [rows x columns]. Throws core::InputError if abscissae do not rise.
  Curve(std::vector<double> abscissae, std::vector<double> values, Between between);
  Curve() = default;

  [[nodiscard]] bool empty() const { return abscissae_.empty(); }
  /// More than one row: values may change.
  [[nodiscard]] bool varies() const { return abscissae_.size() > 1; }
  [[nodiscard]] double first() const { return abscissae_.front(); }
  [[nodiscard]] double last() const { return abscissae_.back(); }
  /// Values and derivatives of all columns at x. Beyond the rows the derivatives are zero. At a row a linear curve has
  /// the derivative of the interval above.
  void at(double x, std::span<double> value, std::span<double> slope) const;

private:
  std::vector<double> abscissae_, values_, slopes_;
  std::size_t columns_ = 0;
};

}  // namespace whirl::core
