#include "whirl/study/deck.hpp"

namespace whirl::study {

std::span<const deck::Citation> citations() {
  static constexpr deck::Citation all[] = {
      {"000",
       "B. L. van de Vrande (2001), Nonlinear dynamics of elementary rotor systems with compliant plain journal "
       "bearings, PhD thesis, Technische Universiteit Eindhoven, doi:10.6100/IR550147"},
      {"003",
       "A. Skarolek (2012), Numerical analysis of rotor systems with aerostatic journal bearings, dissertation, "
       "Technical University of Liberec"},
      {"004",
       "I. Gavalas (2022), Nonlinear rotordynamic design of turbine-generator shaft trains applying numerical "
       "continuation, diploma thesis, National Technical University of Athens; 'errata N' is the N-th of its misprints "
       "that this project corrects, stated on the page of the room (src/rotor, src/film, src/system: README.md)"},
      {"van de Vrande (2001)",
       "B. L. van de Vrande (2001), Nonlinear dynamics of elementary rotor systems with compliant plain journal "
       "bearings, PhD thesis, Technische Universiteit Eindhoven, doi:10.6100/IR550147"},
      {"ISO 21940-11",
       "ISO 21940-11:2016, Mechanical vibration, Rotor balancing, Part 11: Procedures and tolerances for rotors with "
       "rigid behaviour"}};
  return all;
}

}  // namespace whirl::study
