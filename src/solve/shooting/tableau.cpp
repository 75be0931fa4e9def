#include "whirl/solve/shooting/tableau.hpp"

#include <fmt/core.h>

#include <cmath>

#include "whirl/core/dense_lu.hpp"
#include "whirl/core/error.hpp"
#include "whirl/solve/cycle/scheme.hpp"

namespace whirl::solve {
namespace {

Tableau make(Eigen::MatrixXd a, Eigen::VectorXd b, int order) {
  Eigen::VectorXd c = a.rowwise().sum();
  return {std::move(a), std::move(b), std::move(c), order};
}

}  // namespace

bool Tableau::sequential() const {
  return a.isLowerTriangular(0);
}

bool Tableau::is_explicit() const {
  return sequential() && a.diagonal().isZero(0);
}

Tableau heun() {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2, 2);
  a(1, 0) = 1;
  return make(a, Eigen::Vector2d(0.5, 0.5), 2);
}

Tableau third_order() {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(3, 3);
  a(1, 0) = 1;
  a(2, 0) = a(2, 1) = 0.25;
  return make(a, Eigen::Vector3d(1, 1, 4) / 6, 3);
}

Tableau classical() {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(4, 4);
  a(1, 0) = a(2, 1) = 0.5;
  a(3, 2) = 1;
  return make(a, Eigen::Vector4d(1, 2, 2, 1) / 6, 4);
}

// x_l = x_0 + H sum a(l,j) K_j inverts H K_j = sum_l slope(j,l) (x_l - x_0).
Tableau radau_iia(int stages) {
  const Scheme s = make_scheme(stages, Points::radau);
  const Eigen::MatrixXd a = core::DenseLu<double>(s.slope.rightCols(stages)).inverse();
  return {a, a.row(stages - 1).transpose(), s.c, s.order()};
}

Tableau sdirk(int order) {
  if (order == 2) {
    const double g = 1 - std::sqrt(0.5);
    Eigen::MatrixXd a(2, 2);
    a << g, 0, 1 - g, g;
    return make(a, a.row(1).transpose(), 2);
  }
  if (order != 4) throw core::InputError(fmt::format("no SDIRK scheme of order {}: 2 or 4", order));
  Eigen::MatrixXd a(5, 5);
  a << 1.0 / 4, 0, 0, 0, 0,                                 //
      1.0 / 2, 1.0 / 4, 0, 0, 0,                            //
      17.0 / 50, -1.0 / 25, 1.0 / 4, 0, 0,                  //
      371.0 / 1360, -137.0 / 2720, 15.0 / 544, 1.0 / 4, 0,  //
      25.0 / 24, -49.0 / 48, 125.0 / 16, -85.0 / 12, 1.0 / 4;
  return make(a, a.row(4).transpose(), 4);
}

}  // namespace whirl::solve
