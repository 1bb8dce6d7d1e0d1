// SPDX-License-Identifier: Apache-2.0
#include "base/renumbering.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace iota {
namespace {

// Against taking out one item after the other, of lists of all sizes.
TEST(Renumbering, gives_the_numbers_of_removed_items_to_the_last_ones) {
  std::mt19937 random(1);
  Renumbering number;
  for (std::size_t count = 1; count < 12; ++count)
    for (int round = 0; round < 100; ++round) {
      std::vector<std::uint32_t> removed, items(count);
      for (std::uint32_t i = 0; i < count; ++i)
        if (random() % 3 == 0) removed.push_back(i);
      std::shuffle(removed.begin(), removed.end(), random);
      std::iota(items.begin(), items.end(), 0u);
      std::vector<std::uint32_t> moved = items;
      number.set(count, removed);
      number.apply(moved);

      std::sort(removed.begin(), removed.end());
      for (auto at = removed.rbegin(); at != removed.rend(); ++at) items[*at] = items.back(), items.pop_back();
      ASSERT_EQ(moved, items);
      for (std::uint32_t i = 0; i < items.size(); ++i) ASSERT_EQ(number(items[i]), i);
    }
}

}  // namespace
}  // namespace iota
