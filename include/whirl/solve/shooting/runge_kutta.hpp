#pragma once
// One Runge-Kutta step on F(angle, x, dx/dt) = 0 with its exact derivatives, however its stages are solved.

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <vector>

#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/shooting/tableau.hpp"

namespace whirl::solve {

/// Stages that are solved together: one of a sequential scheme, all m of a coupled one.
struct StageGroup {
  Eigen::VectorXd angle;  ///< [m]
  Eigen::MatrixXd own;    ///< H a(j,l) [m x m]
  /// Matrices of thin stages leave out what the journals' motion does to forces and films.
  bool lagging = false;
  [[nodiscard]] bool is_explicit() const { return own.isZero(0); }
};

/// What the matrix dF/d(dx/dt) + own dF/dx of a single stage belongs to, beside its point.
struct StepOf {
  double own = 0, parameter = 0;
  /// Whether factors of this serve for the other one.
  [[nodiscard]] bool is_near(const StepOf& other) const {
    return std::abs(other.own - own) <= 0.1 * std::abs(own) &&
           std::abs(other.parameter - parameter) <= 0.05 * std::abs(parameter);
  }
  /// By how much of an error at most they are off then: with A = L1 + own L0 and A_f of these, A_f^-1 A - 1 =
  /// (own/own_f - 1) (1 - A_f^-1 L1), whose second factor is near one along stiff directions, zero along soft ones; the
  /// part of L0 that goes with the speed is off by its ratio likewise. Films' own states apart.
  [[nodiscard]] double mismatch(const StepOf& other) const {
    return std::abs(other.own / own - 1) +
           (other.parameter == parameter ? 0 : std::abs(other.parameter / parameter - 1));
  }
};

/// F(angle_j, x_j, k_j) = 0 of such stages, x_j = base_j + sum_l own(j,l) k_l, and its derivative. Vectors are this
/// rank's scaled rows, x, k and f are [n x m]. Collective.
class Stage {
public:
  using In = const Eigen::Ref<const Eigen::MatrixXd>&;
  using Out = Eigen::Ref<Eigen::MatrixXd>;
  virtual ~Stage() = default;
  /// With `ready` factorise() follows.
  virtual void residual(const StageGroup& group, In x, In k, Out f, bool ready) = 0;
  /// Makes ready for solve() at the point of the last residual().
  virtual void factorise(const StageGroup& group, In x, In k) = 0;
  /// f := (dF/d(dx/dt) + own dF/dx)^-1 f, to the relative residual `tolerance` where it iterates; 1: as good as chords
  /// want.
  virtual void solve(Out f, double tolerance) = 0;
  /// Keeps the derivative at the stages that were found, for slopes(), and makes ready for solve() there.
  virtual void keep(const StageGroup& group, In x, In k) = 0;
  /// The dk of dF/dx (w + own dk) + dF/d(dx/dt) dk = 0 for each column of w; with `loaded` + dF/dp for the last. Both
  /// are [n m x columns], stage below stage.
  virtual void slopes(In w, bool loaded, Out dk) = 0;
  /// Step and parameter of the factors that solve() stands on; `asked` are those of the last factorise().
  [[nodiscard]] virtual StepOf factors(StepOf asked) const { return asked; }
};

/// One way to solve stages.
class Stages {
public:
  virtual ~Stages() = default;
  [[nodiscard]] virtual std::unique_ptr<Stage> make() = 0;
  [[nodiscard]] virtual MPI_Comm comm() const { return PETSC_COMM_SELF; }
  /// To be called after each change of the system's parameter.
  virtual void refresh() {}
  virtual void begin_step() {}
  /// Factors stay while every correction is at most a fifth of the last one.
  [[nodiscard]] virtual bool by_chords() const { return false; }
  /// The last correction, relative to 1 + |x|.
  [[nodiscard]] virtual double tolerance() const { return 1e-9; }
  /// A step makes its derivative on the way, so that both are best taken together.
  [[nodiscard]] virtual bool derivative_is_free() const { return false; }
  [[nodiscard]] long factorisations() const { return factorisations_; }

protected:
  long factorisations_ = 0;
};

/// By dense matrices; the only one for coupled stages. `point` outlives it, and its owner refreshes it.
[[nodiscard]] std::unique_ptr<Stages> dense_stages(problem::ScaledPoint& point);
/// By the structure of a system whose dF/d(dx/dt) depends on nothing but the parameter; null where it tells none or has
/// many coordinates beside its films' states.
[[nodiscard]] std::unique_ptr<Stages> structured_stages(problem::System& system, const Tableau& tableau);
/// By elimination of what hardly changes from step to step, for a system on one rank that tells its structure: the
/// factors of its linear part and of its films' states are kept for many points.
[[nodiscard]] std::unique_ptr<Stages> thin_stages(problem::System& system);
/// Sparse, on system.comm(): by elimination of the parts of a system that has some, else by LU, or one pass over dF/dx
/// where dF/d(dx/dt) of an explicit stage is inverted entry by entry. With `constant_rates`, dF/d(dx/dt) depends on
/// nothing but the parameter; with `whole`, matrices are factorised by MUMPS as they are, to serve many stages.
[[nodiscard]] std::unique_ptr<Stages> sparse_stages(problem::System& system, bool constant_rates, bool whole = false);
/// By structure where the rates are constant and the system tells it, else dense at `point`, or sparse if that is null.
[[nodiscard]] std::unique_ptr<Stages> choose_stages(problem::System& system, const Tableau& tableau,
                                                    bool constant_rates, problem::ScaledPoint* point);

/// The dk_j of all stages [n s x columns] that changes v [n x columns] of x_0 cause, `together` stages after the other:
/// slopes(first, w, dk_first) finds those from `first` on with w_j = v + H sum_(l < first) a(j,l) dk_l [n together x
/// columns].
template <class Slopes>
void carry_stages(const Tableau& t, Eigen::Index together, double length, const Eigen::MatrixXd& v, Eigen::MatrixXd& w,
                  Eigen::MatrixXd& dk, const Slopes& slopes) {
  using Eigen::Index;
  const Index n = v.rows();
  w.resize(n * together, v.cols());
  dk.resize(n * t.stages(), v.cols());
  for (Index first = 0; first < t.stages(); first += together) {
    for (Index j = 0; j < together; ++j) {
      auto own = w.middleRows(j * n, n);
      own = v;
      for (Index l = 0; l < first; ++l)
        if (t.a(first + j, l) != 0) own += length * t.a(first + j, l) * dk.middleRows(l * n, n);
    }
    slopes(first, w, dk.middleRows(first * n, together * n));
  }
}

class RungeKutta;

/// The derivative of one step at the point where it was taken: products only, no matrix of size n x n is formed.
class StepDerivative {
public:
  /// v := G v for each column of v [n x columns], G = d phi/dx_0. Collective.
  void carry(Eigen::MatrixXd& v) const;
  /// d phi/dH at fixed angles and d phi/dp [n].
  [[nodiscard]] const Eigen::VectorXd& d_length() const { return d_length_; }
  [[nodiscard]] const Eigen::VectorXd& d_parameter() const { return d_parameter_; }

private:
  friend class RungeKutta;
  /// v += H sum_j b_j dk_j; `lifts` [n x stages], if not null, are added to the first column of v in the stages, dF/dp
  /// with `loaded` to the equations of the last.
  void change(Eigen::MatrixXd& v, const Eigen::MatrixXd* lifts, bool loaded) const;
  RungeKutta* scheme_ = nullptr;
  double length_ = 0;
  std::vector<std::unique_ptr<Stage>> stages_;  // one for each group
  Eigen::VectorXd d_length_, d_parameter_;
};

/// x_1 = phi(x_0; H, p), in scaled states.
class RungeKutta {
public:
  /// Without `by_length`, derivatives need not know d phi/dH.
  RungeKutta(std::unique_ptr<Stages> stages, Tableau tableau, bool by_length = true);
  [[nodiscard]] const Tableau& tableau() const { return tableau_; }
  [[nodiscard]] Stages& stages() const { return *stages_; }

  /// Carries x [n] over one step of `length` H [s] in which the shaft turns by `d_angle`; fills `derivative` if not
  /// null.
  ///
  /// These are the derivatives of the discrete map itself, not of the flow: G_i = I + dt dg/du and m b_T = g + dt
  /// dg/d(dt) in the notation of van de Vrande (2001), Sec. 3.1, with the errata of the stage chain. Collective; throws
  /// core::DomainError, on all ranks, if a stage leaves the validity of a film or its equation is not solved.
  void step(double angle, double d_angle, double length, Eigen::VectorXd& x, StepDerivative* derivative);
  /// dx/dt of F(angle, x, dx/dt) = 0 [n].
  [[nodiscard]] Eigen::VectorXd rate(double angle, const Eigen::VectorXd& x);

private:
  friend class StepDerivative;
  /// x_ of group_, base_ and k_.
  void place();
  /// group_, base_, k_: k_ from the guess that it holds.
  void find(Stage& stage);
  [[nodiscard]] double largest(const Eigen::MatrixXd& v) const;
  std::unique_ptr<Stages> stages_;
  Tableau tableau_;
  Eigen::Index together_;  // stages in a group
  bool by_length_, shared_;
  StepDerivative unused_;  // of steps whose derivative nobody asks for
  StageGroup group_;
  Eigen::MatrixXd base_, x_, k_, f_, slopes_;  // work space: of a group, and K [n x stages]
  Eigen::MatrixXd lifts_, changes_, w_, dk_;   // and of derivatives [n stages x columns]
};

}  // namespace whirl::solve
