#pragma once
// Journals that leave their bore where no pad is.

#include <cstddef>
#include <string>
#include <vector>

#include "whirl/io/summary.hpp"
#include "whirl/system/options.hpp"

namespace whirl::study {

/// How far journals move outside bores whose pads leave more than a quarter of the circle open. The equations have no
/// wall there, a machine has one.
class OpenBores {
public:
  explicit OpenBores(const system::Machine& machine);
  /// None of the bores is open.
  [[nodiscard]] bool empty() const;
  /// A journal at (x, y) [m] relative to the centre of bearing `place`; `at`: the parameter there.
  void see(std::size_t place, double x, double y, double at);
  /// A warning for each bearing whose journal was farther out than a clearance, with the largest distance;
  /// `unit`: of the parameter, empty if there is none.
  void warn(io::StudySummary& summary, const std::string& unit) const;

  /// What was seen so far.
  void members(auto& archive) {
    for (Bore& b : bores_) archive(b.farthest, b.at);
  }

private:
  struct Bore {
    std::string name;
    double clearance = 0, arc = 0;  // arc: of each pad [rad]; 0: not open
    bool two = false;               // an upper pad as well
    double farthest = 0;            // [clearances]
    double at = 0;                  // where that was
  };
  std::vector<Bore> bores_;
};

}  // namespace whirl::study
