// SPDX-License-Identifier: Apache-2.0
#include "base/sort_unique.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
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

TEST(sort_unique, sorts_long_lists_of_numbers_near_or_far_from_each_other_alike) {
  std::mt19937 random(3);
  for (const std::uint32_t range : {1u, 70u, 5000u, 4000000000u})
    for (const std::uint32_t first : {0u, 100000000u}) {
      const auto number = [&] { return first + static_cast<std::uint32_t>(random()) % range; };
      std::vector<std::uint32_t> numbers;
      std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
      for (int k = 0; k < 1000; ++k) numbers.push_back(number()), pairs.push_back({number(), number() % 9});
      const std::set set(numbers.begin(), numbers.end());
      const std::set set_of_pairs(pairs.begin(), pairs.end());
      sort_unique(numbers), sort_unique(pairs);
      EXPECT_TRUE(std::equal(numbers.begin(), numbers.end(), set.begin(), set.end())) << range;
      EXPECT_TRUE(std::equal(pairs.begin(), pairs.end(), set_of_pairs.begin(), set_of_pairs.end())) << range;
    }
}

}  // namespace
}  // namespace iota
