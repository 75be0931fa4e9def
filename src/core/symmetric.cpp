#include "whirl/core/symmetric.hpp"

#include "whirl/core/error.hpp"
#include "whirl/core/lapack.hpp"

extern "C" {
void dsyev_(const char* job, const char* triangle, const int* n, double* a, const int* lda, double* w, double* work,
            const int* lwork, int* info);
void dsygv_(const int* type, const char* job, const char* triangle, const int* n, double* a, const int* lda, double* b,
            const int* ldb, double* w, double* work, const int* lwork, int* info);
void dposv_(const char* triangle, const int* n, const int* columns, double* a, const int* lda, double* b,
            const int* ldb, int* info);
}

namespace whirl::core {
namespace {

// `call` of LAPACK leaves the vectors in `a`.
template <class Call>
SymmetricPairs pairs(Eigen::MatrixXd& a, bool vectors, const std::string& what, const Call& call) {
  SymmetricPairs out;
  out.values.resize(a.rows());
  if (a.rows() == 0) return out;
  const int info = with_workspace<double>(
      [&](double* work, const int* size, int* result) { call(out.values.data(), work, size, result); });
  if (info > static_cast<int>(a.rows())) throw NotConverged(what + " is not positive definite");
  if (info != 0) throw NotConverged(what + ": its eigenvalues did not converge");
  if (vectors) out.vectors = std::move(a);
  return out;
}

}  // namespace

SymmetricPairs symmetric_pairs(Eigen::MatrixXd a, const std::string& what) {
  if (!a.allFinite()) throw NotConverged(what + " is not finite");
  const int n = static_cast<int>(a.rows());
  return pairs(a, true, what, [&](double* values, double* work, const int* size, int* info) {
    dsyev_("V", "L", &n, a.data(), &n, values, work, size, info);
  });
}

SymmetricPairs symmetric_pairs(Eigen::MatrixXd a, Eigen::MatrixXd b, const std::string& what, bool vectors) {
  if (!a.allFinite() || !b.allFinite()) throw NotConverged(what + ": a matrix is not finite");
  const int n = static_cast<int>(a.rows()), type = 1;
  return pairs(a, vectors, what, [&](double* values, double* work, const int* size, int* info) {
    dsygv_(&type, vectors ? "V" : "N", "L", &n, a.data(), &n, b.data(), &n, values, work, size, info);
  });
}

Eigen::MatrixXd solve_definite(Eigen::MatrixXd a, Eigen::MatrixXd b, const std::string& what) {
  const auto n = static_cast<int>(a.rows()), columns = static_cast<int>(b.cols());
  if (n == 0 || columns == 0) return b;
  int info = 0;
  dposv_("L", &n, &columns, a.data(), &n, b.data(), &n, &info);
  if (info != 0) throw NotConverged(what + " is not positive definite");
  return b;
}

}  // namespace whirl::core
