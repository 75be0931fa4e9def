#pragma once
// Films of gas, point by point, as a checkpoint keeps them.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "study/bearing/gas_point.hpp"
#include "study/pieces.hpp"

namespace whirl::study {

/// What is told of a film of gas.
struct GasQuantity {
  const char *name, *unit, *text;
  std::function<double(const GasPoint&)> of;
};
[[nodiscard]] std::span<const GasQuantity> gas_quantities();

/// A film, or why there is none.
struct GasRow {
  double speed = 0, eccentricity = io::no_value;               ///< rad/s; in clearances
  std::array<double, 2> place{io::no_value, io::no_value};     ///< m
  std::vector<double> values;                                  ///< of gas_quantities(); not numbers without a film
  std::vector<film::NodalField> fields;                        ///< if they were asked for
  std::string reason;                                          ///< empty: there is a film
  double capacity = io::no_value, at_capacity = io::no_value;  ///< N; eccentricity: the most that it carries
  [[nodiscard]] bool found() const { return reason.empty(); }
  void members(auto& archive) { archive(eccentricity, place, values, fields, reason, capacity, at_capacity); }
};
void members(auto& archive, film::NodalField& f) {
  archive(f.pad, f.name, f.unit, f.shape, f.values);
}

/// The piece of that name: what `compute` returns, which must not communicate, or why it does not. A film that carries
/// less than its load leaves the most that it carries. All ranks compute alike, and get the same. Collective.
[[nodiscard]] GasRow gas_row(MPI_Comm comm, Pieces& pieces, const std::string& name, double speed, bool fields,
                             const std::function<GasPoint()>& compute);

/// Why each has no film; empty: it has one.
[[nodiscard]] std::vector<std::string> reasons_of(const std::vector<GasRow>& rows);

}  // namespace whirl::study
