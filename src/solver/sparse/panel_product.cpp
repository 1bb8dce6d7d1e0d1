// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/panel_product.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define IOTA_HAS_WIDE_VECTORS 1
#endif

namespace iota::solver {

namespace {

/// Two vectors of N rows by W columns, all sums in registers.
template <int N, int W>
[[gnu::always_inline]] inline void multiply_tile(double* t, double* t_other, const double* x, const double* x_other,
                                                 const double* const (&y)[W], std::size_t depth) {
  using Lanes __attribute__((vector_size(N * sizeof(double)), aligned(8), may_alias)) = double;
  Lanes sum[W] = {}, sum_other[W] = {};
  for (std::size_t k = 0; k < depth * strip_rows; k += strip_rows) {
    const Lanes rows = *reinterpret_cast<const Lanes*>(x + k);
    const Lanes rows_other = *reinterpret_cast<const Lanes*>(x_other + k);
    for (int c = 0; c < W; ++c) sum[c] += rows * y[c][k], sum_other[c] += rows_other * y[c][k];
  }
  for (int c = 0; c < W; ++c, t += strip_rows, t_other += strip_rows)
    *reinterpret_cast<Lanes*>(t) = sum[c], *reinterpret_cast<Lanes*>(t_other) = sum_other[c];
}

template <int N, int W>
[[gnu::always_inline]] inline void multiply_all(double* t, const double* x, int strips, const double* y,
                                                std::size_t row, std::size_t depth, std::size_t stride) {
  constexpr std::size_t t_stride = W * strip_rows;
  const double* y_rows[W];
  for (std::size_t c = 0; c < W; ++c) y_rows[c] = y + index_in_strips(row + c, 0, stride);
  if constexpr (N == strip_rows) {  // a strip is one vector: two strips at once
    for (; strips > 1; strips -= 2, t += 2 * t_stride, x += 2 * stride)
      multiply_tile<N, W>(t, t + t_stride, x, x + stride, y_rows, depth);
    if (strips > 0) multiply_tile<N, W>(t, t, x, x, y_rows, depth);
  } else {
    for (; strips > 0; --strips, t += t_stride, x += stride)
      for (int r = 0; r < strip_rows; r += 2 * N)
        multiply_tile<N, W>(t + r, t + r + N, x + r, x + r + N, y_rows, depth);
  }
}

template <int N>
[[gnu::always_inline]] inline void multiply_by(double* t, const double* x, int strips, const double* y, std::size_t row,
                                               int columns, std::size_t depth, std::size_t stride) {
  switch (columns) {
    case 1: return multiply_all<N, 1>(t, x, strips, y, row, depth, stride);
    case 2: return multiply_all<N, 2>(t, x, strips, y, row, depth, stride);
    case 3: return multiply_all<N, 3>(t, x, strips, y, row, depth, stride);
    case 4: return multiply_all<N, 4>(t, x, strips, y, row, depth, stride);
    case 5: return multiply_all<N, 5>(t, x, strips, y, row, depth, stride);
    default: return multiply_all<N, 6>(t, x, strips, y, row, depth, stride);
  }
}

using Multiply = void (*)(double*, const double*, int, const double*, std::size_t, int, std::size_t, std::size_t);

void multiply_by_two(double* t, const double* x, int strips, const double* y, std::size_t row, int columns,
                     std::size_t depth, std::size_t stride) {
  multiply_by<2>(t, x, strips, y, row, columns, depth, stride);
}

#if IOTA_HAS_WIDE_VECTORS
[[gnu::target("avx2")]] void multiply_by_four(double* t, const double* x, int strips, const double* y, std::size_t row,
                                              int columns, std::size_t depth, std::size_t stride) {
  multiply_by<4>(t, x, strips, y, row, columns, depth, stride);
}
[[gnu::target("avx512f")]] void multiply_by_eight(double* t, const double* x, int strips, const double* y,
                                                  std::size_t row, int columns, std::size_t depth, std::size_t stride) {
  multiply_by<8>(t, x, strips, y, row, columns, depth, stride);
}
#endif

Multiply choose() {
#if IOTA_HAS_WIDE_VECTORS
  if (__builtin_cpu_supports("avx512f")) return multiply_by_eight;
  if (__builtin_cpu_supports("avx2")) return multiply_by_four;
#endif
  return multiply_by_two;
}

}  // namespace

void multiply_strips(double* t, const double* x, int strips, const double* y, std::size_t row, int columns, int depth,
                     std::size_t stride) {
  static const Multiply multiply = choose();
  multiply(t, x, strips, y, row, columns, static_cast<std::size_t>(depth), stride);
}

}  // namespace iota::solver
