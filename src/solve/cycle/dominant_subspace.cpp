#include "solve/cycle/dominant_subspace.hpp"

#include <fmt/core.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "whirl/core/error.hpp"
#include "whirl/core/plan.hpp"
#include "whirl/spectral/eigenvalues.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

MatrixXd summed(MPI_Comm comm, MatrixXd m) {
  MPI_Allreduce(MPI_IN_PLACE, m.data(), static_cast<int>(m.size()), MPI_DOUBLE, MPI_SUM, comm);
  return m;
}

// The same on all ranks.
[[noreturn]] void fail(const std::string& why) {
  core::NotConverged error(why);
  error.mark_agreed();
  throw error;
}

// Eigenpairs of V^T M V and the residuals of their vectors.
struct Ritz {
  VectorXcd values;  // by falling modulus, the two of a pair side by side
  MatrixXcd vectors;
  Eigen::VectorXd residual;
  MatrixXcd defect;  // M V y - mu V y of the first ones, this rank's rows
};

Ritz ritz(MPI_Comm comm, const MatrixXd& v, const MatrixXd& image, Index most) {
  const MatrixXd projected = summed(comm, v.transpose() * image);
  if (!projected.allFinite()) fail("products with the monodromy matrix are not finite");
  spectral::Eigenpairs pairs = spectral::eigenpairs(projected);
  // What all decide by must not depend on the last digit of a rank's arithmetic.
  MPI_Bcast(pairs.values.data(), static_cast<int>(pairs.values.size()), MPI_C_DOUBLE_COMPLEX, 0, comm);
  MPI_Bcast(pairs.vectors.data(), static_cast<int>(pairs.vectors.size()), MPI_C_DOUBLE_COMPLEX, 0, comm);
  std::vector<Index> order(static_cast<std::size_t>(pairs.values.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    const double p = std::abs(pairs.values(a)), q = std::abs(pairs.values(b));
    return p > q;
  });
  Ritz out{pairs.values(order), pairs.vectors(Eigen::all, order), {}, {}};
  const Index looked_at = std::min<Index>(most, out.values.size());
  out.defect = (image - v * projected) * out.vectors.leftCols(looked_at);
  out.residual = summed(comm, out.defect.colwise().squaredNorm().transpose()).cwiseSqrt();
  return out;
}

// Real columns that span these vectors, one for a real value, two for a pair.
MatrixXd real_columns(const VectorXcd& values, const MatrixXcd& vectors, const std::vector<Index>& of) {
  MatrixXd out(vectors.rows(), 2 * static_cast<Index>(of.size()));
  Index next = 0;
  for (const Index k : of) {
    if (values(k).imag() < 0) continue;  // the other one of a pair has both
    out.col(next++) = vectors.col(k).real();
    if (values(k).imag() > 0) out.col(next++) = vectors.col(k).imag();
  }
  return out.leftCols(next);
}

}  // namespace

MatrixXd generic_columns(MPI_Comm comm, Index local, Index columns) {
  long before = 0;
  const long mine = local;
  MPI_Exscan(&mine, &before, 1, MPI_LONG, MPI_SUM, comm);
  if (core::rank_of(comm) == 0) before = 0;
  MatrixXd out(local, columns);
  for (Index c = 0; c < columns; ++c)
    for (Index k = 0; k < local; ++k) {
      const double phase = (0.7 + 0.4 * static_cast<double>(c)) * static_cast<double>(before + k);
      out(k, c) = 1 + std::sin(phase + std::sin(phase * phase));
    }
  return out;
}

void add_orthonormal(MPI_Comm comm, MatrixXd& v, const MatrixXd& more) {
  constexpr double in_span = 1e-8;  // a column that loses as much lies in the span
  const Index known = v.cols();
  const Eigen::VectorXd sizes = summed(comm, more.colwise().squaredNorm().transpose()).cwiseSqrt();
  MatrixXd x = more;
  for (int pass = 0; pass < 2 && known > 0; ++pass) x -= v * summed(comm, v.transpose() * x);
  v.conservativeResize(x.rows(), known + x.cols());
  Index end = known;
  for (Index c = 0; c < x.cols(); ++c) {
    Eigen::VectorXd column = x.col(c);
    for (int pass = 0; pass < 2; ++pass)
      column -= v.leftCols(end) * summed(comm, v.leftCols(end).transpose() * column).col(0);
    const double size = std::sqrt(summed(comm, MatrixXd::Constant(1, 1, column.squaredNorm()))(0));
    if (size > in_span * sizes(c)) v.col(end++) = column / size;
  }
  v.conservativeResize(Eigen::NoChange, end);
}

DominantSubspace dominant_subspace(MPI_Comm comm, const BlockProduct& multiply, const MatrixXd& start,
                                   const SubspaceOptions& options) {
  constexpr Index probes = 2, first = 4;
  constexpr std::ptrdiff_t shown = 4;  // values at least, where there are as many
  // A Ritz value below the radius tells nothing of what a small basis does not hold: it has to be an eigenvalue, or the
  // basis has room for more than are wanted.
  const double exact = std::max(1e-8, 1e-2 * options.tolerance);
  const Index spare = start.cols() > 0 ? 12 : 20;
  const Index local = start.rows();
  long states = local;
  MPI_Allreduce(MPI_IN_PLACE, &states, 1, MPI_LONG, MPI_SUM, comm);
  const auto n = static_cast<Index>(states);
  const Index widest = n <= 20000 ? 240 : 80;  // vectors that are kept with their products
  const Index beside = std::clamp<Index>(n - start.cols(), 0, start.cols() > 0 ? probes : first);
  MatrixXd v(local, 0), image(local, 0), more(local, start.cols() + beside);
  more << start, generic_columns(comm, local, beside);
  for (Index products = 0;;) {
    const Index known = v.cols();
    add_orthonormal(comm, v, more);
    image.conservativeResize(Eigen::NoChange, v.cols());
    image.rightCols(v.cols() - known) = multiply(v.rightCols(v.cols() - known));
    products += v.cols() - known;

    // The most that may be asked for, with the other one of a pair and one below the radius.
    Ritz found = ritz(comm, v, image, std::min<Index>(options.most, n) + 2);
    DominantSubspace out;
    std::vector<Index> large, open;
    bool below = false;
    for (Index k = 0; k < found.residual.size(); ++k) {
      const double modulus = std::abs(found.values(k)), residual = found.residual(k);
      const bool second = found.values(k).imag() < 0;
      if (!second && (std::ssize(large) >= options.most || (below && std::ssize(out.values) >= shown))) break;
      out.values.push_back(found.values(k));
      const bool settled = residual <= std::max(exact, options.tolerance * modulus),
                 room = v.cols() >= std::min(n, std::ssize(large) + spare);
      if (settled ? modulus <= options.radius : room && modulus + residual < options.radius) {
        below = true;
        continue;
      }
      if (!second && residual > options.tolerance * modulus) open.push_back(k);
      if (modulus <= options.radius) break;  // whether it is below is what is open
      large.push_back(k);
    }
    const bool enough = below || static_cast<int>(large.size()) >= options.most || v.cols() == n;
    if ((open.empty() || v.cols() == n) && enough) {
      add_orthonormal(comm, out.basis = MatrixXd(local, 0), v * real_columns(found.values, found.vectors, large));
      return out;
    }
    if (products >= core::plan::products() || v.cols() == known)
      fail(fmt::format("only {} of {} multipliers converged after {} products", out.values.size() - open.size(),
                       out.values.size(), products));
    more = open.empty() ? MatrixXd(generic_columns(comm, local, v.cols() + probes).rightCols(probes))
                        : real_columns(found.values, found.defect, open);
    if (n <= widest || v.cols() + more.cols() <= widest) continue;
    // Begins again from twice as many vectors as are wanted.
    std::vector<Index> kept(
        static_cast<std::size_t>(std::min<Index>(found.values.size(), 2 * std::ssize(out.values) + 8)));
    std::iota(kept.begin(), kept.end(), Index{0});
    const MatrixXd columns = real_columns(found.values, found.vectors, kept);
    const MatrixXd q =
        Eigen::HouseholderQR<MatrixXd>(columns).householderQ() * MatrixXd::Identity(columns.rows(), columns.cols());
    v = v * q;
    image = image * q;
  }
}

DominantSubspace dominant_multipliers(MPI_Comm comm, const BlockProduct& multiply, const MatrixXd& start,
                                      SubspaceOptions options, double& radius) {
  constexpr double above_a_band = 0.5;
  options.radius = radius;
  try {
    return dominant_subspace(comm, multiply, start, options);
  } catch (const core::NotConverged&) {
    if (radius >= above_a_band) throw;
  }
  options.radius = radius = above_a_band;
  return dominant_subspace(comm, multiply, start, options);
}

}  // namespace whirl::solve
