// The eigenvalues of a pencil that lie near a place.

#include <algorithm>
#include <cmath>
#include <limits>

#include "spectral/pencil_search.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/from_options.hpp"

namespace whirl::spectral {

using core::check;

std::vector<LocalMode> modes_within(Mat a, Mat b, double target, double radius) {
  const MPI_Comm comm = PetscObjectComm(reinterpret_cast<PetscObject>(a));
  PetscInt n = 0, begin = 0, end = 0;
  check(MatGetSize(a, &n, nullptr));
  check(MatGetOwnershipRange(a, &begin, &end));
  const auto make = [](EigenSolver& eps, MPI_Comm where, Mat left, Mat right) {
    check(EPSCreate(where, eps.put()));
    check(EPSSetOptionsPrefix(eps.get(), "parts_"));
    check(EPSSetOperators(eps.get(), left, right));
    check(EPSSetProblemType(eps.get(), EPS_GNHEP));
  };
  std::vector<LocalMode> out;
  const auto take = [&](const Pair& p, std::size_t from, std::size_t count) {
    LocalMode m{p.value, {}};
    for (std::size_t k = from; k < from + count; ++k)
      m.shape.emplace_back(p.real[k], p.value.imag() != 0 ? p.imaginary[k] : 0.0);
    out.push_back(std::move(m));
  };
  core::Matrix minus;
  if (n <= std::max(EigenOptions{}.dense_below, 3)) {
    const core::Matrix left = redundant_dense(a);
    minus = redundant_dense(b);
    check(MatScale(minus.get(), -1));
    std::vector<std::vector<Complex>> whole;
    std::vector<Complex> values;
    core::agree(comm, [&] {
      if (core::rank_of(comm) != 0) return;
      EigenSolver eps;
      make(eps, PETSC_COMM_SELF, left.get(), minus.get());
      check(EPSSetType(eps.get(), EPSLAPACK));
      solve_dense(eps, left.get(), minus.get());
      PetscInt found = 0;
      check(EPSGetConverged(eps.get(), &found));
      core::Vector re, im;
      check(MatCreateVecs(left.get(), re.put(), im.put()));
      for (PetscInt i = 0; i < found; ++i) {
        const Pair p = pair_of(eps.get(), i, re.get(), im.get(), true);
        if (std::isfinite(std::abs(p.value)) && std::abs(p.value - target) <= radius)
          take(p, 0, static_cast<std::size_t>(n));
      }
      for (const LocalMode& m : out) {
        values.push_back(m.lambda);
        whole.push_back(m.shape);
      }
    });
    share(comm, values);
    whole.resize(values.size());
    out.clear();
    for (std::size_t k = 0; k < values.size(); ++k) {
      share(comm, whole[k]);
      out.push_back({values[k], {whole[k].begin() + begin, whole[k].begin() + end}});
    }
  } else {
    check(MatDuplicate(b, MAT_COPY_VALUES, minus.put()));
    check(MatScale(minus.get(), -1));
    constexpr PetscInt most = 400;
    for (PetscInt wanted = 10;; wanted *= 2) {
      EigenSolver eps;
      make(eps, comm, a, minus.get());
      wanted = std::min({wanted, most, n - 2});
      search_near(eps.get(), a, target, wanted, nullptr);
      core::set_from_options(eps.get());
      check(EPSSolve(eps.get()));
      PetscInt found = 0;
      check(EPSGetConverged(eps.get(), &found));
      if (found < wanted) throw core::NotConverged("the eigenvalues of a film by itself did not converge");
      // Those that converged beside the wanted ones need not be the nearest.
      std::vector<double> distances;
      for (PetscInt i = 0; i < found; ++i) {
        const double distance = std::abs(pair_of(eps.get(), i, nullptr, nullptr, false).value - target);
        distances.push_back(std::isfinite(distance) ? distance : std::numeric_limits<double>::infinity());
      }
      std::sort(distances.begin(), distances.end());
      if (distances[static_cast<std::size_t>(wanted) - 1] <= radius && wanted < n - 2) {
        if (wanted == most) throw core::NotConverged("a film by itself has too many eigenvalues in the region");
        continue;
      }
      core::Vector re, im;
      check(MatCreateVecs(a, re.put(), im.put()));
      for (PetscInt i = 0; i < found; ++i) {
        PetscScalar x = 0, y = 0;
        check(EPSGetEigenpair(eps.get(), i, &x, &y, re.get(), im.get()));
        if (std::abs(Complex(x, y) - target) > radius) continue;
        const core::ReadArray u(re.get()), v(im.get());
        Pair p{{x, y}, {u.data(), u.data() + u.size()}, {v.data(), v.data() + v.size()}};
        take(p, 0, static_cast<std::size_t>(end - begin));
      }
      break;
    }
  }
  for (LocalMode& m : out) {
    double size = 0;
    for (const Complex& v : m.shape) size += std::norm(v);
    MPI_Allreduce(MPI_IN_PLACE, &size, 1, MPI_DOUBLE, MPI_SUM, comm);
    for (Complex& v : m.shape) v /= std::sqrt(size);
  }
  std::stable_sort(out.begin(), out.end(), [&](const LocalMode& m, const LocalMode& k) {
    return std::abs(m.lambda - target) < std::abs(k.lambda - target);
  });
  return out;
}

}  // namespace whirl::spectral
