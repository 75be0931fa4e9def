#pragma once
// Films whose kind a test chooses while it runs.

#include "whirl/core/error.hpp"
#include "whirl/film/contract/options.hpp"

namespace whirl::film::testing {

enum class Kind {
  short_bearing,
  long_bearing,
  long_inlet,
  finite_approximate,
  compliant_short,
  compliant_long,
  compliant_finite
};

/// A film of that kind with default options.
inline Options film_of(Kind kind) {
  switch (kind) {
    case Kind::short_bearing:
      return Short{};
    case Kind::long_bearing:
      return Long{};
    case Kind::long_inlet:
      return LongInlet{};
    case Kind::finite_approximate:
      return FiniteApproximate{};
    case Kind::compliant_short:
      return CompliantShort{};
    case Kind::compliant_long:
      return CompliantLong{};
    case Kind::compliant_finite:
      return CompliantFinite{};
  }
  throw core::Bug("a kind without a film");
}

/// The options that all films on a liner have, for one of their kinds; central differences unless a test says others.
struct Elastic : Compliant {
  Elastic() { differences = Differences::central; }
  Kind kind = Kind::compliant_short;
  operator Options() const {
    Options o = film_of(kind);
    as<Compliant>(o) = *this;
    return o;
  }
};

}  // namespace whirl::film::testing
