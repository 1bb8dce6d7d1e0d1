// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace iota::solver {

/// Factors a pivot block in place: unit lower L11 below the diagonal, reciprocal pivots on it, and for LU the rest of U11
/// above it. `Number`: a double, or several that go side by side. judge(k, pivot) sees each pivot.
template <bool Symmetric, int Pivot, class Number, class Judge>
inline void factor_pivot_block(Number (&d)[Pivot][Pivot], Judge judge) {
  for (int k = 0; k < Pivot; ++k) {
    judge(k, d[k][k]);
    const Number inverse = 1.0 / d[k][k];
    d[k][k] = inverse;
    if constexpr (Symmetric) {
      Number column[Pivot];
      for (int i = k + 1; i < Pivot; ++i) {
        column[i] = d[i][k];
        d[i][k] = column[i] * inverse;
        for (int j = k + 1; j <= i; ++j) d[i][j] -= d[i][k] * column[j];
      }
    } else {
      for (int i = k + 1; i < Pivot; ++i) {
        d[i][k] *= inverse;
        for (int j = k + 1; j < Pivot; ++j) d[i][j] -= d[i][k] * d[k][j];
      }
    }
  }
}

/// One row l of the blocks below a factored pivot block, L21 = A21 U11^-1, and the transposed column u of U12 (symmetric:
/// L21 D). In: those of the matrix; u counts for LU only.
template <bool Symmetric, int Pivot, class Number>
inline void factor_row_below(const Number (&d)[Pivot][Pivot], Number (&l)[Pivot], Number (&u)[Pivot]) {
  for (int k = 0; k < Pivot; ++k) {
    if constexpr (Symmetric) {
      u[k] = l[k];
      for (int j = 0; j < k; ++j) u[k] -= u[j] * d[k][j];
      l[k] = u[k] * d[k][k];
    } else {
      for (int j = 0; j < k; ++j) {
        l[k] -= l[j] * d[j][k];
        u[k] -= u[j] * d[k][j];
      }
      l[k] *= d[k][k];
    }
  }
}

}  // namespace iota::solver
