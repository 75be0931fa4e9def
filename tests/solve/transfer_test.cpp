// Parts as transfer functions against dense Schur complements, and the eigenvalues of machines from them.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "solve/newton/rational_fit.hpp"
#include "solve/newton/transfer_modes.hpp"
#include "support/small_system.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"
#include "whirl/spectral/eigenvalues.hpp"

using namespace whirl;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;
using test::Column;
using test::Complex;

namespace {

constexpr int n_hub = 3, n_first = 4, n_second = 5, n = n_hub + n_first + n_second;

int part_of(int k) {
  return k < n_hub ? 0 : k < n_hub + n_first ? 1 : 2;
}

// A x + B dx/dt with a hub that both parts see, with the rates too.
struct Pencil {
  MatrixXd a = MatrixXd::Zero(n, n), b = MatrixXd::Zero(n, n);
  Pencil() {
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        if (part_of(i) != part_of(j) && part_of(i) * part_of(j) != 0) continue;
        a(i, j) = std::sin(1.7 * i + 0.9 * j + 0.3 * i * j) + (i == j ? 3 : 0);
        b(i, j) = 0.3 * std::cos(0.7 * i + 1.1 * j * j) + (i == j ? 1 : 0);
      }
  }
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T) const {
    return a.cast<T>() * x + b.cast<T>() * xdot;
  }
};

class Parts : public test::SmallSystem {
public:
  explicit Parts(const Pencil& p, MPI_Comm comm = MPI_COMM_WORLD) : SmallSystem(comm, n, 0, 1, p) {
    VectorXd state(n), rows(n);
    for (int i = 0; i < n; ++i) {
      state(i) = 1 + 0.1 * i;
      rows(i) = 2 - 0.1 * i;
    }
    set_scales(state, rows);
  }
  [[nodiscard]] std::vector<problem::Field> fields() const override {
    PetscInt begin = 0;
    core::check(VecGetOwnershipRange(vector(VectorXd::Zero(n)).get(), &begin, nullptr));
    std::vector<problem::Field> out;
    const auto add = [&](const char* name, PetscInt from, PetscInt to) {
      out.push_back({.name = name,
                     .begin = std::clamp<PetscInt>(from - begin, 0, local_size()),
                     .end = std::clamp<PetscInt>(to - begin, 0, local_size()),
                     .part = static_cast<int>(out.size())});
    };
    add("hub", 0, n_hub);
    add("one", n_hub, n_hub + n_first);
    add("two", n_hub + n_first, n);
    return out;
  }
  [[nodiscard]] MatrixXcd scaled(const Pencil& p, Complex lambda) const {
    return residual_scale_.cwiseInverse().asDiagonal() * (p.a + lambda * p.b) * state_scale_.asDiagonal();
  }
};

MatrixXcd schur(const MatrixXcd& m) {
  const int rest = n - n_hub;
  return m.topLeftCorner(n_hub, n_hub) -
         m.topRightCorner(n_hub, rest) * m.bottomRightCorner(rest, rest).lu().solve(m.bottomLeftCorner(rest, n_hub));
}

MatrixXcd hub_matrix(solve::FrequencyResolvent& t, Complex lambda, bool slope) {
  return MatrixXcd(t.matrix(lambda, t.evaluate(lambda, slope), slope));
}

}  // namespace

TEST(FrequencyResolvent, IsTheDenseSchurComplement) {
  const Pencil p;
  Parts system(p);
  solve::FrequencyResolvent transfer(system);
  const core::Vector x = system.vector(VectorXd::Zero(n));
  transfer.linearise(x.get());
  EXPECT_EQ(transfer.hub(), n_hub);
  ASSERT_EQ(transfer.ports().size(), 2U);
  EXPECT_EQ(transfer.ports()[1].name, "two");
  for (const Complex lambda : {Complex(0, 0.8), Complex(-0.3, 2), Complex(1.5, 0)}) {
    const MatrixXcd whole = system.scaled(p, lambda), expected = schur(whole);
    EXPECT_LT((hub_matrix(transfer, lambda, false) - expected).norm(), 1e-12 * expected.norm());
    const auto blocks = transfer.evaluate(lambda, false);
    const MatrixXcd second =
        whole.topRightCorner(n_hub, n_second) *
        whole.bottomRightCorner(n_second, n_second).lu().solve(whole.bottomLeftCorner(n_second, n_hub));
    EXPECT_LT((blocks[1].value - second).norm(), 1e-12 * second.norm());
    EXPECT_EQ(blocks[1].slope.size(), 0);
    // A motion of the hub moves the parts so that their rows vanish.
    const VectorXcd z = VectorXcd::LinSpaced(n_hub, Complex(1, 0.3), Complex(-0.4, 2));
    const auto state = transfer.state(z);
    const VectorXcd rows = whole * Eigen::Map<const VectorXcd>(state.data(), n);
    EXPECT_LT(rows.tail(n - n_hub).norm(), 1e-12 * whole.norm());
    EXPECT_LT((rows.head(n_hub) - expected * z).norm(), 1e-12 * whole.norm());
  }
}

// With loads on hub and parts, and with a border through all of them; its conjugate transpose likewise.
TEST(FrequencyResolvent, SolvesWithBordersAndAdjoints) {
  const Pencil p;
  Parts system(p);
  solve::FrequencyResolvent resolvent(system);
  resolvent.linearise(system.vector(VectorXd::Zero(n)).get());
  const Complex lambda(-0.3, 1.2);
  const VectorXcd b = VectorXcd::LinSpaced(n, Complex(1, -1), Complex(-2, 0.4)),
                  c = VectorXcd::LinSpaced(n, Complex(0.3, 2), Complex(1, -1));
  for (const int border : {0, 1}) {
    MatrixXcd a = MatrixXcd::Zero(n + border, n + border);
    a.topLeftCorner(n, n) = system.scaled(p, lambda);
    if (border > 0) {
      a.topRightCorner(n, 1) = b;
      a.bottomLeftCorner(1, n) = c.adjoint();
      resolvent.factorise(lambda, b, c);
    } else {
      resolvent.factorise(lambda);
    }
    const VectorXcd r = VectorXcd::LinSpaced(n + border, Complex(2, 0.1), Complex(-1, 1));
    EXPECT_LT((a * resolvent.solve(r) - r).norm(), 1e-12 * r.norm()) << border;
    EXPECT_LT((a.adjoint() * resolvent.solve_adjoint(r) - r).norm(), 1e-12 * r.norm()) << border;
  }
  const VectorXcd rates = system.scaled(p, 1) * c - system.scaled(p, 0) * c;
  EXPECT_LT((resolvent.rates_times(c) - rates).norm(), 1e-12 * rates.norm());
}

// Functions with three pairs of poles in common are found exactly, and so is their derivative.
TEST(RationalFit, FindsARationalFunction) {
  const std::array<Complex, 3> pole{Complex(-0.3, 1), Complex(-1, 0.4), Complex(-0.1, 2.2)};
  constexpr int entries = 20;  // more than enter the choice of weights
  const auto f = [&](Complex z, bool slope) {
    VectorXcd out(entries);
    for (int e = 0; e < entries; ++e) {
      out(e) = slope ? 0.1 : 0.5 * e + 0.1 * z;
      for (std::size_t k = 0; k < pole.size(); ++k)
        for (const bool conjugate : {false, true}) {
          const Complex p = conjugate ? std::conj(pole[k]) : pole[k],
                        r(std::sin(e + 2.0 * static_cast<double>(k)), 0.3 * e);
          out(e) += (conjugate ? std::conj(r) : r) / (z - p) * (slope ? -1.0 / (z - p) : Complex(1));
        }
    }
    return out;
  };
  std::vector<Complex> points;
  MatrixXcd values(entries, 17);
  for (int k = 0; k < 17; ++k) {
    points.push_back(std::polar(3.0, 3.14159265358979 * k / 16));
    if (k == 0 || k == 16) points.back() = points.back().real();
    values.col(k) = f(points.back(), false);
  }
  const solve::RationalFit fit(points, values, 1e-12);
  EXPECT_NEAR(fit.magnitude(), values.colwise().norm().maxCoeff(), 1e-12);
  for (const Complex z : {Complex(0.3, 0.7), Complex(2, -1), Complex(-0.5, 0), points[3]}) {
    EXPECT_LT((fit.value(z) - f(z, false)).norm(), 1e-9 * f(z, false).norm()) << z;
    EXPECT_LT((fit.slope(z) - f(z, true)).norm(), 1e-6 * f(z, true).norm()) << z;
  }
}

// |T(lambda + d) - T(lambda) - d T'(lambda)| falls with d^2.
TEST(FrequencyResolvent, HasTheDerivativeOfT) {
  const Pencil p;
  Parts system(p);
  solve::FrequencyResolvent transfer(system);
  transfer.linearise(system.vector(VectorXd::Zero(n)).get());
  const Complex lambda(0.2, 1.1);
  const MatrixXcd slope = hub_matrix(transfer, lambda, true);
  const MatrixXcd here = hub_matrix(transfer, lambda, false);
  double last = 0;
  for (const double size : {1e-2, 1e-3, 1e-4}) {
    const Complex d = size * Complex(0.6, -0.8);
    const double rest = (hub_matrix(transfer, lambda + d, false) - here - d * slope).norm();
    EXPECT_GT(rest, 1e-13);
    if (last > 0) {
      EXPECT_NEAR(std::log10(last / rest), 2, 0.05);
    }
    last = rest;
  }
}

TEST(FrequencyResolvent, KnowsTheEigenvaluesOfItsParts) {
  const Pencil p;
  Parts system(p);
  solve::FrequencyResolvent transfer(system);
  transfer.linearise(system.vector(VectorXd::Zero(n)).get());
  int count = 0;
  for (std::size_t i = 0; i < 2; ++i)
    for (const auto& pole : transfer.poles(i, -1, 4)) {
      const MatrixXcd m = system.scaled(p, pole.value);
      const int first = i == 0 ? n_hub : n_hub + n_first, size = i == 0 ? n_first : n_second;
      EXPECT_LT(std::abs(m.block(first, first, size, size).determinant()), 1e-10);
      EXPECT_FALSE(pole.silent);
      ++count;
    }
  EXPECT_GT(count, 4);
}

namespace {

std::vector<Complex> inside(const std::vector<spectral::Mode>& modes, const solve::TransferOptions& o) {
  std::vector<Complex> out;
  const double centre = (o.frequency - o.decay) / 2, along = (o.frequency + o.decay) / 2;
  for (const auto& m : modes)
    if (std::hypot((m.lambda.real() - centre) / along, m.lambda.imag() / o.frequency) < 1) out.push_back(m.lambda);
  return out;
}

}  // namespace

TEST(TransferModes, AreThoseOfTheWholePencil) {
  const Pencil p;
  Parts system(p);
  const core::Vector x = system.vector(VectorXd::Zero(n));
  const auto whole = spectral::modes(system, x.get(), {});
  solve::TransferOptions o;
  o.frequency = 4;
  for (const double decay : {2.5, 5.0, 9.0}) {
    o.decay = decay;
    const auto expected = inside(whole, o);
    const auto found = solve::transfer_modes(system, x.get(), o);
    EXPECT_EQ(found.doubt, "");
    EXPECT_EQ(found.missed, 0) << decay;
    ASSERT_EQ(found.modes.size(), expected.size()) << decay;
    int number = 0;
    for (std::size_t k = 0; k < expected.size(); ++k) {
      EXPECT_LT(std::abs(found.modes[k].lambda - expected[k]), 1e-11) << decay;
      number += expected[k].imag() != 0 ? 2 : 1;
      const MatrixXcd m = p.a + found.modes[k].lambda * p.b;
      const VectorXcd v = Eigen::Map<const VectorXcd>(found.modes[k].shape.data(), n);
      EXPECT_LT((m * v).norm(), 1e-10 * v.norm());
    }
    EXPECT_EQ(found.counted, number);
  }
}

// A part that no port sees has eigenvalues of its own.
TEST(TransferModes, HoldThoseOfAPartThatExertsNoForce) {
  Pencil p;
  p.a.topRightCorner(n_hub, n_second).setZero();
  p.b.topRightCorner(n_hub, n_second).setZero();
  Parts system(p);
  const core::Vector x = system.vector(VectorXd::Zero(n));
  solve::TransferOptions o;
  o.frequency = 4;
  o.decay = 9;
  const auto expected = inside(spectral::modes(system, x.get(), {}), o);
  const auto found = solve::transfer_modes(system, x.get(), o);
  EXPECT_EQ(found.missed, 0);
  ASSERT_EQ(found.modes.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_LT(std::abs(found.modes[k].lambda - expected[k]), 1e-10);
}

// The edge passes between an eigenvalue of a part and that of the machine beside it: det T turns a whole time within so
// small a piece of the edge that it seems not to turn at all.
TEST(TransferModes, AreCountedWhereTheEdgePartsAPoleFromAZero) {
  Pencil p;
  constexpr int at = n_hub + n_first, weak = 2;  // two states of the second part, weakly coupled to the hub alone
  for (int k = at; k < at + weak; ++k) {
    p.a.row(k).setZero();
    p.a.col(k).setZero();
    p.b.row(k).setZero();
    p.b.col(k).setZero();
    p.a(0, k) = p.a(k, 1) = 0.02;
    p.a(k, k) = p.b(k, k) = 1;
  }
  p.a(at, at + 1) = -2;
  p.a(at + 1, at) = 2;
  Parts system(p);
  const core::Vector x = system.vector(VectorXd::Zero(n));
  const auto whole = spectral::modes(system, x.get(), {});
  const Complex pole = Complex(-1, 2);
  const Complex zero = std::min_element(whole.begin(), whole.end(), [&](const auto& a, const auto& b) {
                         return std::abs(a.lambda - pole) < std::abs(b.lambda - pole);
                       })->lambda;
  ASSERT_GT(std::abs(zero - pole), 1e-7);
  ASSERT_LT(std::abs(zero - pole), 1e-3);
  solve::TransferOptions o;
  o.frequency = 4;
  const auto level = [&](Complex z) {
    return std::hypot((z.real() - (o.frequency - o.decay) / 2) / ((o.frequency + o.decay) / 2), z.imag() / o.frequency);
  };
  double least = 1, most = 10;  // decays of regions without and with the place between them
  while (most - least > 1e-14) {
    o.decay = 0.5 * (least + most);
    (level(0.5 * (zero + pole)) < 1 ? most : least) = o.decay;
  }
  ASSERT_NE(level(zero) < 1, level(pole) < 1);
  int number = 0;
  for (const Complex z : inside(whole, o)) number += z.imag() != 0 ? 2 : 1;
  const auto found = solve::transfer_modes(system, x.get(), o);
  EXPECT_EQ(found.doubt, "");
  EXPECT_EQ(found.counted, number);
  EXPECT_EQ(found.missed, 0);
}

// Few points on the contour give too few candidates. The count, which needs no candidates, tells.
TEST(TransferModes, SayWhatTheyMiss) {
  const Pencil p;
  Parts system(p);
  const core::Vector x = system.vector(VectorXd::Zero(n));
  solve::TransferOptions o;
  o.frequency = 4;
  o.decay = 9;
  const auto all = solve::transfer_modes(system, x.get(), o);
  o.contour = 1;
  o.levels = 0;
  const auto some = solve::transfer_modes(system, x.get(), o);
  EXPECT_EQ(some.counted, all.counted);
  EXPECT_GT(some.missed, 0);
  int found = 0;
  for (const auto& m : some.modes) found += m.lambda.imag() != 0 ? 2 : 1;
  EXPECT_EQ(some.missed, some.counted - found);
}
