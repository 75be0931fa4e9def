// Eigenvalues of systems and matrices with exact answers; words for modes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/small_system.hpp"
#include "whirl/core/error.hpp"
#include "whirl/spectral/eigenvalues.hpp"
#include "whirl/spectral/whirl.hpp"

using namespace whirl;
using spectral::Complex;
using spectral::Sense;
using test::Column;

namespace {

// A chain of `masses` unit masses and unit springs between walls, without damping: the rows q' = v have no diagonal.
struct Chain {
  int masses;
  double damping = 0, stiffness = 1;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(2 * masses);
    for (int k = 0; k < masses; ++k) {
      f(k) = xdot(k) - x(masses + k);
      f(masses + k) = xdot(masses + k) + damping * x(masses + k) + 2.0 * stiffness * x(k);
      if (k > 0) f(masses + k) -= stiffness * x(k - 1);
      if (k + 1 < masses) f(masses + k) -= stiffness * x(k + 1);
    }
    return f;
  }
};

// A rigid disc that tilts on an isotropic support, J_d = 1, stiffness 1: a'' - i g a' + a = 0 for a = x + i y, with
// gyroscopic rate g = p J_p/J_d: forward frequency g/2 + sqrt(1 + g^2/4), backward -(g/2 - sqrt(1 + g^2/4)).
struct Gyroscope {
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(4);
    f << xdot(0) - x(2), xdot(1) - x(3), xdot(2) + p * x(3) + x(0), xdot(3) - p * x(2) + x(1);
    return f;
  }
};

}  // namespace

TEST(Modes, DenseAndKrylovFindTheChainsFrequencies) {
  const int masses = 20;
  test::SmallSystem s(MPI_COMM_WORLD, 2 * masses, 0, 1, Chain{masses});
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(2 * masses));
  spectral::EigenOptions o;
  const auto dense = spectral::modes(s, x.get(), o);
  o.dense_below = 0;
  o.count = 10;
  const auto krylov = spectral::modes(s, x.get(), o);
  ASSERT_EQ(dense.size(), 20U);
  ASSERT_GE(krylov.size(), 5U);
  for (std::size_t k = 0; k < dense.size(); ++k) {
    const double exact = 2 * std::sin((static_cast<double>(k) + 1) * std::numbers::pi / (2 * (masses + 1)));
    EXPECT_NEAR(dense[k].lambda.imag(), exact, 1e-12);
    EXPECT_NEAR(dense[k].lambda.real(), 0, 1e-12);
    if (k < 5) {
      EXPECT_NEAR(krylov[k].lambda.imag(), exact, 1e-9);
      EXPECT_NEAR(spectral::mac(dense[k].shape, krylov[k].shape), 1, 1e-9);
      EXPECT_LE(spectral::mac(dense[k].shape, krylov[(k + 1) % 5].shape), 0.3);
    }
  }
}

// Ports of a chain that hold at every moment, z = (1 + k) q, and act back on it: their rows have no rates, and their
// eigenvalues are infinite. What is left is the chain with stiffer ends.
struct ConstrainedChain {
  int ports;
  double damping;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(2 + ports);
    f(0) = xdot(0) - x(1);
    f(1) = xdot(1) + damping * x(1) + x(0);
    for (int k = 0; k < ports; ++k) {
      f(1) += x(2 + k);
      f(2 + k) = x(2 + k) - (1.0 + k) * x(0);
    }
    return f;
  }
};

TEST(Modes, InfiniteEigenvaluesAreNone) {
  for (const double damping : {0.0, 0.1}) {
    test::SmallSystem s(MPI_COMM_WORLD, 5, 0, 1, ConstrainedChain{3, damping});
    const core::Vector x = s.vector(Eigen::VectorXd::Zero(5));
    spectral::EigenOptions o;
    o.rounding = true;
    const auto modes = spectral::modes(s, x.get(), o);
    ASSERT_EQ(modes.size(), 1U);
    EXPECT_NEAR(modes[0].lambda.real(), -0.5 * damping, 1e-12);
    EXPECT_NEAR(modes[0].lambda.imag(), std::sqrt(7 - 0.25 * damping * damping), 1e-12);  // 1 + 1 + 2 + 3
    // They say nothing of how exact the others are.
    EXPECT_LE(modes[0].rounding, 1e-11);
    EXPECT_EQ(modes[0].rounding > 0, damping == 0);
  }
}

// Nodes that decay at 100 to 1e8 1/s, as those of a film of gas, and weak ports that hold at every moment and act back
// on some of them, as its orifices: rounding makes their eigenvalues finite.
struct StiffWithPorts {
  static constexpr int nodes = 60, ports = 8;
  static double decay(int k) { return std::pow(10.0, 2 + 6.0 * k / (nodes - 1)); }
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T) const {
    Column<T> f(nodes + ports);
    for (int k = 0; k < nodes; ++k) f(k) = xdot(k) + decay(k) * x(k) + (k > 0 ? 0.3 * decay(k) * x(k - 1) : T(0));
    for (int k = 0; k < ports; ++k) {
      f(7 * k) += 1e7 * x(nodes + k);
      f(nodes + k) = 1e-6 * (x(nodes + k) - x(7 * k));
    }
    return f;
  }
};

TEST(Modes, OfWeakPortsAreNone) {
  test::SmallSystem s(MPI_COMM_WORLD, StiffWithPorts::nodes + StiffWithPorts::ports, 0, 1, StiffWithPorts{});
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(StiffWithPorts::nodes + StiffWithPorts::ports));
  const auto modes = spectral::modes(s, x.get(), {});
  ASSERT_EQ(modes.size(), static_cast<std::size_t>(StiffWithPorts::nodes));
  std::vector<double> wanted;
  for (int k = 0; k < StiffWithPorts::nodes; ++k)
    wanted.push_back(-StiffWithPorts::decay(k) - (k % 7 == 0 && k < 7 * StiffWithPorts::ports ? 1e7 : 0.0));
  std::sort(wanted.begin(), wanted.end());
  for (std::size_t k = 0; k < wanted.size(); ++k) EXPECT_NEAR(modes[k].lambda.real(), wanted[k], 1e-6 * 1e8);
}

// By LAPACK, and by Krylov-Schur, which has to ask three times until it has found one beyond the radius.
TEST(Modes, WithinARadiusNoneIsMissing) {
  for (const int masses : {20, 320}) {
    test::SmallSystem s(MPI_COMM_WORLD, 2 * masses, 0, 1, Chain{masses});
    const core::Vector x = s.vector(Eigen::VectorXd::Zero(2 * masses));
    core::Matrix a = s.make_jacobian(), b = s.make_jacobian();
    s.jacobian(0, x.get(), x.get(), 1, 0, a.get());
    s.jacobian(0, x.get(), x.get(), 0, 1, b.get());
    const auto exact = [&](int k) { return 2 * std::sin(k * std::numbers::pi / (2 * (masses + 1))); };
    const int pairs = 12;
    const double target = -0.01, radius = std::hypot(target, 0.5 * (exact(pairs) + exact(pairs + 1)));
    const auto found = spectral::modes_within(a.get(), b.get(), target, radius);
    ASSERT_EQ(found.size(), 2U * pairs) << masses;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(std::abs(found[k].lambda.imag()), exact(static_cast<int>(k) / 2 + 1), 1e-9);
      EXPECT_NEAR(found[k].lambda.real(), 0, 1e-9);
      double size = 0;
      for (const Complex& v : found[k].shape) size += std::norm(v);
      MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
      EXPECT_NEAR(size, 1, 1e-12);
      EXPECT_EQ(static_cast<PetscInt>(found[k].shape.size()), s.local_size());
    }
  }
}

TEST(Modes, ScalesDoNotMatterAndShapesAreInSi) {
  test::SmallSystem s(MPI_COMM_WORLD, 4, 0, 1, Chain{2, 0.1});
  s.set_scales(Eigen::Vector4d(1e-6, 1e-3, 2, 1e4), Eigen::Vector4d(1e3, 10, 1e-5, 1));
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(4));
  const auto modes = spectral::modes(s, x.get(), {});
  ASSERT_EQ(modes.size(), 2U);
  const double exact[] = {1, 3};  // omega^2
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(modes[k].lambda.real(), -0.05, 1e-10);
    EXPECT_NEAR(modes[k].lambda.imag(), std::sqrt(exact[k] - 0.0025), 1e-10);
    EXPECT_NEAR(std::abs(modes[k].shape[1] / modes[k].shape[0] - (k == 0 ? 1.0 : -1.0)), 0, 1e-9);
    EXPECT_NEAR(std::abs(modes[k].shape[2] / modes[k].shape[0] - modes[k].lambda), 0, 1e-9);
    EXPECT_NEAR(spectral::log_decrement(modes[k].lambda), 0.1 * std::numbers::pi / modes[k].lambda.imag(), 1e-9);
  }
}

TEST(Modes, SenseOfWhirlOfAGyroscope) {
  const double g = 0.8;
  test::SmallSystem s(MPI_COMM_WORLD, 4, g, 1, Gyroscope{});
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(4));
  for (const int dense_below : {600, 0}) {
    spectral::EigenOptions o;
    o.dense_below = dense_below;
    o.count = 2;
    const auto modes = spectral::modes(s, x.get(), o);
    const double backward = std::sqrt(1 + g * g / 4) - g / 2, forward = std::sqrt(1 + g * g / 4) + g / 2;
    ASSERT_GE(modes.size(), 1U);
    EXPECT_NEAR(modes[0].lambda.imag(), backward, 1e-9);
    EXPECT_EQ(spectral::sense_of_whirl({modes[0].shape[0]}, {modes[0].shape[1]}), Sense::backward);
    if (modes.size() < 2) continue;
    EXPECT_NEAR(modes[1].lambda.imag(), forward, 1e-9);
    EXPECT_EQ(spectral::sense_of_whirl({modes[1].shape[0]}, {modes[1].shape[1]}), Sense::forward);
  }
}

TEST(Modes, RealEigenvaluesAndCountOfUnconverged) {
  test::SmallSystem s(MPI_COMM_WORLD, 3, 0, 1, []<class T>(double, Column<T> x, Column<T> xdot, T) {
    Column<T> f(3);
    f << xdot(0) + 3.0 * x(0) - x(1), xdot(1) + 2.0 * x(1), xdot(2) - 0.5 * x(2);
    return f;
  });
  const core::Vector x = s.vector(Eigen::VectorXd::Zero(3));
  const auto modes = spectral::modes(s, x.get(), {});
  ASSERT_EQ(modes.size(), 3U);
  const double exact[] = {-3, -2, 0.5};
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(std::abs(modes[k].lambda - exact[k]), 0, 1e-13);
}

// A nilpotent shift of size 12 with a corner e has the twelfth roots of e: far from normal.
TEST(Eigenvalues, OfANonnormalMatrix) {
  const int n = 12;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k + 1 < n; ++k) a(k, k + 1) = 1;
  const double corner = 1e-6, radius = std::pow(corner, 1.0 / n);
  a(n - 1, 0) = corner;
  const auto values = spectral::eigenvalues(a);
  ASSERT_EQ(values.size(), 12U);
  std::vector<bool> seen(12, false);
  for (const Complex& v : values) {
    EXPECT_NEAR(std::abs(v), radius, 1e-8);
    const double k = std::arg(v) / (2 * std::numbers::pi) * n;
    EXPECT_NEAR(k, std::round(k), 1e-7);
    seen[static_cast<std::size_t>((std::lround(k) + n) % n)] = true;
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), true), 12);
}

// Ranks whose matrices differ in the last digits, so that a multiplier lies on this side of the circle or on that.
TEST(Eigenvalues, NearestVectorOfAPlaneRotation) {
  const double c = std::cos(0.3), s = std::sin(0.3);
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(3, 3);
  m.topLeftCorner(2, 2) << c, -s, s, c;
  m(2, 2) = 5;
  const auto pairs = spectral::eigenpairs(m);
  for (const double angle : {0.3, -0.3}) {
    const std::complex<double> value = std::polar(1.0, angle);
    const Eigen::VectorXcd v = pairs.nearest(value);
    EXPECT_NEAR(v.norm(), 1, 1e-14);
    EXPECT_LT((m.cast<std::complex<double>>() * v - value * v).norm(), 1e-14);
  }
  EXPECT_NEAR(std::abs(pairs.nearest(4)(2)), 1, 1e-14);
  m(0, 0) = NAN;
  EXPECT_THROW((void)spectral::eigenpairs(m), core::NotConverged);
}

TEST(Eigenvalues, AreThoseOfRankZero) {
  const int rank = core::rank_of(MPI_COMM_WORLD);
  for (const int n : {3, 20}) {
    Eigen::MatrixXd m = Eigen::MatrixXd::Identity(n, n) * 0.5;
    m(0, 0) = 1 + 1e-15 * rank;
    const auto values = spectral::eigenvalues(MPI_COMM_WORLD, m);
    ASSERT_EQ(values.size(), static_cast<std::size_t>(n));
    EXPECT_EQ(values[0], 1.0);
  }
}

TEST(Eigenvalues, SortedByFallingModulus) {
  Eigen::MatrixXd a(4, 4);
  a << -0.5, 30, 2, 1, 0, 0.1, 5, -7, 0, 0, 0, -2, 0, 0, 2, 0;  // -0.5, 0.1, +-2 i
  const auto values = spectral::eigenvalues(a);
  ASSERT_EQ(values.size(), 4U);
  EXPECT_NEAR(std::abs(std::abs(values[0].imag()) - 2), 0, 1e-13);
  EXPECT_NEAR(std::abs(values[0] - std::conj(values[1])), 0, 1e-13);
  EXPECT_NEAR(std::abs(values[2] + 0.5), 0, 1e-13);
  EXPECT_NEAR(std::abs(values[3] - 0.1), 0, 1e-13);
}

TEST(Words, ForModes) {
  const Complex i(0, 1);
  // x = cos, y = sin turns from x to y.
  EXPECT_EQ(spectral::sense_of_whirl({1, 2}, {-i, -2.0 * i}), Sense::forward);
  EXPECT_EQ(spectral::sense_of_whirl({1, 2}, {i, 2.0 * i}), Sense::backward);
  EXPECT_EQ(spectral::sense_of_whirl({1, 2}, {-i, 2.0 * i}), Sense::mixed);
  EXPECT_EQ(spectral::sense_of_whirl({1, 0.01}, {-i, 0.01 * i}), Sense::forward);  // a node that hardly moves
  // Half-axes 1 and 0.5 forward: f = 0.75, b = 0.25, so that (f^2 - b^2)/(f^2 + b^2) = 0.8.
  EXPECT_DOUBLE_EQ(spectral::whirl_energy({1}, {-0.5 * i}).whirl, 0.8);
  EXPECT_DOUBLE_EQ(spectral::whirl_energy({1}, {-0.5 * i}).forward, 0.8);
  EXPECT_TRUE(spectral::turns_backward({1, 2, i, 2.0 * i}));
  EXPECT_TRUE(spectral::turns_backward({1, 2, i, 2.00001 * i})) << "rounding";
  for (const std::vector<Complex>& shape :
       std::vector<std::vector<Complex>>{{1, 2, i, 2.01 * i}, {1, 2, -i, -2.0 * i}, {1, 2, i, -2.0 * i}, {1, 1}, {}})
    EXPECT_FALSE(spectral::turns_backward(shape));
  // A line at 45 degrees, and an orbit of half-axes 1 and 0.04: 2 a b/(a^2 + b^2) = 0.08.
  EXPECT_EQ(spectral::sense_of_whirl({1}, {1}), Sense::planar);
  EXPECT_EQ(spectral::sense_of_whirl({1}, {-0.04 * i}), Sense::planar);
  EXPECT_EQ(spectral::sense_of_whirl({1}, {-0.06 * i}), Sense::forward);
  // Energy 1 forward and 4 backward; the heavy node decides: 50 forward and 4 backward.
  EXPECT_DOUBLE_EQ(spectral::whirl_energy({1, 2}, {-i, 2.0 * i}).forward, -0.6);
  EXPECT_EQ(spectral::sense_of_whirl({1, 2}, {-i, 2.0 * i}, {50, 1}), Sense::forward);
  EXPECT_DOUBLE_EQ(spectral::log_decrement({-0.3, 2}), 0.3 * std::numbers::pi);
  EXPECT_DOUBLE_EQ(spectral::log_decrement({-0.3, -2}), 0.3 * std::numbers::pi);
  EXPECT_EQ(spectral::log_decrement({-1, 0}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(spectral::log_decrement({1, 0}), -std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(spectral::stability_factor({0, 2}), 1);
  EXPECT_DOUBLE_EQ(spectral::mac({1, i}, {2.0 * i, -2}), 1);
  EXPECT_DOUBLE_EQ(spectral::mac({1, i}, {1, -i}), 0);
  EXPECT_DOUBLE_EQ(spectral::mac({1, 0}, {1, 1}), 0.5);
  EXPECT_STREQ(spectral::name_of(Sense::backward), "backward");
}

// Two masses that move alike in x and in y: some combinations of both motions are circles, whatever two are given.
TEST(Words, ForEqualModes) {
  const Complex i(0, 1);
  using Shape = std::vector<Complex>;
  const std::vector<double> mass{2, 1};
  const auto turns_of = [&](const Shape& a, const Shape& b) {
    std::vector<double> turns;
    const auto extremes = spectral::extremes_of_whirl(a, b, mass);
    for (std::size_t k = 0; extremes && k < 2; ++k) {
      Shape x, y;
      for (std::size_t n = 0; n < 4; ++n)
        (n < 2 ? x : y).push_back((*extremes)[k][0] * a[n] + (*extremes)[k][1] * b[n]);
      turns.push_back(spectral::whirl_energy(x, y, mass).forward);
    }
    return turns;
  };
  const auto expect_turns = [&](const Shape& a, const Shape& b, double backward, double forward) {
    const std::vector<double> turns = turns_of(a, b);
    ASSERT_EQ(turns.size(), 2U);
    EXPECT_NEAR(turns[0], backward, 1e-12);
    EXPECT_NEAR(turns[1], forward, 1e-12);
  };
  expect_turns({1, 2, 0, 0}, {0, 0, 1, 2}, -1, 1);                                // lines in x and in y
  expect_turns({1, 2, 0.3 - i, 0.6 - 2.0 * i}, {0.1 * i, 0.2 * i, 1, 2}, -1, 1);  // any two
  expect_turns({1, 2, -i, -2.0 * i}, {1, -1, -i, i}, 1, 1);                       // two forward circles
  expect_turns({1, 0, -0.5 * i, 0}, {0, 1, 0, -0.5 * i}, 0.8, 0.8);               // two ellipses
  EXPECT_TRUE(turns_of({1, 2, -i, -2.0 * i}, {2.0 * i, 4.0 * i, 2, 4}).empty());  // one and the same
}

// Equal eigenvalues lie within the blur of each other, others do not.
TEST(Modes, BlurTellsEqualFromNear) {
  const int masses = 10;
  for (const double apart : {0.0, 1e-9, 1e-7}) {
    test::SmallSystem s(MPI_COMM_WORLD, 4 * masses, 0, 1,
                        [&]<class T>(double t, const Column<T>& x, const Column<T>& xdot, T p) {
                          const int n = 2 * masses;
                          Column<T> f(2 * n);
                          f << Chain{masses, 0.1}(t, Column<T>(x.head(n)), Column<T>(xdot.head(n)), p),
                              Chain{masses, 0.1, 1 + apart}(t, Column<T>(x.tail(n)), Column<T>(xdot.tail(n)), p);
                          return f;
                        });
    const core::Vector x = s.vector(Eigen::VectorXd::Zero(4 * masses));
    spectral::EigenOptions o;
    o.rounding = true;
    const auto modes = spectral::modes(s, x.get(), o);
    ASSERT_EQ(modes.size(), 2U * masses);
    for (std::size_t k = 0; k < modes.size(); k += 2) {
      const double distance = std::abs(modes[k + 1].lambda - modes[k].lambda),
                   blur = std::max(modes[k].blur, modes[k + 1].blur);
      EXPECT_EQ(distance <= blur, apart == 0) << modes[k].lambda << " " << distance << " " << blur;
      EXPECT_GT(blur, 0);
      EXPECT_LE(blur, 1e-10);
    }
  }
}

// Rounding moves the eigenvalues of an undamped chain off the axis by less than its estimate, and that by no more than
// a millionth of a damping that counts. A real part of less than 1e-12 of the eigenvalue is rounding, whatever its
// sign.
TEST(Modes, RoundingIsToldFromDamping) {
  const int masses = 20;
  for (const double damping : {0.0, 1e-13, -1e-13, 1e-9}) {
    test::SmallSystem s(MPI_COMM_WORLD, 2 * masses, 0, 1, Chain{masses, damping});
    const core::Vector x = s.vector(Eigen::VectorXd::Zero(2 * masses));
    spectral::EigenOptions o;
    o.rounding = true;
    const auto modes = spectral::modes(s, x.get(), o);
    ASSERT_EQ(modes.size(), 20U);
    for (const auto& m : modes) {
      EXPECT_EQ(m.neutral(), std::abs(damping) < 1e-12) << m.lambda << " " << m.rounding;
      EXPECT_LE(m.rounding, 1e-11);
      if (damping > 0) {
        EXPECT_NEAR(m.lambda.real(), -damping / 2, m.rounding);
      }
    }
  }
  // A free mass has a double eigenvalue zero with one vector, which rounding splits by its square root.
  test::SmallSystem free(MPI_COMM_WORLD, 4, 0, 1, []<class T>(double, const Column<T>& x, const Column<T>& xdot, T) {
    Column<T> f(4);
    f << xdot(0) - x(1), xdot(1) + 1e-17 * x(0), xdot(2) - x(3), xdot(3) + x(2) + 0.1 * x(3);
    return f;
  });
  const core::Vector x = free.vector(Eigen::VectorXd::Zero(4));
  spectral::EigenOptions o;
  o.rounding = true;
  int neutral = 0;
  for (const auto& m : spectral::modes(free, x.get(), o)) {
    neutral += m.neutral();
    EXPECT_EQ(m.neutral(), std::abs(m.lambda) < 1e-7);
  }
  EXPECT_GE(neutral, 1);
}
