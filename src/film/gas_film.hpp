#pragma once
// Film of gas: mesh, equations and what they answer.

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "film/stencil.hpp"
#include "whirl/film/film.hpp"

namespace whirl::film {

/// States: pressure [Pa, absolute] at the nodes between the ends of the bearing, line by line along z around the bore,
/// then behind each orifice. Rows of nodes are the mass balance of their cells over what a pascal adds to it [Pa/s],
/// those of orifices the pressure between rim and node [Pa]:
///
///   dp/dt + (p dh/dt + div q - source)/h = 0,   q = (Omega R/2) h p e_theta - h^3/(24 mu) grad p^2,   source = r T
///   m/area (p_o^2 - p^2 + 12 mu r T m/(pi h^3) ln(d/(2 r0)))/(2 p_s) = 0,   m = c_o(h) A_o nozzle(p_s, p_o)
///
/// with r0 = exp(-gamma)/4 hypot(dx, dz) where a point source of a mesh of five points reads the pressure of its node.
class GasFilm final : public Film {
public:
  /// Throws core::InputError on values outside their range.
  GasFilm(const Geometry& geometry, const Gas& options, const Lubricant& lubricant);

  [[nodiscard]] std::span<const Port> ports() const override;
  [[nodiscard]] std::size_t states() const override { return nodes_ + orifices_.size(); }
  [[nodiscard]] std::vector<StateField> state_fields() const override;
  [[nodiscard]] int cut(int near) const override;
  [[nodiscard]] Share share(int begin, int end) const override;
  /// A V-cycle; none where a rank holds less than two lines.
  [[nodiscard]] std::unique_ptr<StatePreconditioner> preconditioner(MPI_Comm comm, const Share& share) const override;
  /// Line by line the film between two plates as thick as here that a row of orifices feeds as a slit, in closed form
  /// but for the pressure behind the orifices.
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
  struct Orifice {
    int line, place;  // of its node
    double diameter, supply;
  };
  // Mass flow [kg/s] of an orifice and its derivatives in the pressure behind it and in the thickness there.
  struct Flow {
    double mass, by_pressure, by_thickness;
  };
  struct Part;  // what an evaluation of a share takes and gives
  void around(const Part& part) const;
  void along(const Part& part) const;
  void through_orifices(const Part& part, const Share& share) const;
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
  void place_orifices();
  [[nodiscard]] Flow flow(const Orifice& o, double pressure, double thickness) const;
  [[nodiscard]] std::size_t at(int line, int place) const {
    return static_cast<std::size_t>(line) * static_cast<std::size_t>(inner_) + static_cast<std::size_t>(place);
  }
  [[nodiscard]] double angle(double line) const { return start_ + line * dtheta_; }
  [[nodiscard]] double z(double place) const { return (place + 1) * dz_ - 0.5 * geometry_.length; }
  [[nodiscard]] JournalMotion seen(JournalMotion motion) const;
  [[nodiscard]] double thickness(const JournalMotion& motion, double line, double place) const;
  // Pressure with the ends, place -1 ... inner_.
  [[nodiscard]] double pressure(std::span<const double> states, int line, int place) const {
    return place < 0 || place >= inner_ ? options_.ambient : states[at(line, place)];
  }

  Geometry geometry_;
  Gas options_;
  double viscosity_;
  thermal::Gas gas_;
  int lines_, inner_;  // lines of nodes around, nodes of a line between the ends
  double dtheta_, dz_, dx_, start_ = 0.0;
  double mean_;  // of cos(theta) over a cell, over its value in the middle
  std::size_t nodes_;
  std::vector<Orifice> orifices_;
};

}  // namespace whirl::film
