#include "whirl/study/modes.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common.hpp"
#include "groups.hpp"
#include "pieces.hpp"
#include "whirl/deck/units.hpp"
#include "whirl/io/table.hpp"
#include "whirl/rotor/frequencies.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/spectral/whirl.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

// A mode with its shape along the shaft.
struct ShaftMode {
  Complex lambda;
  std::vector<Complex> x, y;  // per node
  int id = -1;                // the same for the same mode at other speeds

  [[nodiscard]] std::vector<Complex> both() const {
    std::vector<Complex> all = x;
    all.insert(all.end(), y.begin(), y.end());
    return all;
  }
};

std::vector<ShaftMode> shaft_modes(system::RotorSystem& system, Vec equilibrium, int count, double max_frequency) {
  spectral::EigenOptions options;
  options.count = 2 * count + 40;
  std::vector<ShaftMode> out;
  for (const auto& mode : spectral::modes(system, equilibrium, options)) {
    // Two equal real eigenvalues part by rounding into a pair that does not vibrate.
    if (mode.lambda.imag() <= 1e-7 * std::abs(mode.lambda) || mode.lambda.imag() > max_frequency) continue;
    if (static_cast<int>(out.size()) == count) break;
    std::vector<double> part[2];
    for (int k = 0; k < 2; ++k) {
      std::vector<double> state(mode.shape.size());
      for (std::size_t i = 0; i < state.size(); ++i) state[i] = k == 0 ? mode.shape[i].real() : mode.shape[i].imag();
      part[k] = system.shaft(state.data(), 0, false);
    }
    ShaftMode m;
    m.lambda = mode.lambda;
    Complex largest = 0;
    for (std::size_t i = 0; i + 3 < part[0].size(); i += 4) {
      m.x.emplace_back(part[0][i], part[1][i]);
      m.y.emplace_back(part[0][i + 1], part[1][i + 1]);
      for (const Complex& v : {m.x.back(), m.y.back()})
        if (std::abs(v) > std::abs(largest)) largest = v;
    }
    if (largest != 0.0)
      for (auto* side : {&m.x, &m.y})
        for (Complex& v : *side) v /= largest;
    out.push_back(std::move(m));
  }
  return out;
}

// Modes of one speed as numbers, to send them between ranks.
std::vector<double> pack(const std::vector<ShaftMode>& modes) {
  std::vector<double> flat{static_cast<double>(modes.size()),
                           modes.empty() ? 0.0 : static_cast<double>(modes[0].x.size())};
  const auto put = [&](Complex v) {
    flat.push_back(v.real());
    flat.push_back(v.imag());
  };
  for (const ShaftMode& m : modes) {
    put(m.lambda);
    for (const Complex& v : m.both()) put(v);
  }
  return flat;
}

std::vector<ShaftMode> unpack(const std::vector<double>& flat) {
  const auto count = static_cast<std::size_t>(flat[0]), nodes = static_cast<std::size_t>(flat[1]);
  std::vector<ShaftMode> modes(count);
  std::size_t at = 2;
  const auto take = [&] {
    at += 2;
    return Complex(flat[at - 2], flat[at - 1]);
  };
  for (ShaftMode& m : modes) {
    m.lambda = take();
    for (auto* side : {&m.x, &m.y})
      for (std::size_t k = 0; k < nodes; ++k) side->push_back(take());
  }
  return modes;
}

// Gives the modes of one speed the identities of those of the speed before: the best pairs of like shape and near
// eigenvalue first.
void follow(const std::vector<ShaftMode>& before, std::vector<ShaftMode>& now, int& next_id) {
  struct Pair {
    double score;
    std::size_t a, b;
  };
  std::vector<Pair> pairs;
  for (std::size_t a = 0; a < before.size(); ++a)
    for (std::size_t b = 0; b < now.size(); ++b) {
      const double apart = std::abs(before[a].lambda - now[b].lambda) / std::max(std::abs(before[a].lambda), 1.0);
      if (apart < 0.5) pairs.push_back({spectral::mac(before[a].both(), now[b].both()) - 2 * apart, a, b});
    }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& p, const Pair& q) { return p.score > q.score; });
  std::vector<bool> taken(before.size(), false);
  for (const Pair& p : pairs)
    if (!taken[p.a] && now[p.b].id < 0 && p.score > 0) {
      taken[p.a] = true;
      now[p.b].id = before[p.a].id;
    }
  for (ShaftMode& m : now)
    if (m.id < 0) m.id = next_id++;
}

// Supports without films: undamped frequencies of the shaft at rest, the same in both planes.
StudyResult rigid_modes(Context& context, const ModesOptions& options) {
  rotor::Options shaft = context.machine.rotor;
  shaft.reduction = {};
  std::vector<int> pinned;
  if (options.supports == ModesOptions::Supports::pinned)
    for (const auto& b : context.machine.bearings) pinned.push_back(b.node);
  const auto frequencies =
      rotor::natural_frequencies(Groups::split(context.comm, context.machine).space, shaft, pinned, options.count);
  auto& summary = context.results.summary();
  for (std::size_t k = 0; k < frequencies.size(); ++k) {
    summary.set(fmt::format("frequency.{}", k + 1), frequencies[k], "rad/s");
    summary.modes.push_back({0, 0, frequencies[k], 0, "planar"});
  }
  context.results.group()
      .child("spectrum")
      .put("frequency", frequencies, "rad/s", "undamped natural frequencies in one plane");
  summary.points = 1;
  return context.results.finish("completed", true);
}

}  // namespace

StudyResult Modes::run(Context& context) {
  if (options.supports != ModesOptions::Supports::films) return rigid_modes(context, options);
  const std::vector<double> speeds = options.all_speeds();
  const std::string unit = options.unit();
  const double limit = options.max_frequency.value_or(std::numeric_limits<double>::infinity());
  const Groups groups = Groups::split(context.comm, context.machine);
  system::RotorSystem system(groups.space, system::train_of(context.machine), speeds.front());
  Walker walker(system);
  auto& results = context.results;
  auto& summary = results.summary();
  auto& group = results.group();
  std::size_t ready = 0;
  Pieces pieces(results, context.resume);
  const auto compute = [&](std::size_t i) {
    auto modes = pack(shaft_modes(system, walker.at(speeds[i]), options.count, limit));
    results.progress(fmt::format(
        "{}: {} of {} speeds on this rank, {:.1f} {}, {:.1f} s", summary.name, ++ready,
        (speeds.size() + static_cast<std::size_t>(groups.count) - 1) / static_cast<std::size_t>(groups.count),
        deck::from_si(speeds[i], unit), unit, results.seconds()));
    return modes;
  };
  const auto packed = distribute(groups, speeds.size(), compute, pieces, "speed");

  std::vector<double> speed_column, frequency, real, decrement, factor;
  std::vector<std::int64_t> id_column;
  std::vector<std::string> sense_column;
  std::vector<ShaftMode> before;
  int next_id = 1;
  // Damped frequency meets the speed of the shaft between two speeds.
  struct Crossing {
    double s0, s1, f0, f1;
    ShaftMode guide;
  };
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    const double speed = speeds[i];
    auto modes = unpack(packed[i]);
    follow(before, modes, next_id);
    for (const ShaftMode& m : modes) {
      const auto sense = spectral::name_of(spectral::sense_of_whirl(m.x, m.y));
      speed_column.push_back(speed);
      id_column.push_back(m.id);
      frequency.push_back(m.lambda.imag());
      real.push_back(m.lambda.real());
      decrement.push_back(spectral::log_decrement(m.lambda));
      factor.push_back(spectral::stability_factor(m.lambda));
      sense_column.emplace_back(sense);
      summary.modes.push_back(
          {deck::from_si(speed, unit), m.lambda.real(), m.lambda.imag(), decrement.back(), sense, unit});
      for (const ShaftMode& b : before) {
        const double f0 = b.lambda.imag() - speeds[i - 1], f1 = m.lambda.imag() - speed;
        if (m.id == b.id && f0 * f1 < 0) crossings.push_back({speeds[i - 1], speed, f0, f1, m});
      }
    }
    before = std::move(modes);
  }
  // Where the chords cross, refined by solving there and following the shape.
  const auto refine = [&](std::size_t i) {
    Crossing c = crossings[i];
    for (int k = 0; k < 6 && std::abs(c.s1 - c.s0) > 1e-6 * c.s1; ++k) {
      const double s = c.s1 - c.f1 * (c.s1 - c.s0) / (c.f1 - c.f0);
      const auto there = shaft_modes(system, walker.at(s), options.count, limit);
      const auto best = std::max_element(there.begin(), there.end(), [&](const ShaftMode& p, const ShaftMode& q) {
        return spectral::mac(c.guide.both(), p.both()) < spectral::mac(c.guide.both(), q.both());
      });
      if (best == there.end()) break;
      const double f = best->lambda.imag() - s;
      if (f * c.f1 < 0) c.s0 = c.s1, c.f0 = c.f1;
      c.s1 = s;
      c.f1 = f;
      if (std::abs(f) < 1e-7 * s) break;
    }
    return std::vector<double>{c.s1};
  };
  const auto refined = distribute(groups, crossings.size(), refine, pieces, "critical");
  struct Critical {
    double speed;
    int id;
  };
  std::vector<Critical> criticals;
  for (std::size_t i = 0; i < crossings.size(); ++i) criticals.push_back({refined[i][0], crossings[i].guide.id});

  auto& spectrum = group.child("spectrum");
  spectrum.put("speed", speed_column, "rad/s", "shaft speed");
  spectrum.put("mode", id_column, "mode followed by its shape");
  spectrum.put("frequency", frequency, "rad/s", "damped frequency, imaginary part of the eigenvalue");
  spectrum.put("damping_real", real, "1/s", "real part of the eigenvalue");
  spectrum.put("log_decrement", decrement, "1", "-2 pi Re/|Im|");
  spectrum.put("stability_factor", factor, "1", "10^-log_decrement, unstable above 1");
  spectrum.put("whirl", sense_column, "sense of whirl of the shaft's nodes");
  group.set("speed_unit", unit);

  std::sort(criticals.begin(), criticals.end(), [](const Critical& a, const Critical& b) { return a.speed < b.speed; });
  std::vector<double> critical_speed;
  std::vector<std::int64_t> critical_mode;
  for (std::size_t k = 0; k < criticals.size(); ++k) {
    summary.set(fmt::format("critical.{}.speed", k + 1), deck::from_si(criticals[k].speed, unit), unit);
    critical_speed.push_back(criticals[k].speed);
    critical_mode.push_back(criticals[k].id);
  }
  group.child("critical").put("speed", critical_speed, "rad/s", "speed equal to the damped frequency");
  group.child("critical").put("mode", critical_mode, "mode followed by its shape");

  // Shapes at the last speed.
  put_bearings(group, context.machine);
  auto& shapes = group.child("shapes");
  const auto z = rotor::node_positions(system.train().rotor);
  std::vector<double> flat[4], at_frequency;
  for (const ShaftMode& m : before) {
    at_frequency.push_back(m.lambda.imag());
    for (std::size_t k = 0; k < z.size(); ++k) {
      flat[0].push_back(m.x[k].real());
      flat[1].push_back(m.x[k].imag());
      flat[2].push_back(m.y[k].real());
      flat[3].push_back(m.y[k].imag());
    }
  }
  const char* const names[] = {"x_real", "x_imag", "y_real", "y_imag"};
  for (std::size_t k = 0; k < 4; ++k)
    shapes.put(names[k], {before.size(), z.size()}, flat[k], "1", "shape [mode][node], largest displacement one");
  shapes.put("speed", std::vector<double>{speeds.back()}, "rad/s", "speed of the shapes");
  shapes.put("z", z, "m", "axial position of the nodes");
  shapes.put("frequency", at_frequency, "rad/s", "of the shapes");
  summary.points = static_cast<long>(speeds.size());
  return results.finish("completed", true);
}

}  // namespace whirl::study
