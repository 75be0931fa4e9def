#pragma once
// Tables of modes: which way each turns, and how well its eigenvalue is conditioned.

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "study/linear/shaft_modes.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/io/table.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {

/// What columns of the sense of whirl say of themselves.
inline constexpr const char* whirl_text =
    "sense of whirl by the kinetic energy of the shaft's nodes; either: the mode has an equal one, any combination of "
    "both is a mode, and these two turn backward and forward as much as any";

/// One row for each mode at each speed asked for.
class ModeTables {
public:
  /// `z` and `mass` of the shaft's nodes [m, kg]; `condition`: with condition numbers.
  ModeTables(std::vector<double> z, std::vector<double> mass, bool condition)
      : z_(std::move(z)), mass_(std::move(mass)), condition_(condition) {}

  /// The next row, and what of it belongs into the summary's entry.
  void add(const ShaftMode& mode, io::ModeEntry& entry);
  /// Columns beside the others of the spectrum.
  void put_spectrum(io::Group& spectrum) const;
  /// How every node turns in the modes of the spectrum's rows.
  void put_map(io::Group& map) const;
  /// Says which eigenvalues have fewer vectors than their multiplicity, and where condition numbers are not known;
  /// `searches` by speed [rad/s].
  void warn(io::StudySummary& summary, const std::map<double, ModeSearch>& searches) const;
  /// Shapes of modes at some speeds [rad/s].
  void put_shapes(io::Group& shapes, const std::vector<double>& speeds,
                  const std::vector<std::span<const ShaftMode>>& modes) const;
  /// The sense of whirl by the kinetic energy of the nodes; `either` of equal modes without a common one.
  [[nodiscard]] spectral::Sense sense_of(const ShaftMode& mode) const;

private:
  std::vector<double> z_, mass_;
  bool condition_;
  std::vector<double> whirl_, forward_, taken_, turning_, numbers_;
  std::vector<std::int64_t> forward_nodes_, backward_nodes_, multiplicity_, vectors_;
  std::vector<std::string> sense_, rule_;
  std::vector<double> frequency_, speed_;
};

}  // namespace whirl::study
