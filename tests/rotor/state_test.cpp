// Craig-Bampton in state space: exact where it must be, the errors of the trial rotor, the same on every rank count.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "rotor/shafts.hpp"
#include "source_dir.hpp"
#include "support/dense.hpp"
#include "whirl/core/error.hpp"
#include "whirl/rotor/modal_coupling.hpp"
#include "whirl/rotor/rotor.hpp"

using namespace whirl;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double spring = 1e7, speed = 1e4;  // N/m, rad/s

rotor::Options disc_rotor() {
  rotor::Options o = test::uniform_shaft(0.3, 0.015, 20, 2.05e11, 7860);
  rotor::Disc d;
  d.node = 7;
  d.mass = 0.5;
  d.diametral_inertia = 7.81e-5;
  d.polar_inertia = 1.56e-4;
  o.discs = {d};
  return o;
}

rotor::Options reduced(rotor::Options o, int modes, double at = speed) {
  o.reduction = {.type = rotor::Reduction::Type::craig_bampton_state, .masters = {1, 21}, .modes = modes, .speed = at};
  return o;
}

MatrixXd whole_matrix(const rotor::Rotor& r, double omega, double stiffness) {
  const auto& s = *r.states();
  MatrixXd p = test::dense(s.at_rest.get()) + omega * test::dense(s.turning.get());
  for (const int node : {1, 21})
    for (const auto d : {rotor::Freedom::x, rotor::Freedom::y}) {
      const Index at = 2 * r.coordinate(node, d);
      p(at, at) += stiffness;
    }
  return p;
}

// Eigenvalues of N u' + P u = 0, by their moduli.
Eigen::VectorXcd eigenvalues(const rotor::Rotor& r, double omega, double stiffness) {
  const MatrixXd a = test::dense(r.states()->rates.get()).partialPivLu().solve(whole_matrix(r, omega, stiffness));
  Eigen::VectorXcd s = -a.eigenvalues();
  std::sort(s.begin(), s.end(), [](auto x, auto y) { return std::abs(x) < std::abs(y); });
  return s;
}

// On springs by their inverses, of which the slowest are the largest and keep their digits.
std::vector<double> frequencies(const rotor::Options& o, std::size_t count) {
  std::vector<double> out;
  const rotor::Rotor r(MPI_COMM_WORLD, o);
  const MatrixXd a = whole_matrix(r, speed, spring).partialPivLu().solve(test::dense(r.states()->rates.get()));
  for (const std::complex<double> inverse : a.eigenvalues())
    if (const auto s = -1.0 / inverse; s.imag() > 0) out.push_back(s.imag());
  std::sort(out.begin(), out.end());
  out.resize(std::min(out.size(), count));
  return out;
}

}  // namespace

TEST(StateReduction, ErrorsOfTheTrialRotorAreThoseComputedIndependently) {
  std::ifstream file(std::string(WHIRL_SOURCE_DIR) + "/tests/reference/rotor/reduction_trial_rotor.json");
  const nlohmann::json reference = nlohmann::json::parse(file);
  const auto exact = reference.at("frequency").get<std::vector<double>>();
  for (const auto& [count, methods] : reference.at("error").items()) {
    const auto expected = methods.at("cb_state").get<std::vector<double>>();
    const std::vector<double> found = frequencies(reduced(disc_rotor(), std::stoi(count) / 2 - 2), exact.size());
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k)
      EXPECT_NEAR(std::abs(found[k] / exact[k] - 1), expected[k], 2e-3 * expected[k] + 1e-9) << count << ' ' << k;
  }
}

// With all modes nothing is left out, damping of both kinds included, at any speed.
TEST(StateReduction, IsExactWithAllModes) {
  rotor::Options o = test::uniform_shaft(0.3, 0.015, 4, 2.05e11, 7860);
  o.stiffness_damping = 2e-6;
  o.internal_damping = 1e-6;
  const auto whole = test::whirl_modes(o, {{1, spring}, {5, spring}}, 800);
  o.reduction = {.type = rotor::Reduction::Type::craig_bampton_state, .masters = {1, 5}, .modes = 8, .speed = 300};
  const rotor::Rotor r(MPI_COMM_WORLD, o);
  EXPECT_TRUE(std::isinf(r.quality().neglected));
  MatrixXd p = test::dense(r.states()->at_rest.get()) + 800 * test::dense(r.states()->turning.get());
  for (const int node : {1, 5})
    for (const auto d : {rotor::Freedom::x, rotor::Freedom::y}) {
      const Index at = 2 * r.coordinate(node, d);
      p(at, at) += spring;
    }
  Eigen::VectorXcd s = -test::dense(r.states()->rates.get()).partialPivLu().solve(p).eval().eigenvalues();
  for (std::size_t k = 0; k < 6; ++k) {
    double nearest = 1e300;
    for (const auto& v : s)
      nearest = std::min(nearest, std::abs(v - std::complex<double>(whole[k].growth, std::abs(whole[k].frequency))));
    EXPECT_LT(nearest, 1e-7 * std::abs(whole[k].frequency)) << k;
  }
}

// Eigenvectors of the basis are those of the shaft with its masters held; left ones are biorthogonal to them.
TEST(StateReduction, ModesAreUncoupledAndMastersAreStates) {
  rotor::Options o = reduced(disc_rotor(), 3);
  o.internal_damping = 1e-6;
  const rotor::Rotor r(MPI_COMM_WORLD, o);
  EXPECT_EQ(r.size(), 2 * (2 + 3));
  EXPECT_EQ(r.coordinate(21, rotor::Freedom::y), 3);
  EXPECT_FALSE(r.freedom(4).has_value());
  const auto& m = *r.states();
  const MatrixXd n = test::dense(m.rates.get()), p = whole_matrix(r, speed, 0), q = test::dense(m.displacement.get()),
                 v = test::dense(m.velocity.get());
  ASSERT_EQ(n.rows(), 20);
  for (const int node : {1, 21})
    for (const auto d : {rotor::Freedom::x, rotor::Freedom::y}) {
      VectorXd unit = VectorXd::Zero(20);
      unit(2 * r.coordinate(node, d)) = 1;
      EXPECT_EQ((q.row(rotor::full_coordinate(node, d)).transpose() - unit).norm(), 0);
      VectorXd rate = VectorXd::Zero(20);
      rate(2 * r.coordinate(node, d) + 1) = 1;
      EXPECT_EQ((v.row(rotor::full_coordinate(node, d)).transpose() - rate).norm(), 0);
    }
  // Rows of a pair are exchanged.
  const MatrixXd modal = n.bottomRightCorner(12, 12), rest = p.bottomRightCorner(12, 12);
  for (Index i = 0; i < 12; i += 2)
    for (Index j = 0; j < 12; j += 2) {
      Eigen::Matrix2d swap;
      swap << 0, 1, 1, 0;
      EXPECT_LT((modal.block<2, 2>(i, j) - (i == j ? swap : 0 * swap)).norm(), 1e-8);
      if (i != j) {
        EXPECT_LT((rest.block<2, 2>(i, j)).norm(), 1e-7 * rest.norm());
      }
    }
  // The last pair is the fastest one kept.
  EXPECT_NEAR(std::sqrt(std::abs(rest.bottomRightCorner<2, 2>().determinant())), r.quality().retained,
              1e-6 * r.quality().retained);
  EXPECT_GT(r.quality().neglected, r.quality().retained);
}

TEST(StateReduction, StaticShapeUnderGravityIsExact) {
  rotor::Options whole = disc_rotor();
  const rotor::Rotor full(MPI_COMM_WORLD, whole);
  MatrixXd k = test::dense(full.matrices().stiffness.get());
  for (const int node : {1, 21})
    for (const auto d : {rotor::Freedom::x, rotor::Freedom::y})
      k(full.coordinate(node, d), full.coordinate(node, d)) += spring;
  const VectorXd exact = k.partialPivLu().solve(9.81 * test::dense(full.matrices().gravity.get()));
  const rotor::Rotor r(MPI_COMM_WORLD, reduced(whole, 3));
  const VectorXd u = whole_matrix(r, speed, spring).partialPivLu().solve(9.81 * test::dense(r.states()->gravity.get()));
  const VectorXd found = test::dense(r.states()->displacement.get()) * u + 9.81 * test::dense(r.states()->offset.get());
  EXPECT_LT((found - exact).norm(), 1e-9 * exact.norm());
  EXPECT_LT((test::dense(r.states()->velocity.get()) * u).norm(), 1e-6 * exact.norm());
}

// A turning rotor that nothing holds keeps six eigenvalues of zero with four vectors, and the precession of the shaft
// without a disc at I_p/I_d times its speed, 37.4298 rad/s.
TEST(StateReduction, KeepsTheRigidMotionsOfTheFreeRotor) {
  rotor::Options o = disc_rotor();
  o.discs.clear();
  const rotor::Rotor r(MPI_COMM_WORLD, reduced(o, 6));
  const Eigen::VectorXcd s = eigenvalues(r, speed, 0);
  for (Index k = 0; k < 6; ++k) EXPECT_LT(std::abs(s(k)), 0.5) << k;  // the root of rounding
  EXPECT_NEAR(std::abs(s(6).imag()), 37.42981908920773, 1e-3);
  EXPECT_NEAR(std::abs(s(7).imag()), 37.42981908920773, 1e-3);
  EXPECT_GT(std::abs(s(8)), 1000);
  // P has four vectors of zero: in shares of a typical frequency and mass.
  const double omega = 1e4, mass = 0.4;
  MatrixXd p = whole_matrix(r, speed, 0) / omega;
  for (Index j = 0; j < 4; ++j) {
    p.row(2 * j) /= mass * omega;
    p.col(2 * j + 1) *= omega;
  }
  const VectorXd values = p.jacobiSvd().singularValues();
  EXPECT_LT(values(values.size() - 4), 1e-8);
  EXPECT_GT(values(values.size() - 5), 1e-3);
}

TEST(StateReduction, IsTheSameOnEveryRank) {
  const rotor::Rotor all(MPI_COMM_WORLD, reduced(disc_rotor(), 4)), alone(MPI_COMM_SELF, reduced(disc_rotor(), 4));
  EXPECT_EQ(all.size(), alone.size());
  const auto &a = *all.states(), &b = *alone.states();
  for (const auto& [x, y] : {std::pair{a.rates.get(), b.rates.get()}, std::pair{a.at_rest.get(), b.at_rest.get()},
                             std::pair{a.turning.get(), b.turning.get()}, std::pair{a.forces.get(), b.forces.get()}}) {
    const MatrixXd one = test::dense(x), two = test::dense(y);
    EXPECT_LE((one - two).norm(), 1e-9 * two.norm());
  }
}

// V^T G V with V^T M V = I has the eigenvalues of G against M, whatever holds the shaft.
TEST(GyroscopicCoupling, IsThatOfAllRealModes) {
  const rotor::Options o = disc_rotor();
  const rotor::Rotor r(MPI_COMM_SELF, o);
  const Index n = r.size() / 2;
  const MatrixXd m = test::dense(r.matrices().mass.get()), g = test::dense(r.matrices().gyroscopic.get());
  const auto x = Eigen::seqN(0, n, 2), y = Eigen::seqN(1, n, 2);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> whole(g(x, y), m(x, x));
  for (const double support : {0.0, spring}) {
    const auto coupling = rotor::gyroscopic_coupling(o, {1, 21}, support);
    ASSERT_EQ(coupling.matrix.rows(), n);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> own(coupling.matrix);
    EXPECT_LT((own.eigenvalues() - whole.eigenvalues()).cwiseAbs().maxCoeff(), 1e-7 * whole.eigenvalues().maxCoeff());
    if (support == 0) {
      EXPECT_LT(coupling.frequencies(1), 10);
      EXPECT_GT(coupling.frequencies(2), 1000);
    }
  }
}

TEST(StateReduction, RefusesWhatItCannotKeep) {
  EXPECT_THROW(rotor::Rotor(MPI_COMM_WORLD, reduced(disc_rotor(), 41)), core::InputError);
  EXPECT_THROW(rotor::Rotor(MPI_COMM_WORLD, reduced(disc_rotor(), 4, -1)), core::InputError);
}
