#pragma once
// Thermo-hydrodynamics of one bearing: pressure, temperature in film and solids, heat and power at a given place of its
// journal or under a given load, over the speed.

#include <array>
#include <optional>
#include <vector>

#include "whirl/deck/one_or_more.hpp"
#include "whirl/study/study.hpp"
#include "whirl/thermal/options.hpp"
#include "whirl/thermal/turbulence.hpp"

namespace whirl::study {

struct ThdOptions {
  std::string name;
  std::string bearing;                  ///< its name; the first of the deck if empty
  std::vector<deck::Quantity> speeds;   ///< [rad/s]; fields are those at the last
  std::optional<double> eccentricity;   ///< of the journal, in clearances; 0 if neither it nor a load is given
  std::optional<double> attitude;       ///< of the journal, from +x counter-clockwise [rad]; 0 likewise
  deck::OneOrMore load;                 ///< on the journal [N]: one number downwards, or x and y; empty: a given place
  std::array<int, 3> cells{96, 32, 8};  ///< around, along, across the film
  enum class Cavitation { none, half_sommerfeld, reynolds, mass_conserving };
  Cavitation cavitation = Cavitation::none;
  thermal::Turbulence turbulence = thermal::Turbulence::laminar;
  bool second_order = true;  ///< convection of heat
  thermal::FluidOptions fluid;
  thermal::Ambient ambient;
  std::vector<thermal::OrificeRing> orifices;
  std::vector<thermal::SupplyGroove> grooves;
  thermal::WallOptions bush, journal;
  double tolerance = 1e-9;  ///< of temperatures, relative to the absolute temperature
  int most_iterations = 60;
  std::vector<deck::Quantity> temperatures;  ///< of the table of properties [K]; empty: none
  int meshes = 3;                            ///< that the error bars stand on, the deck's included
};
[[nodiscard]] std::span<const deck::Name<ThdOptions::Cavitation>> names(ThdOptions::Cavitation);
void describe(deck::Description<ThdOptions>& d);

class ThdStudy final : public StudyWith<ThdOptions, "thd"> {
public:
  void validate(const system::Machine& machine, const deck::Report& report) const override;
  [[nodiscard]] double memory(const system::Machine& machine, const LayoutOptions& layout) const override;
  [[nodiscard]] StudyResult run(Context& context) override;
  [[nodiscard]] io::Brief brief(const StudyResult& result, std::span<const io::StudySummary> before) const override;
};

}  // namespace whirl::study
