// Transfer matrices of rotors: closed forms, reciprocity, and sums over modes.
#include "study/linear/transfer_points.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "rotor/shafts.hpp"
#include "whirl/film/contract/linear.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::study {
namespace {

using Complex = std::complex<double>;

system::Support spring(int node, std::array<double, 4> stiffness, std::array<double, 4> damping) {
  system::Support s;
  s.name = "B" + std::to_string(node);
  s.node = node;
  film::Linear film;
  film.stiffness = stiffness;
  film.damping = damping;
  s.film = film;
  return s;
}

// A shaft with a disc on dashpots and springs that differ in x and y.
system::Train shaft(bool reduced = false, double mirrored = 1) {
  system::Train train;
  train.gravity = 0;
  train.rotor = test::uniform_shaft(0.3, 0.015, 10, 2.05e11, 7860);
  rotor::Disc disc;
  disc.node = 4;
  disc.mass = 0.5;
  disc.diametral_inertia = 7.81e-5;
  disc.polar_inertia = 1.56e-4;
  train.rotor.discs.push_back(disc);
  train.rotor.stiffness_damping = 1e-7;
  if (reduced) {
    train.rotor.reduction.type = rotor::Reduction::Type::craig_bampton;
    train.rotor.reduction.masters = {1, 11};
    train.rotor.reduction.modes = 8;
  }
  for (const int node : {1, 11})
    train.supports.push_back(spring(node, {1e7, mirrored * 2e5, mirrored * 2e5, 1.4e7}, {200, 0, 0, 300}));
  train.supports[1].has_pedestal = true;
  train.supports[1].mass = {2, 3};
  train.supports[1].stiffness = {3e7, 2e7};
  train.supports[1].damping = {100, 150};
  return train;
}

const std::vector<TransferInput> inputs{
    {4, "", Along::x}, {4, "", Along::slope_y}, {7, "", Along::y}, {0, "B11", Along::x}};

std::vector<TransferOutput> same_outputs() {
  std::vector<TransferOutput> out;
  for (const TransferInput& i : inputs) out.push_back(output_of(i));
  return out;
}

Eigen::MatrixXcd matrix_at(system::RotorSystem& s, double omega) {
  const core::Vector x = s.guess();
  core::check(VecSet(x.get(), 0));
  TransferMatrix g(s, inputs, same_outputs());
  g.linearise(x.get());
  const auto flat = g.at(omega).values;
  const auto n = static_cast<Eigen::Index>(inputs.size());
  return Eigen::Map<const Eigen::Matrix<Complex, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(flat.data(), n, n);
}

// Displacements over forces span six powers of ten: each entry against those that its place and its force are known by.
double apart(const Eigen::MatrixXcd& a, const Eigen::MatrixXcd& b) {
  double most = 0;
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      most = std::max(most, std::abs(a(i, j) - b(i, j)) / std::sqrt(std::abs(a(i, i)) * std::abs(a(j, j))));
  return most;
}

TEST(TransferMatrix, OfOneMassOnASpring) {
  system::Train train;
  train.gravity = 0;
  train.rotor.type = rotor::Options::Type::rigid;
  train.rotor.mass = 3;
  train.supports.push_back(spring(1, {2e6, 0, 0, 8e6}, {50, 0, 0, 0}));
  system::RotorSystem s(MPI_COMM_WORLD, train, 100);
  const core::Vector x = s.guess();
  core::check(VecSet(x.get(), 0));
  using Quantity = TransferOutput::Quantity;
  TransferMatrix g(
      s, {{1, "", Along::x}, {0, "B1", Along::y}},
      {{1, "", Along::x}, {1, "", Along::y, Quantity::velocity}, {1, "", Along::x, Quantity::acceleration}});
  g.linearise(x.get());
  for (const double w : {10.0, 816.0, 5000.0}) {
    const Complex gx = 1.0 / Complex(2e6 - 3 * w * w, 50 * w), gy = 1.0 / (8e6 - 3 * w * w);
    const auto [found, rounding] = g.at(w);
    const Complex wanted[] = {gx, 0, 0, Complex(0, w) * gy, -w * w * gx, 0};
    for (std::size_t k = 0; k < 6; ++k) {
      EXPECT_NEAR(std::abs(found[k] - wanted[k]), 0, 1e-11 * std::abs(wanted[k])) << k;
      // 1e-12 of the motion along x or y, whichever this input makes: what is zero lies below it, and nothing else.
      const double largest = std::abs(k % 2 == 0 ? gx : gy) * (k < 2 ? 1 : k < 4 ? w : w * w);
      EXPECT_NEAR(rounding[k], 1e-12 * largest, 1e-18 * largest) << k;
      EXPECT_EQ(std::abs(found[k]) > rounding[k], wanted[k] != 0.0) << k;
    }
  }
}

// At rest the matrix is symmetric; turning, it is the transpose of that of the shaft that turns the other way, which is
// its mirror image in x.
TEST(TransferMatrix, IsReciprocal) {
  const Eigen::VectorXd mirror{{-1, 1, 1, -1}};
  for (const bool reduced : {false, true}) {
    system::RotorSystem still(MPI_COMM_WORLD, shaft(reduced), 0), s(MPI_COMM_WORLD, shaft(reduced), 9000),
        back(MPI_COMM_WORLD, shaft(reduced, -1), 9000);
    for (const double w : {300.0, 1300.0, 6000.0}) {
      const Eigen::MatrixXcd rest = matrix_at(still, w), turning = matrix_at(s, w);
      const Eigen::MatrixXcd other = mirror.asDiagonal() * matrix_at(back, w) * mirror.asDiagonal();
      EXPECT_LE(apart(rest, rest.transpose()), 1e-9) << w;
      EXPECT_GE(apart(turning, turning.transpose()), 1e-3) << w;
      EXPECT_LE(apart(turning, other.transpose()), 1e-9) << w;
    }
  }
}

// G = sum of x y*/(lambda - i omega) over all modes, with left and right vectors that are found without it.
TEST(TransferMatrix, IsASumOverModes) {
  system::RotorSystem s(MPI_COMM_WORLD, shaft(), 9000);
  const core::Vector x = s.guess();
  core::check(VecSet(x.get(), 0));
  spectral::EigenOptions options;
  options.left = true;
  const auto modes = spectral::modes(s, x.get(), options);
  const auto coordinate = [&](int node, rotor::Freedom f) { return 2 * s.rotor().coordinate(node, f); };
  const PetscInt at[] = {coordinate(4, rotor::Freedom::x), coordinate(4, rotor::Freedom::slope_y),
                         coordinate(7, rotor::Freedom::y)};
  for (const double w : {300.0, 1300.0, 6000.0}) {
    const Eigen::MatrixXcd g = matrix_at(s, w).topLeftCorner(3, 3);
    Eigen::MatrixXcd sum = Eigen::MatrixXcd::Zero(3, 3);
    for (const auto& m : modes)
      for (Eigen::Index o = 0; o < 3; ++o)
        for (Eigen::Index i = 0; i < 3; ++i) {
          const Complex right = m.shape[static_cast<std::size_t>(at[o])],
                        left = std::conj(m.left[static_cast<std::size_t>(at[i])]);
          sum(o, i) += right * left / (m.lambda - Complex(0, w));
          if (m.lambda.imag() > 0) sum(o, i) += std::conj(right * left) / (std::conj(m.lambda) - Complex(0, w));
        }
    EXPECT_LE(apart(g, sum), 1e-7) << w;
  }
}

}  // namespace
}  // namespace whirl::study
