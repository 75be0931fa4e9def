// Unbalance response of the full train (750 coordinates, fixed bearing coefficients) at 100 speeds: FrequencyResolvent
// from the matrices of the System on, against a plain loop of complex sparse LU over M, C, G, K extracted beforehand.
#include <fmt/core.h>

#include <Eigen/SparseLU>
#include <complex>

#include "bench/timing.hpp"
#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/newton/frequency_resolvent.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Complex = std::complex<double>;
using Sparse = Eigen::SparseMatrix<double>;

namespace {

constexpr int kSpeeds = 100;

double speed_at(int k) {
  return 100 + 5.0 * k;
}

// The full train on the stiffness and damping of its films at the equilibrium at 377 rad/s.
system::Train linear_train() {
  auto t = test::train({60, 16}, false);
  test::add_gen_pair(t, 2.5);
  system::RotorSystem s(PETSC_COMM_SELF, t, 377);
  s.set_forcing(false);
  core::Vector x = system::static_guess(s);
  solve::NewtonOptions newton;
  newton.max_iterations = 40;
  core::require(solve::find_equilibrium(s, x.get(), newton).converged, "equilibrium");
  const auto whole = s.gather(x.get());
  const auto films = s.film_responses(whole.data(), film::Need::tangents);
  for (std::size_t b = 0; b < films.size(); ++b) {
    film::Linear o;
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j) {
        o.stiffness[2 * i + j] = -films[b].d_position[i][j];
        o.damping[2 * i + j] = -films[b].d_velocity[i][j];
      }
    t.supports[b].film = o;
  }
  return t;
}

// Entries (2 i, 2 j + rate) of a Jacobian.
Sparse part_of(Mat m, PetscInt rate) {
  PetscInt n = 0;
  core::check(MatGetSize(m, &n, nullptr));
  std::vector<Eigen::Triplet<double>> entries;
  for (PetscInt i = 0; i < n; i += 2) {
    PetscInt k = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    core::check(MatGetRow(m, i, &k, &columns, &values));
    for (PetscInt e = 0; e < k; ++e)
      if (columns[e] % 2 == rate && values[e] != 0) entries.emplace_back(i / 2, columns[e] / 2, values[e]);
    core::check(MatRestoreRow(m, i, &k, &columns, &values));
  }
  Sparse out(n / 2, n / 2);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

Eigen::VectorXcd force(const system::RotorSystem& s, double speed) {
  Eigen::VectorXcd f(s.coordinates());
  for (PetscInt q = 0; q < s.coordinates(); ++q) {
    const auto row = static_cast<std::size_t>(2 * q);
    f(q) = speed * speed * Complex(s.forcing_cosine()[row], -s.forcing_sine()[row]);
  }
  return f;
}

}  // namespace

int main(int argc, char** argv) {
  const core::Session session(argc, argv);
  const int runs = argc > 1 && std::string(argv[1]) == "--quick" ? 2 : 8;
  const system::Train train = linear_train();
  const bench::Timing assembly =
      bench::least(PETSC_COMM_SELF, runs, [&] { const system::RotorSystem s(PETSC_COMM_SELF, train, 377); });

  system::RotorSystem s(PETSC_COMM_SELF, train, 377);
  core::Vector x = core::make_vector(PETSC_COMM_SELF, s.local_size(), PETSC_DETERMINE), rest = core::duplicate(x.get());
  std::vector<Eigen::VectorXcd> ours(kSpeeds), plain(kSpeeds);
  const bench::Timing response = bench::least(PETSC_COMM_SELF, runs, [&] {
    solve::FrequencyResolvent solver(s);
    std::vector<Complex> right(static_cast<std::size_t>(s.size()));
    for (int k = 0; k < kSpeeds; ++k) {
      s.set_parameter(speed_at(k));
      const Eigen::VectorXcd f = force(s, speed_at(k));
      for (PetscInt q = 0; q < s.coordinates(); ++q) right[static_cast<std::size_t>(2 * q)] = f(q);
      solver.linearise(x.get());
      solver.factorise({0, speed_at(k)});
      const std::vector<Complex> amplitude = solver.respond(right);
      auto& z = ours[static_cast<std::size_t>(k)];
      z.resize(s.coordinates());
      for (PetscInt q = 0; q < s.coordinates(); ++q) z(q) = amplitude[static_cast<std::size_t>(2 * q)];
    }
  });

  // K and C hold the coefficients of the bearings; the gyroscopic matrix is the change of C with the speed.
  core::Matrix j = s.make_jacobian(), jd = s.make_jacobian();
  s.set_parameter(1);
  s.jacobian(0, x.get(), rest.get(), 1, 0, j.get());
  const Sparse stiffness = part_of(j.get(), 0), at_one = part_of(j.get(), 1);
  s.set_parameter(2);
  s.jacobian(0, x.get(), rest.get(), 1, 0, j.get());
  const Sparse gyroscopic = part_of(j.get(), 1) - at_one, damping = at_one - gyroscopic;
  s.jacobian(0, x.get(), rest.get(), 0, 1, jd.get());
  const Sparse mass = part_of(jd.get(), 1);
  const bench::Timing loop = bench::least(PETSC_COMM_SELF, runs, [&] {
    Eigen::SparseLU<Eigen::SparseMatrix<Complex>> lu;
    for (int k = 0; k < kSpeeds; ++k) {
      const double w = speed_at(k);
      Eigen::SparseMatrix<Complex> a = (stiffness - w * w * mass).eval().cast<Complex>();
      a += (Complex(0, w) * (damping + w * gyroscopic).eval().cast<Complex>()).eval();
      if (k == 0) lu.analyzePattern(a);
      lu.factorize(a);
      plain[static_cast<std::size_t>(k)] = lu.solve(force(s, w));
    }
  });
  double difference = 0;
  for (std::size_t k = 0; k < kSpeeds; ++k)
    difference = std::max(difference, (ours[k] - plain[k]).norm() / plain[k].norm());

  fmt::print("{} coordinates, {} speeds            wall ms    cpu ms\n", s.coordinates(), kSpeeds);
  fmt::print("assembly of the system           {:9.2f} {:9.2f}\n", 1e3 * assembly.wall, 1e3 * assembly.processor);
  fmt::print("FrequencyResolvent               {:9.2f} {:9.2f}\n", 1e3 * response.wall, 1e3 * response.processor);
  fmt::print("plain loop of Eigen::SparseLU    {:9.2f} {:9.2f}\n", 1e3 * loop.wall, 1e3 * loop.processor);
  fmt::print("largest relative difference {:.1e}\n", difference);
  fmt::print("ratio to the plain loop: {:.2f} (response), {:.2f} (assembly and response)\n", response.wall / loop.wall,
             (assembly.wall + response.wall) / loop.wall);
  return difference < 1e-6 ? 0 : 1;
}
