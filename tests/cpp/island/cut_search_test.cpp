// SPDX-License-Identifier: Apache-2.0
#include "island/cut_search.h"

#include "base/disjoint_sets.h"
#include "ingredient/bonds.h"
#include "tests/cpp/model/small_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace iota::island {
namespace {

/// Rods, of which some are tied by springs; each is an articulate of the same number.
struct TiedRods {
  model::SmallModel m;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ties;

  explicit TiedRods(std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) (void)m.body({{0, 2.0 * i, 0}, {1, 2.0 * i, 0}});
  }
  void tie(std::uint32_t a, std::uint32_t b) {
    ingredient::Bond spring;
    spring.p = m.particle(a, 1), spring.q = m.particle(b, 0);
    (void)ingredient::Bonds::add(m.model, spring);
    ties.push_back({a, b});
  }
  std::vector<std::uint32_t> cut_off(std::vector<std::uint32_t> suspects, std::size_t most = 1000) {
    std::vector<std::uint32_t> found;
    CutSearch().find(m.model, suspects, most, [](std::uint32_t) { return true; }, found);
    std::sort(found.begin(), found.end());
    return found;
  }
};

TEST(CutSearch, finds_nothing_while_all_suspects_are_connected) {
  TiedRods rods(5);
  for (std::uint32_t i = 0; i + 1 < 5; ++i) rods.tie(i, i + 1);
  EXPECT_EQ(rods.cut_off({0, 4}), std::vector<std::uint32_t>{});
  EXPECT_EQ(rods.cut_off({2}), std::vector<std::uint32_t>{});
}

TEST(CutSearch, finds_the_smaller_side_of_a_cut) {
  TiedRods rods(40);
  for (std::uint32_t i = 0; i + 1 < 40; ++i)
    if (i != 2) rods.tie(i, i + 1);
  EXPECT_EQ(rods.cut_off({2, 3}), (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(CutSearch, leaves_parts_alone_that_are_larger_than_asked_for) {
  TiedRods rods(40);
  for (std::uint32_t i = 0; i + 1 < 40; ++i)
    if (i != 19) rods.tie(i, i + 1);
  EXPECT_EQ(rods.cut_off({19, 20}, 16), std::vector<std::uint32_t>{});
  EXPECT_EQ(rods.cut_off({19, 20}).size(), 20u);
}

// Against connected components, with one suspect or more in each.
TEST(CutSearch, finds_all_parts_but_one_of_random_ties) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    const std::uint32_t count = 2 + static_cast<std::uint32_t>(random() % 40);
    TiedRods rods(count);
    DisjointSets sets(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto a = static_cast<std::uint32_t>(random() % count), b = static_cast<std::uint32_t>(random() % count);
      if (a != b) rods.tie(a, b), sets.join(a, b);
    }
    std::map<std::uint32_t, std::vector<std::uint32_t>> parts;
    for (std::uint32_t i = 0; i < count; ++i) parts[sets.root(i)].push_back(i);
    std::vector<std::uint32_t> suspects;
    for (const auto& [root, part] : parts)
      for (const std::uint32_t i : part)
        if (i == part[part.size() / 2] || random() % 4 == 0) suspects.push_back(i);
    const std::vector<std::uint32_t> found = rods.cut_off(suspects);
    std::size_t whole = 0;
    for (const auto& [root, part] : parts) {
      const auto is_found = [&](std::uint32_t i) { return std::binary_search(found.begin(), found.end(), i); };
      const auto of_part = std::count_if(part.begin(), part.end(), is_found);
      ASSERT_TRUE(of_part == 0 || of_part == static_cast<std::ptrdiff_t>(part.size())) << "round " << round;
      whole += of_part == 0;
    }
    ASSERT_EQ(whole, 1u) << "round " << round;
  }
}

}  // namespace
}  // namespace iota::island
