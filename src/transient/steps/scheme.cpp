#include "whirl/transient/steps/scheme.hpp"

namespace whirl::transient {
namespace {

template <class K>
void describe_steps(deck::Description<K>& d) {
  d.add("steps", &K::steps, deck::in(4, 1e8), "equal steps per revolution; more where samples or films want them");
}

}  // namespace

std::string_view name_of(const Scheme& scheme) {
  return std::visit([](const auto& s) { return s.key; }, scheme);
}

int equal_steps(const Scheme& scheme) {
  return std::visit(
      [](const auto& s) {
        if constexpr (requires { s.steps; })
          return s.steps;
        else
          return 0;
      },
      scheme);
}

bool is_explicit(const Scheme& scheme) {
  return std::holds_alternative<RungeKutta4>(scheme) || std::holds_alternative<AdamsMoulton>(scheme);
}

bool has_own_pace(const Scheme& scheme) {
  return std::holds_alternative<Bdf>(scheme) || std::holds_alternative<GeneralizedAlpha>(scheme);
}

void describe(deck::Description<SchemeOptions>& d) {
  d.kinds("type", &SchemeOptions::scheme, "scheme of the steps in time");
}

void describe(deck::Description<Sdirk4>& /*d*/) {}

void describe(deck::Description<GeneralizedAlpha>& d) {
  d.add("radius", &GeneralizedAlpha::radius, deck::in(0, 1),
        "part of the amplitude of the highest frequencies that a step leaves: 1 damps nothing",
        "Jansen, Whiting and Hulbert 2000");
}

void describe(deck::Description<Bdf>& d) {
  d.add("order", &Bdf::order, deck::in(1, 6), "order; above 2 lightly damped high frequencies may be excited");
}

void describe(deck::Description<Irk>& d) {
  d.add("stages", &Irk::stages, deck::in(1, 5), "Gauss points in a step");
  describe_steps(d);
}

void describe(deck::Description<Newmark>& d) {
  describe_steps(d);
}

void describe(deck::Description<NewmarkLinearised>& d) {
  describe_steps(d);
}

void describe(deck::Description<NewmarkFixedPoint>& d) {
  describe_steps(d);
}

void describe(deck::Description<RungeKutta4>& d) {
  describe_steps(d);
}

void describe(deck::Description<AdamsMoulton>& d) {
  describe_steps(d);
}

}  // namespace whirl::transient
