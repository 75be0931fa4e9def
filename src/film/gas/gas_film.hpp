#pragma once
// Film of gas: mesh, equations and what they answer.

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "film/algebra/stencil.hpp"
#include "film/gas/gas_bore.hpp"
#include "film/gas/gas_feed.hpp"
#include "whirl/film/contract/film.hpp"

namespace whirl::film {

/// What makes gas flow along a gap: h^3 p^2 + first h^2 p + second h ln(p), with the slip at the walls.
struct GasDrive {
  double first = 0, second = 0;  // 12 a, 12 a^2, a = mu sqrt(pi r T/2) [Pa m]
  // From one pressure to another one, and its derivatives.
  struct Rise {
    double value, by_low, by_high, by_h;
  };
  [[nodiscard]] Rise rise(double h, double low, double high) const {
    const double h2 = h * h, cube = h2 * h, squares = high * high - low * low;
    Rise out{cube * squares, -2.0 * cube * low, 2.0 * cube * high, 3.0 * h2 * squares};
    if (first != 0.0) {
      out.value += first * h2 * (high - low);
      out.by_low -= first * h2;
      out.by_high += first * h2;
      out.by_h += 2.0 * first * h * (high - low);
    }
    if (second != 0.0) {
      const double logs = std::log(high / low);
      out.value += second * h * logs;
      out.by_low -= second * h / low;
      out.by_high += second * h / high;
      out.by_h += second * logs;
    }
    return out;
  }
};

/// States: pressure [Pa, absolute] at the nodes between the ends of the bearing, line by line along z around the bore,
/// then the unknowns of the orifices: pressures at their rims, pressures in pockets, flows out of pockets [kg/s]. Rows
/// of nodes are the mass balance of their cells over what a pascal adds to it [Pa/s], those of orifices the pressure
/// between rim and nodes [Pa] and the balance of their pockets [Pa/s]:
///
///   dp/dt + (p dh/dt + div q - source)/h = 0,   q = (Omega R/2) h p e_theta - h^3/(24 mu) grad p^2,   source = r T
///   m/area (p_o^2 - p^2 + 12 mu r T m/(pi h^3) ln(rim/reach))/(2 p_s) = 0,   d p_pocket/dt - r T (m_in - m)/V = 0
///
/// with slip h^3 grad p^2 is that of a GasDrive. Nodes in grooves and between pads keep their pressure.
class GasFilm final : public Film {
public:
  /// Throws core::InputError on values outside their range.
  GasFilm(const Geometry& geometry, const Gas& options, const Lubricant& lubricant);

  [[nodiscard]] std::span<const Port> ports() const override;
  [[nodiscard]] std::size_t states() const override { return nodes_ + unknowns_; }
  [[nodiscard]] std::vector<StateField> state_fields() const override;
  [[nodiscard]] int cut(int near) const override;
  [[nodiscard]] Share share(int begin, int end) const override;
  /// A V-cycle; none where a rank holds less than two lines.
  [[nodiscard]] std::unique_ptr<StateInverse> inverse(MPI_Comm comm, const Share& share) const override;
  /// Line by line the film without slip between two plates as thick as here that a row of orifices feeds as a slit, in
  /// closed form but for the pressure behind the orifices.
  void unloaded(const JournalMotion& motion, std::span<double> states) const override;
  void evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                std::span<const double> rates, Need need, StateResponse& response) override;
  using Film::evaluate;
  void resample(const JournalMotion& motion, const Film& other, std::span<const double> from,
                std::span<double> to) const override;
  [[nodiscard]] double least_thickness(const JournalMotion& motion, std::span<const double> states) override;
  [[nodiscard]] bool thickness_of_states() const override { return false; }
  FilmReport summary(const JournalMotion& motion, std::span<const double> states) override;
  std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> states) override;

private:
  struct Part;  // what an evaluation of a share takes and gives
  void around(const Part& part) const;
  void along(const Part& part) const;
  void feed(const Part& part, const Share& share, std::span<const double> rates) const;
  void hold(const Part& part, std::size_t k, std::size_t own, std::span<const double> rates,
            const std::array<double, 4>& w, double pressure) const;
  void close(const Part& part, std::span<const double> rates) const;
  // Lines that a share holds; where one of them, or one beside them, begins among the states seen; the row of a node.
  [[nodiscard]] Lines lines_of(const Share& share) const {
    return {share.begin / inner_, std::min(share.end / inner_, lines_)};
  }
  [[nodiscard]] std::size_t seen_at(const Lines& lines, int line) const {
    return static_cast<std::size_t>(line - lines.begin + 1) * static_cast<std::size_t>(inner_);
  }
  [[nodiscard]] std::size_t row(const Lines& lines, int line, int place) const {
    return static_cast<std::size_t>((line - lines.begin) * inner_ + place);
  }
  [[nodiscard]] double from_grooves(const JournalMotion& motion, std::span<const double> states) const;
  void place_feeds();
  // Place of unknown k of a feed among the unknowns of all.
  [[nodiscard]] std::size_t unknown(std::size_t feed, int k) const {
    return number_[feed][static_cast<std::size_t>(k)];
  }
  [[nodiscard]] std::size_t at(int line, int place) const {
    return static_cast<std::size_t>(line) * static_cast<std::size_t>(inner_) + static_cast<std::size_t>(place);
  }
  [[nodiscard]] double angle(double line) const { return bore_.start() + line * dtheta_; }
  [[nodiscard]] double z(double place) const { return (place + 1) * dz_ - 0.5 * geometry_.length; }
  [[nodiscard]] JournalMotion seen(JournalMotion motion) const;
  [[nodiscard]] double thickness(const JournalMotion& motion, int half_line, double place) const;
  [[nodiscard]] double thickness(const JournalMotion& motion, const GasFeed& feed) const;
  // What `states` say of a feed.
  [[nodiscard]] std::array<double, 2> unknowns_of(std::size_t feed, const double* unknowns) const {
    return {unknowns[unknown(feed, 0)], feeds_[feed].unknowns() > 1 ? unknowns[unknown(feed, 1)] : 0.0};
  }
  // Pressure with the ends, place -1 ... inner_.
  [[nodiscard]] double pressure(std::span<const double> states, int line, int place) const {
    return place < 0 || place >= inner_ ? options_.ambient : states[at(line, place)];
  }

  Geometry geometry_;
  Gas options_;
  double viscosity_;
  GasDrive drive_;
  int lines_, inner_;  // lines of nodes around, nodes of a line between the ends
  double dtheta_, dz_, dx_;
  double mean_;  // of cos(theta) over a cell, over its value in the middle
  std::size_t nodes_;
  GasBore bore_;
  std::vector<GasFeed> feeds_;
  std::vector<std::array<std::size_t, 2>> number_;
  std::size_t unknowns_ = 0, flows_ = 0, reads_ = 0;  // of all feeds; before the first flow; nodes that they read
};

}  // namespace whirl::film
