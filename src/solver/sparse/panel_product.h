// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace iota::solver {

/// Products of a panel's rows with a few of its columns' multipliers: t[c * stride + r] = sum over k < depth of x[k *
/// stride + r] * y[k * stride + c], r < rows, c < columns <= 6 Works on whole multiples of `panel_slack` rows, even if
/// `rows` is not one; the stride has room for them. Each element is summed in the order of k without fused operations,
/// so all processors give the same bits with their widest vectors.
void multiply_panel(double* t, const double* x, const double* y, int rows, int columns, int depth, std::size_t stride);
constexpr int panel_slack = 16;

}  // namespace iota::solver
