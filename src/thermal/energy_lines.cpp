#include "thermal/energy_lines.hpp"

#include <algorithm>

#include "whirl/core/index.hpp"

namespace whirl::thermal {

using core::at;

namespace {

// What a flow brings in its own direction.
double carried(double flow) {
  return flow > 0 ? flow : 0.0;
}

}  // namespace

EnergyLines::EnergyLines(const EnergyTerms& terms, int sweeps)
    : terms_(terms),
      wanted_(sweeps),
      halo_(terms.rows(), at(terms.rows().mesh().nodes_around()) * at(terms.rows().mesh().across), 1) {
  const std::size_t l = at(terms.rows().mesh().across);
  rhs_.resize(l);
  lower_.resize(l);
  upper_.resize(l);
}

void EnergyLines::update() {
  const Rows& rows = terms_.rows();
  double flows[2] = {0, 0};  // to larger i, to smaller ones
  for (const double m : terms_.flow().around) flows[m < 0] += std::abs(m);
  MPI_Allreduce(MPI_IN_PLACE, flows, 2, MPI_DOUBLE, MPI_SUM, rows.comm());
  forward_ = flows[0] >= flows[1];
  const bool reverses = flows[0] > 0 && flows[1] > 0;
  sweeps_ = wanted_ > 0 ? wanted_ : reverses ? 4 : 2;
  inverse_.resize(terms_.flow().heat.size());
  for (int j = rows.begin(); j < rows.end(); ++j)
    for (int i = 0; i < rows.mesh().nodes_around(); ++i) factor(i, j);
}

// The diagonal of the first-order operator is all that leaves a cell.
void EnergyLines::factor(int i, int j) {
  const Rows& rows = terms_.rows();
  const Mesh& mesh = rows.mesh();
  const Flow& flow = terms_.flow();
  const int n = mesh.nodes_around(), l = mesh.across;
  const double c = terms_.laws().heat_capacity();
  const PetscInt node = rows.node(i, j), first = node * l;
  const int left = (i + n - 1) % n;
  const bool entry = !mesh.closed && i == 0;
  const PetscInt node_left = rows.node(left, j), node_above = rows.node(i, j + 1);
  const double* from_left =
      entry ? flow.entry.data() + at(j - rows.begin()) * at(l) : flow.around.data() + node_left * l;
  const double *to_right = flow.around.data() + first, *along = flow.along.data() + first;
  const double* above = flow.along.data() + node_above * l;
  const double *across = flow.across.data() + node * (l + 1), *inflow = flow.inflow.data() + first;
  const double around = terms_.around(node) + (entry ? 0.0 : terms_.around(node_left));
  const double sides = around + terms_.along(node) + terms_.along(node_above), layer = terms_.across(node);
  const double* mix = terms_.mixing(node);
  const auto conduct = [&](int k) { return mix ? layer * mix[k] : layer; };  // from layer k - 1 to k
  double* inverse = inverse_.data() + first;
  double upper = 0;  // over the pivot, of the layer below
  for (int k = 0; k < l; ++k) {
    double diagonal = sides + c * (carried(to_right[k]) + carried(-from_left[k]) + carried(above[k]) +
                                   carried(-along[k]) + carried(-inflow[k]));
    if (k == 0) diagonal += terms_.wall_heat(false, node, 0).slope;
    if (k + 1 == l) diagonal += terms_.wall_heat(true, node, 0).slope;
    if (k > 0) diagonal += c * carried(-across[k]) + conduct(k);
    if (k + 1 < l) diagonal += c * carried(across[k + 1]) + conduct(k + 1);
    if (k > 0) diagonal -= (c * carried(across[k]) + conduct(k)) * upper;
    inverse[k] = 1 / diagonal;
    if (k + 1 < l) upper = (c * carried(-across[k + 1]) + conduct(k + 1)) * inverse[k];
  }
}

void EnergyLines::column(int i, int j, const double* r, double* x) {
  const Rows& rows = terms_.rows();
  const Mesh& mesh = rows.mesh();
  const Flow& flow = terms_.flow();
  const int n = mesh.nodes_around(), l = mesh.across;
  const double c = terms_.laws().heat_capacity();
  const PetscInt node = rows.node(i, j), first = node * l;
  double* __restrict rhs = rhs_.data(), * __restrict lower = lower_.data(), * __restrict upper = upper_.data();
  std::copy_n(r + first, l, rhs);
  // `sign` times the flow comes from the neighbour.
  const auto bring = [&](double sign, const double* m, double g, const double* from) {
    for (int k = 0; k < l; ++k) rhs[k] += (carried(sign * c * m[k]) + g) * from[k];
  };
  if (mesh.closed || i > 0) {
    const PetscInt left = rows.node((i + n - 1) % n, j);
    bring(1, flow.around.data() + left * l, terms_.around(left), x + left * l);
  }
  if (mesh.closed || i + 1 < n) {
    const PetscInt right = rows.node((i + 1) % n, j);
    bring(-1, flow.around.data() + first, terms_.around(node), x + right * l);
  }
  const std::ptrdiff_t here = static_cast<std::ptrdiff_t>(i) * l;
  if (const double* below = halo_.row(j - 1)) bring(1, flow.along.data() + first, terms_.along(node), below + here);
  if (const double* above = halo_.row(j + 1)) {
    const PetscInt next = rows.node(i, j + 1);
    bring(-1, flow.along.data() + next * l, terms_.along(next), above + here);
  }
  const double *across = flow.across.data() + node * (l + 1), *inverse = inverse_.data() + first;
  const double layer = terms_.across(node);
  const double* mix = terms_.mixing(node);
  for (int k = 0; k < l; ++k) {
    rhs[k] *= inverse[k];
    lower[k] = (carried(c * across[k]) + (mix ? layer * mix[k] : layer)) * inverse[k];
    upper[k] = (carried(-c * across[k + 1]) + (mix ? layer * mix[k + 1] : layer)) * inverse[k];
  }
  for (int k = 1; k < l; ++k) rhs[k] += lower[k] * rhs[k - 1];
  double* y = x + first;
  y[l - 1] = rhs[l - 1];
  for (int k = l - 2; k >= 0; --k) y[k] = rhs[k] + upper[k] * y[k + 1];
}

void EnergyLines::sweep(bool up, bool right, const double* r, double* x) {
  const Rows& rows = terms_.rows();
  const int n = rows.mesh().nodes_around();
  for (int b = 0; b < rows.count(); ++b) {
    const int j = up ? rows.begin() + b : rows.end() - 1 - b;
    for (int a = 0; a < n; ++a) column(right ? a : n - 1 - a, j, r, x);
  }
}

void EnergyLines::apply(const double* r, double* x) {
  std::fill_n(x, inverse_.size(), 0.0);
  for (int s = 0; s < sweeps_; ++s) {
    if (s == 0)
      halo_.isolate(x);
    else
      halo_.exchange(x);
    sweep(s % 2 == 0, (s % 4 < 2) == forward_, r, x);
  }
}

}  // namespace whirl::thermal
