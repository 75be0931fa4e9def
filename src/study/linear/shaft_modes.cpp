#include "study/linear/shaft_modes.hpp"

#include <algorithm>
#include <cmath>

#include "study/bars/mesh_wave.hpp"
#include "study/linear/mode_loss.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/solve/newton/machine_modes.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {

using Complex = std::complex<double>;

namespace {

constexpr double lightly_damped = 0.1;  // damping ratio

bool grows(const spectral::Mode& m) {
  return !m.neutral() && m.lambda.real() > 0;
}

// What falls away before it vibrates. Rounding may make zero anything.
bool overdamped(const spectral::Mode& m) {
  return !m.neutral() && spectral::damping_ratio(m.lambda) > spectral::overdamped_above;
}

// The largest of the machine's scaled states; the largest of all is one.
double participation(const std::vector<Complex>& shape, const std::vector<double>& scale, PetscInt machine) {
  double largest = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(machine); ++k)
    largest = std::max(largest, std::abs(shape[k]) / scale[k]);
  return largest;
}

// The largest displacement becomes one.
void normalise(ShaftMode& m) {
  Complex largest = 0;
  for (const auto* column : {&m.x, &m.y})
    for (const Complex& v : *column)
      if (std::abs(v) > std::abs(largest)) largest = v;
  if (largest == 0.0) return;
  for (auto* column : m.columns())
    for (Complex& v : *column) v /= largest;
}

std::vector<Complex> combined(const std::vector<Complex>& a, const std::vector<Complex>& b,
                              const spectral::Combination& c) {
  std::vector<Complex> out;
  for (std::size_t k = 0; k < a.size(); ++k) out.push_back(c[0] * a[k] + c[1] * b[k]);
  return out;
}

// Whether the combinations of two shapes turn in more than one sense. Those that turn most go to `turned`.
bool turn_either_way(const ShaftMode& a, const ShaftMode& b, const std::vector<double>& mass,
                     std::array<ShaftMode, 2>& turned) {
  const auto extremes = spectral::extremes_of_whirl(a.both(), b.both(), mass);
  if (!extremes) return false;
  turned = {a, b};
  for (std::size_t k = 0; k < 2; ++k) {
    ShaftMode from[] = {a, b};
    for (std::size_t c = 0; c < 4; ++c)
      *turned[k].columns()[c] = combined(*from[0].columns()[c], *from[1].columns()[c], (*extremes)[k]);
    normalise(turned[k]);
  }
  const auto sense = [&](const ShaftMode& m) { return spectral::sense_of_whirl(m.x, m.y, mass); };
  return sense(turned[0]) != sense(turned[1]);
}

// An isotropic machine at rest has double eigenvalues: what a solver returns of their shapes is chance.
void tell_equal(const std::vector<ShaftMode*>& modes, const std::vector<double>& mass) {
  const auto equal = [](const ShaftMode& a, const ShaftMode& b) {
    return spectral::vibrates(a.lambda) && std::abs(a.lambda - b.lambda) <= std::max(a.blur, b.blur);
  };
  std::vector<bool> known(modes.size(), false);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (known[i]) continue;
    std::vector<ShaftMode*> group;
    for (std::size_t j = i; j < modes.size(); ++j)
      if (!known[j] && equal(*modes[i], *modes[j])) {
        known[j] = true;
        group.push_back(modes[j]);
      }
    std::array<ShaftMode, 2> turned;
    bool either = false;
    for (std::size_t a = 0; a < group.size() && !either; ++a)
      for (std::size_t b = a + 1; b < group.size() && !either; ++b)
        either = turn_either_way(*group[a], *group[b], mass, turned);
    if (either && group.size() == 2)
      for (std::size_t k = 0; k < 2; ++k) *group[k] = std::move(turned[k]);
    for (ShaftMode* m : group) m->either = either;
  }
}

}  // namespace

std::vector<ShaftMode> shaft_modes(system::RotorSystem& system, Vec equilibrium, int count, int beyond,
                                   double max_frequency, ModeSearch& search, bool condition) {
  const int sought = count + beyond;
  spectral::EigenOptions options;
  options.left = condition;
  options.count = 2 * sought + 40;
  options.rounding = true;
  std::vector<double> scale;
  {
    core::Vector states = core::duplicate(equilibrium), rows = core::duplicate(equilibrium);
    system.scales(states.get(), rows.get());
    scale = core::gather(states.get());
  }
  const auto part_taken = [&](const spectral::Mode& mode) {
    return participation(mode.shape, scale, 2 * system.coordinates());
  };
  const bool waves = may_have_mesh_waves(system);
  // Waves that fall away at once mislead nobody.
  const auto of_mesh = [&](const spectral::Mode& mode) {
    return waves && spectral::damping_ratio(mode.lambda) < lightly_damped && cells_per_wave(system, mode.shape);
  };
  solve::MachineModes found =
      solve::machine_modes(system, equilibrium, options,
                           {std::isfinite(max_frequency) ? max_frequency : 0, sought, [&](const spectral::Mode& mode) {
                              return !overdamped(mode) && part_taken(mode) >= least_participation && !of_mesh(mode);
                            }});
  search = {found.frequency, found.decay, static_cast<double>(found.counted),
            static_cast<double>(found.doubt.empty() ? found.missed : -1), found.gave_up ? 1.0 : 0.0};
  const auto slowest = std::min_element(found.modes.begin(), found.modes.end(), [](const auto& m, const auto& n) {
    return std::abs(m.lambda) < std::abs(n.lambda);
  });
  double rest = -1;  // modulus up to which eigenvalues are zero, which rounding parts
  if (slowest != found.modes.end() && slowest->defective()) {
    search.rest_multiplicity = slowest->multiplicity;
    search.rest_vectors = slowest->vectors;
    std::vector<double> sizes;
    for (const auto& mode : found.modes)
      sizes.insert(sizes.end(), mode.lambda.imag() != 0 ? 2 : 1, std::abs(mode.lambda));
    std::sort(sizes.begin(), sizes.end());
    rest = sizes[std::min(sizes.size(), static_cast<std::size_t>(slowest->multiplicity)) - 1];
  }
  if (system.train().rotor.loss_factor > 0) {
    // Those that count, and a few more whose places among them may change. The overdamped stay as they are.
    std::vector<spectral::Mode> vibrating, others;
    int extra = 4, counted = 0;
    for (spectral::Mode& m : found.modes) {
      const bool moves = m.lambda.imag() > 0 && spectral::vibrates(m.lambda) && !overdamped(m);
      const bool beyond_count = counted >= sought && !grows(m) && extra-- <= 0;
      if (moves && beyond_count) continue;
      if (moves && part_taken(m) >= least_participation) ++counted;
      (moves ? vibrating : others).push_back(std::move(m));
    }
    found.modes = with_loss(system, equilibrium, vibrating);
    found.modes.insert(found.modes.end(), others.begin(), others.end());
  }
  // Real ones that grow have no frequency and stand first.
  std::stable_sort(found.modes.begin(), found.modes.end(), [](const auto& m, const auto& n) {
    return std::pair(m.lambda.imag(), -m.lambda.real()) < std::pair(n.lambda.imag(), -n.lambda.real());
  });
  std::vector<ShaftMode> listed, more;
  int lowest = 0;
  for (const auto& mode : found.modes) {
    if (std::abs(mode.lambda) <= rest) continue;
    const bool growing = grows(mode), moves = spectral::vibrates(mode.lambda);
    if (!growing && !moves && mode.neutral()) continue;  // zero, of a machine that nothing holds
    const double taken = part_taken(mode);
    if (taken < least_participation && !growing) continue;
    if (overdamped(mode)) {
      search.overdamped.push_back(mode.lambda);
      continue;
    }
    if (of_mesh(mode)) {
      search.mesh_waves.push_back(mode.lambda);
      continue;
    }
    const bool low = moves && lowest < count && mode.lambda.imag() <= max_frequency;
    if (!low && !growing && (static_cast<int>(more.size()) == beyond || !moves || mode.lambda.imag() > max_frequency))
      continue;
    lowest += low;
    std::vector<double> part[2];
    for (int k = 0; k < 2; ++k) {
      std::vector<double> state(mode.shape.size());
      for (std::size_t i = 0; i < state.size(); ++i) state[i] = k == 0 ? mode.shape[i].real() : mode.shape[i].imag();
      part[k] = system.shaft(state.data(), 0, false);
    }
    ShaftMode m;
    m.participation = taken;
    m.condition = mode.condition;
    m.multiplicity = mode.multiplicity;
    m.vectors = mode.vectors;
    m.undamped = mode.neutral();
    m.blur = mode.blur;
    m.extra = growing && moves && !low;
    m.lambda = m.undamped ? Complex(0, mode.lambda.imag()) : mode.lambda;
    for (std::size_t i = 0; i + 3 < part[0].size(); i += 4)
      for (std::size_t k = 0; k < 4; ++k) m.columns()[k]->emplace_back(part[0][i + k], part[1][i + k]);
    normalise(m);
    (low || growing ? listed : more).push_back(std::move(m));
  }
  search.listed = static_cast<double>(listed.size());
  std::sort(search.overdamped.begin(), search.overdamped.end(),
            [](Complex a, Complex b) { return std::abs(a) < std::abs(b); });
  listed.insert(listed.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  std::vector<ShaftMode*> all;
  for (ShaftMode& m : listed) all.push_back(&m);
  tell_equal(all, rotor::node_masses(system.train().rotor));
  return listed;
}

}  // namespace whirl::study
