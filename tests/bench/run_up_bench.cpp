// Run-up of the reduced train (104 states, films of 60 x 16 cells) as inputs/turbine_train/run_up.yaml begins it, G2.5,
// 32 samples a revolution, tolerance 1e-5: steps by the structure of the machine against assembled matrices whose steps
// end at every sample (the only way there was before). Both against a run with a tolerance of 1e-8. bench_run_up
// [revolutions]
#include <fmt/core.h>

#include <cmath>

#include "bench/timing.hpp"
#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"
#include "whirl/transient/steps/integrator.hpp"

using namespace whirl;

namespace {

constexpr double rpm = M_PI / 30;
constexpr problem::Drive drive{2200 * rpm, 100 * rpm, 0};
constexpr int samples = 32;

struct Run {
  std::vector<double> x;  // positions of all journals at all samples
  transient::Integrator::Work work;
  double seconds = 0;
};

Run run(const system::Train& train, double tolerance, transient::Algebra algebra, bool between, int revolutions) {
  system::RotorSystem s(PETSC_COMM_SELF, train, drive.speed);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  s.set_forcing(false);
  core::require(solve::find_equilibrium(s, x.get(), newton).converged, "no equilibrium");
  s.set_forcing(true);
  s.set_acceleration(drive.acceleration);
  transient::Integrator integrator(s, drive, x.get(), {.tolerance = tolerance, .algebra = algebra});
  Run out;
  const double begin = bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  for (int r = 0; r < revolutions; ++r) {
    const auto at = [&](int k) { return drive.time_of(2 * M_PI * (r + static_cast<double>(k) / samples)); };
    for (int k = 1; k <= samples; ++k) {
      if (between)
        integrator.advance(at(k), at(samples));
      else
        integrator.advance(at(k));
      integrator.state(x.get());
      for (const system::PlaceState& p : s.observe(x.get()).shown)
        out.x.insert(out.x.end(), p.position.begin(), p.position.end());
    }
    integrator.restart(integrator.time(), integrator.step());
  }
  out.seconds = bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - begin;
  out.work = integrator.work();
  return out;
}

double difference(const Run& a, const Run& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.x.size(); ++k) most = std::max(most, std::abs(a.x[k] - b.x[k]));
  return most;
}

}  // namespace

int main(int argc, char** argv) {
  const int asked = argc > 1 ? std::atoi(argv[1]) : 0, revolutions = asked > 0 ? asked : 20;
  const core::Session session(1, argv);
  auto train = test::train({60, 16}, true);
  test::add_gen_pair(train, 2.5);
  using enum transient::Algebra;
  const Run fine = run(train, 1e-8, automatic, true, revolutions);
  double least = 1e9, before = 1e9;
  Run assembled_run, thin_run;
  for (int k = 0; k < 3; ++k) {
    assembled_run = run(train, 1e-5, assembled, false, revolutions);
    thin_run = run(train, 1e-5, automatic, true, revolutions);
    before = std::min(before, assembled_run.seconds);
    least = std::min(least, thin_run.seconds);
  }
  const auto show = [&](const char* name, const Run& r, double seconds) {
    fmt::print(
        "{}: {:.2f} ms a revolution, {} steps ({} rejected), {} residuals, {} tangents, {} factorisations, {:.2e} m "
        "from fine\n",
        name, 1e3 * seconds / revolutions, r.work.steps, r.work.rejected, r.work.residuals, r.work.jacobians,
        r.work.factorisations, difference(r, fine));
  };
  show("assembled   ", assembled_run, before);
  show("by structure", thin_run, least);
  show("fine        ", fine, fine.seconds);
  fmt::print("ratio {:.2f}\n", before / least);
  return 0;
}
