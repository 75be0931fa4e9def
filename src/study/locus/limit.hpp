#pragma once
// A quantity of cycles that a curve in two parameters keeps: an amplitude or the period.

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "study/located.hpp"
#include "study/state_rows.hpp"
#include "whirl/deck/description.hpp"
#include "whirl/solve/bifurcation/condition.hpp"
#include "whirl/system/plant.hpp"

namespace whirl::study {

struct LocusOptions;

struct LimitOptions {
  enum class Quantity { amplitude, peak_to_peak, eccentricity, period, whirl_ratio };
  enum class Direction { x, y };
  Quantity quantity = Quantity::amplitude;
  std::optional<std::string> bearing;  ///< whose journal moves
  std::optional<int> node;             ///< instead: of the shaft, 1-based
  Direction direction = Direction::y;
  deck::Quantity value;
  int passing = 1;  ///< of the branch, 1-based
};
[[nodiscard]] std::span<const deck::Name<LimitOptions::Quantity>> names(LimitOptions::Quantity);
[[nodiscard]] std::span<const deck::Name<LimitOptions::Direction>> names(LimitOptions::Direction);
void describe(deck::Description<LimitOptions>& d);
/// Reports a place that the machine does not have.
void check_limit(const LimitOptions& limit, const system::Machine& machine, const deck::Report& report);

/// "0-peak amplitude in y at B2".
[[nodiscard]] std::string words_of(const LimitOptions& limit);
/// Whether it is one of a place in the machine.
[[nodiscard]] bool has_place(const LimitOptions& limit);
[[nodiscard]] solve::CycleQuantity quantity_of(const LimitOptions& limit);
/// Of a system whose states this rank has as a whole; empty without a place.
[[nodiscard]] solve::LinearPlace place_of(const LimitOptions& limit, system::Plant& system);

/// What a branch of cycles finds of the limits that later curves of the deck keep. Replicated on all ranks.
class LimitsOnBranch {
public:
  /// Those that begin on the branch `name`.
  LimitsOnBranch(const Context& context, const std::string& name);
  [[nodiscard]] bool empty() const { return limits_.empty(); }
  /// quantity/value - 1 of each limit. Collective on the system's communicator.
  [[nodiscard]] std::vector<double> of(const CycleOrbit& orbit) const;
  /// The same of a point of the branch, for the range that it covers.
  void see(const std::vector<double>& at_point);
  void pass(std::size_t limit, const solve::Cycle& cycle);
  void write(io::Group& group, const SharedRows& like) const;
  void read(const io::Group& group, const SharedRows& like);

private:
  struct Limit {
    std::string name;  ///< of the curve, as a key
    const LimitOptions* options;
    double least = std::numeric_limits<double>::infinity(), most = -least;  // over the value
    std::vector<Located> passings{};
  };
  std::vector<Limit> limits_;
};

/// Where the results `branch` of a branch pass the limit of the curve `name`, with whole states. Throws
/// core::NotConverged, with the range that the branch covers, if they do not. Collective.
[[nodiscard]] Located passing_of(const LocusOptions& options, const std::string& name, const io::Group& branch,
                                 MPI_Comm comm);

}  // namespace whirl::study
