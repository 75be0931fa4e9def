#include "film/algebra/film_matrix.hpp"

#include <algorithm>
#include <complex>

#include "whirl/core/error.hpp"

namespace whirl::film {

template <class Scalar>
FilmMatrix<Scalar>::FilmMatrix(const Share& whole, const Places& states, const Places* rates)
    : matrix_(whole.rows(), whole.rows()) {
  std::vector<Eigen::Triplet<Scalar>> entries;
  const auto each = [&](auto&& f) {
    for_entries(whole, states, {}, [&](int i, int j, double) { f(i, j, of_states_); });
    if (rates) for_entries(whole, *rates, {}, [&](int i, int j, double) { f(i, j, of_rates_); });
  };
  each([&](int i, int j, std::vector<std::size_t>&) { entries.emplace_back(i, j, Scalar(0)); });
  matrix_.setFromTriplets(entries.begin(), entries.end());
  each([&](int i, int j, std::vector<std::size_t>& of) {
    const int *begin = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[j],
              *end = matrix_.innerIndexPtr() + matrix_.outerIndexPtr()[j + 1];
    of.push_back(static_cast<std::size_t>(std::lower_bound(begin, end, i) - matrix_.innerIndexPtr()));
  });
}

template <class Scalar>
const typename FilmMatrix<Scalar>::Sparse& FilmMatrix<Scalar>::filled(std::span<const double> d_states,
                                                                      std::span<const double> d_rates, double alpha,
                                                                      Scalar sigma) {
  core::require(d_states.size() == of_states_.size() && (of_rates_.empty() || d_rates.size() == of_rates_.size()),
                "derivatives of a film at their places");
  Scalar* const values = matrix_.valuePtr();
  std::fill_n(values, matrix_.nonZeros(), Scalar(0));
  for (std::size_t k = 0; k < of_states_.size(); ++k) values[of_states_[k]] += alpha * d_states[k];
  for (std::size_t k = 0; k < of_rates_.size(); ++k) values[of_rates_[k]] += sigma * d_rates[k];
  return matrix_;
}

template class FilmMatrix<double>;
template class FilmMatrix<std::complex<double>>;

}  // namespace whirl::film
