// A flexible rotor (Craig-Bampton, 40 states) on two gas bearings of 96 x 32 cells: the implicit scheme of motions
// against the classical explicit Runge-Kutta method at its limit of stability. From rest under load with an unbalance,
// some revolutions at 2000 rad/s. The explicit method is not run over the span: what a stage costs at the least (the
// residual and a division by a matrix of rates that was factorised before) times the stages that the largest eigenvalue
// asks for. bench_gas_motion [revolutions]
#include <fmt/core.h>

#include <Eigen/LU>
#include <cmath>

#include "bench/timing.hpp"
#include "film/gas_cases.hpp"
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/system/rotor_system.hpp"
#include "whirl/transient/steps/integrator.hpp"

using namespace whirl;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

constexpr double speed = 1000, period = 2 * M_PI / speed;
constexpr int samples = 32;
constexpr double real_limit = 2.7853;  // of the classical method, on the negative real axis

// Steel, 300 mm x 30 mm, 8.3 kg in the middle, so that each bearing carries 49 N; bearings A at 0.6 MPa.
system::Train machine() {
  system::Train t;
  t.rotor.material.modulus = {{293.15, 2.05e11}};
  for (int k = 0; k < 20; ++k) {
    rotor::Segment s;
    s.length = 0.015;
    s.outer_mass_diameter = 0.03;
    t.rotor.segments.push_back(s);
  }
  t.rotor.discs = {{11, 8.3, 1.5e-2, 8e-3}};
  t.rotor.stiffness_damping = 1e-7;
  t.rotor.reduction = {rotor::Reduction::Type::craig_bampton, {4, 18}, 8};
  for (const int node : {4, 18}) {
    system::Support s;
    s.node = node;
    s.geometry = film::testing::spindle();
    s.film = film::testing::aerostatic(1, 6e5, {96, 32});
    s.lubricant = film::testing::air();
    t.supports.push_back(s);
  }
  t.unbalance = {{11, 4e-6, 0}, {4, 1e-6, 1.0}};
  return t;
}

struct Run {
  std::vector<double> x;
  transient::Integrator::Work work;
  double seconds = 0;
};

core::Vector equilibrium(system::RotorSystem& s) {
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 60;
  newton.searches = false;
  s.set_forcing(false);
  core::require(solve::find_equilibrium(s, x.get(), newton).converged, "no equilibrium");
  s.set_forcing(true);
  return x;
}

Run run(double tolerance, int revolutions) {
  system::RotorSystem s(PETSC_COMM_SELF, machine(), speed);
  core::Vector x = equilibrium(s);
  transient::Integrator integrator(s, {speed}, x.get(), {.tolerance = tolerance});
  Run out;
  const double begin = bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
  for (int r = 0; r < revolutions; ++r) {
    for (int k = 1; k <= samples; ++k) {
      integrator.advance(period * k / samples, period);
      integrator.state(x.get());
      for (const system::PlaceState& p : s.observe(x.get()).shown)
        out.x.insert(out.x.end(), p.position.begin(), p.position.end());
    }
    integrator.close_revolution(period);
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

// dx/dt = -(dF/dx')^-1 F, the matrix as at `x`.
class Explicit {
public:
  Explicit(problem::ScaledPoint& point, const problem::BlockStructure& structure, const VectorXd& x)
      : point_(point), n_(structure.size()), f_(x.size()) {
    problem::PointState at;
    const VectorXd rest = VectorXd::Zero(x.size());
    point.residual(0, x, rest, f_, at);
    rotor_ = Eigen::MatrixXd(point.thin_blocks().l1).inverse();
    films_ = VectorXd::Zero(point.own_states());
    for (std::size_t i = 0; i < structure.own().size(); ++i) {
      const problem::OwnStates& own = structure.own()[i];
      for (std::size_t e = 0; e < own.rates.size(); ++e) {
        core::require(own.rates[e].row == own.rates[e].column || at.films.own[i].d_rates[e] == 0,
                      "rates of the film's states are coupled");
        films_(own.first + own.rates[e].row) += at.films.own[i].d_rates[e];
      }
    }
    const auto scaled = [&](VectorXd& v) {
      v = v.cwiseProduct(point.state_scale().tail(v.size())).cwiseQuotient(point.residual_scale().tail(v.size()));
    };
    // The pressures behind the orifices have no rates: they follow those of the film at once, each by its own equation.
    followers_ = VectorXd::Zero(films_.size());
    for (std::size_t i = 0; i < structure.own().size(); ++i) {
      const problem::OwnStates& own = structure.own()[i];
      for (std::size_t e = 0; e < own.states.size(); ++e)
        if (own.states[e].row == own.states[e].column && films_(own.first + own.states[e].row) == 0)
          followers_(own.first + own.states[e].row) += at.films.own[i].d_states[e];
    }
    scaled(films_);
    scaled(followers_);
    for (VectorXd* v : {&films_, &followers_}) *v = v->unaryExpr([](double d) { return d == 0 ? 0 : 1 / d; });
  }
  void rate(double angle, const VectorXd& x, VectorXd& out) {
    if (rest_.size() == 0) rest_ = VectorXd::Zero(x.size());
    point_.residual(angle, x, rest_, f_);
    out.resize(x.size());
    out.head(n_).noalias() = -(rotor_ * f_.head(n_));
    out.tail(films_.size()) = -films_.cwiseProduct(f_.tail(films_.size()));
  }
  // `steps` of length h from x; the largest state afterwards, infinite if the films were left.
  double steps(VectorXd x, double h, int steps) {
    VectorXd k1, k2, k3, k4;
    try {
      for (int i = 0; i < steps; ++i) {
        const double a = speed * h * i;
        rate(a, x, k1);
        rate(a + speed * h / 2, x + h / 2 * k1, k2);
        rate(a + speed * h / 2, x + h / 2 * k2, k3);
        rate(a + speed * h, x + h * k3, k4);
        x += h / 6 * (k1 + 2 * (k2 + k3) + k4);
        x.tail(films_.size()) -= followers_.cwiseProduct(f_.tail(films_.size()));
      }
    } catch (const core::DomainError&) {
      return INFINITY;
    }
    return x.cwiseAbs().maxCoeff();
  }
  // |largest eigenvalue| of the rates' Jacobian, by powers of differences.
  double largest(const VectorXd& x) {
    VectorXd v = VectorXd::Random(x.size()).normalized(), there, here;
    rate(0, x, here);
    double norm = 0;
    for (int k = 0; k < 300; ++k) {
      const double e = 1e-6;
      rate(0, x + e * v, there);
      v = (there - here) / e;
      norm = v.norm();
      v /= norm;
    }
    return norm;
  }

private:
  problem::ScaledPoint& point_;
  Index n_;
  Eigen::MatrixXd rotor_;
  VectorXd films_, followers_, f_, rest_;
};

}  // namespace

int main(int argc, char** argv) {
  const int asked = argc > 1 ? std::atoi(argv[1]) : 0, revolutions = asked > 0 ? asked : 2;
  const core::Session session(1, argv);
  system::RotorSystem s(PETSC_COMM_SELF, machine(), speed);
  const core::Vector start = equilibrium(s);
  problem::ScaledPoint point(s, s.structure(), true);
  VectorXd x;
  {
    const core::ReadArray a(start.get());
    x = Eigen::Map<const VectorXd>(a.data(), a.size()).cwiseQuotient(point.state_scale());
  }
  Explicit method(point, *s.structure(), x);
  const double eigenvalue = method.largest(x), h = real_limit / eigenvalue;
  fmt::print("{} states; largest eigenvalue {:.3e} 1/s, explicit steps of {:.3e} s, {:.0f} a revolution\n", x.size(),
             eigenvalue, h, period / h);
  fmt::print("300 explicit steps: largest state {:.3f} at 0.95 of the limit, {:.3g} at 1.1 of it\n",
             method.steps(x, 0.95 * h, 300), method.steps(x, 1.1 * h, 300));
  const Run fine = run(1e-9, revolutions);
  double travel = 0;
  for (std::size_t k = 0; k < fine.x.size(); ++k) travel = std::max(travel, std::abs(fine.x[k] - fine.x[k % 4]));
  fmt::print("journals travel up to {:.3e} m\n", travel);
  for (const double tolerance : {1e-4, 1e-5, 1e-6, 1e-7}) {
    double least = 1e9, stage = 1e9;
    Run implicit;
    for (int k = 0; k < 3; ++k) {
      implicit = run(tolerance, revolutions);
      least = std::min(least, implicit.seconds);
      const double begin = bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID);
      (void)method.steps(x, 0.95 * h, 100);
      stage = std::min(stage, (bench::clock_seconds(CLOCK_PROCESS_CPUTIME_ID) - begin) / 400);
    }
    const double whole = 4 * stage * revolutions * period / h;
    fmt::print(
        "tolerance {:.0e}: {:.3f} s, {} steps, {} residuals, {} tangents, {} factorisations; {:.1e} of the travel off; "
        "explicit {:.4f} ms a stage, {:.2f} s: ratio {:.1f}\n",
        tolerance, least, implicit.work.steps, implicit.work.residuals, implicit.work.jacobians,
        implicit.work.factorisations, difference(implicit, fine) / travel, 1e3 * stage, whole, whole / least);
  }
  return 0;
}
