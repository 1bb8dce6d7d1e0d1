// SPDX-License-Identifier: Apache-2.0
#include "solver/sparse/panel_product.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace iota::solver {
namespace {

TEST(PanelProduct, multiplies_like_three_loops_in_every_size_and_place) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  constexpr std::size_t depth_of_panel = 8, stride = depth_of_panel * strip_rows;
  std::vector<double> x(6 * stride), y(2 * stride);
  for (double& v : x) v = number(random);
  for (double& v : y) v = number(random);
  for (int strips : {1, 2, 3, 6})
    for (std::size_t first = 0; first < strip_rows; ++first)
      for (int columns = 1; columns <= 6; ++columns)
        for (int depth : {1, 2, 7}) {
          std::vector<double> t(static_cast<std::size_t>(strips * columns * strip_rows) + 1, 7);
          multiply_strips(t.data(), x.data(), strips, y.data(), first, columns, depth, stride);
          for (int row = 0; row < strips * strip_rows; ++row)
            for (int c = 0; c < columns; ++c) {
              double sum = 0;
              for (int k = 0; k < depth; ++k)
                sum += x[index_in_strips(row, k, stride)] * y[index_in_strips(first + c, k, stride)];
              ASSERT_EQ(t[(row / strip_rows * columns + c) * strip_rows + row % strip_rows], sum)
                  << "the same bits on all processors";
            }
          ASSERT_EQ(t.back(), 7) << "nothing is written behind the product";
        }
}

}  // namespace
}  // namespace iota::solver
