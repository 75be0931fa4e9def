#include <Eigen/LU>
#include <algorithm>

#include "solve/dominant_subspace.hpp"
#include "whirl/core/gate.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/solve/composition.hpp"
#include "whirl/spectral/eigenvalues.hpp"

// The small system of a cycle by GMRES: a product with M is one sweep of a state over all intervals, from rank to rank.
// It is preconditioned by the answer for M ~ (M V) V^T with V a basis of the dominant invariant subspace, found with
// the multipliers of the last point: what is left of M is contracted by each turn.
//
//     [ I - M V V^T   -Theta     ] [ x_0 ]         x_0 = t + M V z + Theta d,  z = V^T x_0:
//     [ K V V^T       D + corner ] [ d   ]         [ I - V^T M V   -V^T Theta ] [ z ]   [ V^T t ]
//                                                  [ K V           D + corner ] [ d ] = [ y_c   ]
//
// The small vectors live on the last rank, where a turn ends; the intervals are factorised on all ranks at once, the
// sweeps go through the ranks in turn.

namespace whirl::solve {
namespace {

using core::check;
using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Up to here all multipliers can be had from the dense matrix where a search for the dominant ones fails.
constexpr Index whole_up_to = 1000;

class SweepComposition final : public Composition {
public:
  void compose(const Run& run) override;
  void solve(const double* rhs, VectorXd& border, double* x) override;
  bool has_transpose() const override { return false; }
  void solve_transposed(const double*, VectorXd&, double*) override {
    core::require(false, "sweeps have no transposed solve");
  }
  std::vector<std::complex<double>> multipliers() override;
  VectorXd critical_start(double mu) override;
  MatrixXd monodromy() override;
  VectorXd entering(const VectorXd& v) override;

private:
  [[nodiscard]] bool last() const { return rank_ == size_ - 1; }
  [[nodiscard]] Index local() const { return last() ? run_->n : 0; }
  void set_up(const Run& run);
  // Waits for the state that leaves the previous rank; the first one takes what the last rank gives.
  void enter(double* state, Index count) const;
  void leave(const double* state, Index count) const;
  // Once around: `state` [n x columns] and the rows' sums [nb x columns] are read and left on the last rank. With
  // `loaded` the last nb columns bear the load of the border.
  void turn(MatrixXd& state, MatrixXd& added, bool loaded) const;
  void prepare();
  void precondition(VectorXd& v) const;
  [[nodiscard]] static SweepComposition& of(void* raw) { return *static_cast<SweepComposition*>(raw); }
  static PetscErrorCode multiply(Mat m, Vec v, Vec y);
  static PetscErrorCode apply(PC pc, Vec v, Vec y);

  const Run* run_ = nullptr;
  int rank_ = 0, size_ = 1;
  std::vector<MatrixXd> loads_;  // A_i^-1 columns_i
  // On the last rank.
  MatrixXd basis_, image_, basis_added_;  // V, M V [n x p], K V [nb x p]
  MatrixXd ends_, ends_added_;            // Theta [n x nb], D + corner [nb x nb]
  Eigen::PartialPivLU<MatrixXd> small_;
  double radius_ = 0.2;  // multipliers above it are found
  bool found_ = false;   // the last search for multipliers left its basis
  core::Matrix shell_;
  core::Vector right_, answer_;
  core::LinearSolver solver_;
  core::Gate gate_{MPI_COMM_SELF};
};

void SweepComposition::enter(double* state, Index count) const {
  if (size_ == 1) return;
  MPI_Recv(state, static_cast<int>(count), MPI_DOUBLE, (rank_ + size_ - 1) % size_, 0, run_->comm, MPI_STATUS_IGNORE);
}

void SweepComposition::leave(const double* state, Index count) const {
  if (size_ == 1) return;
  MPI_Send(state, static_cast<int>(count), MPI_DOUBLE, (rank_ + 1) % size_, 0, run_->comm);
}

void SweepComposition::turn(MatrixXd& state, MatrixXd& added, bool loaded) const {
  const Index n = run_->n, nb = run_->borders, columns = state.cols();
  added = MatrixXd::Zero(nb, columns);
  MatrixXd moved(n + nb, columns);
  // The last rank's message to the first begins the turn.
  if (last()) {
    moved << state, added;
    leave(moved.data(), moved.size());
  }
  if (size_ > 1) {
    enter(moved.data(), moved.size());
    state = moved.topRows(n);
    added = moved.bottomRows(nb);
  }
  for (std::size_t i = 0; i < run_->intervals.size(); ++i) {
    run_->intervals[i]->carry(run_->rows[i], state, added);
    if (!loaded) continue;
    state.rightCols(nb) -= loads_[i].bottomRows(n);
    added.rightCols(nb).noalias() -= run_->rows[i] * loads_[i];
  }
  if (!last()) {
    moved << state, added;
    leave(moved.data(), moved.size());
  }
}

PetscErrorCode SweepComposition::multiply(Mat m, Vec v, Vec y) {
  void* raw = nullptr;
  PetscCall(MatShellGetContext(m, &raw));
  SweepComposition& c = of(raw);
  return c.gate_.run([&] {
    const Index n = c.run_->n, nb = c.run_->borders;
    MatrixXd state = MatrixXd::Zero(n, 1), added;
    VectorXd x;
    {
      const core::ReadArray a(v);
      if (c.last()) state = (x = Map<const VectorXd>(a.data(), n + nb)).head(n);
    }
    c.turn(state, added, false);
    const core::WriteArray out(y);
    if (!c.last()) return;
    Map<VectorXd> answer(out.data(), n + nb);
    answer.head(n) = x.head(n) - state - c.ends_ * x.tail(nb);
    answer.tail(nb) = added + c.ends_added_ * x.tail(nb);
  });
}

void SweepComposition::precondition(VectorXd& v) const {
  const Index n = run_->n, nb = run_->borders, p = basis_.cols();
  VectorXd z(p + nb);
  z << basis_.transpose() * v.head(n), v.tail(nb);
  z = small_.solve(z).eval();
  v.head(n) += image_ * z.head(p) + ends_ * z.tail(nb);
  v.tail(nb) = z.tail(nb);
}

PetscErrorCode SweepComposition::apply(PC pc, Vec v, Vec y) {
  void* raw = nullptr;
  PetscCall(PCShellGetContext(pc, &raw));
  const SweepComposition& c = of(raw);
  return of(raw).gate_.run([&] {
    const core::ReadArray in(v);
    const core::WriteArray out(y);
    if (!c.last()) return;
    VectorXd x = Map<const VectorXd>(in.data(), in.size());
    c.precondition(x);
    Map<VectorXd>(out.data(), out.size()) = x;
  });
}

void SweepComposition::set_up(const Run& run) {
  rank_ = core::rank_of(run.comm);
  size_ = core::size_of(run.comm);
  const auto size = static_cast<PetscInt>(run.n + run.borders), mine = last() ? size : 0;
  right_ = core::make_vector(run.comm, mine, size);
  answer_ = core::duplicate(right_.get());
  check(MatCreateShell(run.comm, mine, mine, size, size, this, shell_.put()));
  check(MatShellSetOperation(shell_.get(), MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
  check(KSPCreate(run.comm, solver_.put()));
  check(KSPSetOptionsPrefix(solver_.get(), "turn_"));
  check(KSPSetOperators(solver_.get(), shell_.get(), shell_.get()));
  check(KSPSetType(solver_.get(), KSPGMRES));
  check(KSPSetPCSide(solver_.get(), PC_RIGHT));
  check(KSPGMRESSetRestart(solver_.get(), 100));
  // Its error is made good by the iteration around this composition.
  check(KSPSetTolerances(solver_.get(), 1e-10, 1e-300, PETSC_DEFAULT, 300));
  PC pc = nullptr;
  check(KSPGetPC(solver_.get(), &pc));
  check(PCSetType(pc, PCSHELL));
  check(PCShellSetContext(pc, this));
  check(PCShellSetApply(pc, apply));
  check(KSPSetFromOptions(solver_.get()));
  gate_ = core::Gate(run.comm);
  basis_.resize(local(), 0);
}

void SweepComposition::compose(const Run& run) {
  run_ = &run;
  if (!solver_) set_up(run);
  loads_.resize(run.intervals.size());
  for (std::size_t i = 0; i < run.intervals.size(); ++i) {
    loads_[i] = run.columns[i];
    run.intervals[i]->solve(loads_[i]);
  }
  prepare();
}

// Everything of the preconditioner, by one turn of the basis and the border together.
void SweepComposition::prepare() {
  const Index n = run_->n, nb = run_->borders, p = basis_.cols();
  MatrixXd state = MatrixXd::Zero(n, p + nb), added;
  if (last()) state.leftCols(p) = basis_;
  turn(state, added, true);
  if (!last()) return;
  image_ = state.leftCols(p);
  basis_added_ = added.leftCols(p);
  ends_ = state.rightCols(nb);
  ends_added_ = added.rightCols(nb) + run_->corner;
  MatrixXd small(p + nb, p + nb);
  small.topRows(p) = MatrixXd::Identity(p, p + nb) - basis_.transpose() * state;
  small.bottomRows(nb) << basis_added_, ends_added_;
  small_.compute(small);
}

void SweepComposition::solve(const double* rhs, VectorXd& border, double* x) {
  const Index n = run_->n, nb = run_->borders;
  // Forward: the motion that the right-hand side alone drives.
  VectorXd state = VectorXd::Zero(n), added = VectorXd::Zero(nb);
  if (rank_ > 0) enter(state.data(), n);
  state = run_->drive(rhs, state, nullptr, nullptr, added);
  if (!last()) leave(state.data(), n);
  MPI_Allreduce(MPI_IN_PLACE, added.data(), static_cast<int>(nb), MPI_DOUBLE, MPI_SUM, run_->comm);
  {
    const core::WriteArray a(right_.get());
    if (last()) Map<VectorXd>(a.data(), n + nb) << state, border - added;
  }
  gate_.rethrow(KSPSolve(solver_.get(), right_.get(), answer_.get()));
  {
    const core::ReadArray a(answer_.get());
    if (last()) {
      state = Map<const VectorXd>(a.data(), n);
      border = Map<const VectorXd>(a.data() + n, nb);
    }
  }
  MPI_Bcast(border.data(), static_cast<int>(nb), MPI_DOUBLE, size_ - 1, run_->comm);
  // Back: from the start and the border.
  if (last()) leave(state.data(), n);
  enter(state.data(), n);
  state = run_->drive(rhs, state, &border, x, added);
  if (!last()) leave(state.data(), n);
}

std::vector<std::complex<double>> SweepComposition::multipliers() {
  const Index n = run_->n;
  core::Vector first = core::make_vector(run_->comm, static_cast<PetscInt>(local()), static_cast<PetscInt>(n));
  {
    const core::WriteArray a(first.get());
    for (PetscInt k = 0; k < a.size(); ++k)
      a[k] = basis_.cols() > 0 ? basis_.row(k).sum() : 1 + std::sin(0.7 * static_cast<double>(k));
  }
  const auto times_m = [this](Vec v) {
    MatrixXd state = MatrixXd::Zero(run_->n, 1), added;
    {
      const core::ReadArray a(v);
      if (last()) state = Map<const VectorXd>(a.data(), run_->n);
    }
    turn(state, added, false);
    const core::WriteArray a(v);
    if (last()) Map<VectorXd>(a.data(), run_->n) = state.col(0);
  };
  SubspaceOptions options;
  options.guess = std::max(4, static_cast<int>(basis_.cols()) + 1);
  options.most = 24;
  options.restarts = 20;
  // From the last point's subspace a few vectors do: what is left of M falls by orders of magnitude.
  if (basis_.cols() > 0) options.spare = 4;
  DominantSubspace found;
  for (bool done = false; !done;) {
    options.radius = radius_;
    try {
      found = dominant_subspace(times_m, first.get(), options);
      done = true;
    } catch (const core::NotConverged&) {
      // Films on soft liners at high speed have a dense band of multipliers, as have stiff films at Gauss points: it
      // takes no part in what the cycle does, and is left below a larger radius from here on.
      if (radius_ < 0.5) {
        radius_ = 0.5;
      } else if (n > whole_up_to) {
        throw;
      } else {
        found_ = false;
        return spectral::eigenvalues(monodromy());
      }
    }
  }
  found_ = true;
  basis_ = std::move(found.basis);
  prepare();
  return found.values;
}

// The Ritz vector of V^T M V, which the invariant subspace makes an eigenvector.
VectorXd SweepComposition::critical_start(double mu) {
  (void)multipliers();
  const MatrixXd whole = found_ ? MatrixXd() : monodromy();
  VectorXd v = VectorXd::Zero(run_->n);
  if (last()) {
    const MatrixXd projected = found_ ? MatrixXd(basis_.transpose() * image_) : whole;
    const Index p = projected.rows();
    const Eigen::PartialPivLU<MatrixXd> lu(projected - mu * (1 + 1e-10) * MatrixXd::Identity(p, p));
    VectorXd z = VectorXd::Ones(p);
    for (int k = 0; k < 4; ++k) z = lu.solve(z).normalized();
    v = found_ ? VectorXd(basis_ * z) : z;
  }
  MPI_Bcast(v.data(), static_cast<int>(v.size()), MPI_DOUBLE, size_ - 1, run_->comm);
  return v;
}

MatrixXd SweepComposition::monodromy() {
  MatrixXd m = MatrixXd::Identity(run_->n, run_->n), added;
  turn(m, added, false);
  MPI_Bcast(m.data(), static_cast<int>(m.size()), MPI_DOUBLE, size_ - 1, run_->comm);
  return m;
}

VectorXd SweepComposition::entering(const VectorXd& v) {
  MatrixXd state = v, added = MatrixXd::Zero(run_->borders, 1);
  if (rank_ > 0) enter(state.data(), state.size());
  const VectorXd here = state;
  run_->carry(state, added);
  if (!last()) leave(state.data(), state.size());
  return here;
}

}  // namespace

std::unique_ptr<Composition> make_sweep_composition() {
  return std::make_unique<SweepComposition>();
}

}  // namespace whirl::solve
