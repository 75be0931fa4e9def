#include "whirl/solve/newton/machine_modes.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "solve/newton/port_elimination.hpp"
#include "solve/newton/transfer_modes.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/spectral/count.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::solve {

namespace {

bool by_transfer(const problem::System& system) {
  const core::plan::ModesWay way = core::plan::modes(system.size());
  if (system.fields().size() <= 1) return false;
  core::plan::note(way);
  return way == core::plan::ModesWay::transfer;
}

constexpr int most_searches = 6;
constexpr int most_for_count = 4;  // times as many eigenvalues as at first, to find those that a count misses

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
    if (ports_.inverse()) ports_.inverse()->set({0, x_, rest_.get()}, 1, target_);
    ports_.factorise(a);
  }
  void solve(Vec rhs, Vec x) override { ports_.solve(rhs, x); }

private:
  static std::unique_ptr<problem::PartInverse> exact_inverse(problem::System& system) {
    auto inverse = own_inverse(system);
    return inverse && inverse->exact() != nullptr ? std::move(inverse) : nullptr;
  }

  Vec x_;
  double target_;
  core::Vector rest_;
  PortElimination ports_;
};

// Searches on the whole pencil of a large machine.
class WholeSearch {
public:
  WholeSearch(problem::System& system, Vec x, spectral::EigenOptions options)
      : system_(system), x_(x), options_(options), ports_(problem::parts_of(system.fields()).size() > 1) {}

  // The `count` nearest to zero. Those far out do not converge where the nearest are slower by many orders: a second
  // search begins beside the farthest that did.
  [[nodiscard]] std::vector<spectral::Mode> nearest(int count) {
    std::vector<spectral::Mode> found = near(options_.target, count);
    int values = 0;
    for (const spectral::Mode& m : found) values += m.lambda.imag() > 0 ? 2 : 1;
    if (values < std::min<int>(count, system_.size() - 2)) add(found, farthest(found), count);
    return found;
  }

  // Those beyond all of `found` that are nearest to a real target.
  void add(std::vector<spectral::Mode>& found, double target, int count) {
    const double reach = farthest(found);
    for (spectral::Mode& m : near(target, count))
      if (std::abs(m.lambda) > reach * (1 + 1e-6)) found.push_back(std::move(m));
    sort(found);
  }

  // The real eigenvalue that a count has seen about `place`, if it is not among those found. False if there is none.
  bool add_real(std::vector<spectral::Mode>& found, double place) {
    for (spectral::Mode& m : near(place, 2)) {
      const auto same = [&](const spectral::Mode& other) {
        return std::abs(other.lambda - m.lambda) <= 1e-6 * std::abs(m.lambda);
      };
      if (m.lambda.imag() != 0 || m.lambda.real() <= 0 || std::any_of(found.begin(), found.end(), same)) continue;
      found.push_back(std::move(m));
      sort(found);
      return true;
    }
    return false;
  }

  static void sort(std::vector<spectral::Mode>& found) {
    std::stable_sort(found.begin(), found.end(), [](const spectral::Mode& m, const spectral::Mode& n) {
      return std::pair(m.lambda.imag(), m.lambda.real()) < std::pair(n.lambda.imag(), n.lambda.real());
    });
  }

  // Farthest from the first target.
  [[nodiscard]] double farthest(const std::vector<spectral::Mode>& found) const {
    double out = 0;
    for (const spectral::Mode& m : found) out = std::max(out, std::abs(m.lambda - options_.target));
    return out;
  }

private:
  [[nodiscard]] std::vector<spectral::Mode> near(double target, int count) {
    spectral::EigenOptions options = options_;
    options.target = target;
    options.count = count;
    std::optional<ByPorts> inverse;
    if (ports_) options.inverse = &inverse.emplace(system_, x_, target);
    return spectral::modes(system_, x_, options);
  }

  problem::System& system_;
  Vec x_;
  spectral::EigenOptions options_;
  bool ports_;
};

// Those nearest to the target; twice as many again until enough of them count and none is known to be missing.
MachineModes whole_modes(problem::System& system, Vec x, spectral::EigenOptions options, const Wanted& wanted) {
  MachineModes out;
  if (system.size() <= options.dense_below) {
    out.modes = spectral::modes(system, x, options);
    return out;
  }
  WholeSearch search(system, x, options);
  // Rows as long as a film fill the factors of a count; machines with such films are counted by their transfer
  // functions.
  const bool sparse = system.fields().size() == 1 && options.target == 0;
  int count = options.count;
  for (int k = 0;; ++k) {
    out.modes = search.nearest(count);
    const bool last = k + 1 == most_searches || count >= system.size();
    const bool far = wanted.frequency > 0 && search.farthest(out.modes) > wanted.frequency;
    const bool done = !wanted.counts || enough(out.modes, wanted) || far;
    if (done || last) {
      spectral::EigenCount counted;
      if (sparse) counted = spectral::count_eigenvalues(system, x, out.modes);
      const bool lost = counted.real > 0 && !search.add_real(out.modes, counted.real);
      out.frequency = out.decay = counted.radius;
      out.counted = counted.counted;
      out.missed = counted.missed + (lost ? 1 : 0);
      if (!counted.sure) out.doubt = "the phase of the determinant could not be followed";
      out.gave_up = !done && count < system.size();
      if (last || out.missed == 0 || !counted.sure || count >= most_for_count * options.count) return out;
    }
    count = std::min<int>(2 * count, system.size());
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
