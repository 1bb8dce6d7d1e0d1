// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/panel_product.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define IOTA_HAS_WIDE_VECTORS 1
#endif

namespace iota::solver {

namespace {

/// 2 N rows by W columns, all sums in registers.
template <int N, int W>
[[gnu::always_inline]] inline void multiply_tile(double* t, const double* x, const double* y, int depth,
                                                 std::size_t stride) {
  using Lanes __attribute__((vector_size(N * sizeof(double)), aligned(8), may_alias)) = double;
  Lanes above[W] = {}, below[W] = {};
  for (int k = 0; k < depth; ++k, x += stride, y += stride) {
    const Lanes x_above = *reinterpret_cast<const Lanes*>(x), x_below = *reinterpret_cast<const Lanes*>(x + N);
    for (int c = 0; c < W; ++c) above[c] += x_above * y[c], below[c] += x_below * y[c];
  }
  for (int c = 0; c < W; ++c, t += stride)
    *reinterpret_cast<Lanes*>(t) = above[c], *reinterpret_cast<Lanes*>(t + N) = below[c];
}

template <int N>
[[gnu::always_inline]] inline void multiply_by(double* t, const double* x, const double* y, int rows, int columns,
                                               int depth, std::size_t stride) {
  static_assert(2 * N <= panel_slack);
  for (int r = 0; r < rows; r += 2 * N, t += 2 * N, x += 2 * N) switch (columns) {
      case 1: multiply_tile<N, 1>(t, x, y, depth, stride); break;
      case 2: multiply_tile<N, 2>(t, x, y, depth, stride); break;
      case 3: multiply_tile<N, 3>(t, x, y, depth, stride); break;
      case 4: multiply_tile<N, 4>(t, x, y, depth, stride); break;
      case 5: multiply_tile<N, 5>(t, x, y, depth, stride); break;
      default: multiply_tile<N, 6>(t, x, y, depth, stride); break;
    }
}

using Multiply = void (*)(double*, const double*, const double*, int, int, int, std::size_t);

void multiply_by_two(double* t, const double* x, const double* y, int rows, int columns, int depth,
                     std::size_t stride) {
  multiply_by<2>(t, x, y, rows, columns, depth, stride);
}

#if IOTA_HAS_WIDE_VECTORS
[[gnu::target("avx2")]] void multiply_by_four(double* t, const double* x, const double* y, int rows, int columns,
                                              int depth, std::size_t stride) {
  multiply_by<4>(t, x, y, rows, columns, depth, stride);
}
[[gnu::target("avx512f")]] void multiply_by_eight(double* t, const double* x, const double* y, int rows, int columns,
                                                  int depth, std::size_t stride) {
  multiply_by<8>(t, x, y, rows, columns, depth, stride);
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

void multiply_panel(double* t, const double* x, const double* y, int rows, int columns, int depth, std::size_t stride) {
  static const Multiply multiply = choose();
  multiply(t, x, y, rows, columns, depth, stride);
}

}  // namespace iota::solver
