#include "whirl/thermal/cylinder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace whirl::thermal {

double Cylinder::angle(int i) const {
  constexpr double turn = 2 * std::numbers::pi;
  const int n = columns();
  if (n == 1) return turn;
  const bool first = i == 0, last = i == n - 1;
  const double before = first ? (closed ? theta.back() - turn : theta.front()) : theta[at(i - 1)];
  const double after = last ? (closed ? theta.front() + turn : theta.back()) : theta[at(i + 1)];
  return (after - before) / 2;
}

double Cylinder::depth(int q) const {
  return (z[at(std::min(q + 1, rows() - 1))] - z[at(std::max(q - 1, 0))]) / 2;
}

std::vector<double> graded(double from, double to, int layers, double ratio) {
  double sum = 0, step = 1;
  for (int k = 0; k < layers; ++k, step *= ratio) sum += step;
  std::vector<double> faces{from};
  step = (to - from) / sum;
  for (int k = 0; k < layers; ++k, step *= ratio) faces.push_back(faces.back() + step);
  faces.back() = to;
  return faces;
}

std::vector<double> beyond(double length, double step, double growth) {
  std::vector<double> out;
  double reached = 0;
  while (reached < length * (1 - 1e-12)) {
    reached += step;
    step *= growth;
    out.push_back(reached);
  }
  for (double& x : out) x *= length / reached;
  return out;
}

std::vector<double> columns_beside(const Mesh& film, bool ring) {
  std::vector<double> theta;
  for (int i = 0; i < film.nodes_around(); ++i) theta.push_back(film.theta(i));
  if (film.closed || !ring) return theta;
  const double gap = 2 * std::numbers::pi - film.extent;
  const int n = std::max(2, static_cast<int>(std::ceil(gap / (film.extent / film.around) - 1e-9)));
  for (int i = 1; i < n; ++i) theta.push_back(film.begin + film.extent + gap * i / n);
  return theta;
}

std::vector<double> cell_ends(const std::vector<double>& nodes, double period) {
  std::vector<double> out;
  if (nodes.empty()) return out;
  out.push_back(period > 0 ? (nodes.front() + nodes.back() - period) / 2 : nodes.front());
  for (std::size_t n = 0; n + 1 < nodes.size(); ++n) out.push_back((nodes[n] + nodes[n + 1]) / 2);
  out.push_back(period > 0 ? out.front() + period : nodes.back());
  return out;
}

}  // namespace whirl::thermal
