#pragma once
// Eigen's kernels of dense products, triangular and sparse solutions, compiled once: other files call them. Without
// these declarations every file compiles its own, which makes a quarter of all machine code.

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <complex>

// clang-format off
// `kind` is `extern template` here and `template` in the file that compiles them.
#define WHIRL_GEMV(kind, T, matrix, vector) \
  kind struct general_matrix_vector_product<Index, T, const_blas_data_mapper<T, Index, matrix>, matrix, false, \
                                            T, const_blas_data_mapper<T, Index, vector>, false, 0>;
#define WHIRL_GEMM_PACK(kind, T, map, order, panel) \
  kind struct gemm_pack_lhs<T, Index, map<T, Index, order>, gebp_traits<T, T>::mr, gebp_traits<T, T>::LhsProgress, \
                            typename gebp_traits<T, T>::LhsPacket4Packing, order, false, panel>; \
  kind struct gemm_pack_rhs<T, Index, map<T, Index, order>, gebp_traits<T, T>::nr, order, false, panel>;
#define WHIRL_TRIANGLE(kind, T, mode, order) \
  kind struct triangular_solve_matrix<T, Index, OnTheLeft, mode, false, order, ColMajor, 1>; \
  kind struct triangular_solve_vector<T, T, Index, OnTheLeft, mode, false, order>;
#define WHIRL_EIGEN_KERNELS(kind, T) \
  namespace Eigen { \
  namespace internal { \
  kind struct gebp_kernel<T, T, Index, blas_data_mapper<T, Index, ColMajor>, gebp_traits<T, T>::mr, \
                          gebp_traits<T, T>::nr, false, false>; \
  WHIRL_GEMM_PACK(kind, T, const_blas_data_mapper, ColMajor, false) \
  WHIRL_GEMM_PACK(kind, T, const_blas_data_mapper, RowMajor, false) \
  WHIRL_GEMM_PACK(kind, T, blas_data_mapper, ColMajor, true) \
  WHIRL_GEMV(kind, T, ColMajor, ColMajor) \
  WHIRL_GEMV(kind, T, ColMajor, RowMajor) \
  WHIRL_GEMV(kind, T, RowMajor, ColMajor) \
  WHIRL_GEMV(kind, T, RowMajor, RowMajor) \
  WHIRL_TRIANGLE(kind, T, Upper, ColMajor) \
  WHIRL_TRIANGLE(kind, T, UnitLower, ColMajor) \
  WHIRL_TRIANGLE(kind, T, Lower, RowMajor) \
  WHIRL_TRIANGLE(kind, T, UnitUpper, RowMajor) \
  kind struct partial_lu_impl<T, ColMajor, int>; \
  } \
  kind void PartialPivLU<Matrix<T, Dynamic, Dynamic>>::compute(); \
  kind void SparseLU<SparseMatrix<T>, COLAMDOrdering<int>>::analyzePattern(const SparseMatrix<T>&); \
  kind void SparseLU<SparseMatrix<T>, COLAMDOrdering<int>>::factorize(const SparseMatrix<T>&); \
  }
// clang-format on

WHIRL_EIGEN_KERNELS(extern template, double)
WHIRL_EIGEN_KERNELS(extern template, std::complex<double>)
