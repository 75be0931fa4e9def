// Discs that are eccentric, skewed or off their node: what they do to the machine, against a body of point masses.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <complex>

#include "support/dense.hpp"
#include "system/start.hpp"
#include "whirl/problem/taylor.hpp"
#include "whirl/rotor/shaft.hpp"
#include "whirl/system/options.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Complex = std::complex<double>;

namespace {

constexpr int node = 4;

rotor::Disc disc() {
  rotor::Disc d;
  d.node = node;
  d.mass = 3;
  d.polar_inertia = 0.02;
  d.diametral_inertia = 0.014;
  d.offset = 0.03;
  d.eccentricity = 2e-6;
  d.eccentricity_phase = 0.4;
  d.skew = 3e-5;
  d.skew_phase = 1.9;
  return d;
}

// A shaft with an overhung node, on linear bearings that are not isotropic.
system::Machine machine() {
  system::Machine m;
  rotor::Segment s;
  s.length = 0.1;
  s.outer_mass_diameter = 0.03;
  m.rotor.segments.assign(6, s);
  m.rotor.material.modulus = {{293.15, 2.1e11}};
  m.rotor.discs = {disc()};
  for (const int at : {1, 6}) {
    system::Bearing b;
    b.name = at == 1 ? "left" : "right";
    b.node = at;
    b.film = film::Linear{{2e6, 1e5, -1e5, 3e6}, {200, 0, 0, 200}};
    m.bearings.push_back(b);
  }
  return m;
}

// Near rest, moving; the same on any number of ranks.
core::Vector wave(Vec like, double size, double shift) {
  core::Vector x = core::duplicate(like);
  PetscInt begin = 0;
  core::check(VecGetOwnershipRange(x.get(), &begin, nullptr));
  const core::WriteArray a(x.get());
  for (PetscInt i = 0; i < a.size(); ++i) a[i] = size * std::sin(shift + 1.7 * static_cast<double>(begin + i));
  return x;
}

using Real = long double;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;

// A quantity of second degree in time: at rest of its third derivative.
struct Path {
  Complex start, rate, acceleration;
  [[nodiscard]] std::complex<Real> at(Real t) const {
    return std::complex<Real>(start) + t * std::complex<Real>(rate) + t * t / 2 * std::complex<Real>(acceleration);
  }
};

// The shortest turn that takes z to the direction (p, 1).
Matrix3 leaning(std::complex<Real> p) {
  return Eigen::Quaternion<Real>::FromTwoVectors(Vector3(0, 0, 1), Vector3(p.real(), p.imag(), 1)).toRotationMatrix();
}

// Six masses with the mass and the inertias of disc(), fixed to a section that moves, leans and turns.
struct Body {
  Path place, lean;
  Real angle, speed, acceleration;

  [[nodiscard]] Vector3 node_at(Real t) const { return {place.at(t).real(), place.at(t).imag(), 0}; }
  [[nodiscard]] Vector3 mass_at(Real t, const Vector3& in_disc) const {
    const rotor::Disc d = disc();
    const Matrix3 section =
        leaning(lean.at(t)) * Eigen::AngleAxis<Real>(angle + speed * t + acceleration * t * t / 2, Vector3(0, 0, 1));
    const auto e = std::polar<Real>(d.eccentricity, d.eccentricity_phase), g = std::polar<Real>(d.skew, d.skew_phase);
    return node_at(t) + section * (Vector3(e.real(), e.imag(), d.offset) + leaning(g) * in_disc);
  }

  // Force and moment about the node that the motion takes at t = 0, without the torque along the section's axis; the
  // moment as that on slopes: that on dx/dz turns about y, that on dy/dz about -x.
  [[nodiscard]] std::array<Complex, 2> needed() const {
    constexpr Real h = 1e-5L;
    Vector3 force = Vector3::Zero(), moment = Vector3::Zero();
    const auto add = [&](Real mass, const Vector3& in_disc) {
      const auto x = [&](int k) { return mass_at(k * h, in_disc); };
      const Vector3 a = (-x(-2) + 16 * x(-1) - 30 * x(0) + 16 * x(1) - x(2)) / (12 * h * h);
      force += mass * a;
      moment += mass * (x(0) - node_at(0)).cross(a);
    };
    const Real r = 0.1L, away = std::sqrt(0.004L);
    for (const Real sign : {-1.0L, 1.0L}) {
      add(0.5L, sign * Vector3(r, 0, 0));
      add(0.5L, sign * Vector3(0, r, 0));
      add(0.5L, sign * Vector3(0, 0, away));
    }
    const Vector3 axis = leaning(lean.at(0)) * Vector3(0, 0, 1);
    moment -= moment.dot(axis) * axis;
    return {Complex(static_cast<double>(force.x()), static_cast<double>(force.y())),
            Complex(static_cast<double>(moment.y()), static_cast<double>(-moment.x()))};
  }
};

// What the disc adds to the rows of the unreduced machine while the node's freedoms follow the paths.
Eigen::VectorXd rows_of_disc(const system::Machine& with, const Body& b,
                             const std::vector<std::pair<int, Path>>& paths) {
  system::Machine without = with;
  without.rotor.discs.clear();
  system::RotorSystem s(MPI_COMM_WORLD, system::train_of(with, {"discs"}), static_cast<double>(b.speed)),
      none(MPI_COMM_WORLD, system::train_of(without), static_cast<double>(b.speed));
  s.set_acceleration(static_cast<double>(b.acceleration));
  core::Vector x = core::make_vector(MPI_COMM_WORLD, s.local_size(), PETSC_DETERMINE), rate = core::duplicate(x.get()),
               f = core::duplicate(x.get()), g = core::duplicate(x.get());
  if (core::rank_of(MPI_COMM_WORLD) == 0)
    for (const auto& [coordinate, path] : paths)
      for (int plane = 0; plane < 2; ++plane) {
        const auto part = [plane](Complex z) { return plane == 0 ? z.real() : z.imag(); };
        const PetscInt row = 2 * (coordinate + plane);
        core::check(VecSetValue(x.get(), row, part(path.start), INSERT_VALUES));
        core::check(VecSetValue(x.get(), row + 1, part(path.rate), INSERT_VALUES));
        core::check(VecSetValue(rate.get(), row + 1, part(path.acceleration), INSERT_VALUES));
      }
  for (Vec v : {x.get(), rate.get()}) {
    core::check(VecAssemblyBegin(v));
    core::check(VecAssemblyEnd(v));
  }
  s.residual(static_cast<double>(b.angle), x.get(), rate.get(), f.get());
  none.residual(static_cast<double>(b.angle), x.get(), rate.get(), g.get());
  return test::dense(f.get()) - test::dense(g.get());
}

const Body moving{
    {{3e-6, -2e-6}, {4e-4, 2e-4}, {0.02, -0.03}}, {{2e-5, 1e-5}, {-2e-3, 3e-3}, {0.2, 0.1}}, 0.7L, 120, 900};

void expect_near(Complex found, Complex wanted) {
  EXPECT_NEAR(found.real(), wanted.real(), 2e-6 * std::abs(wanted));
  EXPECT_NEAR(found.imag(), wanted.imag(), 2e-6 * std::abs(wanted));
}

}  // namespace

// Momentum: with the shaft accelerated, all forces of the disc are what moves its masses. The torque along the section
// is what the shaft transmits; no moment alpha I_p (dy/dz, -dx/dz) is left beside it.
TEST(Disc, ItsRowsAreTheRateOfMomentumOfABodyOfMasses) {
  system::Machine m = machine();
  m.gravity = 0.0;
  using rotor::Freedom;
  const int at = rotor::full_coordinate(node, Freedom::x), tilt = rotor::full_coordinate(node, Freedom::slope_x);
  const Eigen::VectorXd rows = rows_of_disc(m, moving, {{at, moving.place}, {tilt, moving.lean}});
  const auto [force, moment] = moving.needed();
  expect_near({rows(2 * at), rows(2 * at + 2)}, force);
  expect_near({rows(2 * tilt), rows(2 * tilt + 2)}, moment);
  // Without the angular acceleration it is another force.
  Body steady = moving;
  steady.acceleration = 0;
  EXPECT_GT(std::abs(steady.needed()[0] - force), 1e-3 * std::abs(force));
  EXPECT_GT(std::abs(steady.needed()[1] - moment), 1e-3 * std::abs(moment));
}

// On a hub the same body leans as the line through both ends: moments are couples of forces there.
TEST(Disc, OnAHubItsMomentsAreForcesAtTheEnds) {
  system::Machine m = machine();
  m.gravity = 0.0;
  m.rotor.discs[0].hub = {3, 5};
  const double length = 0.2;
  Body b = moving;
  const auto end = [&](double side) {  // place -+ half the hub times the slope
    const auto of = [&](Complex u, Complex s) { return u + side * length / 2 * s; };
    return Path{of(b.place.start, b.lean.start), of(b.place.rate, b.lean.rate),
                of(b.place.acceleration, b.lean.acceleration)};
  };
  using rotor::Freedom;
  const int left = rotor::full_coordinate(3, Freedom::x), at = rotor::full_coordinate(node, Freedom::x),
            right = rotor::full_coordinate(5, Freedom::x);
  const Eigen::VectorXd rows = rows_of_disc(m, b, {{left, end(-1)}, {at, b.place}, {right, end(1)}});
  const auto [force, moment] = b.needed();
  const auto row = [&](int coordinate) { return Complex(rows(2 * coordinate), rows(2 * coordinate + 2)); };
  expect_near(row(at), force);
  expect_near(row(right), moment / length);
  expect_near(row(left), -moment / length);
}

TEST(Disc, ItsWeightActsAtItsCentre) {
  system::Machine with = machine(), without = machine();
  without.rotor.discs.clear();
  system::RotorSystem s(MPI_COMM_WORLD, system::train_of(with), 100),
      none(MPI_COMM_WORLD, system::train_of(without), 100);
  core::Vector x = core::make_vector(MPI_COMM_WORLD, s.local_size(), PETSC_DETERMINE), f = core::duplicate(x.get()),
               g = core::duplicate(x.get());
  s.residual(0.3, x.get(), x.get(), f.get());
  none.residual(0.3, x.get(), x.get(), g.get());
  const Eigen::VectorXd rows = test::dense(f.get()) - test::dense(g.get());
  const int y = rotor::full_coordinate(node, rotor::Freedom::y),
            tilt = rotor::full_coordinate(node, rotor::Freedom::slope_y);
  EXPECT_NEAR(rows(2 * y), 3 * -system::lateral(with.gravity)[1], 1e-12);
  EXPECT_NEAR(rows(2 * tilt), 3 * -system::lateral(with.gravity)[1] * 0.03, 1e-12);
  EXPECT_EQ(rows(2 * y - 2), 0);
}

TEST(Disc, DerivativesPassTheTaylorTest) {
  const std::vector<int> masters{1, 4, 6};
  for (const bool reduced : {false, true})
    for (const bool hub : {false, true})
      for (const char* option : {"eccentricity", "skew", "offset", "speed"}) {
        system::Machine m = machine();
        if (hub) m.rotor.discs[0].hub = {3, 5};
        if (reduced) m.rotor.reduction = {rotor::Reduction::Type::guyan, masters, 0};
        const auto value = [option](rotor::Disc& d) -> double& {
          return option[0] == 'e' ? d.eccentricity : option[1] == 'k' ? d.skew : d.offset;
        };
        const auto train = [m, value](double p) {
          system::Machine at = m;
          value(at.rotor.discs[0]) = p;
          return system::train_of(at, {"discs"});
        };
        const double start = value(m.rotor.discs[0]);
        const bool speed = option[1] == 'p';
        const auto made =
            speed ? std::make_unique<system::RotorSystem>(MPI_COMM_WORLD, train(start), 300)
                  : std::make_unique<system::RotorSystem>(MPI_COMM_WORLD, system::Varying{train, start, start}, 300);
        const core::Vector like = core::make_vector(MPI_COMM_WORLD, made->local_size(), PETSC_DETERMINE),
                           x = wave(like.get(), 1e-5, 0.3), rate = wave(like.get(), 1e-3, 1.1);
        const auto r = problem::taylor_test(*made, 0.7, x.get(), rate.get(), 1e-3);
        // Linear in all but the speed: what is left is rounding.
        EXPECT_GT(r.first_difference, 0) << option;
        EXPECT_TRUE(r.parameter_order >= 1.9 || !speed) << option << ' ' << r.parameter_order;
        // The parameter's derivative as a difference over a tenth of it: the rows are quadratic in it at most.
        const core::Vector by = core::duplicate(like.get()), f = core::duplicate(like.get()),
                           g = core::duplicate(like.get());
        made->parameter_derivative(0.7, x.get(), rate.get(), by.get());
        const double p = made->parameter(), step = 0.1 * p;
        made->set_parameter(p + step);
        made->residual(0.7, x.get(), rate.get(), f.get());
        made->set_parameter(p - step);
        made->residual(0.7, x.get(), rate.get(), g.get());
        const Eigen::VectorXd wanted = (test::dense(f.get()) - test::dense(g.get())) / (2 * step);
        EXPECT_GT(wanted.norm(), 0) << option;
        EXPECT_LE((test::dense(by.get()) - wanted).norm(), 1e-6 * wanted.norm()) << option << reduced << hub;
      }
}

// The same motion of the nodes on any number of ranks and of a basis that holds it.
TEST(Disc, ReducedForcesAreThoseOfTheWholeShaftInItsBasis) {
  for (const bool hub : {false, true}) {
    system::Machine m = machine();
    if (hub) m.rotor.discs[0].hub = {3, 5};
    system::RotorSystem whole(MPI_COMM_WORLD, system::train_of(m, {"discs"}), 100);
    m.rotor.reduction = {rotor::Reduction::Type::guyan, {1, 6}, 0};
    system::RotorSystem small(MPI_COMM_WORLD, system::train_of(m, {"discs"}), 100);
    const Eigen::MatrixXd basis = test::dense(small.rotor().matrices().basis.get());
    const auto momenta = [](const std::vector<double>& v) -> Eigen::VectorXd {
      const auto n = static_cast<Eigen::Index>(v.size() / 2);
      return Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<2>>(v.data(), n);
    };
    const Eigen::VectorXd wanted = basis.transpose() * momenta(whole.forcing_cosine());
    EXPECT_GT(wanted.norm(), 1e-7);
    EXPECT_LE((momenta(small.forcing_cosine()) - wanted).norm(), 1e-12 * wanted.norm());
  }
}
