#include "solve/bifurcation/critical_vectors.hpp"

#include <cmath>

namespace whirl::solve {

CriticalVectors generic_vectors(Eigen::Index n) {
  CriticalVectors out{ComplexVector(n), ComplexVector(n)};
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto t = static_cast<double>(k);
    out.p(k) = {std::sin(1 + t), std::cos(2 + 0.7 * t)};
    out.q(k) = {std::cos(3 + 1.3 * t), std::sin(2 + 1.7 * t)};
  }
  for (ComplexVector* v : {&out.q, &out.p}) v->normalize();
  return out;
}

std::complex<double> null_vectors(FrequencyResolvent& shifted, double omega, const CriticalVectors& borders,
                                  CriticalVectors& out) {
  shifted.factorise({0, omega}, borders.p, borders.q);
  const Eigen::Index n = shifted.size();
  const ComplexVector last = ComplexVector::Unit(n + 1, n), v = shifted.solve(last), w = shifted.solve_adjoint(last);
  out = {v.head(n), w.head(n)};
  return v(n);
}

// The first borders are generic, the second ones the null vectors themselves.
CriticalVectors critical_vectors(FrequencyResolvent& shifted, double omega) {
  const auto unit = [](CriticalVectors& vectors) {
    for (ComplexVector* v : {&vectors.q, &vectors.p}) *v *= std::sqrt(static_cast<double>(v->size())) / v->norm();
  };
  CriticalVectors out = generic_vectors(shifted.size());
  unit(out);
  for (int pass = 0; pass < 2; ++pass) {
    const CriticalVectors borders = out;
    null_vectors(shifted, omega, borders, out);
    unit(out);
  }
  return out;
}

}  // namespace whirl::solve
