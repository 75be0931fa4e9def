#include "core/eigen_kernels.hpp"

WHIRL_EIGEN_KERNELS(template, double)
WHIRL_EIGEN_KERNELS(template, std::complex<double>)
