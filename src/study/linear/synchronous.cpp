#include "study/linear/synchronous.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>

#include "whirl/core/error.hpp"

namespace whirl::study {

HarmonicState harmonic_response(system::RotorSystem& system, solve::FrequencyResolvent& solver,
                                const std::vector<std::complex<double>>& force) {
  const std::vector<std::complex<double>> amplitude = solver.respond(force);
  HarmonicState state;
  for (std::size_t part = 0; part < 2; ++part) {
    const core::Vector v = core::make_vector(system.comm(), system.local_size(), PETSC_DETERMINE);
    const auto value = [part](std::complex<double> z) { return part == 0 ? z.real() : z.imag(); };
    std::ranges::transform(amplitude, core::WriteArray(v.get()).data(), value);
    state[part] = system.gather(v.get());
    // Not every solver tells of a singular matrix.
    if (!std::ranges::all_of(state[part], [](double s) { return std::isfinite(s); }))
      throw core::NotConverged(solve::singular_at_frequency);
  }
  return state;
}

HarmonicState synchronous_response(system::RotorSystem& system, solve::FrequencyResolvent& solver, Vec x,
                                   double speed) {
  PetscInt begin = 0, end = 0;
  core::check(VecGetOwnershipRange(x, &begin, &end));
  // F holds minus the forcing Omega^2 (u_c cos + u_s sin) = Re(Omega^2 (u_c - i u_s) exp(i angle)) on the
  // rotor's rows; own states of films, behind all pairs of coordinate and rate, are not forced.
  std::vector<std::complex<double>> right(static_cast<std::size_t>(end - begin));
  for (PetscInt row = begin; row < std::min(end, 2 * system.coordinates()); ++row) {
    const auto of = static_cast<std::size_t>(row);
    right[static_cast<std::size_t>(row - begin)] = {speed * speed * system.forcing_cosine()[of],
                                                    -speed * speed * system.forcing_sine()[of]};
  }
  std::optional<system::RotorSystem::WithLoss> loss;  // equilibria know of none
  if (system.train().rotor.loss_factor > 0) loss.emplace(system, system.loss_at(speed));
  solver.linearise(x);
  solver.factorise({0, speed});
  return harmonic_response(system, solver, right);
}

}  // namespace whirl::study
