#include "whirl/film/algebra/direct_inverse.hpp"

#include <algorithm>
#include <complex>
#include <numeric>
#include <optional>

#include "whirl/core/index.hpp"
#include "whirl/core/pencil_lu.hpp"

namespace whirl::film {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

/// Arrays of which each rank has a piece, of the same length each time.
class Pieces {
public:
  /// Collective, as all().
  Pieces(MPI_Comm comm, std::size_t here) : comm_(comm), counts_(core::at(core::size_of(comm))) {
    const auto own = static_cast<int>(here);
    MPI_Allgather(&own, 1, MPI_INT, counts_.data(), 1, MPI_INT, comm);
  }
  [[nodiscard]] const std::vector<int>& counts() const { return counts_; }
  /// All pieces one behind the other, `times` as long.
  template <class T>
  [[nodiscard]] std::vector<T> all(std::span<const T> here, int times = 1) const {
    const int size = times * static_cast<int>(sizeof(T));
    std::vector<int> bytes, begins(1, 0);
    for (const int n : counts_) {
      bytes.push_back(size * n);
      begins.push_back(begins.back() + bytes.back());
    }
    std::vector<T> out(static_cast<std::size_t>(begins.back()) / sizeof(T));
    MPI_Allgatherv(here.data(), static_cast<int>(here.size_bytes()), MPI_BYTE, out.data(), bytes.data(), begins.data(),
                   MPI_BYTE, comm_);
    return out;
  }

private:
  MPI_Comm comm_;
  std::vector<int> counts_;
};

/// Keeps what its factors are made from: those of a complex frequency are made when first wanted.
class DirectInverse final : public ExactStateInverse {
public:
  DirectInverse(MPI_Comm comm, const Share& share);
  void set(const StateDerivatives& at, double alpha, double sigma) override { set_factors(real_, at, alpha, sigma); }
  void apply(std::span<const double> r, std::span<double> x) override { solve(*real_, false, r, x); }
  void apply_transposed(std::span<const double> r, std::span<double> x) override { solve(*real_, true, r, x); }
  void set_at(const StateDerivatives& at, Complex lambda) override { set_factors(complex_, at, 1.0, lambda); }
  void apply_at(std::span<const Complex> r, std::span<Complex> x) override { solve(*complex_, false, r, x); }

private:
  using Entries = std::vector<core::PencilPlace>;
  template <class Scalar>
  using Factors = core::PencilLu<Scalar>;
  template <class Scalar>
  void set_factors(std::optional<Factors<Scalar>>& factors, const StateDerivatives& at, double alpha, Scalar sigma);
  template <class Scalar>
  void solve(Factors<Scalar>& factors, bool adjoint, std::span<const Scalar> r, std::span<Scalar> x) const;

  MPI_Comm comm_;
  int begin_, rows_, all_;  // first row here, their number, and that of the film
  bool gathers_ = false;
  Entries states_, rates_;  // here, or where all are gathered of all ranks
  Pieces of_rows_, of_states_, of_rates_;
  std::optional<Factors<double>> real_;
  std::optional<Factors<Complex>> complex_;
};

DirectInverse::DirectInverse(MPI_Comm comm, const Share& share)
    : comm_(comm),
      begin_(share.begin),
      rows_(share.rows()),
      of_rows_(comm, core::at(rows_)),
      of_states_(comm, share.d_states.size()),
      of_rates_(comm, share.d_rates.size()) {
  constexpr double most_gathered = 5e7;  // numbers in a band, 800 MB of factors on each rank
  all_ = std::accumulate(of_rows_.counts().begin(), of_rows_.counts().end(), 0);
  int width = 0;
  for (const auto& [places, to] : {std::pair{&share.d_states, &states_}, std::pair{&share.d_rates, &rates_}})
    for_entries(share, *places, {}, [&, to = to](int row, int state, double) {
      to->push_back({begin_ + row, state});
      width = std::max(width, std::abs(begin_ + row - state));
    });
  if (core::size_of(comm) == 1) return;
  MPI_Allreduce(MPI_IN_PLACE, &width, 1, MPI_INT, MPI_MAX, comm);
  gathers_ = core::BandLu::pays(all_, width) && static_cast<double>(all_) * width <= most_gathered;
  if (!gathers_) return;
  for (const auto& [places, pieces] : {std::pair{&states_, &of_states_}, std::pair{&rates_, &of_rates_}})
    *places = pieces->all(std::span<const core::PencilPlace>(*places));
}

template <class Scalar>
void DirectInverse::set_factors(std::optional<Factors<Scalar>>& factors, const StateDerivatives& at, double alpha,
                                Scalar sigma) {
  if (!factors) factors.emplace(gathers_ ? PETSC_COMM_SELF : comm_, gathers_ ? all_ : rows_, states_, rates_);
  if (gathers_)
    factors->set(of_states_.all(at.states), of_rates_.all(at.rates), alpha, sigma);
  else
    factors->set(at.states, at.rates, alpha, sigma);
}

// Columns stand one behind the other within the piece of each rank.
template <class Scalar>
void DirectInverse::solve(Factors<Scalar>& factors, bool adjoint, std::span<const Scalar> r,
                          std::span<Scalar> x) const {
  if (!gathers_) return factors.solve(adjoint, r, x);
  using Columns = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  const auto columns = static_cast<int>(r.size()) / rows_;
  const std::vector<Scalar> pieces = of_rows_.all(r, columns);
  Columns right(all_, columns), found(all_, columns);
  Index first = 0;
  for (const Index n : of_rows_.counts()) {
    right.middleRows(first, n) = Eigen::Map<const Columns>(pieces.data() + first * columns, n, columns);
    first += n;
  }
  factors.solve(adjoint, std::span<const Scalar>(core::span_of(right)), core::span_of(found));
  Eigen::Map<Columns>(x.data(), rows_, columns) = found.middleRows(begin_, rows_);
}

}  // namespace

std::unique_ptr<StateInverse> make_direct_inverse(MPI_Comm comm, const Share& share) {
  return std::make_unique<DirectInverse>(comm, share);
}

}  // namespace whirl::film
