#include "study/motion/linearity_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/make_plant.hpp"
#include "study/motion/forces.hpp"
#include "study/state_rows.hpp"
#include "whirl/core/error.hpp"
#include "whirl/transient/steps/integrator.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;
constexpr std::size_t signals = LinearityRecord::signals;
// Films are looked at this often, in samples.
constexpr long between_looks = 16;
constexpr std::size_t excerpt_samples = 2000;

std::vector<TransferInput> along_both(int node) {
  return {{node, "", Along::x}, {node, "", Along::y}};
}

int node_of(const LinearityOptions& o, const system::Machine& machine) {
  if (o.node) return *o.node;
  return machine.bearings[o.bearing ? *system::find_bearing(machine, *o.bearing) : 0].node;
}

}  // namespace

transient::Random noise_of(const LinearityOptions& o, double level, int d) {
  return {.rms = level, .cutoff = o.cutoff, .oversampling = o.oversampling, .seed = 2 * o.seed + d};
}

LinearityRunner::LinearityRunner(const Context& context, const Layout& layout, const LinearityOptions& options)
    : options_(options),
      node_(node_of(options, context.machine)),
      system_(layout.space, system::train_of(context.machine), options.speed.value),
      rest_(find_rest(system_)),
      x_(core::duplicate(rest_.get())),
      columns_{load_on(system_.rotor(), node_, rotor::Freedom::x), load_on(system_.rotor(), node_, rotor::Freedom::y)},
      films_(system_.places()),
      response_(system_, along_both(node_), {output_of(along_both(node_)[0]), output_of(along_both(node_)[1])}) {}

// Displacement and force at one place do work with each other: the same column says what the one is of the coordinates
// and the other on them.
std::array<double, 2> LinearityRunner::watched(Vec x) const {
  PetscInt begin = 0, end = 0;
  core::check(VecGetOwnershipRange(x, &begin, &end));
  const auto last = static_cast<PetscInt>(2 * columns_[0].size());  // pedestals and films stand behind the rotor
  std::array<double, 2> out{};
  {
    const core::ReadArray a(x);
    for (PetscInt row = begin + begin % 2; row < std::min(end, last); row += 2)
      for (std::size_t d = 0; d < 2; ++d) out[d] += columns_[d][static_cast<std::size_t>(row / 2)] * a[row - begin];
  }
  MPI_Allreduce(MPI_IN_PLACE, out.data(), 2, MPI_DOUBLE, MPI_SUM, system_.comm());
  return out;
}

LinearityRecord LinearityRunner::record(double level, const std::function<void(double)>& say) {
  transient::Forces forces;
  for (int d = 0; d < 2; ++d) {
    const auto& load = columns_[static_cast<std::size_t>(d)];
    forces.add(transient::make_signal(noise_of(options_, level, d)), entries_of(load));
  }
  const double rate = rate_of(options_);
  transient::Integrator integrator(system_, {options_.speed.value}, rest_.get(),
                                   {.tolerance = options_.tolerance, .first_step = 1 / rate, .forces = &forces});
  const auto at_rest = watched(rest_.get());
  const auto settled = std::lround(options_.settle * rate), count = std::lround(options_.duration * rate);
  std::vector<std::vector<double>> record(signals);
  for (long k = 1; k <= settled + count; ++k) {
    integrator.advance(static_cast<double>(k) / rate);
    integrator.state(x_.get());
    if (films_.exists() && k % between_looks == 0) {
      const auto film = system_.observe(x_.get()).film_thickness;
      if (!(films_.margin(film) > 0)) throw core::DomainError(films_.reason(film));
    }
    if (k <= settled) continue;
    const auto now = watched(x_.get());
    for (std::size_t d = 0; d < 2; ++d) {
      record[d].push_back(forces.value(d, integrator.time()));
      record[2 + d].push_back(now[d] - at_rest[d]);
    }
    if (k % 1024 == 0) say(static_cast<double>(k) / static_cast<double>(settled + count));
  }
  LinearityRecord out;
  out.steps = static_cast<double>(integrator.work().steps);
  for (std::size_t s = 0; s < signals; ++s) {
    const double count_here = static_cast<double>(record[s].size());
    double mean = 0, square = 0;
    for (const double v : record[s]) mean += v / count_here;
    for (const double v : record[s]) square += (v - mean) * (v - mean) / count_here;
    (s < 2 ? out.force[s] : out.rms[s - 2]) = std::sqrt(square);
    if (s >= 2) out.mean[s - 2] = mean;
  }
  for (std::size_t k = 0; k < record[0].size(); ++k)
    out.peak = std::max(out.peak, std::hypot(record[2][k] - out.mean[0], record[3][k] - out.mean[1]));
  for (std::size_t k = 0; k < std::min(excerpt_samples, record[0].size()); ++k)
    for (const auto& s : record) out.excerpt.push_back(s[k]);
  auto& spectra = out.spectra;
  spectra = transient::spectral_matrix(record, 1 / rate, {.segments = options_.segments});
  // The force is what stands between its samples as well.
  for (std::size_t k = 0; k < spectra.lines.size(); ++k) {
    const double gain = transient::interpolation_gain(noise_of(options_, level, 0), spectra.frequency(k));
    spectra.lines[k].topRows(2) *= gain;
    spectra.lines[k].leftCols(2) *= gain;
  }
  return out;
}

std::vector<double> LinearityRunner::linear(double frequency) {
  std::vector<double> out;
  response_.linearise(rest_.get());
  for (const Complex& g : response_.at(2 * std::numbers::pi * frequency).values)
    out.insert(out.end(), {g.real(), g.imag()});
  return out;
}

}  // namespace whirl::study
