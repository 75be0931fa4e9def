#pragma once
// A film of gas with its journal held: what it carries, takes and loses.

#include <array>
#include <vector>

#include "whirl/film/contract/film.hpp"
#include "whirl/film/contract/gas.hpp"
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

}  // namespace whirl::study
