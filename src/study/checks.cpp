#include <fmt/core.h>

#include <algorithm>

#include "whirl/io/record.hpp"
#include "whirl/rotor/hinges.hpp"
#include "whirl/study/study.hpp"

namespace whirl::study {

bool Study::goes_on_from(const Study& earlier) const {
  const std::string from = starts_from();
  return !from.empty() && (from == earlier.name() || earlier.may_add(io::plain_name(from)));
}

namespace {

// Whether item i stands before it in the list already.
template <class T>
bool repeats(const std::vector<T>& list, std::size_t i) {
  const auto item = list.begin() + static_cast<std::ptrdiff_t>(i);
  return std::find(list.begin(), item, *item) != item;
}

}  // namespace

void check_unbalance(const std::vector<std::string>& names, const system::Machine& machine,
                     const deck::Report& report) {
  if (names.empty()) report.fail("unbalance", "'unbalance' is empty");
  for (std::size_t i = 0; i < names.size(); ++i)
    if (repeats(names, i))
      report.fail(fmt::format("unbalance.{}", i + 1),
                  fmt::format("'{}' stands in this list already: it would count twice", names[i]));
    else if (names[i] == system::unbalance_of_discs && !system::find_unbalance(machine, names[i])) {
      if (!system::discs_force(machine))
        report.fail(fmt::format("unbalance.{}", i + 1), "no disc has an 'eccentricity' or a 'skew'");
    } else if (!system::find_unbalance(machine, names[i]))
      report.fail(fmt::format("unbalance.{}", i + 1),
                  fmt::format("there is no unbalance '{}'{}", names[i],
                              deck::did_you_mean_one_of(names[i], system::unbalance_names(machine))));
}

void check_nodes(const std::string& key, const std::vector<int>& nodes, const system::Machine& machine,
                 const deck::Report& report) {
  const int n_nodes = static_cast<int>(machine.rotor.segments.size()) + 1;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (repeats(nodes, i))
      report.fail(fmt::format("{}.{}", key, i + 1), fmt::format("node {} is named twice", nodes[i]));
    else if (nodes[i] > n_nodes)
      report.fail(fmt::format("{}.{}", key, i + 1),
                  fmt::format("node {} does not exist: the shaft has nodes 1 to {}", nodes[i], n_nodes));
}

void check_carried_at_rest(const std::string& key, const system::Machine& machine, const deck::Report& report) {
  for (const system::Bearing& b : machine.bearings)
    if (!film::facts(b.film).coefficients)
      return report.fail(key, fmt::format("the film of bearing {} carries no load at rest: {} must be positive "
                                          "(linear films have coefficients at rest, too)",
                                          b.name, key == "speed" ? "the speed" : "speeds"));
}

void check_held(const system::Machine& machine, const deck::Report& report) {
  if (const auto loose = rotor::loose_part(machine.rotor, system::support_nodes(machine)))
    report.fail("", rotor::words(*loose, machine.rotor, "at its bearings alone"));
}

}  // namespace whirl::study
