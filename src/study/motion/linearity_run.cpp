#include "study/motion/linearity_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/bars/summary_bars.hpp"
#include "study/growth.hpp"
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
      response_(system_) {}

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

std::vector<double> LinearityRunner::record(double level, const std::function<void(double)>& say) {
  transient::Forces forces;
  for (int d = 0; d < 2; ++d) {
    std::vector<transient::Forces::Entry> column;
    const auto& load = columns_[static_cast<std::size_t>(d)];
    for (std::size_t q = 0; q < load.size(); ++q)
      if (load[q] != 0) column.push_back({static_cast<PetscInt>(2 * q), load[q]});
    forces.add(transient::make_signal(noise_of(options_, level, d)), std::move(column));
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
  std::vector<double> flat{0, static_cast<double>(integrator.work().steps),
                           static_cast<double>(integrator.work().rejected)};
  for (const auto& s : record) {
    double mean = 0, square = 0;
    for (const double v : s) mean += v / static_cast<double>(s.size());
    for (const double v : s) square += (v - mean) * (v - mean) / static_cast<double>(s.size());
    flat.insert(flat.end(), {mean, std::sqrt(square)});
  }
  for (std::size_t k = 0; k < record[0].size(); ++k)
    flat[0] = std::max(flat[0], std::hypot(record[2][k] - flat[7], record[3][k] - flat[9]));
  const std::size_t kept = std::min(excerpt_samples, record[0].size());
  flat.push_back(static_cast<double>(kept));
  for (std::size_t k = 0; k < kept; ++k)
    for (const auto& s : record) flat.push_back(s[k]);
  auto spectra = transient::spectral_matrix(record, 1 / rate, {.segments = options_.segments});
  // The force is what stands between its samples as well.
  for (std::size_t k = 0; k < spectra.lines.size(); ++k) {
    const double gain = transient::interpolation_gain(noise_of(options_, level, 0), spectra.frequency(k));
    spectra.lines[k].topRows(2) *= gain;
    spectra.lines[k].leftCols(2) *= gain;
  }
  flat.insert(flat.end(), {spectra.resolution, static_cast<double>(spectra.samples), spectra.averages,
                           static_cast<double>(spectra.lines.size())});
  for (const Eigen::MatrixXcd& m : spectra.lines)
    for (Eigen::Index i = 0; i < m.size(); ++i) flat.insert(flat.end(), {m.data()[i].real(), m.data()[i].imag()});
  return flat;
}

LinearityRecord LinearityRunner::unpack(const std::vector<double>& flat, const LinearityOptions& options) {
  LinearityRecord r;
  auto at = flat.begin();
  r.peak = *at++;
  r.steps = *at++;
  r.rejected = *at++;
  for (std::size_t s = 0; s < signals; ++s) {
    const double mean = *at++, rms = *at++;
    if (s < 2)
      r.force[s] = rms;
    else {
      r.mean[s - 2] = mean;
      r.rms[s - 2] = rms;
    }
  }
  const auto kept = static_cast<std::ptrdiff_t>(*at++) * static_cast<std::ptrdiff_t>(signals);
  r.excerpt.assign(at, at + kept);
  at += kept;
  r.spectra.resolution = *at++;
  r.spectra.samples = static_cast<int>(*at++);
  r.spectra.averages = *at++;
  r.spectra.segments = options.segments;
  r.spectra.lines.assign(static_cast<std::size_t>(*at++), Eigen::MatrixXcd(signals, signals));
  for (Eigen::MatrixXcd& m : r.spectra.lines)
    for (Eigen::Index i = 0; i < m.size(); ++i) {
      const double re = *at++, im = *at++;
      m.data()[i] = {re, im};
    }
  return r;
}

std::vector<double> LinearityRunner::linear(double frequency) {
  PetscInt begin = 0, end = 0;
  core::check(VecGetOwnershipRange(rest_.get(), &begin, &end));
  std::vector<double> out(8);
  std::vector<std::complex<double>> right(static_cast<std::size_t>(end - begin));
  response_.linearise(rest_.get());
  response_.factorise({0, 2 * std::numbers::pi * frequency});
  for (std::size_t force = 0; force < 2; ++force) {
    std::ranges::fill(right, 0.0);
    const auto last = static_cast<PetscInt>(2 * columns_[force].size());
    for (PetscInt row = begin + begin % 2; row < std::min(end, last); row += 2)
      right[static_cast<std::size_t>(row - begin)] = columns_[force][static_cast<std::size_t>(row / 2)];
    const std::vector<std::complex<double>> amplitude = response_.respond(right);
    for (std::size_t part = 0; part < 2; ++part) {
      {
        const core::WriteArray a(x_.get());
        const auto value = [part](std::complex<double> z) { return part == 0 ? z.real() : z.imag(); };
        std::ranges::transform(amplitude, a.data(), value);
      }
      const auto moved = watched(x_.get());
      for (std::size_t d = 0; d < 2; ++d) out[2 * (2 * d + force) + part] = moved[d];
    }
  }
  return out;
}

std::vector<double> LinearityRunner::growing() {
  return answer_of([&] { return packed(growth_at(system_, rest_.get())); });
}

}  // namespace whirl::study
