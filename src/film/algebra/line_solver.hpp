#pragma once
// Tridiagonal work on many lines side by side: arrays are [along the line][lines], so that loops over lines run in
// vector registers.

#include <array>
#include <vector>

#include "whirl/core/index.hpp"

namespace whirl::film {

/// Of a preconditioner, which no digit of the result depends on: half the bytes, twice the lanes of a register.
using Real = float;

using core::at;

// Values at lines first .. first + count - 1 of one colour, with one neighbour's column on either side.
struct Columns {
  int length = 0, count = 0, stride = 0;
  std::vector<Real> data;
  Columns() = default;
  Columns(int along, int columns) : length(along), count(columns), stride(columns + 2) {
    data.assign(at(length * stride), Real{0});
  }
  [[nodiscard]] Real* row(int z) { return data.data() + z * stride + 1; }
  [[nodiscard]] const Real* row(int z) const { return data.data() + z * stride + 1; }
};

// A block that is tridiagonal along the line: entries of row z at z - 1, z, z + 1.
struct Block {
  Columns below, centre, above;
  Block() = default;
  Block(int along, int columns) : below(along, columns), centre(along, columns), above(along, columns) {}
  std::array<Columns*, 3> parts() { return {&below, &centre, &above}; }
};

// Exact solves with the blocks on the diagonal, all lines at once.
class LineSolver {
public:
  void factor(const Block& own) {
    const int n = own.centre.count;
    inverse_ = own.centre;
    lower_ = own.below;
    upper_ = own.above;
    for (int z = 0; z < inverse_.length; ++z) {
      Real *inv = inverse_.row(z), *low = lower_.row(z);
      const Real *before = z > 0 ? inverse_.row(z - 1) : nullptr, *up = z > 0 ? upper_.row(z - 1) : nullptr;
      for (int i = 0; i < n; ++i) {
        if (before) low[i] *= before[i];
        inv[i] = Real{1} / (before ? inv[i] - low[i] * up[i] : inv[i]);
      }
    }
  }
  void solve(Columns& x) const {
    const int n = x.count, length = x.length;
    for (int z = 1; z < length; ++z) {
      Real* __restrict y = x.row(z);
      const Real* __restrict before = x.row(z - 1), * __restrict low = lower_.row(z);
      for (int i = 0; i < n; ++i) y[i] -= low[i] * before[i];
    }
    for (int z = length - 1; z >= 0; --z) {
      Real* __restrict y = x.row(z);
      const Real *__restrict after = z + 1 < length ? x.row(z + 1) : nullptr, *__restrict up = upper_.row(z),
                             *__restrict inv = inverse_.row(z);
      if (after)
        for (int i = 0; i < n; ++i) y[i] = (y[i] - up[i] * after[i]) * inv[i];
      else
        for (int i = 0; i < n; ++i) y[i] *= inv[i];
    }
  }
  // With the transposed blocks: U^T w = x, then L^T.
  void solve_transposed(Columns& x) const {
    const int n = x.count, length = x.length;
    for (int z = 0; z < length; ++z) {
      Real* y = x.row(z);
      for (int i = 0; i < n; ++i) {
        if (z > 0) y[i] -= upper_.row(z - 1)[i] * x.row(z - 1)[i];
        y[i] *= inverse_.row(z)[i];
      }
    }
    for (int z = length - 2; z >= 0; --z) {
      Real* y = x.row(z);
      const Real *after = x.row(z + 1), *low = lower_.row(z + 1);
      for (int i = 0; i < n; ++i) y[i] -= low[i] * after[i];
    }
  }

private:
  Columns lower_, upper_, inverse_;
};

// to -= a x + b y + c z, in one sweep over `to`.
inline void subtract(int n, const Real* __restrict a, const Real* __restrict x, const Real* __restrict b,
                     const Real* __restrict y, const Real* __restrict c, const Real* __restrict z,
                     Real* __restrict to) {
  for (int i = 0; i < n; ++i) to[i] -= a[i] * x[i] + b[i] * y[i] + c[i] * z[i];
}
inline void subtract(int n, const Real* __restrict a, const Real* __restrict x, Real* __restrict to) {
  for (int i = 0; i < n; ++i) to[i] -= a[i] * x[i];
}

// y -= block x, with x of the neighbour `shift` columns on; a diagonal block has only its centre.
inline void subtract(const Block& block, bool diagonal, const Columns& x, int shift, Columns& y) {
  const int n = y.count;
  for (int z = 0; z < y.length; ++z) {
    Real* to = y.row(z);
    const Real *a = block.centre.row(z), *v = x.row(z) + shift;
    const bool below = !diagonal && z > 0, above = !diagonal && z + 1 < y.length;
    if (below && above) {
      subtract(n, a, v, block.below.row(z), x.row(z - 1) + shift, block.above.row(z), x.row(z + 1) + shift, to);
      continue;
    }
    subtract(n, a, v, to);
    if (below) subtract(n, block.below.row(z), x.row(z - 1) + shift, to);
    if (above) subtract(n, block.above.row(z), x.row(z + 1) + shift, to);
  }
}

}  // namespace whirl::film
