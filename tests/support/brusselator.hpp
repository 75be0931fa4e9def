#pragma once
// The Brusselator by the method of lines, distributed over the ranks of its communicator.

#include <petscmat.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "whirl/problem/system.hpp"

namespace whirl::test {

/// du/dt = (Du/L^2) u_xx + u^2 v - (B + 1) u + A, dv/dt = (Dv/L^2) v_xx - u^2 v + B u on [0, 1], u = A and v = B/A at
/// both ends, second differences on `cells` equal intervals. A = 2, Du = 0.008, Dv = 0.004; the parameter is L or B.
///
/// State: u_1, v_1, u_2, v_2, ...; F = dx/dt - f(x). Source: van de Vrande (2001), Sec. 3.2, after Holodniok et al.
class Brusselator : public problem::System {
public:
  enum class Parameter { length, b };
  Brusselator(MPI_Comm comm, int cells, Parameter which = Parameter::length)
      : comm_(comm), n_(2 * (cells - 1)), cells_(cells), which_(which) {
    // Whole cells on each rank.
    const PetscInt points = cells - 1, rank = core::rank_of(comm), size = core::size_of(comm);
    begin_ = points * rank / size;
    local_ = 2 * (points * (rank + 1) / size - begin_);
    x_ = core::make_vector(comm, local_, n_);
    core::check(VecScatterCreateToAll(x_.get(), scatter_.put(), whole_.put()));
  }

  [[nodiscard]] MPI_Comm comm() const override { return comm_; }
  [[nodiscard]] PetscInt size() const override { return n_; }
  [[nodiscard]] PetscInt local_size() const override { return local_; }
  [[nodiscard]] double parameter() const override { return which_ == Parameter::length ? length_ : b_; }
  void set_parameter(double p) override { (which_ == Parameter::length ? length_ : b_) = p; }
  [[nodiscard]] double speed() const override { return 1; }
  [[nodiscard]] bool parameter_is_speed() const override { return false; }

  void residual(double, Vec x, Vec xdot, Vec f) override {
    gather(x);
    const core::ReadArray z(whole_.get()), d(xdot);
    const core::WriteArray fa(f);
    for_each_point([&](PetscInt i, PetscInt k) {
      const Local p = at(z, i);
      fa[k] = d[k] - (du() * p.u_xx + p.u * p.u * p.v - (b_ + 1) * p.u + a_);
      fa[k + 1] = d[k + 1] - (dv() * p.v_xx - p.u * p.u * p.v + b_ * p.u);
    });
  }
  [[nodiscard]] core::Matrix make_jacobian() override {
    core::Matrix m;
    core::check(MatCreateAIJ(comm_, local_, local_, n_, n_, 4, nullptr, 2, nullptr, m.put()));
    return m;
  }
  void jacobian(double, Vec x, Vec, double alpha, double sigma, Mat j) override {
    gather(x);
    const core::ReadArray z(whole_.get());
    const auto set = [&](PetscInt row, PetscInt column, double value) {
      if (column >= 0 && column < n_) core::check(MatSetValue(j, row, column, value, INSERT_VALUES));
    };
    for_each_point([&](PetscInt i, PetscInt) {
      const Local p = at(z, i);
      const PetscInt r = 2 * i;
      set(r, r, sigma - alpha * (-2 * du() + 2 * p.u * p.v - (b_ + 1)));
      set(r, r + 1, -alpha * p.u * p.u);
      set(r + 1, r, -alpha * (-2 * p.u * p.v + b_));
      set(r + 1, r + 1, sigma - alpha * (-2 * dv() - p.u * p.u));
      for (const PetscInt o : {-2, 2}) {
        set(r, r + o, -alpha * du());
        set(r + 1, r + 1 + o, -alpha * dv());
      }
    });
    core::check(MatAssemblyBegin(j, MAT_FINAL_ASSEMBLY));
    core::check(MatAssemblyEnd(j, MAT_FINAL_ASSEMBLY));
  }
  void parameter_derivative(double, Vec x, Vec, Vec f) override {
    gather(x);
    const core::ReadArray z(whole_.get());
    const core::WriteArray fa(f);
    for_each_point([&](PetscInt i, PetscInt k) {
      const Local p = at(z, i);
      if (which_ == Parameter::length) {
        fa[k] = 2 * du() / length_ * p.u_xx;
        fa[k + 1] = 2 * dv() / length_ * p.v_xx;
      } else {
        const double ends = dv() / a_ * ((i == 0) + (i == cells_ - 2));
        fa[k] = p.u;
        fa[k + 1] = -ends - p.u;
      }
    });
  }
  void scales(Vec state, Vec residual) override {
    core::check(VecSet(state, 1));
    core::check(VecSet(residual, 1));
  }

  /// A disturbed equilibrium, from which the motion tends to the cycle: all states, on every rank.
  [[nodiscard]] Eigen::VectorXd disturbed() const {
    Eigen::VectorXd x(n_);
    for (PetscInt i = 0; i < cells_ - 1; ++i) {
      const double s = std::sin(std::numbers::pi * static_cast<double>(i + 1) / cells_);
      x(2 * i) = a_ + s;
      x(2 * i + 1) = b_ / a_ - 0.5 * s;
    }
    return x;
  }

private:
  struct Local {
    double u, v, u_xx, v_xx;  // second differences without the factor 1/dx^2
  };
  template <class F>
  void for_each_point(F f) const {
    for (PetscInt k = 0; k < local_; k += 2) f(begin_ + k / 2, k);
  }
  [[nodiscard]] Local at(const core::ReadArray& z, PetscInt i) const {
    const PetscInt r = 2 * i;
    const bool first = i == 0, last = i == cells_ - 2;
    const double u = z[r], v = z[r + 1];
    return {u, v, (first ? a_ : z[r - 2]) - 2 * u + (last ? a_ : z[r + 2]),
            (first ? b_ / a_ : z[r - 1]) - 2 * v + (last ? b_ / a_ : z[r + 3])};
  }
  [[nodiscard]] double du() const { return 0.008 * cells_ * cells_ / (length_ * length_); }
  [[nodiscard]] double dv() const { return 0.004 * cells_ * cells_ / (length_ * length_); }
  void gather(Vec x) {
    core::check(VecScatterBegin(scatter_.get(), x, whole_.get(), INSERT_VALUES, SCATTER_FORWARD));
    core::check(VecScatterEnd(scatter_.get(), x, whole_.get(), INSERT_VALUES, SCATTER_FORWARD));
  }

  MPI_Comm comm_;
  PetscInt n_, cells_, begin_ = 0, local_ = 0;
  Parameter which_;
  double a_ = 2, b_ = 5.45, length_ = 1;
  core::Vector x_;
  core::Scatter scatter_;
  core::Vector whole_;
};

}  // namespace whirl::test
