#include "study/equilibrium/static.hpp"

namespace whirl::study {

void describe(deck::Description<StaticOptions>& d) {
  d.add("name", &StaticOptions::name, "name in the results; the kind if not given");
  d.add("speed", &StaticOptions::speed, "rad/s", deck::positive, "shaft speed").required().alias("speeds");
  d.add("fields", &StaticOptions::fields, "write pressure and thickness of every film");
}

void Static::validate(const system::Machine&, const deck::Report&) const {}

}  // namespace whirl::study
