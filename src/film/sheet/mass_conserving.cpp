// Mass-conserving cavitation of a pad: pressure where the gap is full, a deficit of oil where it is not.
//
// With the fill theta (the part of the gap that holds oil) the flow around the pad is Omega h theta/2 less that of the
// pressure; p >= 0, theta <= 1, p (1 - theta) = 0 (Jakobsson and Floberg 1957, Olsson 1965; as one equation for p and
// theta Elrod and Adams 1974). In the deficit s = |Omega| (1 - theta), which the flow carries along, node by node
//
//     A p + v src - D s = 0,   (D s)_i = v (h_(i+1/2) s_i - h_(i-1/2) s_(i-1))/(2 dtheta)   for Omega > 0
//
// with the deficit of the node upstream on each face. Both A and -D have positive diagonals and columns that sum to
// zero or more, and so has every matrix made of columns of either: p and s are the positive and the negative part of
// one unknown w, whose equation is piecewise linear and is solved by Newton's method on the set of full nodes. No
// tuning, no regularisation; two to six factorisations from nothing, one or two from a neighbouring place.
//
// Around a whole circle a row without a node that is held can be in the cavity as a whole: its columns sum to zero
// within the row, the matrix is singular, and how much oil goes round is not determined. It is regular if every such
// row has a full node: from each node the columns then lead to a side or to a node that is held. Where oil comes in, it
// has one: what enters a row in the cavity cannot leave it. So the iteration leaves at least one node of each such row
// full, and a row without pressure at its end runs dry.
//
// A film without own states does not know how fast its cavity fills: the void (1 - theta) h is taken as constant in
// time as the journal moves. At rest this is exact.
#include <algorithm>
#include <cmath>

#include "film/sheet/banded_pad.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

void BandedPad::enter_conserving(double edge_fill) {
  const std::size_t n = source_.size();
  full_.assign(n, 1);
  deficit_.assign(n, 0.0);
  diagonal_.assign(n, 1.0);
  void_at_edge_ = 1.0 - edge_fill;
  if (!pad_.closed) return;
  for (int j = 0; j < rows_; ++j) {
    bool held_anywhere = false;
    for (int i = 0; i < grid_.n_theta; ++i) held_anywhere |= held(i, j);
    if (!held_anywhere) unheld_rows_.push_back(j);
  }
}

// The node of a row around a whole circle that is nearest to being full.
std::size_t BandedPad::fullest(int row) const {
  std::size_t best = at(0, row);
  for (int i = 1; i < grid_.n_theta; ++i)
    if (x_[at(i, row)] > x_[best]) best = at(i, row);
  return best;
}

// s at a node: of a column in a groove zero, as in a hole, at the edge where the oil enters what is given.
double BandedPad::deficit_at(int i, int j) const {
  if (!wall(i)) return deficit_[at(wrap(i), j)];
  return !pad_.closed && i == (ahead_ > 0 ? 0 : grid_.n_theta) ? std::abs(speed_) * void_at_edge_ : 0.0;
}

void BandedPad::solve_conserving() {
  constexpr int kMost = 100;
  constexpr double kRounding = 1e-13;
  const std::size_t n = source_.size();
  for (int i = first_; i < grid_.n_theta; ++i)
    for (int j = 0; j < rows_; ++j) {
      const double around_it = a_.value[around(wrap(i - 1), j)] + a_.value[around(i, j)];
      const double up = j + 1 < z_faces_ ? b_.value[along(i, j + 1)] : 0.0;
      diagonal_[at(i, j)] = held(i, j) ? 1.0 : share(j) * around_it + b_.value[along(i, j)] + up;
    }
  // The next place starts from nothing.
  const auto give_up = [this] { std::fill(full_.begin(), full_.end(), 1); };
  int iteration = 0;
  double largest = 0.0;
  do {
    if (++iteration > kMost) {
      give_up();
      throw core::NotConverged("the cavitated region of a film did not settle");
    }
    assemble_conserving();
    band_.factor();
    ++factorisations_;
    band_.solve(false, x_.data(), x_.data(), 1);
    largest = 0.0;
    bool finite = true;
    for (const double w : x_) {
      largest = std::max(largest, std::abs(w));
      finite &= std::isfinite(w);
    }
    if (!finite) {
      give_up();
      throw core::NotConverged("the equations of a film that conserves its mass are singular");
    }
    before_ = full_;
    // Rounding alone does not move the rupture.
    for (std::size_t k = 0; k < n; ++k)
      full_[k] = cavitated_[k] || x_[k] > (full_[k] ? -kRounding : kRounding) * largest;
    for (const int j : unheld_rows_) full_[fullest(j)] = 1;
  } while (full_ != before_);
  for (const int j : unheld_rows_) {
    if (x_[fullest(j)] > kRounding * largest) continue;
    give_up();
    throw core::DomainError("a film runs dry: what comes through its holes does not reach its whole length");
  }
  // From w to pressure and deficit; s_k = diagonal/carried of the face downstream times -w.
  for (int i = first_; i < grid_.n_theta; ++i)
    for (int j = 0; j < rows_; ++j) {
      const std::size_t k = at(i, j);
      deficit_[k] = full_[k] ? 0.0 : -x_[k] * diagonal_[k] / carried(ahead_ > 0 ? i : i - 1, j);
      if (!full_[k]) x_[k] = 0.0;
    }
}

// The equations in w, with the columns of A at full nodes and those of -D, scaled to the same diagonal, elsewhere; and
// their right-hand side in x_.
void BandedPad::assemble_conserving() {
  band_.clear();
  for (int i = first_; i < grid_.n_theta; ++i)
    for (int j = 0; j < rows_; ++j) {
      const std::size_t here = at(i, j);
      const auto entry = [&](std::size_t there) -> double& {
        return band_.entry(static_cast<int>(here), static_cast<int>(there));
      };
      entry(here) = diagonal_[here];
      x_[here] = 0.0;
      if (cavitated_[here]) {
        x_[here] = held_pressure(i, j);
        continue;
      }
      x_[here] -= source_[here];
      const auto along_it = [&](int other, double value) {
        const std::size_t there = at(i, other);
        if (full_[there]) entry(there) -= value;
      };
      if (j > 0) along_it(j - 1, b_.value[along(i, j)]);
      if (j + 1 < rows_) along_it(j + 1, b_.value[along(i, j + 1)]);
      for (const int side : {i - 1, i + 1}) {
        const bool upstream = side == i - ahead_;
        const int face = std::min(side, i);
        if (wall(side)) {
          const double p = wall_pressure(side);
          x_[here] += share(j) * a_.value[around(wrap(face), j)] * p;
          if (upstream) x_[here] -= carried(face, j) * deficit_at(side, j);
          continue;
        }
        const std::size_t there = at(wrap(side), j);
        if (full_[there])
          entry(there) -= share(j) * a_.value[around(wrap(face), j)];
        else if (upstream)
          entry(there) -= diagonal_[there];
      }
    }
}

// Force by the trapezoidal rule with exact means of cos and sin, and its derivatives in w into load_.
void BandedPad::integrate_conserving(Need need, Response& response) {
  const double area = pad_.radius * grid_.dtheta * grid_.dz * grid_.mean * std::cos(0.5 * grid_.dtheta);
  std::fill(load_.begin(), load_.end(), Quad::zero());
  Quad force = Quad::zero();
  for (int i = first_; i < grid_.n_theta; ++i) {
    const auto node = static_cast<std::size_t>(i);
    const double cosine = -area * grid_.node_cos[node], sine = -area * grid_.node_sin[node];
    for (int j = 0; j < rows_; ++j) {
      const std::size_t k = at(i, j);
      const double times = whole_ ? 1.0 : 2.0 * share(j), z = tilt_ ? row_z(j) : 0.0;
      const Quad weight = {Quad::Vector{times * cosine, times * sine, times * z * cosine, times * z * sine}};
      force += x_[k] * weight;
      if (need == Need::tangents && full_[k]) load_[k] = weight;
    }
  }
  for (int f = 0; f < 4; ++f) response.force[static_cast<std::size_t>(f)] += force[f];
}

// Film that is ruptured within a cell or cut off counts as it is written in the equations.
std::optional<Flows> BandedPad::flows(const JournalMotion& motion) {
  if (cavitation_ == Reynolds::Cavitation::half_sommerfeld) return {};
  Response ignored;
  solved_.reset();
  add(motion, Need::force, ignored);
  const bool conserving = cavitation_ == Reynolds::Cavitation::mass_conserving;
  return PadEquations::flows([&](int i, int j) { return pressure_at(i, j); },
                             [&](int i, int j) { return conserving ? deficit_at(i, j) : 0.0; });
}

}  // namespace whirl::film
