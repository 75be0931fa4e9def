// The program's own factorisations beside libraries on the same matrices: processor time of factors and of the solves
// that a client makes with them, on one rank, without the analysis of patterns.
//
//     OPENBLAS_NUM_THREADS=1 bench_factor
//
// The first line of each matrix is what the program takes. The ratio is its time over that of another line.
#include "bench/pad.hpp"
#include "bench/ways.hpp"
#include "film/algebra/film_matrix.hpp"
#include "film/algebra/line_solver.hpp"
#include "solve/cycle/pencil.hpp"
#include "solve/cycle/time_modes.hpp"
#include "support/train_system.hpp"
#include "support/uniform_shaft.hpp"
#include "system/start.hpp"
#include "whirl/core/session.hpp"
#include "whirl/core/shell.hpp"
#include "whirl/problem/scaled_point.hpp"
#include "whirl/solve/cycle/cycle.hpp"
#include "whirl/system/rotor_system.hpp"

extern "C" {
void sgttrf_(const int* n, float* dl, float* d, float* du, float* du2, int* pivots, int* info);
void sgttrs_(const char*, const int* n, const int* sides, const float* dl, const float* d, const float* du,
             const float* du2, const int* pivots, float* b, const int* ldb, int* info);
}

using namespace whirl;
using namespace whirl::bench;
using core::check;
using Eigen::ArrayXcd;

namespace {

// The five-point equation of a pad with h^3 varying by a factor of 30, in the program's order: along the pad first, the
// columns of a closed one from both sides, 0, n - 1, 1, n - 2, ... Where a film that conserves its mass is `ruptured`,
// here in half of its columns, the unknown is what the gap lacks, which the next column takes over.
Sparse pad(int columns, int rows, bool closed, bool ruptured) {
  const double step = closed ? 2 * M_PI / columns : 0.05;
  const auto a = [=](double i) { return std::pow(1 + 0.5 * std::cos(step * i), 3); };
  const auto at = [=](int i, int j) {
    return (!closed ? i : i < (columns + 1) / 2 ? 2 * i : 2 * (columns - 1 - i) + 1) * rows + j;
  };
  Entries entries;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      const double diagonal = a(i - 0.5) + a(i + 0.5) + 2 * a(i);
      const int here = at(i, j), before = (i + columns - 1) % columns, after = (i + 1) % columns;
      entries.emplace_back(here, here, diagonal);
      const bool lacks = ruptured && 2 * i >= columns;
      if (closed || i + 1 < columns) entries.emplace_back(at(after, j), here, lacks ? -diagonal : -a(i + 0.5));
      if (lacks) continue;
      if (closed || i > 0) entries.emplace_back(at(before, j), here, -a(i - 0.5));
      if (j > 0) entries.emplace_back(here - 1, here, -a(i));
      if (j + 1 < rows) entries.emplace_back(here + 1, here, -a(i));
    }
  return made_of(columns * rows, entries);
}

void pads() {
  const auto one = [](const std::string& what, int columns, int rows, bool closed) {
    const Sparse a = pad(columns, rows, closed, false), g = pad(columns, rows, closed, true);
    const MatrixXd b = sides(a.rows(), 5);
    const std::string of = fmt::format("{}, width {}", what, bandwidth(a));
    compare("BandLu in place, " + of, a.rows(), 5, {band_in_place(a, b, true), lapack_band(a, b, true, true)});
    compare("The same, half ruptured", a.rows(), 5, {band_in_place(g, b, false), lapack_band(g, b, false, true)});
  };
  one("arc of 60 x 16 cells, half of it", 59, 8, false);
  one("arc of 60 x 16 cells, tilted", 59, 15, false);
  one("closed bore of 60 x 16 cells, half of it", 60, 8, true);
}

// I - own A of the states of a film along a line.
void narrow_bands() {
  for (const auto& [n, reach, columns] :
       {std::array{48, 2, 1}, {48, 2, 5}, {96, 4, 1}, {96, 4, 5}, {196, 4, 1}, {196, 4, 5}}) {
    Entries entries;
    for (int i = 0; i < n; ++i)
      for (int j = std::max(0, i - reach); j <= std::min(n - 1, i + reach); ++j)
        entries.emplace_back(i, j, (i == j) + 0.08 * std::sin(1.0 + 3 * i + 7 * j));
    const Sparse a = made_of(n, entries);
    const MatrixXd b = sides(n, columns);
    compare(fmt::format("BandLu, reach {}", reach), n, columns, {band_lu(a, b), lapack_band(a, b)});
  }
}

// Lines of a level of the V-cycle, in single precision: half of those of a film of 100 x 20 cells. One call of LAPACK
// takes all of them one behind the other.
void lines() {
  constexpr int along = 19, count = 50, n = along * count;
  struct State {
    film::LineSolver own;
    film::Columns x{along, count};
    Eigen::VectorXf below, centre, above, second, y;
    Eigen::VectorXi pivots;
  };
  const MatrixXd b = sides(n, 1);
  film::Block block(along, count);
  film::Columns load(along, count);
  Eigen::VectorXf centre(n), beside(n);
  Entries entries;
  for (int k = 0; k < n; ++k) {
    const int z = k % along, i = k / along;
    block.centre.row(z)[i] = centre(k) = 2.5F + 0.1F * static_cast<float>(i % 7);
    block.below.row(z)[i] = block.above.row(z)[i] = -1;
    load.row(z)[i] = static_cast<float>(b(k, 0));
    beside(k) = z + 1 < along ? -1 : 0;
    entries.emplace_back(k, k, centre(k));
    if (z + 1 == along) continue;
    entries.emplace_back(k, k + 1, -1);
    entries.emplace_back(k + 1, k, -1);
  }
  const Sparse a = made_of(n, entries);
  auto s = std::make_shared<State>();
  compare("LineSolver, 50 lines of 19, single precision", n, 1,
          {{"own", [=] { s->own.factor(block); }, [=] { s->x = load, s->own.solve(s->x); },
            [=] {
              MatrixXd x(n, 1);
              for (int k = 0; k < n; ++k) x(k, 0) = s->x.row(k % along)[k / along];
              return left(a, x, b);
            }},
           {"sgttrf",
            [=] {
              int size = n, info = 0;
              s->centre = centre, s->below = s->above = beside;
              s->second.resize(n), s->pivots.resize(n);
              sgttrf_(&size, s->below.data(), s->centre.data(), s->above.data(), s->second.data(), s->pivots.data(),
                      &info);
            },
            [=] {
              int size = n, one = 1, info = 0;
              s->y = b.col(0).cast<float>();
              sgttrs_("N", &size, &one, s->below.data(), s->centre.data(), s->above.data(), s->second.data(),
                      s->pivots.data(), s->y.data(), &size, &info);
            },
            [=] { return left(a, MatrixXd(s->y.cast<double>()), b); }}});
}

// alpha dg/ds + sigma dg/ds' of a film at rest, with what its client solves it by first.
void film_states(const std::string& what, std::unique_ptr<film::Film> made, const film::JournalMotion& m, double alpha,
                 double sigma, bool band) {
  film::Film& f = *made;
  std::vector<double> states(f.states());
  const std::vector<double> zero(states.size(), 0.0);
  f.unloaded(m, states);
  (void)film::relax(f, m, states);
  film::StateResponse r;
  f.evaluate(m, f.whole(), film::seen_of(f.whole(), states), film::seen_of(f.whole(), zero), film::Need::tangents, r);
  film::FilmMatrix<double> matrix(f.whole(), f.whole().d_states, &f.whole().d_rates);
  Sparse a = matrix.filled(r.d_states, r.d_rates, alpha, sigma);
  const std::shared_ptr<film::StateInverse> inverse = f.inverse(PETSC_COMM_SELF, f.whole());
  if (!inverse) {  // several units: scaled for all, as BandLu does by itself
    VectorXd units(a.rows());
    for (const film::StateField& field : f.state_fields()) field.each([&](int k) { units(k) = field.scale; });
    const VectorXd rows = (a.cwiseAbs() * units).cwiseInverse();
    a = Sparse(rows.asDiagonal() * a * units.asDiagonal());
  }
  const MatrixXd b = sides(a.rows(), 5);
  std::vector<Way> ways;
  core::Gate gate(PETSC_COMM_SELF);
  Eigen::SparseMatrix<double, Eigen::RowMajor, PetscInt> rows = a;
  core::Matrix product;
  const auto n = static_cast<PetscInt>(a.rows());
  check(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, rows.outerIndexPtr(), rows.innerIndexPtr(), rows.valuePtr(),
                                  product.put()));
  double apart = 1e-10;  // another matrix each time: an inverse keeps the factors of the one before
  const auto set = [&](auto& i, const Sparse&) {
    apart = -apart;
    i.set({r.d_states, r.d_rates}, alpha, sigma * (1 + apart));
  };
  core::LinearSolver krylov;
  if (dynamic_cast<film::ExactStateInverse*>(inverse.get()))
    ways.push_back(by("DirectInverse", inverse, a, b, set, [&](auto& i, const MatrixXd& y) {
      MatrixXd x(y.rows(), y.cols());
      i.apply(core::span_of(y), core::span_of(x));
      return x;
    }));
  else if (inverse) {
    krylov = core::make_krylov(product.get(), gate, {"ring_", KSPFGMRES, 1e-9}, [&](Vec y, Vec x) {
      const core::ReadArray in(y);
      const core::WriteArray out(x);
      inverse->apply(in.span(), out.span());
    });
    // As elimination does: one V-cycle for each column of the ports, FGMRES once.
    auto x = std::make_shared<MatrixXd>(b);
    ways.push_back({"V-cycle, FGMRES", [&] { set(*inverse, a); },
                    [&, x] {
                      const Index ports = b.cols() - 1;
                      inverse->apply({b.data(), core::at(ports * n)}, {x->data(), core::at(ports * n)});
                      core::Vector from, to;
                      check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, b.col(ports).data(), from.put()));
                      check(VecCreateSeqWithArray(PETSC_COMM_SELF, 1, n, x->col(ports).data(), to.put()));
                      gate.rethrow(KSPSolve(krylov.get(), from.get(), to.get()));
                    },
                    [&, x] { return left(a, MatrixXd(x->rightCols(1)), MatrixXd(b.rightCols(1))); }});
  }
  if (band) ways.push_back(band_lu(a, b));
  ways.push_back(sparse_lu(a, b));
  if (band) ways.push_back(lapack_band(a, b));
  for (Way& w : std::vector{pivoted(a, b), klu(a, b), mumps(a, b)}) ways.push_back(std::move(w));
  compare(fmt::format("{}, width {}", what, bandwidth(a)), a.rows(), b.cols(), ways);
  PetscInt iterations = 0;
  if (krylov) check(KSPGetIterationNumber(krylov.get(), &iterations));
  if (krylov) fmt::print("{} iterations\n", iterations);
}

void films() {
  for (const int layers : {1, 8})
    film_states(fmt::format("BandLu, pad with heat in {} layers", layers),
                make_film(bench::one_pad(), bench::heated(layers, film::States::dynamic), {0.0067, 850.0}),
                bench::loaded(false), 1, 0, true);
  film::Reynolds content;
  content.cavitation = film::Reynolds::Cavitation::mass_conserving;
  content.states = film::Reynolds::States::dynamic;
  for (const int m : {1, 4}) {
    content.cells = {60 * m, 16 * m};
    film_states(fmt::format("DirectInverse, pad that conserves its mass, {} x {}", 60 * m, 16 * m),
                make_film(bench::one_pad(), content, {0.0067, 850.0}), bench::loaded(false), 1, 2900, true);
  }
  const film::Geometry bore{film::Geometry::Bore::cylindrical, 0.005, 0.01, 25e-6, 0, 0, 0};
  film::CompliantFinite liner;
  liner.compliance = 0.1;
  liner.reference_speed = 160;
  liner.differences = film::Compliant::Differences::central;
  const film::JournalMotion m{{0.3 * bore.clearance, -0.5 * bore.clearance, 0, 0}, {}, 320};
  for (const int fine : {1, 2, 4}) {
    liner.cells = {60 * fine, 12 * fine};
    film_states(fmt::format("RingPreconditioner, soft liner, {} x {}", 60 * fine, 12 * fine),
                make_film(bore, liner, {0.001, 1000}), m, 2 * M_PI / 320 / 96, 1, false);
  }
}

void dense() {
  for (const auto& [n, columns] : {std::pair{4, 1}, {16, 1}, {104, 104}, {312, 104}}) {
    const MatrixXd a = sides(n, n) + 2 * MatrixXd::Identity(n, n), b = sides(n, columns);
    compare("DenseLu", n, columns, {dense_lu(a, b), lapack_dense(a, b)});
  }
}

// Calls solve::Pencil for `columns` right-hand sides, the same at all lambda.
Way pencil(const problem::ThinBlocks& k, const ArrayXcd& lambda, const MatrixXd& b) {
  struct State {
    solve::Pencil pencil;
    MatrixXd x;
  };
  auto s = std::make_shared<State>();
  const Index lanes = lambda.size(), columns = b.cols(), count = lanes * columns;
  MatrixXd all = MatrixXd::Zero(2 * count, b.rows());
  for (Index q = 0; q < columns; ++q) all.middleRows(q * lanes, lanes) = b.col(q).transpose().replicate(lanes, 1);
  return {"Pencil", [=] { s->pencil.compute(k.l1, k.l0, k.kinematic, lambda); },
          [=] { s->x = all, s->pencil.solve(s->x, columns); },
          [=] {
            double most = 0;
            for (Index j = 0; j < lanes; ++j)
              for (Index q = 0; q < columns; ++q) {
                const Eigen::MatrixXcd x = (s->x.row(q * lanes + j) + Complex(0, 1) * s->x.row(count + q * lanes + j))
                                               .transpose(),
                                       y = b.col(q).cast<Complex>();
                const Eigen::SparseMatrix<Complex> t = k.l0.cast<Complex>() + lambda(j) * k.l1.cast<Complex>();
                most = std::max(most, left(t, x, y));
              }
            return most;
          }};
}

// p + i q as blocks [p -q; q p].
Sparse real_form(const Eigen::SparseMatrix<Complex>& a) {
  Entries entries;
  for (int j = 0; j < a.cols(); ++j)
    for (Eigen::SparseMatrix<Complex>::InnerIterator e(a, j); e; ++e)
      for (const int p : {0, 1})
        for (const int q : {0, 1}) {
          const double value = p == q ? e.value().real() : (p - q) * e.value().imag();
          entries.emplace_back(2 * static_cast<int>(e.row()) + p, 2 * j + q, value);
        }
  return made_of(2 * a.rows(), entries);
}

void pencils(const std::string& what, const problem::ThinBlocks& k, const ArrayXcd& lambda, Index columns) {
  const Index n = k.l1.rows();
  const MatrixXd b = sides(n, columns);
  MatrixXd twice = MatrixXd::Zero(2 * n, columns);
  for (Index i = 0; i < n; ++i) twice.row(2 * i) = b.row(i);
  std::vector<Way> eigen, by_klu, by_mumps;
  for (const Complex& l : lambda) {
    const Eigen::SparseMatrix<Complex> t = k.l0.cast<Complex>() + l * k.l1.cast<Complex>();
    const Sparse real = real_form(t);
    eigen.push_back(pivoted(t, b));
    by_klu.push_back(klu(real, twice));
    by_mumps.push_back(mumps(real, twice));
  }
  compare(fmt::format("Pencil, {}, {} shifts", what, lambda.size()), n, columns,
          {pencil(k, lambda, b), all_of(eigen), all_of(by_klu), all_of(by_mumps)});
}

// A cycle of 60 intervals by time modes; one interval of degree 4; and a step in time of a hundredth of a turn.
void machine(const std::string& what, const system::Train& train, bool sparse) {
  constexpr double speed = 377, period = 2 * M_PI / speed;
  system::RotorSystem s(PETSC_COMM_SELF, train, speed);
  problem::ScaledPoint point(s, s.structure(), true);
  problem::ThinBlocks k = point.thin_blocks();
  problem::Films films;
  const std::vector<double> x = s.gather(system::static_guess(s).get());
  const VectorXd inputs = s.structure()->c() * Eigen::Map<const VectorXd>(x.data(), s.size());
  s.structure()->films(inputs, nullptr, nullptr, true, films);
  k.l0 = Sparse(k.l0 - Sparse(k.b * Sparse(films.d_inputs.sparseView()) * k.c));
  const Sparse step = k.l1 + period / 100 * k.l0;
  const MatrixXd loads = sides(step.rows(), k.b.cols() + 1);
  std::vector<Way> ways = {pivoted(step, loads), klu(step, loads), mumps(step, loads)};
  if (!sparse) ways.insert(ways.begin(), dense_lu(MatrixXd(step), loads));
  compare("L1 + tau L0 of " + what, step.rows(), loads.cols(), ways);
  if (!sparse) return;
  const auto cycle = solve::cycle_modes(solve::make_scheme(2, solve::Points::radau), solve::uniform_mesh(60), 1);
  pencils(what, k, cycle.lambda / period, 5);
  const auto interval = solve::interval_modes(solve::make_scheme(4, solve::Points::radau), period / 60);
  pencils(what, k, interval.lambda, 4 * k.b.cols());
}

}  // namespace

int main(int argc, char** argv) {
  core::Session session(argc, argv);
  pads();
  narrow_bands();
  lines();
  films();
  dense();
  machine("the reduced train", test::train({60, 16}, true), false);
  machine("a uniform shaft", test::uniform_shaft(29), true);
  machine("the whole train", test::train({60, 16}, false), true);
}
