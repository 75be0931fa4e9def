// The linear response solves its own equations, also those that are eliminated.

#include "whirl/solve/newton/frequency_resolvent.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "support/dense.hpp"
#include "support/train_system.hpp"
#include "system/start.hpp"
#include "whirl/system/rotor_system.hpp"

using namespace whirl;
using Complex = std::complex<double>;

namespace {

// Whole on every rank.
Eigen::VectorXcd whole(const std::vector<Complex>& here) {
  core::Vector v = core::make_vector(MPI_COMM_WORLD, static_cast<PetscInt>(here.size()), PETSC_DETERMINE);
  const auto gathered = [&](auto&& part) {
    std::ranges::transform(here, core::WriteArray(v.get()).data(), part);
    return test::dense(v.get()).cast<Complex>().eval();
  };
  return gathered([](Complex z) { return z.real(); }) + Complex(0, 1) * gathered([](Complex z) { return z.imag(); });
}

void solves_its_equations(bool guyan) {
  system::RotorSystem s(MPI_COMM_WORLD, test::train({30, 8}, guyan), 377);
  core::Vector x = system::static_guess(s), rest = core::duplicate(x.get()), xs = core::duplicate(x.get()),
               fs = core::duplicate(x.get());
  s.scales(xs.get(), fs.get());
  std::vector<Complex> right(static_cast<std::size_t>(s.local_size()));
  {
    const core::ReadArray scale(fs.get());
    PetscInt begin = 0;
    core::check(VecGetOwnershipRange(fs.get(), &begin, nullptr));
    // Loads on all rows, the kinematic ones too.
    for (PetscInt i = 0; i < scale.size(); ++i)
      right[static_cast<std::size_t>(i)] = scale[i] * Complex(std::sin(1.0 + begin + i), std::cos(0.7 * (begin + i)));
  }
  solve::FrequencyResolvent response(s);
  core::Matrix jx = s.make_jacobian(), jd = s.make_jacobian();
  for (const double omega : {0.0, 150.0, 377.0}) {  // at rest the pattern of values is thinner
    s.set_parameter(200 + omega);
    response.linearise(x.get());
    response.factorise({0, omega});
    s.jacobian(0, x.get(), rest.get(), 1, 0, jx.get());
    s.jacobian(0, x.get(), rest.get(), 0, 1, jd.get());
    const Eigen::MatrixXcd a =
        test::dense(jx.get()).cast<Complex>() + Complex(0, omega) * test::dense(jd.get()).cast<Complex>();
    const Eigen::VectorXcd z = whole(response.respond(right)), b = whole(right);
    // Rows measured against the sum of their terms.
    const Eigen::VectorXd size = a.cwiseAbs() * z.cwiseAbs() + b.cwiseAbs();
    EXPECT_LE((a * z - b).cwiseAbs().cwiseQuotient(size).maxCoeff(), 1e-9) << omega;
    EXPECT_GT(z.cwiseQuotient(test::dense(xs.get())).norm(), 1e-6);
  }
}

}  // namespace

TEST(FrequencyResponse, SolvesItsEquationsOnTheFullTrain) {
  solves_its_equations(false);
}

TEST(FrequencyResponse, SolvesItsEquationsOnTheReducedTrain) {
  solves_its_equations(true);
}
