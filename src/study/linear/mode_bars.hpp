#pragma once
// Error bars of eigenvalues over speed, and what the reduction of the shaft did to them.

#include <array>
#include <complex>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "study/bars/unresolved.hpp"
#include "study/common.hpp"
#include "study/layout.hpp"
#include "study/pieces.hpp"
#include "whirl/io/summary.hpp"
#include "whirl/spectral/follow.hpp"
#include "whirl/study/study.hpp"
#include "whirl/system/rotor_system.hpp"

namespace whirl::study {

/// The modes of one speed with the identities that they have over all speeds.
struct SampledModes {
  double speed = 0;
  std::vector<int> ids;
  std::vector<spectral::ModePoint> modes;
  std::size_t listed = 0;  ///< the first of them, which results show
};

/// At so many speeds at most modes are computed on other meshes.
inline constexpr std::size_t most_with_bars = 5;

class ModeBars {
public:
  /// Computes the modes at the same equilibria on other film meshes and on the shaft with every segment cut in two,
  /// each paired by its shape. `modes_at` gives those of a system at an equilibrium. Collective.
  ModeBars(const Context& context, const Layout& layout, Pieces& pieces, const std::vector<SampledModes>& sampled,
           const std::function<std::vector<spectral::ModePoint>(system::RotorSystem&, Vec)>& modes_at);

  /// Bars of the real part [1/s], imaginary part [rad/s] and log decrement of a mode. At a speed with other meshes each
  /// is the largest of its own and those of the neighbours, so that a difference of meshes that vanishes by chance at
  /// one speed hides nothing; between two of these speeds it is on a straight line, so that eigenvalues at neighbouring
  /// speeds have like bars. NaN: unknown.
  [[nodiscard]] std::array<double, 3> at(int id, double speed) const;
  /// The largest error of a frequency by the mesh of the shaft as "shaft_mesh.largest_error" [1], with a warning above
  /// one per cent that names the element; and which of the modes that results show have no bars, and why.
  void tell(io::StudySummary& summary, const rotor::Options& rotor, const std::set<int>& shown) const;
  /// Whether a mode that grows is a vibration of the elements of the shaft.
  [[nodiscard]] bool of_elements(std::complex<double> lambda) const { return is_of_elements(lambda, resolved_to_); }
  /// Whether films or shaft have a mesh.
  [[nodiscard]] bool any() const { return any_; }
  // All of these give nothing where neither films nor shaft have a mesh.
  /// The same as numbers of a summary.
  [[nodiscard]] std::map<std::string, double> named(int id, double speed) const;
  [[nodiscard]] std::map<std::string, double> as_bar(double error) const;
  /// The same as columns beside those of the modes with these identities at these speeds.
  void put(io::Group& spectrum, const std::vector<std::int64_t>& ids, const std::vector<double>& speeds) const;

private:
  struct Point {
    double speed;
    std::array<double, 3> bar;
  };
  std::map<int, std::vector<Point>> of_;
  bool any_ = false;
  double resolved_to_;                            // [rad/s], by the mesh of the shaft
  double shaft_error_ = 0;                        // zero: not known
  std::map<std::string, std::set<int>> without_;  // modes that results show, by why they have no bars
  bool several_ = false;                          // speeds, at which they were computed
};

/// Errors of the reduction at the speeds that have bars; nothing where the shaft is whole.
class ModeReduction {
public:
  /// The modes at some speeds, whose equilibria the walker finds again. Collective.
  ModeReduction(const system::RotorSystem& system, Walker& walker, const std::vector<SampledModes>& sampled);
  /// "real_reduction_error" and "imag_reduction_error" [rad/s] of the mode that was added last, number k at its speed,
  /// and "reduction.largest_error" [rad/s], the largest modulus so far, not a number once
  /// an error is unknown.
  void put(io::StudySummary& summary, double speed, std::size_t k);

private:
  std::map<double, std::vector<std::complex<double>>> of_;
  double largest_ = 0;
};

}  // namespace whirl::study
