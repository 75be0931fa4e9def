#include "study/linear/mode_tables.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "whirl/deck/units.hpp"

namespace whirl::study {

using Complex = std::complex<double>;

void ModeTables::add(const ShaftMode& m, io::ModeEntry& entry) {
  const auto energy = spectral::whirl_energy(m.x, m.y, mass_);
  const std::vector<double> turning = spectral::turning(m.x, m.y);
  entry.whirl = spectral::name_of(sense_of(m));
  entry.whirl_rule = spectral::name_of(m.either ? spectral::Sense::either : spectral::sense_by_nodes(turning));
  entry.more["participation"] = m.participation;
  speed_.push_back(deck::number_to_si(entry.speed, entry.speed_unit));
  frequency_.push_back(m.lambda.imag());
  whirl_.push_back(energy.whirl);
  forward_.push_back(energy.forward);
  taken_.push_back(m.participation);
  sense_.push_back(entry.whirl);
  rule_.push_back(entry.whirl_rule);
  turning_.insert(turning_.end(), turning.begin(), turning.end());
  const auto nodes = [&](int sign) {
    return std::count_if(turning.begin(), turning.end(), [&](double t) { return sign * t > spectral::straight; });
  };
  forward_nodes_.push_back(nodes(1));
  backward_nodes_.push_back(nodes(-1));
  if (!condition_) return;
  entry.more["condition"] = m.condition;
  entry.more["multiplicity"] = m.multiplicity;
  entry.more["vectors"] = m.vectors;
  numbers_.push_back(m.condition);
  multiplicity_.push_back(m.multiplicity);
  vectors_.push_back(m.vectors);
}

void ModeTables::put_spectrum(io::Group& spectrum) const {
  spectrum.put("whirl", sense_, whirl_text);
  spectrum.put("whirl_rule", rule_, "sense of whirl by the nodes alone: mixed if they do not all turn one way");
  spectrum.put("whirl_share", whirl_, "1", "of the kinetic energy: 0 every node on a line, 1 on a circle");
  spectrum.put("forward_share", forward_, "1", "the same, backward motion counted negative");
  spectrum.put("forward_nodes", forward_nodes_, "nodes that turn with the shaft");
  spectrum.put("backward_nodes", backward_nodes_, "nodes that turn against the shaft");
  spectrum.put("participation", taken_, "1",
               "largest motion of shaft and pedestals over that of any state, in their scales");
  if (!condition_) return;
  spectrum.put(
      "condition", numbers_, "1",
      "condition number of the eigenvalue, |x| |B* y|/|y* B x| in the states' scales; not a number: not known");
  spectrum.put("multiplicity", multiplicity_, "eigenvalues that rounding does not tell from this one, with it");
  spectrum.put("vectors", vectors_, "independent vectors that these have");
}

void ModeTables::put_map(io::Group& map) const {
  map.put("z", z_, "m", "axial position of the nodes");
  map.put("turning", {frequency_.size(), z_.size()}, turning_, "1",
          "how each node turns [row of the spectrum][node]: 1 a forward circle, -1 a backward one, 0 a line");
  map.label_each({io::numbered(z_.size(), "node")});
}

void ModeTables::warn(io::StudySummary& summary, const std::map<double, ModeSearch>& searches) const {
  if (!condition_) return;
  for (std::size_t k = 0; k < numbers_.size(); ++k)
    if (vectors_[k] < multiplicity_[k]) {
      summary.warnings.push_back(fmt::format(
          "the eigenvalue at {:.6g} rad/s and a speed of {:.6g} rad/s has multiplicity {} but {} vector{}: it is "
          "defective, moves with the root of every change, and no sum of modes describes its motions",
          frequency_[k], speed_[k], multiplicity_[k], vectors_[k], vectors_[k] == 1 ? "" : "s"));
      break;
    }
  const auto rest =
      std::find_if(searches.rbegin(), searches.rend(), [](const auto& s) { return s.second.rest_vectors > 0; });
  if (rest != searches.rend()) {
    summary.set("rest.multiplicity", rest->second.rest_multiplicity, "1");
    summary.set("rest.vectors", rest->second.rest_vectors, "1");
    summary.warnings.push_back(fmt::format(
        "at {:.6g} rad/s the eigenvalue zero has multiplicity {:.0f} but {:.0f} eigenvectors, as of a shaft "
        "that drifts freely: no sum of modes describes how it drifts and tilts",
        rest->first, rest->second.rest_multiplicity, rest->second.rest_vectors));
  }
  if (std::any_of(numbers_.begin(), numbers_.end(), [](double c) { return std::isnan(c); }))
    summary.warnings.push_back(
        "condition numbers are not known where films with states are eliminated or counted by transfer functions, and "
        "where a search with the transposed matrices finds other eigenvalues: PETSc option -modes_st_pc_type lu "
        "factorises the machine as one");
}

spectral::Sense ModeTables::sense_of(const ShaftMode& mode) const {
  return mode.either ? spectral::Sense::either : spectral::sense_of_whirl(mode.x, mode.y, mass_);
}

void ModeTables::put_shapes(io::Group& shapes, const std::vector<double>& speeds,
                            const std::vector<std::span<const ShaftMode>>& modes) const {
  std::vector<double> flat[8], at_frequency, at_speed, at_decrement, turning;
  std::vector<std::string> at_sense;
  std::vector<std::int64_t> at_mode;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    for (ShaftMode m : modes[i]) {
      at_speed.push_back(speeds[i]);
      at_mode.push_back(m.id);
      at_frequency.push_back(m.lambda.imag());
      at_decrement.push_back(spectral::log_decrement(m.lambda));
      at_sense.emplace_back(spectral::name_of(sense_of(m)));
      const std::vector<double> turns = spectral::turning(m.x, m.y);
      turning.insert(turning.end(), turns.begin(), turns.end());
      for (std::size_t k = 0; k < 8; ++k)
        for (const Complex& v : *m.columns()[k / 2]) flat[k].push_back(k % 2 == 0 ? v.real() : v.imag());
    }
  }
  const char* const names[] = {"x_real",       "x_imag",       "y_real",       "y_imag",
                               "slope_x_real", "slope_x_imag", "slope_y_real", "slope_y_imag"};
  for (std::size_t k = 0; k < 8; ++k)
    shapes.put(names[k], {at_speed.size(), z_.size()}, flat[k], k < 4 ? "1" : "1/m",
               k < 4 ? "shape [mode][node], largest displacement one" : "its derivative along the shaft");
  shapes.put("turning", {at_speed.size(), z_.size()}, turning, "1",
             "how each node turns [mode][node]: 1 a forward circle, -1 a backward one, 0 a line");
  shapes.label_each({io::numbered(z_.size(), "node")});
  shapes.put("speed", at_speed, "rad/s", "speed of the shapes");
  shapes.put("mode", at_mode, "mode followed by its shape");
  shapes.put("z", z_, "m", "axial position of the nodes");
  shapes.put("frequency", at_frequency, "rad/s", "of the shapes");
  shapes.put("log_decrement", at_decrement, "1", "of the shapes");
  shapes.put("whirl", at_sense, whirl_text);
}

}  // namespace whirl::study
