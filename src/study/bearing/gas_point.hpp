#pragma once
// A film of gas with its journal held: what it carries, takes and loses, and the same as a checkpoint keeps it.

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "study/bearing/film_at_rest.hpp"
#include "study/packed.hpp"
#include "whirl/film/contract/film.hpp"
#include "whirl/film/contract/gas.hpp"
#include "whirl/io/quantity.hpp"
#include "whirl/system/train.hpp"

namespace whirl::study {

struct GasPoint {
  double speed = 0, eccentricity = 0;  // rad/s; in clearances
  std::array<double, 2> place{};       // m
  double load = 0, attitude = 0;       // N; from the load to the journal, with the rotation [rad]
  film::FilmReport report;
  double normal_flow = 0;  // l/min of gas at 0 degC and 101325 Pa
  double knudsen = 0, reynolds = 0, squeeze_reynolds = 0, taylor = 0;
  long factorisations = 0;  // of Newton's method from the film between parallel plates; zero: not counted
  std::vector<film::NodalField> fields;
};

/// The film at a place of its journal, by Newton's method from a cold start. Throws core::DomainError and
/// core::NotConverged.
[[nodiscard]] GasPoint gas_at(const system::Support& support, double speed, const std::array<double, 2>& place);

/// Mean free path [m] at a pressure [Pa]: mu/p sqrt(pi r T/2). Source: Skarolek (2011) sec. 1.3.
[[nodiscard]] double mean_free_path(const film::Gas& gas, double viscosity, double pressure);

/// What is told of a film of gas.
struct GasQuantity {
  const char *name, *unit, *text;
  std::function<double(const GasPoint&)> of;
};
[[nodiscard]] std::span<const GasQuantity> gas_quantities();
/// Its place among them.
[[nodiscard]] std::size_t gas_quantity(std::string_view name);

/// A film, or why there is none.
struct GasRow {
  double speed = 0, eccentricity = io::no_value;            ///< rad/s; in clearances
  std::array<double, 2> place{io::no_value, io::no_value};  ///< m
  std::vector<double> values;                               ///< of gas_quantities(); not numbers without a film
  std::vector<film::NodalField> fields;                     ///< if they were asked for
  std::string reason;                                       ///< empty: there is a film
  std::optional<Capacity> most;                             ///< of a film that carries less than its load
  [[nodiscard]] bool found() const { return reason.empty(); }
  void members(auto& archive) { archive(speed, eccentricity, place, values, fields, reason, most); }
};
void members(auto& archive, film::NodalField& f) {
  archive(f.pad, f.name, f.unit, f.shape, f.values);
}

/// What `compute` returns, or why it does not. A film that carries less than its load leaves the most that it carries.
[[nodiscard]] GasRow gas_row(double speed, bool fields, const std::function<GasPoint()>& compute);

}  // namespace whirl::study
