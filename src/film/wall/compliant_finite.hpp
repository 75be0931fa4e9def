#pragma once
// Film of finite length in a full cylindrical bore with an elastic liner: the thickness on a mesh around and along the
// bearing is the state.

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "film/algebra/stencil.hpp"
#include "film/sheet/groove.hpp"
#include "film/wall/compliant.hpp"
#include "whirl/core/index.hpp"

namespace whirl::film {

// Between every node and the one `ahead` of it in the work space, a and b, goes f = w ((h_a + h_b)/2)^3 (P_b - P_a)
// from b to a: df/dh_a = df/dh_b = q, df/dP_b = -df/dP_a = k.
struct LinerFaces {
  std::vector<double> f, k, q;
  void set(double w, std::size_t ahead, const std::vector<double>& h, const std::vector<double>& p, Need need) {
    for (auto* values : {&f, &k, &q}) values->resize(h.size() - ahead);
    if (need == Need::tangents)
      fill<true>(w, f.size(), h.data(), h.data() + ahead, p.data(), p.data() + ahead, f.data(), k.data(), q.data());
    else
      fill<false>(w, f.size(), h.data(), h.data() + ahead, p.data(), p.data() + ahead, f.data(), k.data(), q.data());
  }

private:
  template <bool tangents>
  static void fill(double w, std::size_t n, const double* __restrict ha, const double* __restrict hb,
                   const double* __restrict pa, const double* __restrict pb, double* __restrict to,
                   double* __restrict by_p, double* __restrict by_h) {
    for (std::size_t x = 0; x < n; ++x) {
      const double h = 0.5 * (ha[x] + hb[x]), square = w * h * h, rise = pb[x] - pa[x];
      to[x] = square * h * rise;
      if constexpr (tangents) {
        by_p[x] = square * h;
        by_h[x] = 1.5 * square * rise;
      }
    }
  }
};

// Line i lies at theta = 90 deg + i d, its states j = 0 .. M - 2 at z = L ((j + 1)/M - 1/2); P = 0 on both edges,
// where the liner gives way to the asperities alone, without its damping: h = 1 - e_x cos - e_y sin if there are none.
// With the scales of the other compliant films and s = 1/(4 (L/D)^2 (dz/L)^2), (4.22) reads
//
//     dh/dt = -Omega/2 dh/dtheta + 1/2 (delta_theta (h^3 delta_theta P)/d^2 + s delta_z (h^3 delta_z P))
//
// with h at faces midway between nodes from both neighbours. A line in a groove has P = 0 and stays among the states,
// so that lines form a ring: its deflection u falls by du/dt = -kappa u and is zero if it was, kappa being the rate at
// which a film of nominal thickness would let a node go.
class FiniteFilm final : public CompliantModel {
public:
  FiniteFilm(const Geometry& geometry, const Compliant& options, const Lubricant& lubricant)
      : CompliantModel(geometry, options, options.cells[1], lubricant),
        cells_(options.cells[1]),
        fixed_(grooved(options.cells[0], options.grooves)) {
    const double slenderness = g_.length / g_.radius;  // 2 L/D
    by_step_ = 0.5 / (ring_.step() * ring_.step());
    by_length_ = 0.5 * cells_ * cells_ / (slenderness * slenderness);
    const double per_cell = 1.0 / cells_;
    for (int j = 1; j < cells_; ++j)
      z_weight_.push_back((ring_.nodal() ? (j % 2 == 0 ? 2.0 : 4.0) / 3.0 : 1.0) * per_cell);
    edge_weight_ = per_cell / (ring_.nodal() ? 3.0 : 2.0);
  }

  [[nodiscard]] std::size_t states() const override { return core::at(ring_.nodes() * inner()); }
  // At whole lines. A share sees `reach` lines on either side, in front of its own and behind them.
  [[nodiscard]] int cut(int near) const override { return (near + inner() / 2) / inner() * inner(); }
  [[nodiscard]] Share share(int begin, int end) const override;
  [[nodiscard]] std::unique_ptr<StateInverse> inverse(MPI_Comm comm, const Share& share) const override;
  void unloaded(const JournalMotion& motion, std::span<double> states) const override {
    for (int i = 0; i < ring_.nodes(); ++i)
      std::fill_n(states.begin() + i * inner(), inner(), rigid(motion, i) * g_.clearance);
  }
  void evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                std::span<const double> rates, Need need, StateResponse& response) override;
  void resample(const JournalMotion& motion, const Film& other, std::span<const double> from,
                std::span<double> to) const override;
  FilmReport summary(const JournalMotion& motion, std::span<const double> states) override;
  std::vector<NodalField> fields(const JournalMotion& motion, std::span<const double> states) override;

private:
  [[nodiscard]] int inner() const { return cells_ - 1; }
  [[nodiscard]] int reach() const { return neighbours_.reach; }
  [[nodiscard]] bool fixed(int line) const { return fixed_[ring_.index(line)]; }
  [[nodiscard]] std::array<double, 2> normal(int line) const { return {ring_.cosine(line), ring_.sine(line)}; }
  // Velocity of the journal away from a line.
  [[nodiscard]] double away(const JournalMotion& m, int line) const {
    return m.velocity[0] * ring_.cosine(line) + m.velocity[1] * ring_.sine(line);
  }
  // Node j (0 and `cells_` on the edges) of the line at `row` of the work space.
  [[nodiscard]] std::size_t node(int row, int j) const { return core::at(row * (cells_ + 1) + j); }
  void set(const JournalMotion& motion, Lines part, std::span<const double> states, std::span<const double> rates);
  void set_settled(const JournalMotion& motion, std::span<const double> states);
  void slopes(Lines part);
  void integrate(Lines part, Need need, StateResponse& response);
  void add_edges(int line, const LinerLaw::Edge& edge, Need need, Response& out) const;
  void rows(Lines part, const JournalMotion& motion, std::span<const double> rates, Need need, StateResponse& response);
  // Row i of the lines at hand; of all together there are `rows`.
  void hold(int i, int rows, int line, const JournalMotion& motion, const double* rates, Need need,
            StateResponse& response) const;
  void residual(int i, double speed, const double* rates, double* g) const;
  void by_states(int i, int rows, double speed, StateResponse& response) const;
  void by_journal(int i, int line, StateResponse& response);
  // kappa
  [[nodiscard]] double release() const { return 2.0 * (by_step_ + by_length_) * liner_.stiffness(); }

  int cells_;                               // along the bearing
  std::vector<bool> fixed_;                 // lines in grooves
  double by_step_ = 0.0, by_length_ = 0.0;  // 1/(2 d^2), s/2
  std::vector<double> z_weight_;            // of the mean along z, per inner node
  double edge_weight_ = 0.0;                // the same of an edge
  // Of the lines at hand and their neighbours, with the edges: in clearances thickness, deflection and its rate.
  std::vector<double> h_, u_, moved_;
  Carried carried_;
  std::vector<LinerLaw::Edge> edge_;  // of both edges of a line
  LinerFaces around_, along_;
  std::array<std::vector<double>, 2> slope_;  // d force*/d P at the states of the lines at hand
  std::vector<int> mixed_;                    // those in front of cells in which P changes its sign
};

}  // namespace whirl::film
