#pragma once
// Schemes that integrate a motion in time, as decks choose them.

#include <string_view>
#include <variant>

#include "whirl/deck/description.hpp"

namespace whirl::transient {

/// Singly diagonally implicit Runge-Kutta of order 4, error-controlled (Hairer and Wanner 1996, IV (6.16)).
struct Sdirk4 {
  static constexpr std::string_view key = "sdirk4",
                                    text = "diagonally implicit Runge-Kutta of order 4 with error control, L-stable";
};

/// PETSc's TSALPHA, error-controlled (Jansen, Whiting and Hulbert 2000).
struct GeneralizedAlpha {
  static constexpr std::string_view key = "generalized_alpha",
                                    text = "order 2 with error control, damps high frequencies by its radius";
  double radius = 0.9;  ///< part of the highest frequencies' amplitude that a step leaves
};

/// PETSc's TSBDF with steps and error control.
struct Bdf {
  static constexpr std::string_view key = "bdf",
                                    text = "backward differences of order 1 to 6 with error control, multi-step";
  int order = 2;
};

/// Implicit Runge-Kutta at Gauss points: order 2 s, conserves quadratic invariants.
struct Irk {
  static constexpr std::string_view key = "irk",
                                    text = "implicit Runge-Kutta at Gauss points, order twice the stages, equal steps";
  int stages = 2, steps = 64;
};

/// Newmark's method with beta = 1/4, gamma = 1/2 (Skarolek 2011, (2.44)-(2.58)), Newton's method in every step.
struct Newmark {
  static constexpr std::string_view key = "newmark",
                                    text = "Newmark's method, beta 1/4, by Newton's method, order 2, equal steps";
  int steps = 256;
};

/// The same with films linearised at the beginning of a step (ibid., (2.51)-(2.52)).
struct NewmarkLinearised {
  static constexpr std::string_view key = "newmark_linearised",
                                    text = "Newmark's method with films linearised at the beginning of every step";
  int steps = 256;
};

/// The same by fixed-point iteration (ibid., (2.60)-(2.64)).
struct NewmarkFixedPoint {
  static constexpr std::string_view key = "newmark_fixed_point",
                                    text = "Newmark's method by fixed-point iteration over the films' forces";
  int steps = 1024;
};

/// The classical explicit Runge-Kutta method of order 4, PETSc's TSRK (ibid., (2.41)-(2.42)).
struct RungeKutta4 {
  static constexpr std::string_view key = "runge_kutta_4",
                                    text = "the classical explicit Runge-Kutta method, order 4, equal steps";
  int steps = 1024;
};

/// Predictor of Adams and Bashforth, corrector of Adams and Moulton, order 2, evaluated twice (ibid., section 3.2).
struct AdamsMoulton {
  static constexpr std::string_view key = "adams_moulton",
                                    text = "predictor and corrector of Adams, order 2, explicit, equal steps";
  int steps = 1024;
};

using Scheme = std::variant<Sdirk4, GeneralizedAlpha, Bdf, Irk, Newmark, NewmarkLinearised, NewmarkFixedPoint,
                            RungeKutta4, AdamsMoulton>;

/// Its key.
[[nodiscard]] std::string_view name_of(const Scheme& scheme);
/// Steps per revolution of a scheme with equal steps, 0 of one with error control.
[[nodiscard]] int equal_steps(const Scheme& scheme);
/// Whether rates must follow from states alone: dF/d(dx/dt) regular.
[[nodiscard]] bool is_explicit(const Scheme& scheme);

/// Whether it keeps a history of several steps, whose lengths its error control alone decides.
[[nodiscard]] bool has_own_pace(const Scheme& scheme);

/// A scheme as a deck gives it.
struct SchemeOptions {
  Scheme scheme;
};
void describe(deck::Description<SchemeOptions>& d);
void describe(deck::Description<Sdirk4>& d);
void describe(deck::Description<GeneralizedAlpha>& d);
void describe(deck::Description<Bdf>& d);
void describe(deck::Description<Irk>& d);
void describe(deck::Description<Newmark>& d);
void describe(deck::Description<NewmarkLinearised>& d);
void describe(deck::Description<NewmarkFixedPoint>& d);
void describe(deck::Description<RungeKutta4>& d);
void describe(deck::Description<AdamsMoulton>& d);

}  // namespace whirl::transient
