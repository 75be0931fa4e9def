// Exact inverses of films, wherever ranks cut them: of films whose states form a band, and of others.
#include "whirl/film/algebra/direct_inverse.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "film/content_cases.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::film::testing {
namespace {

struct Case {
  std::string name;
  Geometry geometry;
  Options options;
  std::array<double, 4> position;
};

// A film on all ranks, part of it empty, with its inverse and its derivatives as one rank sees them.
struct Shared {
  explicit Shared(const Case& c) : film(make_film(c.geometry, c.options, oil())) {
    const JournalMotion m = motion(c.geometry, c.position, {}, 377.0);
    const auto n = static_cast<int>(film->states()), ranks = core::size_of(MPI_COMM_WORLD),
               rank = core::rank_of(MPI_COMM_WORLD);
    share = film->share(film->cut(n * rank / ranks), film->cut(n * (rank + 1) / ranks));
    std::vector<double> q = settled(*film, m), rest(q.size(), 0.0);
    if (film->whole_steps())
      for (std::size_t k = 0; k < q.size(); k += 7) q[k] = -1e-6;  // holes in the full film
    film->evaluate(m, q, rest, Need::tangents, whole);
    film->evaluate(m, share, seen_of(share, q), seen_of(share, rest), Need::tangents, here);
    inverse = film->whole_steps() ? film->inverse(MPI_COMM_WORLD, share) : make_direct_inverse(MPI_COMM_WORLD, share);
  }
  std::unique_ptr<Film> film;
  Share share;
  StateResponse whole, here;
  std::unique_ptr<StateInverse> inverse;
};

class Films : public ::testing::TestWithParam<Case> {};

TEST_P(Films, AreSolvedExactly) {
  Shared s(GetParam());
  ASSERT_NE(s.inverse->exact(), nullptr);
  const auto n = static_cast<Eigen::Index>(s.film->states());
  Eigen::MatrixXd b(n, 2);  // both right-hand sides at once
  for (Eigen::Index k = 0; k < n; ++k)
    b.row(k) << std::sin(0.37 * static_cast<double>(k * (k + 1))), std::cos(1.1 * static_cast<double>(k));
  const Eigen::Index rows = s.share.rows();
  const Eigen::MatrixXd here = b.middleRows(s.share.begin, rows);
  const std::vector<double> r(here.data(), here.data() + here.size());
  std::vector<double> x(r.size());
  for (const auto& [alpha, sigma] : {std::pair{1.0, 0.0}, std::pair{2e-6, 1.0}}) {
    s.inverse->set({s.here.d_states, s.here.d_rates}, alpha, sigma);
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(matrix_of(*s.film, s.whole, sigma / alpha));
    for (const bool transposed : {false, true}) {
      const Eigen::MatrixXd exact = (transposed ? Eigen::MatrixXd(lu.transpose().solve(b)) : lu.solve(b)) / alpha;
      transposed ? s.inverse->exact()->apply_transposed(r, x) : s.inverse->apply(r, x);
      const Eigen::MatrixXd found = Eigen::Map<const Eigen::MatrixXd>(x.data(), rows, 2);
      const Eigen::MatrixXd error = found - exact.middleRows(s.share.begin, rows);
      for (Eigen::Index c = 0; c < 2; ++c)
        ASSERT_LE(error.col(c).lpNorm<Eigen::Infinity>(), 1e-9 * exact.col(c).lpNorm<Eigen::Infinity>())
            << GetParam().name << " " << c << (transposed ? " transposed" : "");
    }
  }
}

TEST_P(Films, AreSolvedAtComplexFrequencies) {
  Shared s(GetParam());
  using Complex = std::complex<double>;
  const Complex lambda(-30, 200);
  const auto n = static_cast<Eigen::Index>(s.film->states());
  Eigen::MatrixXcd b(n, 2);
  for (Eigen::Index k = 0; k < n; ++k)
    b.row(k) << std::polar(1.0, 0.37 * static_cast<double>(k * (k + 1))), std::polar(0.5, 1.1 * static_cast<double>(k));
  const Eigen::SparseMatrix<double> still = matrix_of(*s.film, s.whole, 0), moving = matrix_of(*s.film, s.whole, 1);
  const Eigen::SparseMatrix<Complex> a =
      (1.0 - lambda) * still.cast<Complex>() + lambda * Eigen::SparseMatrix<Complex>(moving.cast<Complex>());
  const Eigen::MatrixXcd exact = Eigen::SparseLU<Eigen::SparseMatrix<Complex>>(a).solve(b);
  const Eigen::Index rows = s.share.rows();
  const Eigen::MatrixXcd here = b.middleRows(s.share.begin, rows);
  const std::vector<Complex> r(here.data(), here.data() + here.size());
  std::vector<Complex> x(r.size());
  s.inverse->exact()->set_at({s.here.d_states, s.here.d_rates}, lambda);
  s.inverse->exact()->apply_at(r, x);
  const Eigen::MatrixXcd found = Eigen::Map<const Eigen::MatrixXcd>(x.data(), rows, 2);
  for (Eigen::Index c = 0; c < 2; ++c)
    ASSERT_LE((found - exact.middleRows(s.share.begin, rows)).col(c).lpNorm<Eigen::Infinity>(),
              1e-9 * exact.col(c).lpNorm<Eigen::Infinity>());
}

// All content films; one of three columns, for three ranks; and one in a ring, whose band does not pay.
std::vector<Case> films() {
  std::vector<Case> out;
  for (const ContentCase& c : content_films()) out.push_back({c.name, c.geometry, c.options, c.position});
  out.push_back({"three_columns", arc(), dynamic({4, 6}), {0.2, -0.6, 0.1, 0.1}});
  CompliantFinite liner;
  liner.cells = {40, 8};
  liner.compliance = 0.1;
  liner.reference_speed = 300.0;
  out.push_back({"liner", cylinder(), liner, {0.3, -0.5, 0.0, 0.0}});
  return out;
}

INSTANTIATE_TEST_SUITE_P(Direct, Films, ::testing::ValuesIn(films()),
                         [](const auto& which) { return which.param.name; });

// A cavity at rest keeps what it holds: nothing says how much.
TEST(DirectInverse, OfASingularFilmIsNotFinite) {
  for (const Case& c : {films().front(), films().back()}) {
    Shared s(c);
    std::fill(s.here.d_states.begin(), s.here.d_states.end(), 0.0);
    s.inverse->set({s.here.d_states, s.here.d_rates}, 1.0, 0.0);
    std::vector<double> r(static_cast<std::size_t>(s.share.rows()), 1.0), x(r.size(), 0.0);
    s.inverse->apply(r, x);
    for (const double v : x) EXPECT_FALSE(std::isfinite(v)) << c.name;
  }
}

}  // namespace
}  // namespace whirl::film::testing
