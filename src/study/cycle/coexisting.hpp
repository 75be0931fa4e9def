#pragma once
// Solutions that coexist with the first one of a branch, found by deflation.

#include <functional>
#include <string>
#include <vector>

#include "study/parameter.hpp"
#include "study/stored_vector.hpp"
#include "whirl/io/record.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/solve/branch/deflation.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

[[nodiscard]] solve::DeflationOptions deflation_options(const Deflation& deflation, const solve::NewtonOptions& newton);

/// Equilibria at the present parameter of the plant beside the one that a branch begins with, each as a cycle of one
/// node. Collective; throws core::NotConverged if that one cannot be found.
[[nodiscard]] std::vector<solve::Cycle> coexisting_equilibria(system::Plant& plant, const Deflation& deflation,
                                                              const solve::NewtonOptions& newton);

/// The same motion begun `by` of its period later, s + by.
[[nodiscard]] solve::Cycle delayed(const solve::Cycle& cycle, const solve::Scheme& scheme, double by);
/// Guesses for forced cycles beside `cycle` of so many turns: its vibration larger, smaller, at other phases and
/// slower; the k-th of them.
[[nodiscard]] solve::Cycle other_vibration(const solve::Cycle& cycle, const solve::Scheme& scheme, int turns, int k);

/// What `find` finds into `group`/solutions, and the number of solutions with the first one as the value `solutions`. A
/// search that ends in no answer (has_answer()) found nothing, which a warning says: the branch itself
/// stays. `like` as of write_cycle(). Returns what was found.
std::vector<solve::Cycle> put_solutions(io::Group& group, io::StudySummary& summary,
                                        const std::function<std::vector<solve::Cycle>()>& find,
                                        const SharedRows& like = {});
/// The cycles of put_solutions(), for read_cycle(), in what it was given.
[[nodiscard]] std::vector<io::Group> solutions_in(const io::Group& group);

}  // namespace whirl::study
