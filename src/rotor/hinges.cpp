#include "whirl/rotor/hinges.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>

#include "whirl/core/error.hpp"
#include "whirl/rotor/element.hpp"
#include "whirl/rotor/shaft.hpp"

namespace whirl::rotor {
namespace {

struct Hinge {
  std::size_t coupling, segment;  // from 0
  double place;                   // m
};

std::vector<Hinge> hinges_of(const Options& o) {
  const std::vector<double> z = node_positions(o);
  std::vector<Hinge> out;
  for (std::size_t k = 0; k < o.segments.size(); ++k)
    if (const Coupling* c = coupling_at(o, k); c && !(c->tilt_stiffness > 0))
      out.push_back({static_cast<std::size_t>(c - o.couplings.data()), k, z[k] + o.segments[k].length / 2});
  return out;
}

// Straight between hinges: u = a + b z/l + sum c_k max(0, z - h_k)/l, l the length of the shaft.
class Bent {
public:
  explicit Bent(const Options& o) : z_(node_positions(o)), hinges_(hinges_of(o)) {}
  [[nodiscard]] const std::vector<Hinge>& hinges() const { return hinges_; }
  [[nodiscard]] Eigen::Index size() const { return 2 + static_cast<Eigen::Index>(hinges_.size()); }
  [[nodiscard]] bool has(int node) const { return node >= 1 && node <= static_cast<int>(z_.size()); }
  /// Displacement and slope times l of a node by a, b and all c_k.
  [[nodiscard]] Eigen::MatrixXd at(int node) const {
    const double z = z_[static_cast<std::size_t>(node - 1)], l = length();
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2, size());
    rows.leftCols<2>() << 1, z / l, 0, 1;
    for (Eigen::Index k = 2; k < size(); ++k)
      if (const double beyond = z - hinges_[static_cast<std::size_t>(k - 2)].place; beyond > 0)
        rows.col(k) << beyond / l, 1;
    return rows;
  }
  [[nodiscard]] double length() const { return z_.back(); }
  [[nodiscard]] int nodes() const { return static_cast<int>(z_.size()); }

private:
  std::vector<double> z_;
  std::vector<Hinge> hinges_;
};

// Which a, b, c_k leave at rest what is held, in columns.
Eigen::MatrixXd left_free(const Bent& bent, const std::vector<int>& nodes, const std::vector<int>& slopes) {
  std::vector<Eigen::RowVectorXd> held;
  for (const int node : nodes)
    if (bent.has(node)) held.emplace_back(bent.at(node).row(0));
  for (const int node : slopes)
    if (bent.has(node)) held.emplace_back(bent.at(node).row(1));
  if (held.empty()) return Eigen::MatrixXd::Identity(bent.size(), bent.size());
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(held.size()), bent.size());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) rows.row(i) = held[static_cast<std::size_t>(i)];
  Eigen::FullPivLU<Eigen::MatrixXd> lu(rows);
  lu.setThreshold(1e-10);  // entries are of order one, but for supports that stand close together
  if (lu.dimensionOfKernel() == 0) return Eigen::MatrixXd(bent.size(), 0);
  return lu.kernel();
}

}  // namespace

Eigen::MatrixXd free_motions(const Options& o, const std::vector<int>& nodes, const std::vector<int>& slopes) {
  const Bent bent(o);
  const Eigen::MatrixXd motions = left_free(bent, nodes, slopes);
  Eigen::MatrixXd out(2 * bent.nodes(), motions.cols());
  for (int node = 1; node <= bent.nodes(); ++node) {
    out.middleRows(2 * (node - 1), 2) = bent.at(node) * motions;
    out.row(2 * node - 1) /= bent.length();
  }
  return out;
}

std::optional<Loose> loose_part(const Options& o, const std::vector<int>& nodes, const std::vector<int>& slopes) {
  if (o.type == Options::Type::rigid || o.segments.empty()) return std::nullopt;
  const Bent bent(o);
  const std::vector<Hinge>& hinges = bent.hinges();
  if (hinges.empty()) return std::nullopt;
  const Eigen::MatrixXd motions = left_free(bent, nodes, slopes);
  if (motions.cols() == 0) return std::nullopt;
  const auto moves = [&](int node) {
    return (bent.at(node) * motions).cwiseAbs().maxCoeff() > 1e-8 * motions.cwiseAbs().maxCoeff();
  };
  Loose out;
  for (int node = 1; node <= bent.nodes(); ++node) {
    // Each part between two hinges moves by itself, in displacement or slope at all of its nodes.
    if (!moves(node)) {
      if (out.from > 0) break;
      continue;
    }
    if (out.from == 0) out.from = node;
    out.to = node;
  }
  // The hinge at its left end, of a part that begins with the shaft the first one.
  const auto left = std::find_if(hinges.begin(), hinges.end(),
                                 [&](const Hinge& h) { return static_cast<int>(h.segment) + 2 >= out.from; });
  core::require(left != hinges.end(), "a hinge beside what is free to move");
  out.coupling = left->coupling;
  return out;
}

std::string words(const Loose& loose, const Options& options, const std::string& held) {
  const std::string who = loose.from == loose.to ? fmt::format("node {} is", loose.from)
                                                 : fmt::format("nodes {} to {} are", loose.from, loose.to);
  return fmt::format("held {}, {} free to move: the coupling of segment {} has no 'tilt_stiffness'", held, who,
                     options.couplings[loose.coupling].segment);
}

}  // namespace whirl::rotor
