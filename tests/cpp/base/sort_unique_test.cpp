// SPDX-License-Identifier: Apache-2.0
#include "base/sort_unique.h"

#include <gtest/gtest.h>

#include <utility>

namespace iota {
namespace {

TEST(sort_unique, keeps_each_value_once_in_order) {
  std::vector<int> list{3, 1, 3, 2, 1};
  sort_unique(list);
  EXPECT_EQ(list, (std::vector{1, 2, 3}));
  std::vector<std::pair<int, int>> pairs{{1, 2}, {1, 1}, {1, 2}}, none;
  sort_unique(pairs), sort_unique(none);
  EXPECT_EQ(pairs, (std::vector<std::pair<int, int>>{{1, 1}, {1, 2}}));
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace iota
