// Stages of systems that tell their structure.

#include <algorithm>
#include <optional>

#include "solve/shooting/structured_rate.hpp"
#include "whirl/core/band_lu.hpp"
#include "whirl/core/dense_lu.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double digits_lost = 1e-11;  // of a band: then rows are exchanged

/// k - f(x) = 0, whose derivatives come with f: no point is evaluated twice. With A = df/dx, (I - own A)^-1 treats the
/// states of a film but its last `reach` as a band,
///
///     [ B   U ] [ s ]     B: films, one band each;  X: coordinates and the last states of the films
///     [ W   V ] [ X ]     U, W: their inputs and forces, and the ends of their rings
///
/// and X follows from V - W B^-1 U. The cost is in proportion to the number of states.
class StructuredStage final : public Stage {
public:
  explicit StructuredStage(StructuredRate& rate) : rate_(rate) {}

  void residual(const StageGroup& group, In x, In k, Out f, bool) override {
    f = k - rate_.evaluate(group.angle(0), x.col(0), a_, d_parameter_);
  }

  void factorise(const StageGroup& group, In, In) override {
    implicit_ = !group.is_explicit();
    if (implicit_) factorise_bands(group.own(0, 0));
  }

  void solve(Out f, double) override {
    if (implicit_) solve_bands(f.data());
  }

  // Those of the last iteration serve.
  void keep(const StageGroup&, In, In) override {}

  // dk = (I - own A)^-1 (A w + df/dp)
  void slopes(In w, bool loaded, Out dk) override {
    for (Index c = 0; c < w.cols(); ++c) {
      if (w.col(c).isZero(0))
        dk.col(c).setZero();
      else
        rate_.times(a_, w.col(c).data(), dk.col(c).data());
      if (loaded && c + 1 == w.cols()) dk.col(c) += d_parameter_;
      if (implicit_) solve_bands(dk.col(c).data());
    }
  }

private:
  struct Part {
    std::optional<core::BandLu> band;
    MatrixXd response;  // B^-1 U: of the seen inputs, then of the last states [interior x ...]
    MatrixXd forces;    // own P^T [interior x forces]
    MatrixXd ends;      // own D^T of the last states' rows [interior x reach]
    MatrixXd inputs;    // C of the seen inputs [seen x n]
  };
  void factorise_bands(double own);
  void solve_bands(double* r);  // in place

  StructuredRate& rate_;
  RateMatrix a_;
  bool implicit_ = false;
  std::vector<Part> parts_;
  core::DenseLu<double> border_;
  VectorXd d_parameter_;
  VectorXd ends_;  // X
};

void StructuredStage::factorise_bands(double own) {
  const Index n = rate_.coordinates();
  Index size = n;
  for (const RateFilm& film : rate_.films()) size += film.reach;
  MatrixXd v = MatrixXd::Identity(size, size);
  v.topLeftCorner(n, n) -= own * Map<const MatrixXd>(a_.data(), n, n);
  parts_.resize(rate_.films().size());
  Index end = n;  // of this film's last states in X
  for (std::size_t f = 0; f < parts_.size(); ++f) {
    const RateFilm& film = rate_.films()[f];
    Part& part = parts_[f];
    const Index count = film.at.count, reach = film.reach, inner = count - reach;
    Index seen = 0;
    part.inputs.resize(film.at.inputs, n);
    part.response.setZero(inner, film.at.inputs + reach);
    const auto input = [&](Index e) { return -own * a_.segment(film.inputs + e * film.stride, count); };
    for (Index e = 0; e < film.at.inputs; ++e) {
      if (a_(film.seen + e) == 0) continue;
      part.inputs.row(seen) = rate_.inputs().row(film.at.first_input + e);
      part.response.col(seen) = input(e).head(inner);
      v.block(end, 0, reach, n) += input(e).tail(reach) * part.inputs.row(seen);
      ++seen;
    }
    part.inputs.conservativeResize(seen, n);
    part.response.conservativeResize(inner, seen + reach);
    part.ends.setZero(inner, reach);
    // -own A at (k, j), in a ring.
    const auto each = [&](const auto& add) {
      for (std::size_t d = 0; d < film.shifts.size(); ++d)
        for (Index k = 0; k < count; ++k)
          add(k, (k + film.shifts[d] + count) % count,
              -own * a_(film.diagonals + static_cast<Index>(d) * film.stride + k));
    };
    const bool first = !part.band;
    if (first) part.band.emplace(static_cast<int>(inner), static_cast<int>(reach), VectorXd(), digits_lost);
    if (first || part.band->exchanged()) part.band->clear();
    VectorXd image = VectorXd::Ones(inner);  // of ones
    for (Index j = 0; j < inner; ++j)
      for (Index k = std::max<Index>(0, j - reach); k < std::min(inner, j + reach + 1); ++k)
        part.band->entry(static_cast<int>(k), static_cast<int>(j)) = k == j ? 1 : 0;
    each([&](Index k, Index j, double value) {
      if (k < inner && j < inner) {
        part.band->entry(static_cast<int>(k), static_cast<int>(j)) += value;
        image(k) += value;
      } else if (k < inner) {
        part.response(k, seen + j - inner) += value;
      } else if (j < inner) {
        part.ends(j, k - inner) -= value;
      } else {
        v(end + k - inner, end + j - inner) += value;
      }
    });
    part.band->factor();
    if (!((part.band->solve(image) - VectorXd::Ones(inner)).norm() <= digits_lost)) {
      Eigen::SparseMatrix<double> matrix(inner, inner);
      matrix.setIdentity();
      each([&](Index k, Index j, double value) {
        if (k < inner && j < inner) matrix.coeffRef(k, j) += value;
      });
      matrix.makeCompressed();
      (void)part.band->factor(matrix);
    }
    part.band->solve(false, part.response.data(), part.response.data(), part.response.cols());
    part.forces.resize(inner, film.at.forces);
    for (Index e = 0; e < film.at.forces; ++e) {
      const auto force = own * a_.segment(film.forces + e * film.stride, count);
      part.forces.col(e) = force.head(inner);
      v.block(0, end, n, reach) -= rate_.lead().col(film.at.first_force + e) * force.tail(reach).transpose();
    }
    // V - W B^-1 U, with -W = own (Q P, D) of the interior.
    const MatrixXd forces = rate_.lead().middleCols(film.at.first_force, film.at.forces) *
                            (part.forces.transpose() * part.response),
                   ends = part.ends.transpose() * part.response;
    v.topLeftCorner(n, n) += forces.leftCols(seen) * part.inputs;
    v.block(0, end, n, reach) += forces.rightCols(reach);
    v.block(end, 0, reach, n) += ends.leftCols(seen) * part.inputs;
    v.block(end, end, reach, reach) += ends.rightCols(reach);
    end += reach;
  }
  border_.compute(v);
  ends_.resize(size);
}

void StructuredStage::solve_bands(double* r) {
  const Index n = rate_.coordinates();
  ends_.head(n) = Map<const VectorXd>(r, n);
  Index end = n;
  for (std::size_t f = 0; f < parts_.size(); ++f) {
    const RateFilm& film = rate_.films()[f];
    const Part& part = parts_[f];
    double* s = r + n + film.at.first;
    const Index inner = film.at.count - film.reach;
    part.band->solve(false, s, s, 1);
    const Map<const VectorXd> interior(s, inner);
    ends_.head(n) +=
        rate_.lead().middleCols(film.at.first_force, film.at.forces) * (part.forces.transpose() * interior);
    ends_.segment(end, film.reach) = Map<const VectorXd>(s + inner, film.reach) + part.ends.transpose() * interior;
    end += film.reach;
  }
  ends_ = border_.solve(ends_);
  Map<VectorXd>(r, n) = ends_.head(n);
  end = n;
  for (std::size_t f = 0; f < parts_.size(); ++f) {
    const RateFilm& film = rate_.films()[f];
    const Part& part = parts_[f];
    const Index inner = film.at.count - film.reach, seen = part.inputs.rows();
    Map<VectorXd> s(r + n + film.at.first, film.at.count);
    s.head(inner).noalias() -= part.response.leftCols(seen) * (part.inputs * ends_.head(n));
    s.head(inner).noalias() -= part.response.rightCols(film.reach) * ends_.segment(end, film.reach);
    s.tail(film.reach) = ends_.segment(end, film.reach);
    end += film.reach;
  }
}

class StructuredStages final : public Stages {
public:
  explicit StructuredStages(std::unique_ptr<StructuredRate> rate) : rate_(std::move(rate)) {}
  std::unique_ptr<Stage> make() override { return std::make_unique<StructuredStage>(*rate_); }
  void refresh() override { rate_->refresh(); }
  [[nodiscard]] bool derivative_is_free() const override { return true; }

private:
  std::unique_ptr<StructuredRate> rate_;
};

}  // namespace

std::unique_ptr<Stages> structured_stages(problem::System& system, const Tableau& tableau) {
  auto rate = tableau.sequential() ? StructuredRate::make(system) : nullptr;
  if (!rate || (!tableau.is_explicit() && !rate->narrow())) return nullptr;
  return std::make_unique<StructuredStages>(std::move(rate));
}

}  // namespace whirl::solve
