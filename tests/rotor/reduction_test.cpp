// Guyan and Craig-Bampton: exact where they must be, convergent elsewhere, the same on every rank count.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>

#include "rotor/shafts.hpp"
#include "support/dense.hpp"
#include "support/turbine_train.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/rotor.hpp"

using namespace whirl;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Type = rotor::Reduction::Type;

namespace {

constexpr std::array translations{rotor::Freedom::x, rotor::Freedom::y};

rotor::Options reduced(rotor::Options o, Type type, std::vector<int> masters, int modes = 0) {
  o.reduction = {type, std::move(masters), modes};
  return o;
}

// Lowest frequencies in both planes of K + bearing springs against M.
VectorXd frequencies(const rotor::Options& o, const std::vector<test::IsotropicBearing>& bearings, Index count) {
  const rotor::Rotor r(MPI_COMM_WORLD, o);
  MatrixXd k = test::dense(r.matrices().stiffness.get());
  for (const auto& b : bearings)
    for (const auto d : translations) k(r.coordinate(b.node, d), r.coordinate(b.node, d)) += b.stiffness;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(k, test::dense(r.matrices().mass.get()));
  return solver.eigenvalues().head(count).cwiseMax(0).cwiseSqrt();
}

const std::vector<test::IsotropicBearing> train_bearings{{6, 2e8}, {49, 5e8}, {93, 1e9}, {160, 8e8}, {181, 2e8}};

}  // namespace

TEST(Reduction, CoordinatesAreThePairsOfTheMastersInOrder) {
  const rotor::Rotor r(MPI_COMM_WORLD, reduced(test::stepped_shaft(), Type::craig_bampton, {9, 2, 12}, 2));
  EXPECT_EQ(r.size(), 2 * (3 + 2));
  EXPECT_EQ(r.coordinate(2, rotor::Freedom::x), 0);
  EXPECT_EQ(r.coordinate(9, rotor::Freedom::y), 3);
  EXPECT_EQ(r.coordinate(12, rotor::Freedom::x), 4);
  EXPECT_EQ(r.coordinate(9, rotor::Freedom::slope_x), -1);
  EXPECT_EQ(r.coordinate(5, rotor::Freedom::x), -1);
  const MatrixXd t = test::dense(r.matrices().basis.get());
  ASSERT_EQ(t.rows(), 52);
  ASSERT_EQ(t.cols(), 10);
  for (int node : {2, 9, 12})
    for (const auto d : translations) {
      VectorXd unit = VectorXd::Zero(10);
      unit(r.coordinate(node, d)) = 1;
      EXPECT_EQ((t.row(rotor::full_coordinate(node, d)).transpose() - unit).norm(), 0);
    }
}

// Slopes that are kept follow the translations of their node; T gives them back as they are, and under gravity the
// exact shape has none of what slaves lose.
TEST(Reduction, SlopesOfSomeMastersAreKept) {
  for (const Type type : {Type::guyan, Type::craig_bampton}) {
    rotor::Options o = reduced(test::stepped_shaft(), type, {9, 2, 12}, type == Type::guyan ? 0 : 2);
    o.reduction.slopes = {12, 2};
    const rotor::Rotor r(MPI_COMM_WORLD, o);
    const int masters = 2 * (3 + 2);
    EXPECT_EQ(r.size(), masters + 2 * o.reduction.modes);
    using enum rotor::Freedom;
    EXPECT_EQ(r.coordinate(2, x), 0);
    EXPECT_EQ(r.coordinate(2, slope_y), 3);
    EXPECT_EQ(r.coordinate(9, y), 5);
    EXPECT_EQ(r.coordinate(9, slope_y), -1);
    EXPECT_EQ(r.coordinate(12, slope_x), 8);
    const MatrixXd t = test::dense(r.matrices().basis.get());
    const VectorXd offset = test::dense(r.matrices().offset.get());
    for (const int node : {2, 12})
      for (const auto d : {x, y, slope_x, slope_y}) {
        const PetscInt at = r.coordinate(node, d);
        ASSERT_EQ(r.freedom(at), d);
        VectorXd unit = VectorXd::Zero(r.size());
        unit(at) = 1;
        EXPECT_EQ((t.row(rotor::full_coordinate(node, d)).transpose() - unit).norm(), 0);
        EXPECT_EQ(offset(rotor::full_coordinate(node, d)), 0);
      }
    EXPECT_GT(offset.norm(), 0);
    if (o.reduction.modes > 0) {
      EXPECT_FALSE(r.freedom(masters).has_value());
    }
  }
  rotor::Options wrong = reduced(test::stepped_shaft(), Type::guyan, {2, 12}, 0);
  wrong.reduction.slopes = {9};
  EXPECT_THROW(rotor::Rotor(MPI_COMM_WORLD, wrong), core::InputError);
}

TEST(Reduction, MatricesAreTheProjectionsOfTheFullOnes) {
  const rotor::Options o = test::stepped_shaft();
  const rotor::Rotor full(MPI_COMM_WORLD, o), small(MPI_COMM_WORLD, reduced(o, Type::craig_bampton, {2, 9, 12}, 3));
  const MatrixXd t = test::dense(small.matrices().basis.get());
  const auto expect_projected = [&](Mat a, Mat b) {
    const MatrixXd wanted = t.transpose() * test::dense(a) * t;
    EXPECT_LE((test::dense(b) - wanted).norm(), 1e-12 * wanted.norm());
  };
  expect_projected(full.matrices().mass.get(), small.matrices().mass.get());
  expect_projected(full.matrices().gyroscopic.get(), small.matrices().gyroscopic.get());
  expect_projected(full.matrices().damping.get(), small.matrices().damping.get());
  const VectorXd wanted = t.transpose() * test::dense(full.matrices().gravity.get());
  EXPECT_LE((test::dense(small.matrices().gravity.get()) - wanted).norm(), 1e-12 * wanted.norm());
}

TEST(Reduction, StiffnessOfMastersAndModesIsBlockDiagonal) {
  const rotor::Rotor r(MPI_COMM_WORLD, reduced(test::stepped_shaft(), Type::craig_bampton, {2, 9, 12}, 3));
  const MatrixXd k = test::dense(r.matrices().stiffness.get()), m = test::dense(r.matrices().mass.get());
  const MatrixXd modal = k.bottomRightCorner(6, 6), mass = m.bottomRightCorner(6, 6);
  EXPECT_LE(k.topRightCorner(6, 6).norm(), 1e-8 * modal.norm());
  EXPECT_LE((mass - MatrixXd::Identity(6, 6)).norm(), 1e-10);
  EXPECT_LE((modal - MatrixXd(modal.diagonal().asDiagonal())).norm(), 1e-8 * modal.norm());
  EXPECT_NEAR(std::sqrt(modal(5, 5)) / r.quality().retained, 1, 1e-8);
  EXPECT_NEAR(modal(4, 4) / modal(5, 5), 1, 1e-12);  // one mode in x, the same in y
  EXPECT_GT(r.quality().neglected, r.quality().retained);
}

TEST(Reduction, StaticShapeUnderGravityIsExact) {
  const std::vector<test::IsotropicBearing> bearings{{2, 2e7}, {12, 3e7}};
  const rotor::Options o = test::stepped_shaft();
  const auto sag = [&](const rotor::Rotor& r) {
    MatrixXd k = test::dense(r.matrices().stiffness.get());
    for (const auto& b : bearings)
      for (const auto d : translations) k(r.coordinate(b.node, d), r.coordinate(b.node, d)) += b.stiffness;
    return VectorXd(k.partialPivLu().solve(9.81 * test::dense(r.matrices().gravity.get())));
  };
  const VectorXd exact = sag(rotor::Rotor(MPI_COMM_WORLD, o));
  for (int modes : {-1, 0, 2, 6}) {
    const rotor::Rotor small(MPI_COMM_WORLD,
                             reduced(o, modes < 0 ? Type::guyan : Type::craig_bampton, {2, 6, 12}, std::max(modes, 0)));
    const VectorXd found =
        test::dense(small.matrices().basis.get()) * sag(small) + 9.81 * test::dense(small.matrices().offset.get());
    EXPECT_LE((found - exact).norm(), 1e-8 * exact.norm()) << modes;
  }
}

TEST(Reduction, GuyanKeepsTheLowFrequenciesOfTheTrainFromAbove) {
  const rotor::Options o = test::train_rotor();
  const VectorXd full = frequencies(o, train_bearings, 12);
  const VectorXd guyan = frequencies(reduced(o, Type::guyan, test::train_masters()), train_bearings, 12);
  for (Index i = 0; i < 12; ++i) {
    EXPECT_GE(guyan(i) / full(i), 1 - 1e-9) << i;  // Rayleigh-Ritz
    EXPECT_LE(guyan(i) / full(i), 1 + 1e-2) << i;
  }
  const rotor::Rotor r(MPI_COMM_WORLD, reduced(o, Type::guyan, test::train_masters()));
  EXPECT_EQ(r.size(), 42);
  EXPECT_EQ(r.quality().retained, 0);
  for (Index i = 0; i < 12; ++i) EXPECT_LE(guyan(i) / full(i) - 1, std::pow(full(i) / r.quality().neglected, 2));
}

TEST(Reduction, CraigBamptonConvergesToTheFullModel) {
  const rotor::Options o = test::train_rotor();
  const VectorXd full = frequencies(o, train_bearings, 8);
  const std::vector<int> journals{6, 49, 93, 160, 181};
  double last = 1;
  for (int modes : {4, 8, 16, 32}) {
    const rotor::Options small = reduced(o, Type::craig_bampton, journals, modes);
    const Eigen::ArrayXd error = frequencies(small, train_bearings, 8).array() / full.head(8).array() - 1;
    EXPECT_GE(error.minCoeff(), -1e-9) << modes;  // Rayleigh-Ritz
    EXPECT_LT(error.maxCoeff(), last / 4) << modes;
    last = error.maxCoeff();
    const rotor::Rotor r(MPI_COMM_WORLD, small);
    EXPECT_TRUE((error <= (full.head(8).array() / r.quality().neglected).square()).all()) << modes;
  }
  EXPECT_LT(last, 5e-6);
  // All fixed-interface modes together span everything.
  const rotor::Options stepped = test::stepped_shaft();
  const std::vector<test::IsotropicBearing> bearings{{2, 2e7}, {12, 3e7}};
  const VectorXd exact = frequencies(stepped, bearings, 20);
  const VectorXd found = frequencies(reduced(stepped, Type::craig_bampton, {2, 12}, 24), bearings, 20);
  EXPECT_LE((found.array() / exact.array() - 1).abs().maxCoeff(), 1e-8);
  const rotor::Rotor complete(MPI_COMM_WORLD, reduced(stepped, Type::craig_bampton, {2, 12}, 24));
  EXPECT_TRUE(std::isinf(complete.quality().neglected));
}

TEST(Reduction, EveryRankCountGivesTheSerialCoordinates) {
  for (const rotor::Options& o : {reduced(test::stepped_shaft(), Type::craig_bampton, {2, 9, 12}, 4),
                                  reduced(test::uniform_shaft(1, 0.05, 8), Type::craig_bampton, {1, 9}, 4),
                                  reduced(test::train_rotor(), Type::guyan, test::train_masters())}) {
    const rotor::Rotor all(MPI_COMM_WORLD, o), alone(MPI_COMM_SELF, o);
    const auto expect_same = [](const MatrixXd& a, const MatrixXd& b, double tolerance) {
      EXPECT_LE((a - b).norm(), tolerance * b.norm());
    };
    expect_same(test::dense(all.matrices().basis.get()), test::dense(alone.matrices().basis.get()), 1e-9);
    expect_same(test::dense(all.matrices().mass.get()), test::dense(alone.matrices().mass.get()), 1e-9);
    expect_same(test::dense(all.matrices().stiffness.get()), test::dense(alone.matrices().stiffness.get()), 1e-9);
    expect_same(test::dense(all.matrices().gyroscopic.get()), test::dense(alone.matrices().gyroscopic.get()), 1e-9);
    expect_same(test::dense(all.matrices().gravity.get()), test::dense(alone.matrices().gravity.get()), 1e-9);
  }
}
