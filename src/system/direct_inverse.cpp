#include "direct_inverse.hpp"

#include <complex>
#include <optional>

#include "whirl/core/pencil_lu.hpp"

namespace whirl::system {
namespace {

using Complex = std::complex<double>;

template <class Scalar>
core::PencilLu<Scalar> make_factors(MPI_Comm comm, const film::Share& share) {
  using Place = typename core::PencilLu<Scalar>::Place;
  const auto places = [&](const film::Places& of) {
    std::vector<Place> out;
    film::for_entries(share, of, {}, [&](int row, int state, double) { out.push_back({share.begin + row, state}); });
    return out;
  };
  return {comm, share.rows(), places(share.d_states), places(share.d_rates)};
}

/// Keeps what its factors are made from: those of a complex frequency are made when first wanted.
class DirectInverse final : public film::ExactStateInverse {
public:
  DirectInverse(MPI_Comm comm, const film::Share& share)
      : comm_(comm), share_(share), real_(make_factors<double>(comm, share)) {}
  void set(const film::StateDerivatives& at, double alpha, double sigma) override {
    real_.set(at.states, at.rates, alpha, sigma);
  }
  void apply(std::span<const double> r, std::span<double> x) override { real_.solve(false, r, x); }
  void apply_transposed(std::span<const double> r, std::span<double> x) override { real_.solve(true, r, x); }
  void set_at(const film::StateDerivatives& at, Complex lambda) override {
    if (!complex_) complex_.emplace(make_factors<Complex>(comm_, share_));
    complex_->set(at.states, at.rates, 1.0, lambda);
  }
  void apply_at(std::span<const Complex> r, std::span<Complex> x) override { complex_->solve(false, r, x); }

private:
  MPI_Comm comm_;
  film::Share share_;
  core::PencilLu<double> real_;
  std::optional<core::PencilLu<Complex>> complex_;
};

}  // namespace

std::unique_ptr<film::StateInverse> make_direct_inverse(MPI_Comm comm, const film::Share& share) {
  return std::make_unique<DirectInverse>(comm, share);
}

}  // namespace whirl::system
