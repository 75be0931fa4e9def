#pragma once
// Systems of a few states made of one formula, for tests of the solvers.

#include <Eigen/Core>
#include <complex>
#include <functional>
#include <utility>

#include "whirl/core/agree.hpp"
#include "whirl/problem/structure.hpp"
#include "whirl/problem/system.hpp"

namespace whirl::test {

using Complex = std::complex<double>;
template <class T>
using Column = Eigen::Matrix<T, Eigen::Dynamic, 1>;

/// F(angle, x, xdot, p) from one generic function, called with T = double and T = complex: derivatives by complex steps
/// of 1e-40, exact to rounding. Every rank evaluates all rows and keeps its own.
class SmallSystem : public problem::System {
public:
  /// `f(double angle, Column<T> x, Column<T> xdot, T p) -> Column<T>`. `speed` 0: the parameter is the speed.
  template <class F>
  SmallSystem(MPI_Comm comm, int n, double parameter, double speed, F f)
      : comm_(comm), n_(n), parameter_(parameter), speed_(speed), real_(f), complex_(f) {
    x_ = core::make_vector(comm, PETSC_DECIDE, n);
    check(VecScatterCreateToAll(x_.get(), scatter_.put(), whole_.put()));
    check(VecGetLocalSize(x_.get(), &local_));
    check(VecGetOwnershipRange(x_.get(), &begin_, nullptr));
    state_scale_ = residual_scale_ = Eigen::VectorXd::Ones(n);
  }
  void set_scales(Eigen::VectorXd state, Eigen::VectorXd residual) {
    state_scale_ = std::move(state);
    residual_scale_ = std::move(residual);
  }

  [[nodiscard]] MPI_Comm comm() const override { return comm_; }
  [[nodiscard]] PetscInt size() const override { return n_; }
  [[nodiscard]] PetscInt local_size() const override { return local_; }
  [[nodiscard]] double parameter() const override { return parameter_; }
  void set_parameter(double p) override { parameter_ = p; }
  [[nodiscard]] double speed() const override { return speed_ != 0 ? speed_ : parameter_; }
  [[nodiscard]] bool parameter_is_speed() const override { return speed_ == 0; }

  void residual(double angle, Vec x, Vec xdot, Vec f) override {
    const Eigen::VectorXd xs = gather(x), ds = gather(xdot);
    Eigen::VectorXd value;
    core::agree(comm_, [&] { value = real_(angle, xs, ds, parameter_); });
    put(value, f);
  }
  [[nodiscard]] core::Matrix make_jacobian() override {
    core::Matrix m;
    check(MatCreateAIJ(comm_, local_, local_, n_, n_, n_, nullptr, n_, nullptr, m.put()));
    return m;
  }
  void jacobian(double angle, Vec x, Vec xdot, double alpha, double sigma, Mat j) override {
    const Eigen::VectorXd xs = gather(x), ds = gather(xdot);
    const double h = 1e-40;
    for (PetscInt c = 0; c < n_; ++c) {
      Eigen::VectorXcd xc = xs.cast<Complex>(), dc = ds.cast<Complex>(), value;
      xc(c) += Complex(0, alpha * h);
      dc(c) += Complex(0, sigma * h);
      core::agree(comm_, [&] { value = complex_(angle, xc, dc, parameter_); });
      for (PetscInt i = begin_; i < begin_ + local_; ++i)
        check(MatSetValue(j, i, c, value(i).imag() / h, INSERT_VALUES));
    }
    check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
  }
  void parameter_derivative(double angle, Vec x, Vec xdot, Vec f) override {
    const Eigen::VectorXd xs = gather(x), ds = gather(xdot);
    Eigen::VectorXcd value;
    core::agree(comm_,
                [&] { value = complex_(angle, xs.cast<Complex>(), ds.cast<Complex>(), Complex(parameter_, 1e-40)); });
    put(value.imag() / 1e-40, f);
  }
  void scales(Vec state, Vec residual) override {
    put(state_scale_, state);
    put(residual_scale_, residual);
  }

  /// A distributed vector of the given values / all values on every rank.
  [[nodiscard]] core::Vector vector(const Eigen::VectorXd& values) const {
    core::Vector v = core::duplicate(x_.get());
    put(values, v.get());
    return v;
  }
  [[nodiscard]] Eigen::VectorXd gather(Vec v) const {
    check(VecScatterBegin(scatter_.get(), v, whole_.get(), INSERT_VALUES, SCATTER_FORWARD));
    check(VecScatterEnd(scatter_.get(), v, whole_.get(), INSERT_VALUES, SCATTER_FORWARD));
    const core::ReadArray a(whole_.get());
    return Eigen::Map<const Eigen::VectorXd>(a.data(), n_);
  }

protected:
  Eigen::VectorXd state_scale_, residual_scale_;

private:
  static void check(PetscErrorCode code) { core::check(code); }
  void put(const Eigen::VectorXd& values, Vec v) const {
    const core::WriteArray a(v);
    for (PetscInt i = 0; i < local_; ++i) a[i] = values(begin_ + i);
  }

  MPI_Comm comm_;
  PetscInt n_, local_ = 0, begin_ = 0;
  double parameter_, speed_;
  std::function<Eigen::VectorXd(double, Eigen::VectorXd, Eigen::VectorXd, double)> real_;
  std::function<Eigen::VectorXcd(double, Eigen::VectorXcd, Eigen::VectorXcd, Complex)> complex_;
  core::Vector x_;
  core::Scatter scatter_;
  core::Vector whole_;
};

/// The blocks of F = L1 xdot + (L0 + p L0p) x - load(angle, p) - B f(C x, p).
struct Blocks {
  Eigen::MatrixXd l1, l0, l0p, b, c;
  std::vector<problem::KinematicRow> kinematic;
};

/// The same formula told twice: as F, and as Structure. `load(double angle, T p)` and `forces(Column<T> w, T p)` return
/// Column<T>.
class StructuredSystem : public SmallSystem {
public:
  template <class Load, class Forces>
  StructuredSystem(double parameter, double speed, const Blocks& blocks, Load load, Forces forces)
      : SmallSystem(PETSC_COMM_SELF, static_cast<int>(blocks.l1.rows()), parameter, speed,
                    [blocks, load, forces]<class T>(double angle, Column<T> x, Column<T> xdot, T p) {
                      const Column<T> w = blocks.c.template cast<T>() * x;
                      return Column<T>(blocks.l1.template cast<T>() * xdot + blocks.l0.template cast<T>() * x +
                                       p * (blocks.l0p.template cast<T>() * x) - load(angle, p) -
                                       blocks.b.template cast<T>() * forces(w, p));
                    }),
        structure_(*this, blocks),
        kinematic_(blocks.kinematic) {
    structure_.load_ = [load](double angle, Complex p) { return load(angle, p); };
    structure_.forces_ = [forces](const Eigen::VectorXcd& w, Complex p) { return forces(w, p); };
  }
  [[nodiscard]] problem::BlockStructure* structure() override { return &structure_; }
  [[nodiscard]] std::vector<problem::KinematicRow> kinematic() const override { return kinematic_; }

private:
  class Told : public problem::BlockStructure {
  public:
    Told(const StructuredSystem& system, const Blocks& blocks)
        : system_(system), blocks_(blocks), l1_(told(blocks.l1)), b_(told(blocks.b)), c_(told(blocks.c)) {}
    [[nodiscard]] Eigen::Index size() const override { return blocks_.l1.rows(); }
    [[nodiscard]] Eigen::Index n_forces() const override { return blocks_.b.cols(); }
    [[nodiscard]] Eigen::Index n_inputs() const override { return blocks_.c.rows(); }
    [[nodiscard]] const std::vector<problem::OwnStates>& own() const override { return none_; }
    [[nodiscard]] const problem::SparseBlock& l1() override { return l1_; }
    [[nodiscard]] const problem::SparseBlock& l0() override {
      return now_ = told(blocks_.l0 + system_.parameter() * blocks_.l0p);
    }
    [[nodiscard]] const problem::SparseBlock& b() const override { return b_; }
    [[nodiscard]] const problem::SparseBlock& c() const override { return c_; }
    void load(double angle, Eigen::VectorXd& load) override { load = load_(angle, system_.parameter()).real(); }
    void films(const Eigen::VectorXd& inputs, const double*, const double*, bool tangents,
               problem::Films& out) override {
      const Eigen::VectorXcd value = forces_(inputs.cast<Complex>(), Complex(system_.parameter(), step));
      out.forces = value.real();
      if (!tangents) return;
      out.d_inputs.resize(value.size(), inputs.size());
      for (Eigen::Index k = 0; k < inputs.size(); ++k) {
        Eigen::VectorXcd w = inputs.cast<Complex>();
        w(k) += Complex(0, step);
        out.d_inputs.col(k) = forces_(w, system_.parameter()).imag() / step;
      }
    }
    void parameter_derivative(double angle, const Eigen::VectorXd& x, const Eigen::VectorXd&, const problem::Films&,
                              Eigen::VectorXd& out) override {
      const Complex p(system_.parameter(), step);
      out = blocks_.l0p * x - load_(angle, p).imag() / step -
            blocks_.b * (forces_((blocks_.c * x).cast<Complex>(), p).imag() / step);
    }
    std::function<Eigen::VectorXcd(double, Complex)> load_;
    std::function<Eigen::VectorXcd(Eigen::VectorXcd, Complex)> forces_;

  private:
    static problem::SparseBlock told(const Eigen::MatrixXd& block) { return block.sparseView(); }
    static constexpr double step = 1e-40;
    const StructuredSystem& system_;
    Blocks blocks_;
    problem::SparseBlock l1_, b_, c_, now_;
    std::vector<problem::OwnStates> none_;
  };
  Told structure_;
  std::vector<problem::KinematicRow> kinematic_;
};

}  // namespace whirl::test
