// Counts eigenvalues of sparse pencils by the winding number of their determinant.

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "spectral/pencil_search.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"
#include "whirl/core/pivoted_lu.hpp"
#include "whirl/spectral/count.hpp"

namespace whirl::spectral {
namespace {

using core::check;
using Sparse = Eigen::SparseMatrix<Complex>;

constexpr double most_entries = 2e6;
constexpr int first_points = 24, most_points = 400;
constexpr double largest_turn = std::numbers::pi / 2;

// The whole of a distributed matrix on this rank.
Sparse whole(Mat distributed) {
  core::Matrix copy;
  Mat all = distributed;
  const int size = core::size_of(PetscObjectComm(reinterpret_cast<PetscObject>(distributed)));
  if (size > 1) {
    check(MatCreateRedundantMatrix(distributed, size, PETSC_COMM_SELF, MAT_INITIAL_MATRIX, copy.put()));
    all = copy.get();
  }
  PetscInt n = 0;
  check(MatGetSize(all, &n, nullptr));
  std::vector<Eigen::Triplet<Complex>> entries;
  for (PetscInt r = 0; r < n; ++r) {
    PetscInt count = 0;
    const PetscInt* columns = nullptr;
    const PetscScalar* values = nullptr;
    check(MatGetRow(all, r, &count, &columns, &values));
    for (PetscInt k = 0; k < count; ++k) entries.emplace_back(r, columns[k], values[k]);
    check(MatRestoreRow(all, r, &count, &columns, &values));
  }
  Sparse out(n, n);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

class Contour {
public:
  Contour(Sparse a, Sparse b, const std::vector<Complex>& known) : a_(std::move(a)), b_(std::move(b)), known_(known) {}

  // False if the factors are too large, or the matrix is singular there.
  [[nodiscard]] bool begin(Complex lambda) {
    const Sparse t = a_ - lambda * b_;
    return lu_.compute(t) && static_cast<double>(lu_.entries()) <= most_entries;
  }

  // Direction of det(a - lambda b) over the product of lambda - lambda_k.
  [[nodiscard]] std::optional<Complex> quotient(Complex lambda) {
    const Sparse t = a_ - lambda * b_;
    ++factorisations;
    if (!lu_.factorise(t)) return std::nullopt;
    Complex out = std::polar(1.0, lu_.angle());
    for (const Complex k : known_) {
      const Complex d = lambda - k;
      if (d == 0.0) return std::nullopt;
      out *= std::conj(d) / std::abs(d);
    }
    if (!std::isfinite(out.real()) || !std::isfinite(out.imag())) return std::nullopt;
    return out / std::abs(out);
  }

  // Turn [rad] of the quotient along the upper half of the circle, from the positive real axis to the negative one.
  [[nodiscard]] std::optional<double> turn(double radius) {
    const auto at = [&](double angle) { return quotient(std::polar(radius, angle)); };
    double sum = 0, angle = 0;
    auto left = at(0);
    if (!left) return std::nullopt;
    std::vector<std::pair<double, Complex>> ahead;  // the nearest last
    for (int k = first_points; k > 0; --k) {
      const double next = std::numbers::pi * k / first_points;
      const auto value = at(next);
      if (!value) return std::nullopt;
      ahead.emplace_back(next, *value);
    }
    while (!ahead.empty()) {
      const auto [next, value] = ahead.back();
      const double step = std::arg(value / *left);
      if (std::abs(step) > largest_turn) {
        if (factorisations > most_points) return std::nullopt;
        const double middle = (angle + next) / 2;
        const auto between = at(middle);
        if (!between) return std::nullopt;
        ahead.emplace_back(middle, *between);
        continue;
      }
      sum += step;
      angle = next;
      left = value;
      ahead.pop_back();
    }
    return sum;
  }

  // About where the quotient changes its sign on the real axis between two places; zero: nowhere.
  [[nodiscard]] double real_above(double low, double high) {
    const auto sign = [&](double at) {
      const auto value = quotient(at);
      return value ? value->real() : 0.0;
    };
    const double first = sign(low);
    if (!(first * sign(high) < 0)) return 0;
    while (high > 1.01 * low) {
      const double middle = std::sqrt(low * high), value = sign(middle);
      if (value == 0) return middle;
      (value * first > 0 ? low : high) = middle;
    }
    return std::sqrt(low * high);
  }

  int factorisations = 0;

private:
  Sparse a_, b_;
  const std::vector<Complex>& known_;
  core::PivotedLu<Complex> lu_;
};

// The unknown ones crowd beyond the farthest known one, near -1/tau of a shaft with damping in proportion to its
// stiffness: a circle that passes near them turns with each of them. So it keeps away from the farthest by a factor.
// Between the moduli from there down to a tenth, where the gap is widest.
double radius_in(const std::vector<Complex>& known) {
  constexpr double apart = 2.5, least = 10;
  std::vector<double> sizes;
  for (const Complex k : known) sizes.push_back(std::abs(k));
  std::sort(sizes.begin(), sizes.end());
  const double reach = sizes.back() / apart;
  double best = 0, widest = 1;
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k) {
    const double low = std::max(sizes[k], reach / least), high = std::min(sizes[k + 1], reach);
    if (high > low * widest) {
      widest = high / low;
      best = std::sqrt(low * high);
    }
  }
  return best;
}

EigenCount count_here(Sparse a, Sparse b, const std::vector<Complex>& known) {
  EigenCount out;
  const double radius = radius_in(known);
  const double fastest = a.norm() / b.norm();
  Contour contour(std::move(a), std::move(b), known);
  if (!(radius > 0) || !contour.begin({0, radius})) return out;
  out.radius = radius;
  for (const Complex k : known) out.counted += std::abs(k) < radius;
  const auto turn = contour.turn(radius);
  // The other half turns as much: the quotient at the conjugate is the conjugate.
  const double missing = turn ? *turn / std::numbers::pi : 0;
  out.missed = static_cast<int>(std::lround(missing));
  out.sure = turn && std::abs(missing - out.missed) < 0.1 && out.missed >= 0;
  out.counted += std::max(out.missed, 0);
  out.real = contour.real_above(radius, 1e6 * std::max(fastest, radius));
  out.factorisations = contour.factorisations;
  return out;
}

}  // namespace

EigenCount count_eigenvalues(problem::System& system, Vec x, const std::vector<Mode>& found) {
  std::vector<Complex> known;
  for (const Mode& m : found) {
    known.push_back(m.lambda);
    if (m.lambda.imag() > 0) known.push_back(std::conj(m.lambda));
  }
  if (known.size() < 4) return {};
  const ScaledPencil pencil = scaled_pencil(system, x);
  Sparse a = whole(pencil.a.get()), b = whole(pencil.b.get());
  std::vector<double> numbers(6, 0.0);
  core::agree(system.comm(), [&] {
    if (core::rank_of(system.comm()) != 0) return;
    const EigenCount c = count_here(std::move(a), std::move(b), known);
    numbers = {c.radius, 1.0 * c.counted, 1.0 * c.missed, c.real, c.sure ? 1.0 : 0.0, 1.0 * c.factorisations};
  });
  core::share(system.comm(), numbers.data(), numbers.size());
  const auto whole_number = [&](std::size_t k) { return static_cast<int>(numbers[k]); };
  return {numbers[0], whole_number(1), whole_number(2), numbers[3], numbers[4] > 0.5, whole_number(5)};
}

}  // namespace whirl::spectral
