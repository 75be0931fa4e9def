#include "study/bearing/journal_locus.hpp"

#include <algorithm>
#include <cmath>

#include "whirl/core/error.hpp"
#include "whirl/core/pivoted_lu.hpp"
#include "whirl/film/contract/share.hpp"

namespace whirl::study {
namespace {

using Eigen::Index;

std::size_t at_index(Index k) {
  return static_cast<std::size_t>(k);
}

}  // namespace

double JournalLocus::Node::eccentricity() const {
  return std::hypot(place[0], place[1]);
}

// Scaled so that the Euclidean norm takes the mean square of the states.
JournalLocus::JournalLocus(film::Film& film, double clearance, double speed, double load)
    : film_(film),
      clearance_(clearance),
      load_(load),
      scale_(film.states()),
      rows_(film.states()),
      rest_(film.states()) {
  motion_.speed = speed;
  const double root = std::sqrt(static_cast<double>(film.states()));
  for (const film::StateField& f : film.state_fields())
    f.each([&](int k) {
      scale_[static_cast<std::size_t>(k)] = f.scale * root;
      rows_[static_cast<std::size_t>(k)] = f.row_scale() * root;
    });
}

JournalLocus::Vector JournalLocus::pack(const Node& node) const {
  Vector z(static_cast<Index>(scale_.size()) + 2);
  for (std::size_t k = 0; k < scale_.size(); ++k) z(static_cast<Index>(k)) = node.states[k] / scale_[k];
  z.tail<2>() = Eigen::Vector2d(node.place[0], node.place[1]);
  return z;
}

JournalLocus::Node JournalLocus::unpack(const Vector& z) const {
  Node node{std::vector<double>(scale_.size()), {z(z.size() - 2), z(z.size() - 1)}};
  for (std::size_t k = 0; k < scale_.size(); ++k) node.states[k] = z(static_cast<Index>(k)) * scale_[k];
  return node;
}

double JournalLocus::rise(const Point& p) {
  return p.z.tail<2>().normalized().dot(p.tangent.tail<2>());
}

// Rows: g, F_x, and what closes the equations,
//
//     | dg/ds      dg/d(x, y)   |
//     | dF_x/ds    dF_x/d(x, y) |
//     |         closing         |
//
// which is regular at folds too, where dg/ds with F_x need not be.
Eigen::SparseMatrix<double> JournalLocus::matrix(const Vector& closing) const {
  const auto n = static_cast<Index>(scale_.size());
  std::vector<Eigen::Triplet<double>> entries;
  const film::Share& whole = film_.whole();
  film::for_entries(whole, whole.d_states, at_.d_states, [&](int i, int j, double v) {
    entries.emplace_back(i, j, v * scale_[static_cast<std::size_t>(j)] / rows_[static_cast<std::size_t>(i)]);
  });
  for (std::size_t port = 0; port < 2; ++port) {
    const Index column = n + static_cast<Index>(port);
    for (Index k = 0; k < n; ++k)
      entries.emplace_back(k, column, at_.inputs(static_cast<Eigen::Index>(port), k) * clearance_ / rows_[at_index(k)]);
    entries.emplace_back(n, column, at_.journal.d_position[0][port] * clearance_ / load_);
  }
  for (Index k = 0; k < n; ++k) entries.emplace_back(n, k, at_.forces(0, k) * scale_[at_index(k)] / load_);
  for (Index k = 0; k < n + 2; ++k) entries.emplace_back(n + 1, k, closing(k));
  Eigen::SparseMatrix<double> out(n + 2, n + 2);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

// Newton's method; `closing` gives the last row and its residual. The tangent points to where the last row rises.
std::optional<JournalLocus::Point> JournalLocus::newton(Vector z, const Closing& closing) {
  constexpr int most = 12;
  constexpr double enough = 1e-10;
  const auto n = static_cast<Index>(scale_.size());
  double before = INFINITY;
  try {
    for (int steps = 1; steps <= most; ++steps) {
      const Node node = unpack(z);
      motion_.position = {node.place[0] * clearance_, node.place[1] * clearance_, 0, 0};
      film_.evaluate(motion_, node.states, rest_, film::Need::tangents, at_);
      const auto [row, miss] = closing(z);
      const core::PivotedLu<double> lu(matrix(row));
      if (!lu.regular()) return std::nullopt;
      Vector residual(n + 2);
      for (Index k = 0; k < n; ++k) residual(k) = at_.residual[at_index(k)] / rows_[at_index(k)];
      residual(n) = at_.journal.force[0] / load_;
      residual(n + 1) = miss;
      const Vector step = lu.solve(residual);
      const double size = step.norm();
      if (!(size < before || size <= enough || film_.whole_steps())) return std::nullopt;
      z -= step;
      before = size;
      if (size > enough) continue;
      return Point{z, lu.solve(Vector(Vector::Unit(n + 2, n + 1))).normalized(), steps, at_.journal.force[1]};
    }
  } catch (const core::DomainError& e) {
    why = e.what();
  } catch (const core::NotConverged& e) {
    why = e.what();
  }
  return std::nullopt;
}

std::optional<JournalLocus::Point> JournalLocus::along(const Vector& from, const Vector& direction, double length) {
  return newton(from + length * direction, [&](const Vector& z) {
    return std::pair{direction, direction.dot(z - from) - length};
  });
}

std::optional<JournalLocus::Point> JournalLocus::held(Vector z, double eccentricity) {
  return newton(std::move(z), [&](const Vector& here) {
    Vector row = Vector::Zero(here.size());
    row.tail<2>() = here.tail<2>().normalized();
    return std::pair{row, here.tail<2>().norm() - eccentricity};
  });
}

JournalLocus::Node JournalLocus::turn(const Point& from, double step) {
  const bool rises = rise(from) > 0;
  Vector low = from.z;
  double begin = 0, end = step;
  for (int k = 0; k < 60 && end - begin > 1e-10 * step; ++k) {
    const double middle = 0.5 * (begin + end);
    const auto p = along(from.z, from.tangent, middle);
    if (!p) break;
    if ((rise(*p) > 0) == rises) {
      low = p->z;
      begin = middle;
    } else {
      end = middle;
    }
  }
  return unpack(low);
}

// Steps that bend little; where even a short one bends it is a kink, of a film whose tangents jump. A curve that has
// turned back by half of its farthest eccentricity, or for the hundredth time, has turned for good.
void JournalLocus::follow(Node start, double most) {
  constexpr double longest = 0.1, shortest = 1e-7, straight = 0.98, kink = 1e-4, kinked = 0.5, back = 0.5;
  constexpr int few = 4;
  constexpr std::size_t most_folds = 100, most_nodes = 10000;
  nodes = {std::move(start)};
  end = End::lost;
  auto here = held(pack(nodes.front()), nodes.front().eccentricity());
  if (!here) return;
  double step = 0.25 * longest, farthest_yet = nodes.front().eccentricity();
  while (step >= shortest && farthest_yet < most && nodes.back().eccentricity() > back * farthest_yet &&
         folds.size() < most_folds && nodes.size() < most_nodes) {
    why.clear();
    const auto next = along(here->z, here->tangent, step);
    if (!next || next->tangent.dot(here->tangent) < (step > kink ? straight : kinked)) {
      step /= 2;
      continue;
    }
    if (!(next->lift > 0)) break;
    if ((rise(*next) > 0) != (rise(*here) > 0)) {
      nodes.push_back(turn(*here, step));
      folds.push_back(nodes.back().eccentricity());
    }
    nodes.push_back(unpack(next->z));
    farthest_yet = farthest().eccentricity();
    here = next;
    if (here->steps <= few) step = std::min(1.4 * step, longest);
  }
  if (farthest_yet >= most)
    end = End::reached;
  else if (&farthest() != &nodes.back())
    end = End::fold;
}

const JournalLocus::Node& JournalLocus::farthest() const {
  return *std::ranges::max_element(nodes, {}, &Node::eccentricity);
}

std::optional<JournalLocus::Node> JournalLocus::at(double eccentricity) {
  const auto above = std::ranges::find_if(nodes, [&](const Node& n) { return n.eccentricity() >= eccentricity; });
  if (above == nodes.end() || (above == nodes.begin() && above->eccentricity() != eccentricity)) return std::nullopt;
  if (above->eccentricity() == eccentricity) return *above;
  Vector low = pack(*(above - 1)), high = pack(*above);
  // Close to a fold the chord is far from the curve: it is halved until Newton's method stays near.
  for (int k = 0; k < 40; ++k) {
    const double e_low = low.tail<2>().norm(), e_high = high.tail<2>().norm();
    const double share = e_high > e_low ? (eccentricity - e_low) / (e_high - e_low) : 0.5;
    const Vector chord = high - low;
    const Vector guess = low + std::clamp(share, 0.0, 1.0) * chord;
    const auto found = held(guess, eccentricity);
    if (found && (found->z - guess).norm() <= 0.5 * chord.norm()) return unpack(found->z);
    const auto middle = along(low, chord.normalized(), 0.5 * chord.norm());
    if (!middle) return std::nullopt;
    (middle->z.tail<2>().norm() < eccentricity ? low : high) = middle->z;
  }
  return std::nullopt;
}

}  // namespace whirl::study
