// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

namespace iota::solver {

/// Calls body(i) for i = 0 ... N-1, each a constant, so that small arrays can be in registers. Otherwise a compiler
/// makes copies and vectors of such short loops, with three times the instructions. The caller must be `flatten`.
template <int N, class Body>
inline void unroll(Body body) {
  [&]<int... i>(std::integer_sequence<int, i...>) {
    (body(std::integral_constant<int, i>{}), ...);
  }(std::make_integer_sequence<int, N>{});
}

/// Factors a pivot block in place: unit lower L11 below the diagonal, reciprocal pivots on it, and for LU the rest of U11
/// above it. `Number`: a double, or several in SIMD lanes. judge(k, pivot) is called for each pivot.
template <bool Symmetric, int Pivot, class Number, class Judge>
inline void factor_pivot_block(Number (&d)[Pivot][Pivot], Judge judge) {
  unroll<Pivot>([&](auto k) {
    judge(k, d[k][k]);
    const Number inverse = 1.0 / d[k][k];
    d[k][k] = inverse;
    Number column[Pivot];
    unroll<Pivot - 1 - k>([&](auto below) {
      constexpr int i = k + 1 + below;
      if constexpr (Symmetric) {
        column[i] = d[i][k];
        d[i][k] = column[i] * inverse;
        unroll<i - k>([&](auto right) { d[i][k + 1 + right] -= d[i][k] * column[k + 1 + right]; });
      } else {
        d[i][k] *= inverse;
        unroll<Pivot - 1 - k>([&](auto right) { d[i][k + 1 + right] -= d[i][k] * d[k][k + 1 + right]; });
      }
    });
  });
}

/// One row l of the blocks below a factored pivot block, L21 = A21 U11^-1, and the transposed column u of U12 (symmetric:
/// L21 D). Input: those of the matrix; u is used for LU only.
template <bool Symmetric, int Pivot, class Number>
inline void factor_row_below(const Number (&d)[Pivot][Pivot], Number (&l)[Pivot], Number (&u)[Pivot]) {
  unroll<Pivot>([&](auto k) {
    if constexpr (Symmetric) {
      u[k] = l[k];
      unroll<k>([&](auto j) { u[k] -= u[j] * d[k][j]; });
      l[k] = u[k] * d[k][k];
    } else {
      unroll<k>([&](auto j) {
        l[k] -= l[j] * d[j][k];
        u[k] -= u[j] * d[k][j];
      });
      l[k] *= d[k][k];
    }
  });
}

/// Calls f.template operator()<Pivot>() for the run-time size of a pivot block.
template <class Function>
inline auto with_pivot(int pivot, Function f) {
  switch (pivot) {
    case 1: return f.template operator()<1>();
    case 2: return f.template operator()<2>();
    case 3: return f.template operator()<3>();
    case 4: return f.template operator()<4>();
    case 5: return f.template operator()<5>();
    default: return f.template operator()<6>();
  }
}

}  // namespace iota::solver
