#pragma once
// The linearised machine at complex frequencies: responses, borders, adjoints, and films as transfer functions.

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <complex>
#include <memory>
#include <string>
#include <vector>

#include "whirl/problem/system.hpp"

namespace whirl::solve {

class FrequencyHub;
class FrequencyInverse;
class PortMatrix;
template <class Scalar>
class PartFactors;

/// What a core::NotConverged says where the matrix is singular.
inline constexpr const char* singular_at_frequency =
    "the equations are singular there, as at an undamped resonance: the motion grows without limit";

using ComplexVector = Eigen::VectorXcd;

/// The machine at rest, A = dF/dx + lambda dF/d(dx/dt), after its parts (films, solids) are eliminated:
///
///     [ A_i(lambda)  G_i(lambda) ] [ x_i ]       H_i = F_i A_i^-1 G_i      (forces x ports)
///     [ F_i(lambda)  A_h(lambda) ] [ z   ]       T(lambda) z = (A_h - sum H_i) z = 0
///
/// Rows are scaled by the residuals, columns by the states (System::scales). T is factorised on every rank, as a
/// complex sparse matrix without the kinematic rows q' = v (FrequencyHub). A border is one more row and column of the
/// hub. A machine without parts is its hub.
/// Exact inverses of the parts serve where the system has them. Else, and for adjoints, parts are factorised one by one
/// (core::PencilLu, prefix "parts_"). Where a part has more states than the option -parts_kept_states says and there
/// are approximate inverses, FGMRES around these takes the place of factors; where it does not converge, parts are
/// factorised from then on if the machine has at most -parts_whole_states. Nothing of a part's size is ever dense or
/// gathered but k columns of its states, spread like them, and whole states if they are asked for.
/// All members are collective on the system's communicator unless they say not.
class FrequencyResolvent {
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

  explicit FrequencyResolvent(problem::System& system);
  ~FrequencyResolvent();

  /// Takes the derivatives at x (SI), dx/dt = 0, and the system's parameter.
  void linearise(Vec x);
  /// Factorises A at lambda [1/s], or with columns b and c [size()], whole on every rank, [A b; c^* 0]. Throws
  /// core::NotConverged if it is singular, or A_i of a part is.
  void factorise(Complex lambda, const ComplexVector& b = {}, const ComplexVector& c = {});
  /// A^-1 r and A^-* r (conjugate transpose), scaled and whole on every rank; with a border its entry comes last.
  [[nodiscard]] ComplexVector solve(const ComplexVector& r) { return solve_whole(r, false); }
  [[nodiscard]] ComplexVector solve_adjoint(const ComplexVector& r) { return solve_whole(r, true); }
  /// A^-1 r without a border, of this rank's rows in SI: amplitudes z of x = Re(z exp(lambda t)) under forces r.
  [[nodiscard]] std::vector<Complex> respond(const std::vector<Complex>& r);
  /// dF/d(dx/dt) v, scaled and whole on every rank.
  [[nodiscard]] ComplexVector rates_times(const ComplexVector& v) const;
  /// Number of states. Not collective.
  [[nodiscard]] PetscInt size() const { return system_.size(); }

  /// Ports are known after linearise(). Not collective.
  [[nodiscard]] const std::vector<Ports>& ports() const { return ports_; }
  /// Whether the parts are solved by iterations on their approximate inverses, none of which has failed so far.
  /// Not collective.
  [[nodiscard]] bool iterates() const { return iterated_ != nullptr; }
  /// Number of states of the hub. Not collective.
  [[nodiscard]] PetscInt hub() const { return static_cast<PetscInt>(hub_numbers_.size()); }

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
  [[nodiscard]] MPI_Comm comm() const { return system_.comm(); }

private:
  struct Coupled;
  /// Whether parts are solved by inverses of their own, not as matrices.
  [[nodiscard]] bool eliminates_by_inverse() const { return inverse_ || iterated_; }
  /// Hub, ports and couplings of the layout, once.
  void find_ports();
  /// The hub's a and b of all ranks.
  void gather_hub();
  /// A_i of all parts as matrices, where they are not made yet.
  void assemble() const;
  /// Rows and columns of the border: 1 or 0.
  [[nodiscard]] int border() const { return b_.size() > 0 ? 1 : 0; }
  /// G_i and F_i^* at lambda_ here [local x ports or forces], with the border's.
  [[nodiscard]] Eigen::MatrixXcd motions(const Coupled& part) const;
  [[nodiscard]] Eigen::MatrixXcd forces(const Coupled& part) const;
  /// evaluate() with the border of factorise() among ports and forces.
  [[nodiscard]] Transfers eliminate(Complex lambda, bool slopes);
  /// A_i^-1 G_i, and its slopes, of all parts at once.
  void eliminate_together(bool slopes);
  /// `columns(part)` of all parts below each other, this rank's rows.
  template <class F>
  [[nodiscard]] Eigen::MatrixXcd together(F&& columns) const;
  /// b of the parts times such columns.
  [[nodiscard]] Eigen::MatrixXcd rates_of_parts(const Eigen::MatrixXcd& columns) const;
  /// A_i^-1 of such columns, or A_i^-* by factors. Throws core::NotConverged if the parts are singular or iterations
  /// end before the tolerance.
  [[nodiscard]] Eigen::MatrixXcd solve_parts(const Eigen::MatrixXcd& right, bool adjoint);
  /// This rank's rows of A^-1 r or A^-* r; `corner` is the border's entry of both.
  [[nodiscard]] ComplexVector solve_here(const ComplexVector& r, Complex& corner, bool adjoint);
  [[nodiscard]] ComplexVector solve_whole(const ComplexVector& r, bool adjoint);
  /// Gathers a state of which every rank has its own rows.
  [[nodiscard]] ComplexVector whole(const ComplexVector& local) const;

  problem::System& system_;
  std::unique_ptr<problem::PartInverse> inverse_;  // an exact one, or null
  std::unique_ptr<FrequencyInverse> iterated_;     // in its place where inverses are approximate
  std::unique_ptr<PartFactors<Complex>> factors_;  // where there is neither, and for adjoints
  bool factorised_ = false;                        // at lambda_
  core::Vector x_, rest_, state_scale_, row_scale_;
  PetscInt begin_ = 0;  // first row of this rank
  problem::Entries entries_;
  core::Matrix jacobian_;                        // of a system that lists no entries
  std::unique_ptr<PortMatrix> at_rest_, rates_;  // a and b, scaled
  std::vector<std::size_t> hub_places_;          // places of this rank's hub entries in a and b
  std::vector<std::unique_ptr<Coupled>> parts_;
  std::vector<Ports> ports_;
  std::vector<PetscInt> hub_numbers_;  // of the hub's states among all
  std::unique_ptr<FrequencyHub> hub_;
  std::vector<double> hub_scale_, hub_row_scale_;
  Complex lambda_;
  ComplexVector b_, c_;  // the border
};

}  // namespace whirl::solve
