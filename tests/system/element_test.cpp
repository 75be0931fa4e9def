// Elements at nodes: what they are in F and J, where they rest, and what they do beyond their tables.

#include <gtest/gtest.h>

#include <cmath>

#include "support/rest_finder.hpp"
#include "support/varied_machines.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/spectral/eigenvalues.hpp"

using namespace whirl;
using system::Element;
using system::Role;

namespace {

constexpr double speed = 300;

system::Bearing linear_bearing(const std::string& name, int node, const film::Linear& film) {
  system::Bearing b;
  b.name = name;
  b.node = node;
  b.film = film;
  return b;
}

system::Bearing oil_film(const std::string& name, int node) {
  system::Bearing b = test::bearing(name, node, film::Short{}, film::Geometry::Bore::cylindrical);
  b.elevation = 0;
  return b;
}

// A shaft in two oil films.
system::Machine in_films() {
  system::Machine m;
  m.rotor = test::four_segments();
  m.lubricants["oil"] = {0.02, 870};
  m.bearings = {oil_film("left", 1), oil_film("right", 5)};
  m.rest = &test::newton_rest;
  return m;
}

// Films and linear coefficients at node 3 as a bearing, for comparison.
const film::Linear coefficients{{3e6, 1e6, -1e6, 2e6}, {1e3, 0, 0, 2e3}};

Element seal_of(const film::Linear& film, int node) {
  Element e;
  e.name = "seal";
  e.node = node;
  e.role = Role::seal;
  e.stiffness = film.stiffness;
  e.damping = film.damping;
  return e;
}

core::Vector wavy(system::RotorSystem& s, double size) {
  core::Vector x = core::make_vector(s.comm(), s.local_size(), PETSC_DETERMINE), rows = core::duplicate(x.get());
  s.scales(x.get(), rows.get());
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
  const core::WriteArray a(x.get());
  for (PetscInt i = 0; i < a.size(); ++i) a[i] *= size * std::sin(3.7 * static_cast<double>(begin + i));
  return x;
}

std::vector<double> rows_of(system::RotorSystem& s, const core::Vector& x, const core::Vector& rate) {
  const core::Vector f = core::duplicate(x.get());
  s.residual(0.7, x.get(), rate.get(), f.get());
  return s.gather(f.get());
}

// J times x.
std::vector<double> product(system::RotorSystem& s, const core::Vector& x, const core::Vector& rate) {
  const core::Matrix j = s.make_jacobian();
  const core::Vector f = core::duplicate(x.get());
  s.jacobian(0.7, x.get(), rate.get(), 0.8, 30, j.get());
  core::check(MatMult(j.get(), x.get(), f.get()));
  return s.gather(f.get());
}

void expect_same(const std::vector<double>& a, const std::vector<double>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  double size = 0, error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    size = std::max(size, std::abs(b[i]));
    error = std::max(error, std::abs(a[i] - b[i]));
  }
  EXPECT_GT(size, 0);
  EXPECT_LE(error, tolerance * size);
}

core::Vector at_rest(system::RotorSystem& s) {
  core::Vector x = s.guess();
  s.set_forcing(false);
  EXPECT_TRUE(solve::find_equilibrium(s, x.get(), {}).converged);
  return x;
}

std::vector<std::complex<double>> eigenvalues(system::RotorSystem& s, Vec x, int count) {
  spectral::EigenOptions o;
  o.count = count;
  std::vector<std::complex<double>> out;
  for (const auto& mode : spectral::modes(s, x, o)) out.push_back(mode.lambda);
  return out;
}

}  // namespace

// An element that carries load is a linear bearing; beside a bearing, two at a node, in a whole and in reduced shafts.
TEST(Elements, OneThatCarriesLoadIsALinearBearing) {
  using Type = rotor::Reduction::Type;
  for (const Type type : {Type::none, Type::guyan, Type::craig_bampton, Type::craig_bampton_state}) {
    system::Machine with = in_films();
    if (type != Type::none) {
      with.rotor.reduction = {type, {1, 3, 5}, 2};
      with.rotor.reduction.speed = speed;
    }
    system::Machine other = with;
    with.bearings.push_back(linear_bearing("third", 3, coefficients));
    with.bearings.push_back(linear_bearing("fourth", 5, coefficients));
    for (const int node : {3, 5}) {
      Element e = seal_of(coefficients, node);
      e.static_load = true;
      other.elements.push_back(e);
    }
    system::RotorSystem a(MPI_COMM_WORLD, system::train_of(with), speed),
        b(MPI_COMM_WORLD, system::train_of(other), speed);
    const core::Vector x = wavy(a, 0.02), rate = wavy(a, 0.5);
    expect_same(rows_of(b, x, rate), rows_of(a, x, rate), 1e-13);
    expect_same(product(b, x, rate), product(a, x, rate), 1e-13);
  }
}

// A rigid rotor of 40 kg in springs of 1 MN/m and in a seal whose fluid weighs 12 kg: sqrt(k/(m + M)).
TEST(Elements, FluidMassLowersTheFrequency) {
  system::Machine m;
  m.rotor.type = rotor::Options::Type::rigid;
  m.rotor.mass = 40;
  m.bearings = {linear_bearing("springs", 1, {{1e6, 0, 0, 1e6}, {}})};
  Element seal = seal_of({}, 1);
  seal.mass = {12, 0, 0, 12};
  m.elements = {seal};
  system::RotorSystem s(MPI_COMM_WORLD, system::train_of(m), speed);
  const auto found = eigenvalues(s, at_rest(s).get(), 2);
  ASSERT_GE(found.size(), 1U);
  EXPECT_NEAR(std::abs(found[0].imag()), std::sqrt(1e6 / 52), 1e-8);
}

// The shaft hangs in its films as if the seal were not there, and vibrates as if the seal were a bearing that lies
// where the shaft does.
TEST(Elements, ASealActsOnTheMotionAboutTheStaticEquilibrium) {
  system::Machine bare = in_films(), m = bare;
  m.elements = {seal_of(coefficients, 3), seal_of(coefficients, 5)};
  system::RotorSystem without(MPI_COMM_WORLD, system::train_of(bare), speed),
      s(MPI_COMM_WORLD, system::train_of(m), speed);
  const core::Vector there = at_rest(without), x = at_rest(s);
  expect_same(s.gather(x.get()), without.gather(there.get()), 1e-9);
  const std::vector<double> whole = s.gather(x.get());
  for (const auto& e : s.elements(whole.data())) {
    EXPECT_GT(std::abs(e.motion[1]), 1e-6);
    for (const double f : e.force) EXPECT_NEAR(f, 0, 1e-3);
  }
  // Each seal as a bearing whose centre is the place of rest of its journal, along y; along x it has no elevation, so
  // that Jacobians are compared and not forces.
  system::Machine bearings = bare;
  bearings.bearings.push_back(linear_bearing("third", 3, coefficients));
  bearings.bearings.push_back(linear_bearing("fourth", 5, coefficients));
  system::RotorSystem b(MPI_COMM_WORLD, system::train_of(bearings), speed);
  expect_same(product(s, x, wavy(s, 0)), product(b, x, wavy(b, 0)), 1e-13);
  const core::Vector moved = wavy(s, 0.02), rest = wavy(s, 0);
  core::Vector at = core::duplicate(x.get());
  core::check(VecWAXPY(at.get(), 1, x.get(), moved.get()));
  // F(x + dx) - F(x) of both, which differ by nothing but the place of rest.
  const auto change = [&](system::RotorSystem& of) {
    std::vector<double> far = rows_of(of, at, rest), near = rows_of(of, x, rest);
    for (std::size_t i = 0; i < far.size(); ++i) far[i] -= near[i];
    return far;
  };
  s.set_forcing(false);
  b.set_forcing(false);
  expect_same(change(s), change(b), 1e-10);
}

// dF/dp has the derivative of the place of rest in it, be p the speed (a table over it, too) or an option.
TEST(Elements, DerivativesAreExact) {
  system::Machine m = in_films();
  m.elements = test::varied_elements();
  m.elements[0].to_pedestal.reset();
  for (Element& e : m.elements) e.static_load = e.name == "spring";
  const auto taylor = [](system::RotorSystem& s) {
    const core::Vector rest = at_rest(s), moved = wavy(s, 0.05), rate = wavy(s, 0.5);
    core::Vector x = core::duplicate(rest.get());
    core::check(VecWAXPY(x.get(), 1, rest.get(), moved.get()));
    s.set_forcing(true);
    return problem::taylor_test(s, 0.7, x.get(), rate.get(), 1e-3);
  };
  system::RotorSystem over_speed(MPI_COMM_WORLD, system::train_of(m), speed);
  const auto by_speed = taylor(over_speed);
  EXPECT_GE(by_speed.state_order, 1.9);
  EXPECT_GE(by_speed.parameter_order, 1.9);
  for (const char* path : {"lubricants.oil.viscosity", "elements.seal.stiffness.1", "elements.spring.stiffness.4"}) {
    SCOPED_TRACE(path);
    system::Machine start = m;
    const double value = *deck::find_option(start, path).value;
    system::RotorSystem s(MPI_COMM_WORLD,
                          system::Varying{[&](double p) {
                                            system::Machine at = m;
                                            *deck::find_option(at, path).value = p;
                                            return system::train_of(at);
                                          },
                                          value, value},
                          speed);
    EXPECT_GE(taylor(s).parameter_order, 1.9);
  }
}

// The place of rest is kept where supports do not know the speed, and found anew where they do.
TEST(Elements, RestOnLinearSupportsFollowsTheSpeed) {
  for (const bool by_speed : {false, true}) {
    system::Machine m = in_films();
    film::Linear springs{{2e8, 0, 0, 3e8}, {1e4, 0, 0, 1e4}};
    if (by_speed) springs.table = {{.speed = 0.5 * speed, .k_yy = 0}, {.speed = 2 * speed, .k_yy = 5e8}};
    for (system::Bearing& b : m.bearings) b.film = springs;
    m.elements = {seal_of({}, 3)};
    m.elements[0].stiffness = {1e8, 0, 0, 1e8};
    system::RotorSystem moved(MPI_COMM_WORLD, system::train_of(m), speed),
        fresh(MPI_COMM_WORLD, system::train_of(m), 1.3 * speed);
    const core::Vector x = wavy(moved, 0.02);
    (void)rows_of(moved, x, x);
    moved.set_parameter(1.3 * speed);
    expect_same(rows_of(moved, x, x), rows_of(fresh, x, x), 1e-12);
  }
}

// On one rank and on all.
TEST(Elements, RanksAgree) {
  system::Machine m = in_films();
  m.bearings[0].pedestal = system::Pedestal{{50, 60}, {4e8, 5e8}, {3e4, 2e4}};
  m.elements = test::varied_elements();
  m.elements[0].to_pedestal = "left";
  system::RotorSystem alone(MPI_COMM_SELF, system::train_of(m), speed), all(MPI_COMM_WORLD, system::train_of(m), speed);
  for (const double at : {speed, 1.1 * speed}) {
    alone.set_parameter(at);
    all.set_parameter(at);
    const core::Vector x = wavy(alone, 0.02), rate = wavy(alone, 0.5), y = wavy(all, 0.02), there = wavy(all, 0.5);
    expect_same(rows_of(all, y, there), rows_of(alone, x, rate), 1e-9);
    expect_same(product(all, y, there), product(alone, x, rate), 1e-12);
    const core::Vector df = core::duplicate(x.get()), dg = core::duplicate(y.get());
    alone.parameter_derivative(0.7, x.get(), rate.get(), df.get());
    all.parameter_derivative(0.7, y.get(), there.get(), dg.get());
    expect_same(all.gather(dg.get()), alone.gather(df.get()), 1e-7);
  }
}

TEST(Elements, BeyondTheirTable) {
  system::Machine m = in_films();
  Element seal = seal_of({}, 3);
  seal.static_load = true;
  seal.table = {{.speed = 100, .k_xx = 1e6, .k_yy = 1e6}, {.speed = 200, .k_xx = 2e6, .k_yy = 3e6}};
  m.elements = {seal};
  system::RotorSystem refused(MPI_COMM_WORLD, system::train_of(m), 150);
  const core::Vector x = wavy(refused, 0.02);
  (void)rows_of(refused, x, x);
  refused.set_parameter(300);
  EXPECT_THROW((void)rows_of(refused, x, x), core::DomainError);
  m.elements[0].extrapolate = film::Linear::Beyond::hold;
  system::RotorSystem held(MPI_COMM_WORLD, system::train_of(m), 300);
  m.elements[0].table.clear();
  m.elements[0].stiffness = {2e6, 0, 0, 3e6};
  system::RotorSystem constant(MPI_COMM_WORLD, system::train_of(m), 300);
  expect_same(rows_of(held, x, x), rows_of(constant, x, x), 1e-15);
}
