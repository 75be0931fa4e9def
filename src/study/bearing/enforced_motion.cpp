#include "study/bearing/enforced_motion.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "study/bars/summary_bars.hpp"
#include "study/columns.hpp"
#include "whirl/film/use/enforced.hpp"

namespace whirl::study {

namespace {

using All = std::vector<std::vector<std::vector<EnforcedAt>>>;  // [speed][frequency][amplitude]

template <class Visit>
void each(const All& found, const Visit& visit) {
  for (const auto& speed : found)
    for (const auto& frequency : speed)
      for (const EnforcedAt& a : frequency) visit(a);
}

void fill(EnforcedAt& out, std::size_t port, const film::EnforcedForces& f) {
  for (std::size_t i = 0; i < out.coefficients.ports; ++i) {
    out.coefficients.stiffness[i][port] = f.stiffness[i];
    out.coefficients.damping[i][port] = f.damping[i];
  }
  out.distortion[port] = f.distortion;
  out.tail[port] = f.tail;
}

}  // namespace

double difference(const film::PortCoefficients& a, const film::PortCoefficients& b, std::size_t ports) {
  double out = 0;
  for (std::size_t block = 0; block < ports; block += 2)
    for (const auto of : {&film::PortCoefficients::stiffness, &film::PortCoefficients::damping}) {
      double most = 0, size = 0;
      for (std::size_t i = block; i < block + 2; ++i)
        for (std::size_t j = block; j < block + 2; ++j) {
          const double d = std::abs((a.*of)[i][j] - (b.*of)[i][j]);
          most = std::isnan(d) ? d : std::max(most, d);
          size = std::max(size, std::abs((b.*of)[i][j]));
        }
      if (size > 0) out = std::isnan(most) ? most : std::max(out, most / size);
    }
  return out;
}

std::vector<EnforcedAt> enforced_at(film::Film& film, const film::Geometry& bore, const JournalPlace& at, double omega,
                                    std::span<const double> amplitudes, const film::PortCoefficients& perturbation) {
  film::Enforced enforced(film, at.motion, at.states, omega);
  const auto ports = film.ports();
  film::EnforcedForces none;
  none.distortion = none.tail = std::numeric_limits<double>::quiet_NaN();
  none.stiffness.fill(none.distortion);
  none.damping.fill(none.distortion);
  std::vector<EnforcedAt> out;
  for (const double amplitude : amplitudes) {
    EnforcedAt& now = out.emplace_back();
    now.coefficients.ports = ports.size();
    for (std::size_t port = 0; port < ports.size(); ++port) {
      const bool slope = ports[port] >= film::Port::tilt_x;
      const double size = amplitude * bore.clearance / (slope ? 2 * bore.length : 1.0);
      fill(now, port, none);
      (void)has_answer([&] { fill(now, port, enforced.along(port, size)); }, &now.lost[port]);
    }
    now.apart = difference(now.coefficients, perturbation, perturbation.ports);
  }
  return out;
}

void put_matrices(io::StudySummary& summary, const std::string& head, const film::PortCoefficients& c,
                  const std::function<bool(std::size_t)>& skip) {
  for (std::size_t i = 0; i < c.ports; ++i)
    for (std::size_t j = 0; j < c.ports; ++j) {
      if (skip && skip(j)) continue;
      summary.set(head + "K." + pair_name(i, j, "."), c.stiffness[i][j], stiffness_units[slopes_in(i, j)]);
      summary.set(head + "C." + pair_name(i, j, "."), c.damping[i][j], damping_units[slopes_in(i, j)]);
    }
}

void put_enforced(io::StudySummary& summary, const std::string& head, std::span<const double> amplitudes,
                  const std::vector<EnforcedAt>& found) {
  for (std::size_t a = 0; a < found.size(); ++a) {
    const std::string at = fmt::format("{}amplitude.{:.6g}.", head, amplitudes[a]);
    const film::PortCoefficients& c = found[a].coefficients;
    put_matrices(summary, at, c, [&](std::size_t port) { return !found[a].lost[port].empty(); });
    for (std::size_t j = 0; j < c.ports; ++j) {
      if (!found[a].lost[j].empty()) continue;
      summary.set(at + "distortion." + port_words[j], found[a].distortion[j], "1");
      summary.set(at + "tail." + port_words[j], found[a].tail[j], "1");
    }
    if (std::isfinite(found[a].apart)) summary.set(at + "from_perturbation", found[a].apart, "1");
  }
}

std::vector<std::string> lost_motions(const All& found, const std::vector<std::string>& speeds,
                                      const std::vector<double>& ratios, const std::vector<double>& amplitudes) {
  std::vector<std::string> out;
  std::map<std::string, std::pair<std::size_t, int>> known;  // line and how many more, by reason
  std::vector<std::string> first;
  for (std::size_t s = 0; s < found.size(); ++s)
    for (std::size_t f = 0; f < found[s].size(); ++f)
      for (std::size_t a = 0; a < found[s][f].size(); ++a)
        for (std::size_t port = 0; port < found[s][f][a].coefficients.ports; ++port) {
          const std::string& why = found[s][f][a].lost[port];
          if (why.empty()) continue;
          const auto [at, is_new] = known.try_emplace(why, first.size(), 0);
          if (is_new)
            first.push_back(
                fmt::format("no values of the enforced motion along {} with amplitude {:.6g} at {:.6g} of "
                            "the speed {}",
                            port_words[port], amplitudes[a], ratios[f], speeds[s]));
          else
            ++at->second.second;
        }
  out.resize(first.size());
  for (const auto& [why, line] : known)
    out[line.first] = fmt::format("{}{}: {}", first[line.first],
                                  line.second > 0 ? fmt::format(", nor of {} more", line.second) : "", why);
  return out;
}

std::array<std::size_t, 2> motions_without_values(const All& found) {
  std::array<std::size_t, 2> out{};
  each(found, [&](const EnforcedAt& a) {
    for (std::size_t port = 0; port < a.coefficients.ports; ++port) {
      out[0] += a.lost[port].empty() ? 0 : 1;
      ++out[1];
    }
  });
  return out;
}

void put_matrices(io::Group& table, const io::Shape& shape, const std::string& axes,
                  const std::vector<film::PortCoefficients>& all) {
  const std::size_t n = all.front().ports;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const auto put = [&](const char* letter, const char* unit, const std::string& what, const auto of) {
        table.put(letter + pair_name(i, j, "_"), shape,
                  column(all, [&](const film::PortCoefficients& c) { return (c.*of)[i][j]; }), unit, what + " " + axes);
      };
      put("k_", stiffness_units[slopes_in(i, j)], "stiffness", &film::PortCoefficients::stiffness);
      put("c_", damping_units[slopes_in(i, j)], "damping", &film::PortCoefficients::damping);
    }
}

void put_enforced_tables(io::Group& group, const std::vector<double>& speeds, const std::vector<double>& ratios,
                         const std::vector<double>& amplitudes, const All& found) {
  auto& table = group.child("enforced");
  table.put("speed", speeds, "rad/s", "shaft speed");
  table.put("ratio", ratios, "1", "frequency over speed, omega/Omega");
  table.put("amplitude", amplitudes, "1",
            "0 to peak of the motion along x and y, in clearances; of slopes over twice the length of the bearing");
  const io::Shape shape{speeds.size(), ratios.size(), amplitudes.size()};
  std::vector<film::PortCoefficients> all;
  each(found, [&](const EnforcedAt& a) { all.push_back(a.coefficients); });
  put_matrices(table, shape, "[speed][frequency][amplitude]", all);
  const std::size_t n = all.front().ports;
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<double> left, tail;
    std::vector<std::string> reasons;
    each(found, [&](const EnforcedAt& a) {
      reasons.push_back(a.lost[j]);
      left.push_back(a.distortion[j]);
      tail.push_back(a.tail[j]);
    });
    if (std::ranges::any_of(reasons, [](const std::string& why) { return !why.empty(); }))
      table.put(std::string("reason_") + port_words[j],
                io::Dataset{shape, std::move(reasons), "",
                            "why the motion along it has no values; empty: it has [speed][frequency][amplitude]"});
    table.put(std::string("tail_") + port_words[j], shape, tail, "1",
              "highest harmonics of the force over the first one [speed][frequency][amplitude]");
    table.put(
        std::string("distortion_") + port_words[j], shape, left, "1",
        "what stiffness and damping leave of the force, ratio of root mean squares [speed][frequency][amplitude]");
  }
  table.label_each({io::labels_of(ratios, "ratio"), io::labels_of(amplitudes, "amplitude")});
}

}  // namespace whirl::study
