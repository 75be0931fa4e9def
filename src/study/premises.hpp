#pragma once
// What the numbers of a study rest on beside its own options: the unbalance that is applied, tables over the speed.

#include <string>
#include <vector>

#include "whirl/study/study.hpp"

namespace whirl::study {

/// Fractions of a balance grade that do not sum to one, a weight that points upwards, bearings and discs of
/// proportions that no usual machine has: a line each.
[[nodiscard]] std::vector<std::string> machine_warnings(const system::Machine& machine);

/// Speeds of `study` at which the coefficients of a bearing or an element are not known, a line for each.
[[nodiscard]] std::vector<std::string> table_warnings(const system::Machine& machine, const Study& study);

/// Adds the unbalance that the study applies: the mass of each grade, `unbalance.NAME.mass` [kg], U of each plane,
/// `unbalance.NAME.plane.K` [kg m], and a table `unbalance` of all planes; the lines of table_warnings(), and
/// warn_of_films() of every study that solves a film of the machine.
void put_premises(StudyResult& result, const system::Machine& machine, const Study& study);

}  // namespace whirl::study
