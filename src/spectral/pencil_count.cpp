#include "spectral/pencil_count.hpp"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "whirl/core/agree.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::spectral {
namespace {

using core::check;
using Complex = std::complex<double>;
using Sparse = Eigen::SparseMatrix<Complex>;

constexpr double most_entries = 2e6;
constexpr int first_points = 24, most_points = 400;
constexpr double largest_turn = std::numbers::pi / 4;

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

// The determinant itself overflows; only its direction is wanted.
class Factors : public Eigen::SparseLU<Sparse> {
public:
  [[nodiscard]] Complex direction() const {
    Complex out = static_cast<double>(m_detPermR * m_detPermC);
    for (Eigen::Index j = 0; j < cols(); ++j)
      for (SCMatrix::InnerIterator it(m_Lstore, j); it; ++it)
        if (it.index() == j) {
          out *= it.value() / std::abs(it.value());
          break;
        }
    return out;
  }
};

class Contour {
public:
  Contour(Sparse a, Sparse b, const std::vector<Complex>& known) : a_(std::move(a)), b_(std::move(b)), known_(known) {}

  // False if the factors are too large, or the matrix is singular there.
  [[nodiscard]] bool begin(Complex lambda) {
    const Sparse t = a_ - lambda * b_;
    lu_.analyzePattern(t);
    lu_.factorize(t);
    return lu_.info() == Eigen::Success && static_cast<double>(lu_.nnzL() + lu_.nnzU()) <= most_entries;
  }

  // Direction of det(a - lambda b) over the product of lambda - lambda_k.
  [[nodiscard]] std::optional<Complex> quotient(Complex lambda) {
    const Sparse t = a_ - lambda * b_;
    lu_.factorize(t);
    ++factorisations;
    if (lu_.info() != Eigen::Success) return std::nullopt;
    Complex out = lu_.direction();
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

  int factorisations = 0;

private:
  Sparse a_, b_;
  const std::vector<Complex>& known_;
  Factors lu_;
};

// Between the moduli of the farther half, where the gap is widest.
double radius_in(const std::vector<Complex>& known) {
  std::vector<double> sizes;
  for (const Complex k : known) sizes.push_back(std::abs(k));
  std::sort(sizes.begin(), sizes.end());
  double best = 0, widest = 1;
  for (std::size_t k = sizes.size() / 2; k + 1 < sizes.size(); ++k)
    if (sizes[k] > 0 && sizes[k + 1] / sizes[k] > widest) {
      widest = sizes[k + 1] / sizes[k];
      best = std::sqrt(sizes[k] * sizes[k + 1]);
    }
  return best;
}

PencilCount count_here(Sparse a, Sparse b, const std::vector<Complex>& known) {
  PencilCount out;
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
  // Beyond all eigenvalues the sign is that of the leading coefficient.
  const auto near = contour.quotient(radius), far = contour.quotient(1e6 * std::max(fastest, radius));
  out.real = near && far && near->real() * far->real() < 0;
  out.factorisations = contour.factorisations;
  return out;
}

}  // namespace

PencilCount count_near_zero(Mat a, Mat b, const std::vector<Complex>& known) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(a));
  std::vector<double> numbers(6, 0.0);
  if (known.size() < 4) return {};
  Sparse left = whole(a), right = whole(b);
  core::agree(comm, [&] {
    if (core::rank_of(comm) != 0) return;
    const PencilCount c = count_here(std::move(left), std::move(right), known);
    numbers = {
        c.radius,           static_cast<double>(c.counted),       static_cast<double>(c.missed), c.real ? 1.0 : 0.0,
        c.sure ? 1.0 : 0.0, static_cast<double>(c.factorisations)};
  });
  core::share(comm, numbers.data(), numbers.size());
  return {numbers[0],       static_cast<int>(numbers[1]), static_cast<int>(numbers[2]), numbers[3] > 0.5,
          numbers[4] > 0.5, static_cast<int>(numbers[5])};
}

}  // namespace whirl::spectral
