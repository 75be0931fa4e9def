// Equilibria of systems whose parts offer approximate inverses, good and useless ones.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

#include "support/petsc_options.hpp"
#include "support/small_system.hpp"
#include "whirl/solve/newton/equilibrium.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"

using namespace whirl;
using test::Column;

namespace {

constexpr PetscInt hub = 2, n = 6;

// A hub of two states on two films of two states each; `stiffness` of the hub beside that of its films.
struct OnTwoFilms {
  double stiffness;
  template <class T>
  Column<T> operator()(double, const Column<T>& x, const Column<T>& xdot, T p) const {
    Column<T> f(n);
    f << xdot(0) + stiffness * x(0) + x(2) - p, xdot(1) + stiffness * x(1) + x(4) - 2.0 * p,
        xdot(2) + x(2) + x(2) * x(2) * x(2) + 0.2 * x(3) - x(0), xdot(3) + x(3) + 0.5 * x(2),
        xdot(4) + x(4) + x(4) * x(4) * x(4) - 0.3 * x(5) - x(1), xdot(5) + 2.0 * x(5) + 0.5 * x(4);
    return f;
  }
};

// Cut where the ranks want it.
class TwoFilms : public test::SmallSystem {
public:
  TwoFilms(double stiffness, double quality)
      : SmallSystem(MPI_COMM_WORLD, n, 1, 1, OnTwoFilms{stiffness}), q_(quality) {}
  [[nodiscard]] std::vector<problem::Field> fields() const override {
    PetscInt first = 0;
    const core::Vector like = vector(Eigen::VectorXd::Zero(n));
    core::check(VecGetOwnershipRange(like.get(), &first, nullptr));
    const auto here = [&](PetscInt k) { return std::clamp<PetscInt>(k - first, 0, local_size()); };
    return {{.name = "machine", .begin = 0, .end = here(hub)},
            {.name = "one", .begin = here(2), .end = here(4), .part = 1},
            {.name = "two", .begin = here(4), .end = here(6), .part = 2}};
  }
  [[nodiscard]] std::unique_ptr<problem::PartInverse> make_part_inverse() override {
    return std::make_unique<Inverse>(*this);
  }
  int sets = 0, applications = 0;

private:
  // `quality` times what the diagonal of A_pp gives: nothing is of no use.
  class Inverse : public problem::PartInverse {
  public:
    explicit Inverse(TwoFilms& system) : system_(system) {}
    void set(const problem::Point& at, double alpha, double sigma) override {
      ++system_.sets;
      core::Matrix a = system_.make_jacobian();
      system_.jacobian(at.angle, at.x, at.xdot, alpha, sigma, a.get());
      core::Vector d = core::duplicate(at.x);
      core::check(MatGetDiagonal(a.get(), d.get()));
      const Eigen::VectorXd all = system_.gather(d.get());
      PetscInt begin = 0, end = 0;
      core::check(VecGetOwnershipRange(at.x, &begin, &end));
      begin = std::max(begin, hub);
      inverse_ = system_.q_ * all.segment(begin, std::max<PetscInt>(end - begin, 0)).cwiseInverse();
    }
    void apply(std::span<const double> r, std::span<double> y) override {
      ++system_.applications;
      if (inverse_.size() == 0) return;
      const Eigen::Index columns = static_cast<Eigen::Index>(r.size()) / inverse_.size();
      const Eigen::Map<const Eigen::MatrixXd> given(r.data(), inverse_.size(), columns);
      Eigen::Map<Eigen::MatrixXd>(y.data(), inverse_.size(), columns) = inverse_.asDiagonal() * given;
    }

  private:
    TwoFilms& system_;
    Eigen::VectorXd inverse_;
  };
  double q_;
};

class WithoutInverses : public TwoFilms {
public:
  using TwoFilms::TwoFilms;
  [[nodiscard]] std::unique_ptr<problem::PartInverse> make_part_inverse() override {
    ++asked;
    return nullptr;
  }
  int asked = 0;
};

// Newton's method finds a place of rest on films of this stiffness.
solve::NewtonResult expect_rest(TwoFilms& s, double stiffness) {
  core::Vector v = s.vector(Eigen::VectorXd::Constant(n, 0.3));
  solve::NewtonOptions options;
  options.max_iterations = 40;
  const solve::NewtonResult result = solve::find_equilibrium(s, v.get(), options);
  EXPECT_TRUE(result.converged) << result.reason;
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(n);
  EXPECT_LT(OnTwoFilms{stiffness}(0, s.gather(v.get()), still, 1.0).norm(), 1e-9);
  return result;
}

}  // namespace

TEST(PartInverses, CarryNewtonsMethod) {
  TwoFilms s(2, 1);
  const auto result = expect_rest(s, 2);
  EXPECT_GT(result.iterations, 2);
  EXPECT_GE(s.sets, result.iterations);  // of every matrix
  EXPECT_GT(s.applications, 0);
}

TEST(PartInverses, ThatDoNotServeAreAskedOnce) {
  const test::WithOptions few(test::WithOptions::List{{"-equilibrium_ksp_max_it", "1"}});
  TwoFilms s(2, 1);
  const auto result = expect_rest(s, 2);
  EXPECT_GT(result.iterations, 2);
  EXPECT_EQ(s.sets, 1);
}

// Without the films, nothing holds the hub.
TEST(PartInverses, MayLeaveTheHubSingular) {
  TwoFilms s(0, 0);
  (void)expect_rest(s, 0);
  EXPECT_EQ(s.sets, 1);
}

// Steps that are kept, each with its elimination.
TEST(PartInverses, AreAskedForOnceWhereThereAreNone) {
  WithoutInverses s(2, 1);
  solve::RungeKutta scheme(solve::sparse_stages(s, false), solve::sdirk(2));
  const Eigen::VectorXd v = Eigen::VectorXd::Constant(s.local_size(), 0.7);
  Eigen::VectorXd x = Eigen::VectorXd::Constant(s.local_size(), 0.3);
  const double length = 0.1, h = 1e-4;
  std::vector<solve::StepDerivative> kept(3);
  for (solve::StepDerivative& derivative : kept) {
    Eigen::VectorXd ahead = x + h * v, behind = x - h * v;
    scheme.step(0, 0, length, ahead, nullptr);
    scheme.step(0, 0, length, behind, nullptr);
    scheme.step(0, 0, length, x, &derivative);
    Eigen::MatrixXd moved = v;
    derivative.carry(moved);
    EXPECT_LT(((ahead - behind) / (2 * h) - moved).norm(), 1e-6);
  }
  EXPECT_EQ(s.asked, 1);
}
