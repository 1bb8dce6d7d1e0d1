// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/panel_product.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace iota::solver {
namespace {

TEST(PanelProduct, multiplies_like_three_loops_in_every_size) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int rows : {1, 3, 15, 16, 17, 40, 48})
    for (int columns = 1; columns <= 6; ++columns)
      for (int depth : {1, 2, 7}) {
        const std::size_t stride = 48;
        std::vector<double> x(stride * 8 + panel_slack), y(stride * 8), t(stride * 8);
        for (double& v : x) v = number(random);
        for (double& v : y) v = number(random);
        multiply_panel(t.data(), x.data(), y.data(), rows, columns, depth, stride);
        for (int r = 0; r < rows; ++r)
          for (int c = 0; c < columns; ++c) {
            double sum = 0;
            for (int k = 0; k < depth; ++k) sum += x[k * stride + r] * y[k * stride + c];
            ASSERT_EQ(t[c * stride + r], sum) << "the same bits on all processors";
          }
      }
}

}  // namespace
}  // namespace iota::solver
