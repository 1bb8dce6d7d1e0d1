// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/sparse/pivot_block.h"

#include <array>

namespace iota::solver {

/// One number, or two in SIMD lanes with the same operations, which give the same bits as one alone.
template <int N>
struct LanesOf {
  using Type __attribute__((vector_size(N * sizeof(double)))) = double;
};
template <>
struct LanesOf<1> {
  using Type = double;
};

/// Vertices of one shape that couple with one later node each and not with each other: the links of chains and trees.
/// Division latency dominates; N independent ones are eliminated in SIMD lanes: a step of 512 rods takes 0.18 instead of
/// 0.22 us a link.
template <int Pivot, int N>
struct Leaves {
  using Lanes = typename LanesOf<N>::Type;
  using Pointers = std::array<double*, N>;
  Pointers diagonal, lower, upper;  ///< the blocks of each
  Pointers target;                  ///< the diagonal block of its later node, and the length of its rows
  std::array<int, N> target_stride;
  Pointers own, later;  ///< the right-hand side, or solution, of each and of its later node

  static Lanes get(const Pointers& from, int i) {
    if constexpr (N == 1)
      return from[0][i];
    else
      return Lanes{from[0][i], from[1][i]};
  }
  static void put(const Pointers& to, int i, const Lanes& value) {
    for (int lane = 0; lane < N; ++lane) to[lane][i] = of(value, lane);
  }
  static double of(const Lanes& value, int lane) {
    if constexpr (N == 1)
      return value;
    else
      return value[lane];
  }

  /// Factors, and substitutes forward if there is a right-hand side; returns the number of pivots with the wrong sign.
  template <bool Symmetric>
  int eliminate(int positives) const;
  /// Substitutes backward.
  template <bool Symmetric>
  void finish() const;
};

template <int Pivot, int N>
template <bool Symmetric>
[[gnu::flatten]] int Leaves<Pivot, N>::eliminate(int positives) const {
  int wrong = 0;
  Lanes d[Pivot][Pivot];
  unroll<Pivot>(
      [&](auto i) { unroll<Symmetric ? i + 1 : Pivot>([&](auto j) { d[i][j] = get(diagonal, i * Pivot + j); }); });
  factor_pivot_block<Symmetric>(d, [&](int k, const Lanes& pivot) {
    for (int lane = 0; lane < N; ++lane) wrong += k < positives ? !(of(pivot, lane) > 0) : !(of(pivot, lane) < 0);
  });
  unroll<Pivot>(
      [&](auto i) { unroll<Symmetric ? i + 1 : Pivot>([&](auto j) { put(diagonal, i * Pivot + j, d[i][j]); }); });

  Lanes l[3][Pivot], u[3][Pivot];
  unroll<3>([&](auto r) {
    unroll<Pivot>([&](auto k) {
      l[r][k] = get(lower, r * Pivot + k);
      if constexpr (!Symmetric) u[r][k] = get(upper, r * Pivot + k);
    });
    factor_row_below<Symmetric>(d, l[r], u[r]);
    unroll<Pivot>([&](auto k) {
      put(lower, r * Pivot + k, l[r][k]);
      if constexpr (!Symmetric) put(upper, r * Pivot + k, u[r][k]);
    });
  });
  unroll<3>([&](auto r) {
    unroll<Symmetric ? r + 1 : 3>([&](auto c) {
      Lanes sum = l[r][0] * u[c][0];
      unroll<Pivot - 1>([&](auto k) { sum += l[r][k + 1] * u[c][k + 1]; });
      for (int lane = 0; lane < N; ++lane) target[lane][r * target_stride[lane] + c] -= of(sum, lane);  // may be one
    });
  });

  if (own[0] == nullptr) return wrong;
  Lanes y[Pivot];
  unroll<Pivot>([&](auto k) {
    y[k] = get(own, k);
    unroll<k>([&](auto j) { y[k] -= d[k][j] * y[j]; });
    put(own, k, y[k]);
  });
  unroll<3>([&](auto r) {
    Lanes sum = l[r][0] * y[0];
    unroll<Pivot - 1>([&](auto k) { sum += l[r][k + 1] * y[k + 1]; });
    for (int lane = 0; lane < N; ++lane) later[lane][r] -= of(sum, lane);
  });
  return wrong;
}

template <int Pivot, int N>
template <bool Symmetric>
[[gnu::flatten]] void Leaves<Pivot, N>::finish() const {
  const Pointers& off_diagonal = Symmetric ? lower : upper;
  Lanes x[Pivot];
  unroll<Pivot>([&](auto k) {
    x[k] = get(own, k);
    if constexpr (Symmetric) x[k] *= get(diagonal, k * Pivot + k);
    unroll<3>([&](auto r) { x[k] -= get(off_diagonal, r * Pivot + k) * get(later, r); });
  });
  unroll<Pivot>([&](auto from_last) {
    constexpr int k = Pivot - 1 - from_last;
    unroll<Pivot - 1 - k>([&](auto right) {
      constexpr int j = k + 1 + right;
      x[k] -= get(diagonal, Symmetric ? j * Pivot + k : k * Pivot + j) * x[j];
    });
    if constexpr (!Symmetric) x[k] *= get(diagonal, k * Pivot + k);
    put(own, k, x[k]);
  });
}

}  // namespace iota::solver
