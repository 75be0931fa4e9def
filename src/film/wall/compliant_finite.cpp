// Force, residual and tangents of the film of finite length.
#include "film/wall/compliant_finite.hpp"

#include <Eigen/Core>
#include <algorithm>

#include "film/algebra/ring_preconditioner.hpp"
#include "whirl/core/error.hpp"

namespace whirl::film {

using core::at;
using Array = Eigen::Map<const Eigen::ArrayXd>;

void FiniteFilm::set(const JournalMotion& motion, Lines part, std::span<const double> states,
                     std::span<const double> rates) {
  const int rows = part.count() + 2 * reach(), first = part.begin - reach();
  core::require(states.size() == at(rows * inner()), "lines of a film with their neighbours");
  const std::size_t n = at(inner());
  if (h_.size() != node(rows, 0)) {
    for (auto* values : {&h_, &u_, &moved_}) values->assign(node(rows, 0), 0.0);
    carried_.resize(h_.size());
    edge_.resize(at(rows));
  }
  const double per_clearance = 1.0 / g_.clearance;
  for (int row = 0; row < rows; ++row) {
    const int line = first + row;
    const double r = rigid(motion, line), *s = states.data() + row * inner(), *rate = rates.data() + row * inner();
    double* __restrict h = &h_[node(row, 1)], * __restrict u = &u_[node(row, 1)], * __restrict v = &moved_[node(row, 1)];
    edge_[at(row)] = fixed(line) ? LinerLaw::Edge{r} : liner_.edge(r);
    h_[node(row, 0)] = h_[node(row, cells_)] = edge_[at(row)].h;
    for (std::size_t j = 0; j < n; ++j) {
      h[j] = s[j] * per_clearance;
      u[j] = h[j] - r;
    }
    if (fixed(line)) std::fill_n(u, n, 0.0);
    const double moved = away(motion, line);
    for (std::size_t j = 0; j < n && liner_.damped(); ++j) v[j] = per_clearance * (rate[j] + moved);
  }
  if (!(Array(h_.data(), static_cast<Eigen::Index>(h_.size())).minCoeff<Eigen::PropagateNaN>() > 0.0))
    throw core::DomainError("the journal touches the liner: the film thickness is not positive");
  liner_.carry(h_, u_, moved_, 0, carried_);
  for (int row = 0; row < rows; ++row)
    if (fixed(first + row))
      carried_.clear(node(row, 0), n + 2);
    else
      for (const int j : {0, cells_})
        for (auto* values : {&carried_.p, &carried_.by_h, &carried_.by_u, &carried_.by_rate})
          (*values)[node(row, j)] = 0.0;
}

// For reports.
void FiniteFilm::set_settled(const JournalMotion& motion, std::span<const double> states) {
  const Lines all{0, ring_.nodes()};
  const std::vector<double> rates = balanced_rates(motion, states);
  set(motion, all, seen_of(whole(), states), seen_of(whole(), rates));
}

// dF*/dP at every state; F* = -int max(P, 0) (cos, sin), around the bearing at every inner node of z, is homogeneous in
// P. A cell around the bearing with P < 0 at one end counts by itself.
void FiniteFilm::slopes(Lines part) {
  for (auto& values : slope_) values.resize(at(part.count() * inner()));
  const std::size_t stride = node(1, 0);
  const double* w = z_weight_.data();
  const int n = inner();
  const auto add_part = [&](int i, int j, double a, double b) {
    const RingQuadrature::Weights of = ring_.part(part.begin + i, a, b);
    for (std::size_t d = 0; d < 2; ++d) {
      if (i >= 0) slope_[d][at(i * n + j)] += w[j] * of.left[d];
      if (i + 1 < part.count()) slope_[d][at((i + 1) * n + j)] += w[j] * of.right[d];
    }
  };
  mixed_.clear();
  for (int i = 0; i < part.count(); ++i) {
    const double *p = &carried_.p[node(i + reach(), 1)], *pb = p - stride, *pf = p + stride;
    const auto [bx, by] = ring_.full(part.begin + i - 1).right;
    const auto [ax, ay] = ring_.full(part.begin + i).left;
    double* __restrict x = &slope_[0][at(i * n)], * __restrict y = &slope_[1][at(i * n)];
    if (ring_.nodal()) {
      for (int j = 0; j < n; ++j) {
        const double weight = p[j] > 0.0 ? w[j] : 0.0;
        x[j] = weight * (bx + ax);
        y[j] = weight * (by + ay);
      }
      continue;
    }
    long parts_before = 0, parts_after = 0;
    for (int j = 0; j < n; ++j) {
      const double a = pb[j], b = p[j], c = pf[j];
      const double before = a >= 0.0 && b >= 0.0 && a + b > 0.0 ? w[j] : 0.0,
                   after = b >= 0.0 && c >= 0.0 && b + c > 0.0 ? w[j] : 0.0;
      x[j] = before * bx + after * ax;
      y[j] = before * by + after * ay;
      parts_before |= a * b < 0.0 ? 1 : 0;
      parts_after |= b * c < 0.0 ? 1 : 0;
    }
    if (i == 0 && parts_before != 0) mixed_.push_back(-1);
    if (parts_after != 0) mixed_.push_back(i);
  }
  for (const int i : mixed_) {
    const double *p = &carried_.p[node(i + reach(), 1)], *pf = p + stride;
    for (int j = 0; j < n; ++j)
      if (p[j] * pf[j] < 0.0) add_part(i, j, p[j], pf[j]);
  }
}

// F* = -int (max(P, 0) + contact) (cos, sin) of the nodes of a part.
void FiniteFilm::integrate(Lines part, Need need, StateResponse& response) {
  slopes(part);
  Response& out = response.journal;
  const auto n = static_cast<Eigen::Index>(inner());
  const Array z(z_weight_.data(), n);
  for (int i = 0; i < part.count(); ++i) {
    const std::size_t x = node(i + reach(), 1), k = at(i * inner());
    const Array sx(&slope_[0][k], n), sy(&slope_[1][k], n), p(&carried_.p[x], n);
    out.force[0] += scales_.force * (sx * p).sum();
    out.force[1] += scales_.force * (sy * p).sum();
    if (!liner_.touches()) continue;
    const double touched = scales_.force * (z * Array(&carried_.contact[x], n)).sum();
    for (std::size_t d = 0; d < 2; ++d) out.force[d] += ring_.node(part.begin + i)[d] * touched;
    add_edges(part.begin + i, edge_[at(i + reach())], need, out);
  }
  if (need == Need::force) return;
  const double scale = scales_.force / g_.clearance;
  for (int i = 0; i < part.count(); ++i) {
    const std::size_t x = node(i + reach(), 1), k = at(i * inner());
    const std::array<double, 2> normal = this->normal(part.begin + i);
    const Array sx(&slope_[0][k], n), sy(&slope_[1][k], n), by_u(&carried_.by_u[x], n), by_h(&carried_.by_h[x], n),
        by_rate(&carried_.by_rate[x], n);
    Eigen::Map<Eigen::ArrayXd> fx(response.of_force(0) + k, n), fy(response.of_force(1) + k, n);
    fx = scale * sx * by_h;
    fy = scale * sy * by_h;
    if (liner_.touches()) {
      const auto [wx, wy] = ring_.node(part.begin + i);
      const Array stiff(&carried_.stiff[x], n);
      fx += scale * wx * z * stiff;
      fy += scale * wy * z * stiff;
    }
    const auto add = [&](const Array& by, std::array<std::array<double, 4>, 4>& to) {
      const std::array<double, 2> slope = {scale * (sx * by).sum(), scale * (sy * by).sum()};
      for (std::size_t d = 0; d < 2; ++d)
        for (std::size_t e = 0; e < 2; ++e) to[d][e] += slope[d] * normal[e];
    };
    add(by_u, out.d_position);
    if (!liner_.damped()) continue;
    Eigen::Map<Eigen::ArrayXd>(response.of_force_rate(0) + k, n) = scale * sx * by_rate;
    Eigen::Map<Eigen::ArrayXd>(response.of_force_rate(1) + k, n) = scale * sy * by_rate;
    add(by_rate, out.d_velocity);
  }
}

// Asperities on both edges of a line.
void FiniteFilm::add_edges(int line, const LinerLaw::Edge& edge, Need need, Response& out) const {
  const std::array<double, 2> full = ring_.node(line), normal = this->normal(line);
  for (std::size_t d = 0; d < 2; ++d) {
    const double weight = scales_.force * 2.0 * edge_weight_ * full[d];
    out.force[d] += weight * edge.contact.pressure;
    for (std::size_t e = 0; e < 2 && need == Need::tangents; ++e)
      out.d_position[d][e] -= weight * edge.contact.slope * edge.by_rigid * normal[e] / g_.clearance;
  }
}

void FiniteFilm::rows(Lines part, const JournalMotion& motion, std::span<const double> rates, Need need,
                      StateResponse& response) {
  around_.set(by_step_, node(1, 0), h_, carried_.p, need);
  along_.set(by_length_, 1, h_, carried_.p, need);
  for (int i = 0; i < part.count(); ++i) {
    const int line = part.begin + i;
    const double* rate = rates.data() + (i + reach()) * inner();
    if (fixed(line)) {
      hold(i, part.count() * inner(), line, motion, rate, need, response);
      continue;
    }
    residual(i, motion.speed, rate, &response.residual[at(i * inner())]);
    if (need == Need::force) continue;
    by_states(i, part.count() * inner(), motion.speed, response);
    by_journal(i, line, response);
  }
}

// A line in a groove.
void FiniteFilm::hold(int i, int rows, int line, const JournalMotion& motion, const double* rates, Need need,
                      StateResponse& response) const {
  const std::size_t begin = at(i * inner()), n = at(inner());
  const double moved = away(motion, line), r = rigid(motion, line), *h = &h_[node(i + reach(), 1)];
  for (std::size_t j = 0; j < n; ++j)
    response.residual[begin + j] = rates[j] + moved + release() * g_.clearance * (h[j] - r);
  if (need == Need::force) return;
  const auto fill = [&](double* values, double value) { std::fill_n(values + begin, n, value); };
  for (const auto& [values, centre] : {std::pair{&response.d_states, release()}, std::pair{&response.d_rates, 1.0}})
    for (std::size_t place = 0; place * at(rows) < values->size(); ++place)
      fill(values->data() + place * at(rows), place == Stencil::centre ? centre : 0.0);
  fill(response.d_speed.data(), 0.0);
  const std::array<double, 2> away_from = normal(line);
  for (std::size_t d = 0; d < 2; ++d) {
    fill(response.by_position(d), release() * away_from[d]);
    fill(response.by_velocity(d), away_from[d]);
  }
}

void FiniteFilm::residual(int i, double speed, const double* rates, double* __restrict g) const {
  const double c = g_.clearance, wedge = 0.5 * c * speed / ring_.step();
  const double w0 = wedge * neighbours_.slope[0], w1 = wedge * neighbours_.slope[1], w2 = wedge * neighbours_.slope[2],
               w3 = wedge * neighbours_.slope[3];
  const std::size_t stride = node(1, 0), x = node(i + reach(), 1);
  const double *h = &h_[x], *hb = h - stride, *hf = h + stride, *hs = reach() == 2 ? hb - stride : hb,
               *after = &around_.f[x], *before = after - stride, *above = &along_.f[x], *below = above - 1;
  for (int j = 0; j < inner(); ++j) {
    const double slope = w0 * hs[j] + w1 * hb[j] + w2 * h[j] + w3 * hf[j],
                 in = after[j] - before[j] + above[j] - below[j];
    g[j] = rates[j] + slope - c * in;
  }
}

// The P of a node follows its h and the journal; on an edge P is zero and h follows.
void FiniteFilm::by_states(int i, int rows, double speed, StateResponse& response) const {
  const double wedge = 0.5 * speed / ring_.step();
  const auto [w0, w1, w2, w3] = neighbours_.slope;
  const std::size_t stride = node(1, 0), x = node(i + reach(), 1), begin = at(i * inner());
  const int n = inner();
  const double *ka = &around_.k[x], *kb = ka - stride, *kz = &along_.k[x], *qa = &around_.q[x], *qb = qa - stride,
               *qz = &along_.q[x];
  const auto place = [&](Stencil::Place p, std::vector<double>& of) {
    return Stencil::at(p, at(rows), of.data()) + begin;
  };
  // Of the P that `by` moves, and of the h at faces (flow = 1) or not.
  const auto set = [&](const std::vector<double>& by, double flow, std::array<double, 3> wedge_of,
                       std::vector<double>& s) {
    const auto [before, centre, after] = wedge_of;
    const double *here = &by[x], *pb = here - stride, *pf = here + stride;
    double* __restrict to = place(Stencil::centre, s);
    double* __restrict to_before = place(Stencil::before, s);
    double* __restrict to_after = place(Stencil::after, s);
    double* __restrict to_below = place(Stencil::below, s);
    double* __restrict to_above = place(Stencil::above, s);
    for (int j = 0; j < n; ++j) {
      to[j] = centre - flow * (qa[j] - qb[j] + qz[j] - qz[j - 1]) + here[j] * (ka[j] + kb[j] + kz[j] + kz[j - 1]);
      to_before[j] = before + flow * qb[j] - pb[j] * kb[j];
      to_after[j] = after - flow * qa[j] - pf[j] * ka[j];
      to_below[j] = flow * qz[j - 1] - here[j - 1] * kz[j - 1];
      to_above[j] = -flow * qz[j] - here[j + 1] * kz[j];
    }
    to_below[0] = to_above[n - 1] = 0.0;
  };
  set(carried_.by_h, 1.0, {w1 * wedge, w2 * wedge, w3 * wedge}, response.d_states);
  if (reach() == 2) std::fill_n(place(Stencil::second_before, response.d_states), n, w0 * wedge);
  if (liner_.damped()) set(carried_.by_rate, 0.0, {0.0, 1.0, 0.0}, response.d_rates);
}

void FiniteFilm::by_journal(int i, int line, StateResponse& response) {
  const std::size_t stride = node(1, 0), x = node(i + reach(), 1), begin = at(i * inner());
  const int n = inner();
  const auto [w0, w1, w2, w3] = neighbours_.slope;
  const double *ka = &around_.k[x], *kb = ka - stride, *kz = &along_.k[x], *h = &h_[x], *hb = h - stride,
               *hf = h + stride, *hs = reach() == 2 ? hb - stride : hb;
  const double wedge = 0.5 * g_.clearance / ring_.step();
  double* __restrict by_speed = &response.d_speed[begin];
  for (int j = 0; j < n; ++j) by_speed[j] = wedge * (w0 * hs[j] + w1 * hb[j] + w2 * h[j] + w3 * hf[j]);
  const auto [cb, sb] = normal(line - 1);
  const auto [c, s] = normal(line);
  const auto [cf, sf] = normal(line + 1);
  // Of the P that `by` moves with the journal.
  const auto through = [&, c = c, s = s, cb = cb, sb = sb, cf = cf, sf = sf](const std::vector<double>& by,
                                                                             double* of_x, double* of_y) {
    const double *here = &by[x], *pb = here - stride, *pf = here + stride;
    double* __restrict to_x = of_x + begin, * __restrict to_y = of_y + begin;
    for (int j = 0; j < n; ++j) {
      const double before = kb[j] * pb[j], after = ka[j] * pf[j],
                   centre =
                       (ka[j] + kb[j] + kz[j] + kz[j - 1]) * here[j] - kz[j - 1] * here[j - 1] - kz[j] * here[j + 1];
      to_x[j] = centre * c - before * cb - after * cf;
      to_y[j] = centre * s - before * sb - after * sf;
    }
  };
  through(carried_.by_u, response.by_position(0), response.by_position(1));
  if (liner_.damped()) through(carried_.by_rate, response.by_velocity(0), response.by_velocity(1));
  const double follow = edge_[at(i + reach())].by_rigid;
  for (const auto& [j, by_edge] : {std::pair{0, along_.q[x - 1]}, std::pair{n - 1, -along_.q[x + at(n - 1)]}}) {
    response.by_position(0)[begin + at(j)] -= by_edge * follow * c;
    response.by_position(1)[begin + at(j)] -= by_edge * follow * s;
  }
}

Share FiniteFilm::share(int begin, int end) const {
  const int line = inner(), n = static_cast<int>(states()), rows = end - begin;
  core::require(begin % line == 0 && end % line == 0, "a film that is cut at whole lines");
  Share out{begin, end, {}, {}, {}};
  for (int k = begin - reach() * line; k < end + reach() * line; ++k) out.seen.push_back((k % n + n) % n);
  // In the order of Stencil; with the zeros at the ends of lines, so that every diagonal is in one piece.
  const int own = reach() * line;
  for (const int offset : {0, -line, line, -1, 1}) out.d_states.add({0, own + offset, rows});
  if (reach() == 2) out.d_states.add({0, own - 2 * line, rows});
  for (const int offset : {0, -line, line, -1, 1})
    if (offset == 0 || liner_.damped()) out.d_rates.add({0, own + offset, rows});
  return out;
}

std::unique_ptr<StateInverse> FiniteFilm::inverse(MPI_Comm comm, const Share& share) const {
  const Lines here{share.begin / inner(), share.end / inner()};
  int least = here.count();
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT, MPI_MIN, comm);
  if (least < 2) return nullptr;
  return std::make_unique<RingPreconditioner>(comm, ring_.nodes(), inner(), here);
}

void FiniteFilm::evaluate(const JournalMotion& motion, const Share& share, std::span<const double> states,
                          std::span<const double> rates, Need need, StateResponse& response) {
  const Lines part{share.begin / inner(), share.end / inner()};
  set(motion, part, states, rates);
  resize(share, need, response);
  if (!liner_.damped()) std::fill(response.d_rates.begin(), response.d_rates.end(), 1.0);
  response.journal.min_thickness =
      g_.clearance * Array(&h_[node(reach(), 0)], static_cast<Eigen::Index>(node(part.count(), 0))).minCoeff();
  integrate(part, need, response);
  rows(part, motion, rates, need, response);
}

std::unique_ptr<Film> make(const Geometry& geometry, const CompliantFinite& options, const Lubricant& lubricant) {
  return used(options, std::make_unique<FiniteFilm>(geometry, options, lubricant));
}

}  // namespace whirl::film
