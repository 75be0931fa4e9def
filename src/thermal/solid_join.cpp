// A solid beside a film of given temperature.
#include "thermal/solid_parts.hpp"
#include "whirl/core/agree.hpp"

namespace whirl::thermal {

using core::check;

void Solid::join(const std::vector<double>& film) {
  core::agree(comm_, [&] { core::require(film.size() == wall_.size(), "a conductance for each column of the film"); });
  const core::Vector sum = core::duplicate(diagonal_.get());
  check(VecCopy(diagonal_.get(), sum.get()));
  {
    const core::WriteArray d(sum.get());
    for (std::size_t c = 0; c < wall_.size(); ++c) {
      joined_[c] = film[c] > 0 ? 1 / (1 / film[c] + resistance_[c]) : 0;
      if (!held(wall_[c])) d[local(wall_[c])] += joined_[c];
    }
  }
  check(MatDiagonalSet(matrix_.get(), sum.get(), INSERT_VALUES));
}

void Solid::load(const std::vector<double>& film, Vec rhs) const {
  check(VecCopy(supply_.get(), rhs));
  const core::WriteArray b(rhs);
  for (std::size_t c = 0; c < wall_.size(); ++c)
    if (!held(wall_[c])) b[local(wall_[c])] += joined_[c] * film[c];
}

}  // namespace whirl::thermal
