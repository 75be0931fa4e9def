// What studies ask of a system: one that is no rotor, constant rates, an accelerated unbalance.

#include <gtest/gtest.h>

#include <cmath>

#include "support/film_of.hpp"
#include "support/half_rotor.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/system/brusselator.hpp"
#include "whirl/system/flows.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;

namespace {

std::unique_ptr<system::Plant> brusselator(MPI_Comm comm, double system::Brusselator::*option) {
  const system::Brusselator o{.cells = 12};
  return system::make_system(comm, {[o, option](double p) {
                                      system::Brusselator changed = o;
                                      changed.*option = p;
                                      return changed;
                                    },
                                    o.*option, 1});
}

// A vector whose entry k is f(k), whatever the ranks.
template <class F>
core::Vector filled(const problem::System& s, F f) {
  core::Vector x = core::make_vector(s.comm(), s.local_size(), PETSC_DETERMINE);
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
  const core::WriteArray a(x.get());
  for (PetscInt k = 0; k < a.size(); ++k) a[k] = f(static_cast<double>(begin + k));
  return x;
}

system::Train rotor_in(film::testing::Kind kind, double liner_damping = 0) {
  film::Options all = film::testing::film_of(kind);
  if (film::facts(all).gives_way) {
    auto& film = film::as<film::Compliant>(all);
    film.cells = {16, 4};
    film.compliance = 0.1;
    film.liner_damping = liner_damping;
    film.reference_speed = 160;
  }
  return test::half_rotor(all, 4e-6, 0.3);
}

}  // namespace

TEST(Plant, DerivativesOfTheBrusselatorPassTheTaylorTest) {
  for (const auto option :
       {&system::Brusselator::length, &system::Brusselator::a, &system::Brusselator::b,
        &system::Brusselator::diffusion_u, &system::Brusselator::diffusion_v, &system::Brusselator::amplitude}) {
    const auto s = brusselator(MPI_COMM_WORLD, option);
    const auto x = filled(*s, [](double k) { return 2 + std::sin(k); }),
               rate = filled(*s, [](double k) { return std::cos(2 * k); });
    const auto r = problem::taylor_test(*s, 0.7, x.get(), rate.get(), 1e-3);
    EXPECT_GT(r.first_difference, 1e-6);
    EXPECT_GE(r.state_order, 1.9);
    EXPECT_GE(r.rate_order, 1.9);
    EXPECT_GE(r.parameter_order, 1.9);
  }
}

// A flow as a function of one of its options.
template <class Options>
std::unique_ptr<system::Plant> flow(double Options::*option) {
  const Options o;
  const auto at = [o, option](double p) {
    Options changed = o;
    changed.*option = p;
    return changed;
  };
  return system::make_system(MPI_COMM_WORLD, system::OptionsAlong<Options>{at, o.*option, 1});
}

template <class Options>
void passes_taylor(std::initializer_list<double Options::*> options) {
  for (const auto option : options) {
    const auto s = flow<Options>(option);
    const auto x = filled(*s, [](double k) { return 2 + std::sin(k); }),
               rate = filled(*s, [](double k) { return std::cos(2 * k); });
    const auto r = problem::taylor_test(*s, 0.7, x.get(), rate.get(), 1e-3);
    EXPECT_GT(r.first_difference, 1e-6);
    EXPECT_GE(r.state_order, 1.9);
    EXPECT_GE(r.rate_order, 1.9);
    EXPECT_GE(r.parameter_order, 1.9);
  }
}

TEST(Plant, DerivativesOfTheFlowsPassTheTaylorTest) {
  using namespace system;
  passes_taylor<Lorenz>({&Lorenz::sigma, &Lorenz::rho, &Lorenz::beta});
  passes_taylor<Rossler>({&Rossler::a, &Rossler::b, &Rossler::c});
  passes_taylor<Duffing>({&Duffing::damping, &Duffing::linear, &Duffing::cubic, &Duffing::amplitude});
}

TEST(Plant, FlowsRestWhereTheySay) {
  for (const auto& s : {flow(&system::Lorenz::rho), flow(&system::Rossler::c), flow(&system::Duffing::damping)}) {
    s->set_forcing(false);
    const core::Vector x = s->guess(), rest = core::duplicate(x.get()), f = core::duplicate(x.get());
    core::check(VecSet(rest.get(), 0));
    s->residual(0, x.get(), rest.get(), f.get());
    double norm = 1;
    core::check(VecNorm(f.get(), NORM_INFINITY, &norm));
    EXPECT_LE(norm, 1e-13);
  }
  EXPECT_TRUE(flow(&system::Duffing::damping)->forced());
  EXPECT_FALSE(flow(&system::Lorenz::rho)->forced());
}

TEST(Plant, TheBrusselatorRestsAtItsUniformState) {
  const auto s = brusselator(MPI_COMM_WORLD, &system::Brusselator::length);
  const core::Vector x = s->guess(), rest = core::duplicate(x.get()), f = core::duplicate(x.get());
  core::check(VecSet(rest.get(), 0));
  s->residual(0, x.get(), rest.get(), f.get());
  double norm = 1;
  core::check(VecNorm(f.get(), NORM_INFINITY, &norm));
  EXPECT_LE(norm, 1e-13);
  const auto shown = s->shown(s->gather(x.get()).data());
  EXPECT_EQ(shown[0].position[0], 2);
  EXPECT_EQ(shown[0].position[1], 5.45 / 2);
  // Moved away, the middle moves by the whole offset and its rate is what the equations say.
  s->displace(x.get(), {0.1, 0});
  s->residual(0, x.get(), rest.get(), f.get());
  const auto whole = s->gather(x.get()), rates = s->gather(f.get());
  const auto moved = s->shown(whole.data());
  EXPECT_NEAR(moved[0].position[0], 2.1, 1e-15);
  EXPECT_NEAR(moved[0].velocity[0], -rates[10], 1e-13);
  EXPECT_NEAR(moved[0].velocity[1], -rates[11], 1e-13);
}

// Explicit schemes keep dF/d(dx/dt) where a system says that it is constant.
TEST(Plant, RatesSaidToBeConstantAreSo) {
  using enum film::testing::Kind;
  struct Case {
    film::testing::Kind kind;
    double liner_damping = 0;  // [s]
  };
  for (const Case& c :
       {Case{short_bearing}, Case{long_bearing}, Case{finite_approximate}, Case{compliant_short}, Case{compliant_long},
        Case{compliant_finite}, Case{compliant_short, 1e-3}, Case{compliant_finite, 1e-3}}) {
    const int kind = static_cast<int>(c.kind);
    system::RotorSystem s(MPI_COMM_WORLD, rotor_in(c.kind, c.liner_damping), 300);
    EXPECT_EQ(s.constant_rates(), c.liner_damping == 0) << kind;
    core::Matrix j[2] = {s.make_jacobian(), s.make_jacobian()};
    for (int k = 0; k < 2; ++k) {
      const core::Vector x = s.guess();
      s.displace(x.get(), {0.1 * k, 0.3 * k});
      const auto rate = filled(s, [k](double i) { return k * 1e-3 * std::sin(3.7 * i); });
      s.jacobian(0.7 * k, x.get(), rate.get(), 0, 1, j[k].get());
    }
    double norm = 0, change = 0;
    core::check(MatNorm(j[0].get(), NORM_FROBENIUS, &norm));
    core::check(MatAXPY(j[1].get(), -1, j[0].get(), SAME_NONZERO_PATTERN));
    core::check(MatNorm(j[1].get(), NORM_FROBENIUS, &change));
    EXPECT_GT(norm, 0.5);
    if (s.constant_rates()) {
      EXPECT_LE(change, 1e-13 * norm) << kind;
    } else {
      EXPECT_GE(change, 1e-3 * norm) << kind;
    }
  }
}

// The force of a mass that moves along (cos, sin)(angle(t)) is minus its second derivative, here by differences.
TEST(Plant, UnbalanceOfAnAcceleratedShaft) {
  constexpr double speed = 30, acceleration = 400, angle = 1.1, phase = 0.3, amount = 2e-6;
  system::RotorSystem s(MPI_COMM_WORLD, rotor_in(film::testing::Kind::short_bearing), speed);
  s.set_acceleration(acceleration);
  const core::Vector x = s.guess(), rest = core::duplicate(x.get()), with = core::duplicate(x.get()),
                     without = core::duplicate(x.get());
  core::check(VecSet(rest.get(), 0));
  s.residual(angle, x.get(), rest.get(), with.get());
  s.set_forcing(false);
  s.residual(angle, x.get(), rest.get(), without.get());
  s.set_forcing(true);
  core::check(VecAXPY(with.get(), -1, without.get()));
  const auto force = s.gather(with.get());
  const auto place = [&](double t, bool sine) {
    const double a = angle + phase + speed * t + acceleration * t * t / 2;
    return amount * (sine ? std::sin(a) : std::cos(a));
  };
  constexpr double h = 1e-4;
  for (int d = 0; d < 2; ++d) {
    const double second = (place(h, d) - 2 * place(0, d) + place(-h, d)) / (h * h);
    EXPECT_NEAR(force[static_cast<std::size_t>(2 * d)], second, 1e-5 * amount * speed * speed);
  }
  if (auto* structure = s.structure()) {
    Eigen::VectorXd load, still;
    structure->load(angle, load);
    s.set_forcing(false);
    structure->load(angle, still);
    for (int d = 0; d < 2; ++d)
      EXPECT_NEAR(still(2 * d) - load(2 * d), force[static_cast<std::size_t>(2 * d)], 1e-12 * amount * speed * speed);
  }
}
