// Stages of a machine that tells its structure, by factors that serve many of them: no matrix of all states is made.

#include <algorithm>
#include <cmath>
#include <vector>

#include "solve/newton/hub_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/sparse_lu.hpp"
#include "whirl/solve/shooting/runge_kutta.hpp"

namespace whirl::solve {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

constexpr std::size_t most_kept = 6;
constexpr double slow_refinement = 0.3;  // a refinement that converges slower pays for new factors
constexpr int most_refinements = 12;
constexpr double thin_tolerance = 1e-6;

bool near(double a, double b, double ratio) {
  return std::abs(a - b) <= ratio * std::abs(b);
}

class ThinStages final : public Stages {
public:
  explicit ThinStages(problem::System& system) : system_(system), point_(system, system.structure(), true) {}
  std::unique_ptr<Stage> make() override;
  void refresh() override {
    if (system_.parameter_is_speed())
      point_.refresh_speed();
    else
      point_.refresh();
  }
  [[nodiscard]] bool by_chords() const override { return true; }
  /// Those of films without own states come with their forces.
  [[nodiscard]] bool derivative_is_free() const override { return point_.own_states() == 0; }

private:
  friend class ThinStage;
  problem::System& system_;
  problem::ScaledPoint point_;
};

/// The rotor's part L1 + own L0 and each film's dg/ds' + own dg/ds are factorised once and kept while steps and speed
/// are nearly the same; what changes with the place of the journals (r forces) enters by a matrix of size r (Woodbury),
/// at the point itself. What the kept factors are off by is put right by refinement; where that does not converge fast
/// they are made anew. Chords go without refinement, with new factors for films that have states of their own. Throws
/// core::NotConverged if the matrix is singular.
class ThinStage final : public Stage {
public:
  explicit ThinStage(ThinStages& all) : all_(all), point_(all.point_), structure_(*all.system_.structure()) {}

  void residual(const StageGroup& group, In x, In k, Out f, bool ready) override {
    angle_ = group.angle(0);
    x_ = x.col(0);
    k_ = k.col(0);
    if (ready)
      point_.residual(angle_, x_, k_, f.col(0), at_);
    else
      point_.residual(angle_, x_, k_, f.col(0));
    known_ = ready;
  }

  void factorise(const StageGroup& group, In, In) override {
    here_ = {group.own(0, 0), all_.system_.parameter()};
    placed_ = false;
    lagging_ = group.lagging;
    if (!lagging_) return;
    known_ = false;
    at_.films.d_inputs.setZero();
    for (core::PartResponse& own : at_.films.own) own.inputs.setZero();
  }

  void solve(Out f, double tolerance) override {
    y_ = f.col(0);
    if (tolerance < 1) {
      refine(tolerance);
      f.col(0) = answer_;
      return;
    }
    if (!placed_) place(point_.own_states() > 0 || lagging_ ? nullptr : nearest());
    apply(y_, f.col(0));
  }

  void keep(const StageGroup& group, In x, In k) override {
    // Films without states of their own told their tangents with the residual there.
    if (!known_ || angle_ != group.angle(0) || x_ != x.col(0) || k_ != k.col(0)) {
      load_.resize(point_.size());
      residual(group, x, k, load_, true);
    }
    factorise(group, x, k);
  }

  void slopes(In w, bool loaded, Out dk) override {
    y_.resize(w.rows());
    for (Index c = 0; c < w.cols(); ++c) {
      point_.times(at_, w.col(c), VectorXd::Zero(w.rows()), y_);
      if (loaded && c + 1 == w.cols()) {
        load_.resize(point_.size());
        point_.parameter_derivative(angle_, at_, load_);
        y_ += load_;
      }
      y_ = -y_;
      refine(thin_tolerance);
      dk.col(c) = answer_;
    }
  }

  [[nodiscard]] StepOf factors(StepOf asked) const override { return now_ ? now_->of : asked; }

private:
  struct Film {
    core::SparseLu lu;  // of dg/ds' + own dg/ds
    MatrixXd by_input;  // its inverse times dg/dw [k x w]
    MatrixXd forces;    // df/ds' + own df/ds [f x k]
  };
  struct Factors {
    StepOf of;
    HubLu hub;  // of L1 + own L0
    std::vector<std::unique_ptr<Film>> films;
    long used = 0;
  };

  [[nodiscard]] Factors* nearest();
  Factors& factorise();
  void factorise_film(std::size_t which, Film& film) const;
  /// The matrix of size r for this point, by these factors or by new ones.
  void place(Factors* f);
  void apply(const VectorXd& y, Ref<VectorXd> x);
  /// answer_ = A^-1 y_ to |y - A x| <= tolerance |y|.
  void refine(double tolerance);

  ThinStages& all_;
  problem::ScaledPoint& point_;
  const problem::BlockStructure& structure_;
  double angle_ = 0;  // of the last residual:
  VectorXd x_, k_;
  problem::PointState at_;
  bool known_ = false;  // with tangents
  StepOf here_;         // of the last factorise():
  bool lagging_ = false, placed_ = false;
  std::vector<std::unique_ptr<Factors>> kept_;
  Factors* now_ = nullptr;               // what was placed:
  MatrixXd by_input_;                    // df/dw with what the films' states add [r x w]
  MatrixXd small_matrix_;                // I - own by_input C (L1 + own L0)^-1 B
  Eigen::PartialPivLU<MatrixXd> small_;  // not core::DenseLu, whose answers are new vectors
  long clock_ = 0;
  VectorXd y_, answer_, left_, more_, load_;   // work space
  VectorXd forces_, rhs_, inputs_, by_force_;  // of apply()
};

std::unique_ptr<Stage> ThinStages::make() {
  return std::make_unique<ThinStage>(*this);
}

ThinStage::Factors* ThinStage::nearest() {
  Factors* best = nullptr;
  for (const auto& f : kept_)
    if (f->of.is_near(here_) && (!best || std::abs(f->of.own - here_.own) < std::abs(best->of.own - here_.own)))
      best = f.get();
  return best;
}

void ThinStage::factorise_film(std::size_t which, Film& film) const {
  const problem::OwnStates& own = structure_.own()[which];
  const core::PartResponse& t = at_.films.own[which];
  const Index first = structure_.size() + own.first;
  const auto columns = point_.state_scale().segment(first, own.count);
  const VectorXd rows = point_.residual_scale().segment(first, own.count).cwiseInverse();
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(t.d_states.size() + t.d_rates.size());
  const auto add = [&](const std::vector<problem::EntryPlace>& places, const std::vector<double>& values,
                       double factor) {
    for (std::size_t e = 0; e < places.size(); ++e)
      entries.emplace_back(places[e].row, places[e].column,
                           factor * values[e] * rows(places[e].row) * columns(places[e].column));
  };
  add(own.states, t.d_states, here_.own);
  add(own.rates, t.d_rates, 1);
  problem::SparseBlock s(own.count, own.count);
  s.setFromTriplets(entries.begin(), entries.end());
  if (!film.lu.compute(s)) throw core::NotConverged("the matrix of a film's states is singular");
  film.by_input = film.lu.solve(MatrixXd(rows.asDiagonal() * t.inputs.transpose()));
  film.forces = here_.own * t.forces * columns.asDiagonal();
  if (t.force_rates.rows() > 0) film.forces += t.force_rates * columns.asDiagonal();
}

ThinStage::Factors& ThinStage::factorise() {
  now_ = nullptr;  // if this throws
  std::unique_ptr<Factors> made;
  // In place of those for the same step, or of those that were not used for longest.
  for (auto& f : kept_)
    if (near(here_.own, f->of.own, 1e-6)) made = std::move(f);
  std::erase(kept_, nullptr);
  if (!made && kept_.size() == most_kept) {
    const auto oldest =
        std::min_element(kept_.begin(), kept_.end(), [](const auto& p, const auto& q) { return p->used < q->used; });
    made = std::move(*oldest);
    kept_.erase(oldest);
  }
  if (!made) made = std::make_unique<Factors>();
  made->of = here_;
  const auto& blocks = point_.thin_blocks();
  if (!made->hub.factorise(blocks.l1 + here_.own * blocks.l0, blocks.b, blocks.c))
    throw core::NotConverged("the matrix of the rotor is singular");
  made->films.resize(structure_.own().size());
  for (std::size_t i = 0; i < made->films.size(); ++i) {
    if (!made->films[i]) made->films[i] = std::make_unique<Film>();
    factorise_film(i, *made->films[i]);
  }
  ++all_.factorisations_;
  kept_.push_back(std::move(made));
  return *kept_.back();
}

void ThinStage::place(Factors* f) {
  now_ = f ? f : &factorise();
  now_->used = ++clock_;
  by_input_ = at_.films.d_inputs;
  for (std::size_t i = 0; i < now_->films.size(); ++i) {
    const problem::OwnStates& own = structure_.own()[i];
    by_input_.block(own.first_force, own.first_input, own.forces, own.inputs) -=
        now_->films[i]->forces * now_->films[i]->by_input;
  }
  small_matrix_.noalias() = -now_->of.own * by_input_ * now_->hub.seen();
  small_matrix_.diagonal().array() += 1;
  small_.compute(small_matrix_);
  placed_ = true;
}

// A = [ M - own B D C   -B F ]     M = L1 + own L0, S = dg/ds' + own dg/ds, F = df/ds' + own df/ds, D = df/dw
//     [ own dg/dw C        S   ]
void ThinStage::apply(const VectorXd& y, Ref<VectorXd> x) {
  const Factors& f = *now_;
  const auto& blocks = point_.thin_blocks();
  const Index n = structure_.size();
  rhs_ = y.head(n);
  if (!f.films.empty()) {
    forces_.setZero(structure_.n_forces());
    for (std::size_t i = 0; i < f.films.size(); ++i) {
      const problem::OwnStates& own = structure_.own()[i];
      f.films[i]->lu.solve(y.data() + n + own.first, x.data() + n + own.first);
      forces_.segment(own.first_force, own.forces) += f.films[i]->forces * x.segment(n + own.first, own.count);
    }
    rhs_ += blocks.b * forces_;
  }
  f.hub.solve(rhs_, x.head(n));
  inputs_.noalias() = blocks.c * x.head(n);
  forces_.noalias() = by_input_ * inputs_;
  by_force_ = small_.solve(forces_);
  x.head(n).noalias() += f.of.own * (f.hub.lead() * by_force_);
  if (f.films.empty()) return;
  inputs_.noalias() += f.of.own * (f.hub.seen() * by_force_);
  for (std::size_t i = 0; i < f.films.size(); ++i) {
    const problem::OwnStates& own = structure_.own()[i];
    x.segment(n + own.first, own.count).noalias() -=
        f.of.own * (f.films[i]->by_input * inputs_.segment(own.first_input, own.inputs));
  }
}

void ThinStage::refine(double tolerance) {
  answer_.resize(y_.size());
  left_.resize(y_.size());
  more_.resize(y_.size());
  for (bool fresh = false;; fresh = true) {
    if (fresh) {
      place(nullptr);
    } else if (!placed_) {
      Factors* const f = nearest();
      fresh = !f;
      place(f);
    }
    apply(y_, answer_);
    double norm = y_.norm();
    const double wanted = tolerance * norm;
    const bool exact =
        point_.own_states() == 0 && here_.parameter == now_->of.parameter && near(here_.own, now_->of.own, 1e-13);
    bool good = exact;
    for (int k = 0; !exact && k < most_refinements; ++k) {
      point_.times(at_, here_.own * answer_, answer_, left_);
      left_ = y_ - left_;
      const double before = norm;
      norm = left_.norm();
      good = norm <= wanted;
      if (good || !(norm <= slow_refinement * before)) break;
      apply(left_, more_);
      answer_ += more_;
    }
    if (!good && !fresh) continue;
    // Of exact factors what may be singular is the matrix of the journals' forces. Else Newton's method tells what is
    // left.
    if (exact ? !answer_.allFinite() && y_.allFinite() : !good && !std::isfinite(norm))
      throw core::NotConverged("the matrix of a step in time is singular");
    return;
  }
}

}  // namespace

std::unique_ptr<Stages> thin_stages(problem::System& system) {
  return std::make_unique<ThinStages>(system);
}

}  // namespace whirl::solve
