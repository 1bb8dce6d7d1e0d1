// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace iota::solver {

/// Rows of a dense panel are stored in strips of so many, each strip by columns: a product reads memory in sequence.
/// Before, columns were a panel's height apart, and each column of a product of large panels waited for the caches.
constexpr int strip_rows = 8;

/// The products of `strips` strips of a panel x with the rows [row, row + columns), columns <= 6, of a panel y; the strips of
/// both are `stride` numbers apart. For each strip s, its row r and c < columns,
///   t[(s * columns + c) * strip_rows + r] = sum over k < depth of x(s * strip_rows + r, k) * y(row + c, k).
/// Each element is summed in the order of k without fused operations, so all processors give the same bits with their
/// widest vectors.
void multiply_strips(double* t, const double* x, int strips, const double* y, std::size_t row, int columns, int depth,
                     std::size_t stride);

/// The index of element (row, column) in the array of a panel.
constexpr std::size_t index_in_strips(std::size_t row, std::size_t column, std::size_t stride) {
  return row / strip_rows * stride + column * strip_rows + row % strip_rows;
}

}  // namespace iota::solver
