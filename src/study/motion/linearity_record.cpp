#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "study/common.hpp"
#include "study/motion/linearity_run.hpp"
#include "whirl/io/table.hpp"
#include "whirl/spectral/dense.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;
constexpr const char* axes[] = {"x", "y"};
// The resonance is where the largest answer to any force has more than a tenth of its power at the peak, and two lines
// beyond: Hann's window smears it so far.
constexpr double resonance_power = 0.1;
constexpr std::size_t smeared = 2;

Eigen::Matrix2cd matrix_of(const std::vector<double>& flat) {
  Eigen::Matrix2cd g;
  for (std::size_t k = 0; k < 4; ++k)
    g(static_cast<Eigen::Index>(k / 2), static_cast<Eigen::Index>(k % 2)) = {flat[2 * k], flat[2 * k + 1]};
  return g;
}

double gain_of(const Eigen::Matrix2cd& g) {
  return spectral::singular_values(Eigen::MatrixXcd(g))(0);
}

struct PeakLines {
  std::size_t peak = 0, first = 0, last = 0;  // lines, from 0
  [[nodiscard]] bool holds(std::size_t k) const { return k >= first && k <= last; }
};

PeakLines resonance_of(const std::vector<double>& gain) {
  PeakLines r;
  r.peak = static_cast<std::size_t>(std::max_element(gain.begin(), gain.end()) - gain.begin());
  const double border = gain[r.peak] * std::sqrt(resonance_power);
  r.first = r.last = r.peak;
  while (r.first > 0 && gain[r.first - 1] > border) --r.first;
  while (r.last + 1 < gain.size() && gain[r.last + 1] > border) ++r.last;
  r.first -= std::min(smeared, r.first);
  r.last = std::min(r.last + smeared, gain.size() - 1);
  return r;
}

// Estimates at all lines of a level, and what they say of its linearity.
struct Judged {
  std::vector<transient::LineEstimate> lines;
  double least = 1, least_at = 0;  // multiple coherence off resonance, and the frequency [Hz]
  double at_resonance = 1;         // least there
  double unexplained = 0;          // mean of 1 - multiple coherence off resonance
  double within = 0;               // share of the entries of H whose bounds hold the linear ones, off resonance
  double deviation = 0;            // root mean square of |H1 - G| over the largest gain of G at the line, off resonance
};

Judged judge(const LinearityRecord& r, const std::vector<std::vector<double>>& linear, const PeakLines& resonance,
             double probability) {
  Judged j;
  std::size_t count = 0;
  for (std::size_t k = 0; k < linear.size(); ++k) {
    const auto e = transient::estimate(r.spectra.lines[k + 1], 2, r.spectra.averages, probability);
    const double both = e.multiple.minCoeff();
    // The first line holds what the window makes of the mean.
    if (resonance.holds(k))
      j.at_resonance = std::min(j.at_resonance, both);
    else if (k > 0) {
      const Eigen::Matrix2cd g = matrix_of(linear[k]);
      if (both < j.least) {
        j.least = both;
        j.least_at = r.spectra.frequency(k + 1);
      }
      j.unexplained += 1 - e.multiple.mean();
      j.within += ((e.h1 - g).cwiseAbs().array() <= e.radius.array()).cast<double>().mean();
      j.deviation += (e.h1 - g).cwiseAbs2().mean() / std::pow(gain_of(g), 2);
      ++count;
    }
    j.lines.push_back(e);
  }
  const double n = std::max<double>(1, static_cast<double>(count));
  j.unexplained /= n;
  j.within /= n;
  j.deviation = std::sqrt(j.deviation / n);
  return j;
}

void put_level(io::Group& group, const LinearityOptions& options, const LinearityRecord& r, const Judged& j) {
  const std::string bound = fmt::format("with a probability of {:.6g}", options.probability);
  std::vector<io::Table::Column> columns{{"frequency", "Hz", "of the line"}};
  for (const char* i : axes)
    for (const char* f : axes) {
      const std::string pair = fmt::format("{}{}", i, f), what = fmt::format("displacement {} by force {}", i, f);
      columns.push_back({"h1_" + pair, "m/N", "magnitude of H1, " + what});
      columns.push_back({"h1_" + pair + "_phase", "rad", "its phase"});
      columns.push_back({"h1_" + pair + "_radius", "m/N", "distance of the true value from H1, " + bound});
      columns.push_back({"h2_" + pair, "m/N", "magnitude of H2, " + what});
      columns.push_back({"coherence_" + pair, "1", "ordinary coherence, " + what});
    }
  for (const char* i : axes) {
    columns.push_back(
        {fmt::format("multiple_{}", i), "1", fmt::format("coherence of displacement {} with both forces", i)});
    columns.push_back({fmt::format("multiple_{}_low", i), "1", "lower bound, " + bound});
    columns.push_back({fmt::format("multiple_{}_high", i), "1", "upper bound"});
    columns.push_back({fmt::format("density_force_{}", i), "N^2/Hz", "one-sided power spectral density"});
    columns.push_back({fmt::format("density_{}", i), "m^2/Hz", "of the displacement, likewise"});
  }
  io::Table table(columns);
  for (std::size_t k = 0; k < j.lines.size(); ++k) {
    const transient::LineEstimate& e = j.lines[k];
    const Eigen::MatrixXcd& s = r.spectra.lines[k + 1];
    std::vector<std::vector<double>> row{{r.spectra.frequency(k + 1)}};
    for (Eigen::Index i = 0; i < 2; ++i)
      for (Eigen::Index f = 0; f < 2; ++f) {
        row.push_back({std::abs(e.h1(i, f))});
        row.push_back({std::arg(e.h1(i, f))});
        row.push_back({e.radius(i, f)});
        row.push_back({e.h2.size() > 0 ? std::abs(e.h2(i, f)) : io::no_value});
        row.push_back({e.ordinary(i, f)});
      }
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto bounds = transient::coherence_bounds(e.multiple(i), 2, r.spectra.averages, options.probability);
      row.push_back({e.multiple(i)});
      row.push_back({bounds.low});
      row.push_back({bounds.high});
      row.push_back({s(i, i).real()});
      row.push_back({s(2 + i, 2 + i).real()});
    }
    table.append(row);
  }
  table.write(group);
}

void put_linear(io::Group& group, const std::vector<std::vector<double>>& linear, double resolution) {
  std::vector<io::Table::Column> columns{{"frequency", "Hz", "of the line"}};
  for (const char* i : axes)
    for (const char* f : axes) {
      columns.push_back(
          {fmt::format("g_{}{}", i, f), "m/N", fmt::format("magnitude, displacement {} by force {}", i, f)});
      columns.push_back({fmt::format("g_{}{}_phase", i, f), "rad", "its phase"});
    }
  io::Table table(columns);
  for (std::size_t k = 0; k < linear.size(); ++k) {
    std::vector<std::vector<double>> row{{resolution * (static_cast<double>(k) + 1)}};
    const Eigen::Matrix2cd g = matrix_of(linear[k]);
    for (Eigen::Index i = 0; i < 2; ++i)
      for (Eigen::Index f = 0; f < 2; ++f) {
        row.push_back({std::abs(g(i, f))});
        row.push_back({std::arg(g(i, f))});
      }
    table.append(row);
  }
  table.write(group);
}

void put_excitation(io::Group& group, const LinearityOptions& options, const LinearityRecord& r, double level) {
  std::vector<double> frequency, wanted, found[2];
  for (std::size_t k = 1; k < r.spectra.lines.size(); ++k) {
    frequency.push_back(r.spectra.frequency(k));
    wanted.push_back(transient::spectral_density(noise_of(options, level, 0), frequency.back()));
    for (Eigen::Index d = 0; d < 2; ++d) found[d].push_back(r.spectra.lines[k](d, d).real());
  }
  group.put("frequency", frequency, "Hz", "of the line");
  group.put("density_x", found[0], "N^2/Hz", "one-sided power spectral density of the force along x");
  group.put("density_y", found[1], "N^2/Hz", "of the force along y");
  group.put("density", wanted, "N^2/Hz",
            "that of white noise through the low pass and between samples, in closed form");
}

void put_excerpt(io::Group& group, const LinearityOptions& options, const LinearityRecord& r) {
  constexpr auto n = static_cast<std::size_t>(LinearityRecord::signals);
  std::vector<double> time, column[n];
  for (std::size_t k = 0; k < r.excerpt.size() / n; ++k) {
    time.push_back(static_cast<double>(k + 1) / rate_of(options));
    for (std::size_t s = 0; s < n; ++s) column[s].push_back(r.excerpt[n * k + s]);
  }
  group.put("time", time, "s", "since the record began");
  group.put("force_x", column[0], "N", "");
  group.put("force_y", column[1], "N", "");
  group.put("x", column[2], "m", "displacement from the equilibrium");
  group.put("y", column[3], "m", "displacement from the equilibrium");
}

}  // namespace

void put_linearity(const Context& context, const LinearityOptions& options, const std::vector<LinearityRecord>& records,
                   const std::vector<std::vector<double>>& linear, int node) {
  auto& summary = context.results.summary();
  auto& group = context.results.group();
  const transient::SpectralMatrix& spectra = records.front().spectra;
  std::vector<double> gain;
  for (const auto& line : linear) gain.push_back(gain_of(matrix_of(line)));
  const PeakLines resonance = resonance_of(gain);
  summary.set("speed", options.speed.value, "rad/s");
  summary.set("resolution", spectra.resolution, "Hz");
  summary.set("averages", spectra.averages, "1");
  summary.set("resonance.frequency", spectra.frequency(resonance.peak + 1), "Hz");
  summary.set("resonance.from", spectra.frequency(resonance.first + 1), "Hz");
  summary.set("resonance.to", spectra.frequency(resonance.last + 1), "Hz");
  summary.set("resonance.gain", gain[resonance.peak], "m/N");
  summary.set("coherence.chance", transient::coherence_of_chance(2, spectra.averages, options.probability), "1");
  io::Table levels({{"force", "N", "root mean square of each force, as asked for"},
                    {"force_x", "N", "that of the samples along x"},
                    {"force_y", "N", "along y"},
                    {"peak", "m", "largest distance from the mean place"},
                    {"rms_x", "m", "root mean square of the displacement"},
                    {"rms_y", "m", "likewise"},
                    {"mean_x", "m", "mean displacement from the equilibrium; zero of a linear system"},
                    {"mean_y", "m", "likewise"},
                    {"multiple_least", "1", "least multiple coherence off resonance"},
                    {"multiple_least_at", "Hz", "its frequency"},
                    {"multiple_resonance", "1", "least multiple coherence at the resonance"},
                    {"unexplained", "1", "mean of 1 - multiple coherence off resonance"},
                    {"within", "1", "share of entries whose bounds hold the linear transfer function, off resonance"},
                    {"deviation", "1", "root mean square of |H1 - G| over the largest gain of the line, off resonance"},
                    {"steps", "1", "in time"}});
  for (std::size_t k = 0; k < records.size(); ++k) {
    const LinearityRecord& r = records[k];
    const Judged j = judge(r, linear, resonance, options.probability);
    const std::string head = fmt::format("level.{}.", k + 1);
    summary.set(head + "force", options.levels[k], "N");
    summary.set(head + "peak", r.peak, "m");
    summary.set(head + "rms.x", r.rms[0], "m");
    summary.set(head + "rms.y", r.rms[1], "m");
    summary.set(head + "mean.x", r.mean[0], "m");
    summary.set(head + "mean.y", r.mean[1], "m");
    summary.set(head + "coherence.least", j.least, "1");
    summary.set(head + "coherence.least_at", j.least_at, "Hz");
    summary.set(head + "coherence.resonance", j.at_resonance, "1");
    summary.set(head + "unexplained", j.unexplained, "1");
    summary.set(head + "within", j.within, "1");
    summary.set(head + "deviation", j.deviation, "1");
    summary.set(head + "steps", r.steps, "1");
    levels.append({options.levels[k], r.force[0], r.force[1], r.peak, r.rms[0], r.rms[1], r.mean[0], r.mean[1], j.least,
                   j.least_at, j.at_resonance, j.unexplained, j.within, j.deviation, r.steps});
    put_level(group.child(fmt::format("level_{}", k + 1)), options, r, j);
  }
  levels.write(group.child("levels"));
  put_linear(group.child("linear"), linear, spectra.resolution);
  put_excitation(group.child("excitation"), options, records.back(), options.levels.back());
  put_excerpt(group.child("record"), options, records.back());
  put_bearings(group, context.machine);
  group.set("node", node);
  group.set("speed", options.speed.value);
  group.set("probability", options.probability);
  group.set("averages", spectra.averages);
  group.set("cutoff", options.cutoff);
  group.set("resonance_from", spectra.frequency(resonance.first + 1));
  group.set("resonance_to", spectra.frequency(resonance.last + 1));
}

}  // namespace whirl::study
