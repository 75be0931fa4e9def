#include "whirl/solve/newton/machine_modes.hpp"

#include <petscsys.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "solve/newton/port_elimination.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/newton/transfer_modes.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::solve {

namespace {

bool by_transfer(const problem::System& system) {
  std::array<char, 16> word{};
  PetscBool given = PETSC_FALSE;
  core::check(PetscOptionsGetString(nullptr, nullptr, "-modes_by", word.data(), word.size(), &given));
  const std::string_view way = given ? word.data() : "automatic";
  // A limit of memory, which transfer functions spare: at 158 104 states both ways take the same time (docs/speed.md).
  PetscInt whole_up_to = 100000;
  core::check(PetscOptionsGetInt(nullptr, nullptr, "-modes_whole_states", &whole_up_to, nullptr));
  if (way != "whole" && way != "transfer" && way != "automatic")
    throw core::InputError("-modes_by is 'whole', 'transfer' or 'automatic'");
  return system.fields().size() > 1 && (way == "transfer" || (way == "automatic" && system.size() > whole_up_to));
}

constexpr int most_searches = 6;

bool vibrates(const spectral::Mode& m) {
  return m.lambda.imag() > 0 && spectral::vibrates(m.lambda);
}

bool enough(const std::vector<spectral::Mode>& modes, const Wanted& wanted) {
  return std::count_if(modes.begin(), modes.end(), [&](const spectral::Mode& m) {
           return vibrates(m) && (!wanted.counts || wanted.counts(m));
         }) >= wanted.at_least;
}

// The parts of a machine are eliminated, as everywhere else: a factorisation of the whole pencil would see rows as long
// as a film.
class ByPorts final : public spectral::ShiftInverse {
public:
  /// Of dF/dx + target dF/d(dx/dt) at the equilibrium x.
  ByPorts(problem::System& system, Vec x, double target)
      : x_(x), target_(target), rest_(core::duplicate(x)), ports_(system.fields(), exact_inverse(system)) {
    core::check(VecSet(rest_.get(), 0));
  }
  void factorise(Mat a) override {
    if (ports_.inverse()) ports_.inverse()->set(0, x_, rest_.get(), 1, target_);
    ports_.factorise(a);
  }
  void solve(Vec rhs, Vec x) override { ports_.solve(rhs, x); }

private:
  static std::unique_ptr<problem::PartInverse> exact_inverse(problem::System& system) {
    auto inverse = system.make_part_inverse();
    return inverse && inverse->exact() ? std::move(inverse) : nullptr;
  }

  Vec x_;
  double target_;
  core::Vector rest_;
  PortElimination ports_;
};

// Those nearest to the target; twice as many again until enough of them count.
MachineModes whole_modes(problem::System& system, Vec x, spectral::EigenOptions options, const Wanted& wanted) {
  const bool all = system.size() <= options.dense_below;
  std::optional<ByPorts> inverse;
  if (!all && PortElimination::serves(system.fields())) options.inverse = &inverse.emplace(system, x, options.target);
  MachineModes out;
  for (int k = 0;; ++k) {
    out.modes = spectral::modes(system, x, options);
    if (all || !wanted.counts || enough(out.modes, wanted)) return out;
    double farthest = 0;
    for (const spectral::Mode& m : out.modes) farthest = std::max(farthest, std::abs(m.lambda - options.target));
    if (wanted.frequency > 0 && farthest > wanted.frequency) return out;
    if (options.count >= system.size()) return out;
    out.gave_up = k + 1 == most_searches;
    if (out.gave_up) return out;
    options.count = std::min<int>(2 * options.count, system.size());
  }
}

}  // namespace

MachineModes machine_modes(problem::System& system, Vec x, const spectral::EigenOptions& options,
                           const Wanted& wanted) {
  // A region is nearly as wide at the axis as it is high.
  const bool given = wanted.frequency > 0;
  TransferOptions region;
  region.frequency = given ? wanted.frequency / 0.94 : 2 * std::abs(system.speed());
  if (!by_transfer(system) || region.frequency == 0) return whole_modes(system, x, options, wanted);
  region.shapes = options.shapes;
  TransferModes found;
  bool short_of = false;
  for (int k = 0;; ++k) {
    region.decay = region.frequency / 2;
    found = transfer_modes(system, x, region);
    short_of = !given && !enough(found.modes, wanted);
    if (!short_of || k + 1 == most_searches) break;
    region.frequency *= 1.5;
  }
  return {std::move(found.modes), found.missed, std::move(found.doubt), true,
          region.frequency,       region.decay, found.counted,          short_of};
}

}  // namespace whirl::solve
