#pragma once
// Films with states as transfer functions between the hub's motions and the forces on it.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "whirl/problem/system.hpp"

namespace whirl::solve {

class FrequencyInverse;

/// The linearised machine at rest, dF/dx + lambda dF/d(dx/dt), after its parts (films, solids) are eliminated:
///
///     [ A_i(lambda)  G_i(lambda) ] [ x_i ]       H_i = F_i A_i^-1 G_i      (forces x ports)
///     [ F_i(lambda)  A_h(lambda) ] [ z   ]       T(lambda) z = (A_h - sum H_i) z = 0
///
/// Rows are scaled by the residuals, columns by the states (System::scales). One factorisation of A_i in real form
/// (twice the states; KSP with prefix "parts_", MUMPS) and one solve with k columns give H_i at one lambda, as many
/// more its derivative. Exact inverses of the parts take the place of the factorisation. Approximate ones do so too,
/// with FGMRES around them, where a part has more states than the option -parts_kept_states says; where FGMRES does not
/// converge, parts are factorised from then on if the machine has at most -parts_whole_states. Parts are taken one by
/// one; nothing of a part's size is ever dense or gathered but k columns of its states, spread like them, and mode
/// shapes if they are asked for. All members are collective on the system's communicator unless they say not.
class TransferFunction {
public:
  using Complex = std::complex<double>;
  using Sparse = Eigen::SparseMatrix<Complex>;

  /// What one part sees of the hub and where it acts on it: columns and rows of T, in rising order.
  struct Ports {
    std::string name;
    std::vector<PetscInt> seen, forces;
  };
  /// H_i and its derivative [forces x seen]; the derivative is empty if it was not asked for.
  struct Block {
    Eigen::MatrixXcd value, slope;
  };
  using Transfers = std::vector<Block>;
  /// An eigenvalue of a part whose ports are held.
  struct Pole {
    Complex value;
    bool silent = false;         ///< its motion exerts no force on the hub: an eigenvalue of the machine too
    std::vector<Complex> shape;  ///< of a silent one: this rank's states of the part
  };

  /// Throws core::Bug for a system without parts.
  explicit TransferFunction(problem::System& system);
  ~TransferFunction();

  /// Takes the derivatives at x (SI), dx/dt = 0, and the system's parameter.
  void linearise(Vec x);
  /// Ports are known after linearise(). Not collective.
  [[nodiscard]] const std::vector<Ports>& ports() const { return ports_; }
  /// Whether the parts are solved by iterations on their approximate inverses, none of which has failed so far.
  /// Not collective.
  [[nodiscard]] bool iterates() const { return iterated_ != nullptr; }
  /// Number of states of the hub. Not collective.
  [[nodiscard]] PetscInt hub() const { return hub_; }

  /// H of every part at lambda [1/s], the same on every rank. Throws core::NotConverged at an eigenvalue of a part.
  [[nodiscard]] Transfers evaluate(Complex lambda, bool slopes);
  /// T(lambda), or with `slope` dT/dlambda, from what evaluate() gave there [hub x hub]. Not collective.
  [[nodiscard]] Sparse matrix(Complex lambda, const Transfers& parts, bool slope) const;
  /// |A| + |lambda| |B| + |H| in the norm of Frobenius, of what T(lambda) is made of. Not collective.
  [[nodiscard]] double magnitude(Complex lambda, const Transfers& parts) const;
  /// What part i does at lambda to rows `forces` of the hub where its states `positions` move with rates `rates`, in
  /// SI: dF/d(position) + lambda dF/d(rate) [forces x positions], from what evaluate() gave there. Not collective.
  [[nodiscard]] Eigen::MatrixXcd from_motion(std::size_t i, const Block& part, Complex lambda,
                                             const std::vector<PetscInt>& positions, const std::vector<PetscInt>& rates,
                                             const std::vector<PetscInt>& forces) const;
  /// The whole state that belongs to the motion z of the hub [hub], scaled, on every rank: exact where evaluate() was
  /// called last, or in first order a step `ahead` of there if it gave slopes.
  [[nodiscard]] std::vector<Complex> state(const Eigen::VectorXcd& z, Complex ahead = 0) const;

  /// The whole state with the given states of part i and nothing else, scaled, on every rank.
  [[nodiscard]] std::vector<Complex> state(std::size_t i, const std::vector<Complex>& shape) const;

  /// Eigenvalues of part i with held ports within `radius` of the real `target` [1/s], both of each pair.
  /// Throws core::NotConverged.
  [[nodiscard]] std::vector<Pole> poles(std::size_t i, double target, double radius) const;
  /// Number of states of part i over all ranks. Not collective.
  [[nodiscard]] PetscInt states(std::size_t i) const;
  [[nodiscard]] MPI_Comm comm() const { return system_.comm(); }

private:
  struct Coupled;
  /// Whether parts are solved by inverses of their own, not as matrices.
  [[nodiscard]] bool eliminates_by_inverse() const { return inverse_ || iterated_; }
  /// Columns of all parts below each other, `columns(part)` being those of a part [local x ports].
  template <class F>
  [[nodiscard]] Eigen::MatrixXcd together(F&& columns) const;
  /// A_i^-1 of such columns of all parts at once, by their own inverses set at a frequency; `to` takes the answers.
  /// Throws core::NotConverged if the parts are singular or iterations end before the tolerance.
  void solve_together(const Eigen::MatrixXcd& right, Eigen::MatrixXcd Coupled::*to);
  /// Couplings of hub and parts and the hub by itself from the system's list of entries; false if it has none.
  bool take_entries();
  struct Listed;
  /// The same from assembled Jacobians.
  void take_assembled();
  /// A_i of all parts as matrices, where they are not made yet.
  void assemble() const;
  /// Factorises a part by a direct solver.
  void factorise(Coupled& part, Complex lambda, PetscInt columns) const;
  /// Gathers a state of which every rank has its own rows.
  [[nodiscard]] std::vector<Complex> whole(const std::vector<Complex>& local) const;
  problem::System& system_;
  std::unique_ptr<problem::PartInverse> inverse_;  // an exact one, or null
  std::unique_ptr<FrequencyInverse> iterated_;     // in its place where inverses are approximate
  core::Vector x_, rest_, state_scale_, row_scale_;
  mutable core::Matrix jx_, jd_;  // where A_i are wanted as matrices
  problem::Entries entries_;
  std::vector<std::unique_ptr<Coupled>> parts_;
  std::vector<Ports> ports_;
  core::IndexSet hub_rows_;
  PetscInt hub_ = 0;
  std::vector<PetscInt> hub_numbers_;          // of the hub's states among all
  Eigen::SparseMatrix<double> a_hub_, b_hub_;  // whole on every rank
  std::vector<double> hub_scale_, hub_row_scale_;
};

}  // namespace whirl::solve
