// SPDX-License-Identifier: Apache-2.0
// Outlines in a tree, hidden, endless and gone.
#include "contact/outline_tree.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <utility>

namespace iota::contact {
namespace {

using Pairs = std::multiset<std::pair<std::uint32_t, std::uint32_t>>;

void add_ball(OutlineTree& tree, std::uint32_t number, const Vec3& at, double radius) {
  tree.make(number).lines.push_back({0, 0, radius, at, at});
  tree.show(number);
}

Pairs pairs_of(const OutlineTree& tree) {
  Pairs pairs;
  tree.for_each_pair([&](std::uint32_t a, std::uint32_t b) { pairs.insert(std::minmax(a, b)); });
  return pairs;
}

TEST(OutlineTree, pairs_are_those_of_a_look_at_each_two_boxes) {
  std::mt19937 random(2);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  OutlineTree tree;
  for (int round = 0; round < 30; ++round) {
    for (std::uint32_t i = 0; i < 60; ++i) {
      if (random() % 3 == 0) add_ball(tree, i, {number(-2, 2), number(-2, 2), number(-2, 2)}, number(0, 0.4));
      if (random() % 20 == 0) tree.remove(i);
      if (tree.has(i) && random() % 20 == 0) tree.hide(i);
    }
    if (round == 10) tree.make(70).solids.push_back({make_form(HalfSpace{}), 0, {}, {}}), tree.show(70);
    tree.update();
    const Pairs pairs = pairs_of(tree);
    std::set<std::uint32_t> shown;
    (void)tree.near({}, 1e9, [&](std::uint32_t each, const Outline&) { return shown.insert(each), 1e9; });
    EXPECT_EQ(shown.contains(70), round >= 10);
    for (const std::uint32_t a : shown)
      for (const std::uint32_t b : shown) {
        if (!(a < b)) continue;
        EXPECT_LE(pairs.count({a, b}), 1u);
        const bool is_pair = b == 70 || overlap(bounds(tree[a]), bounds(tree[b]));
        EXPECT_GE(pairs.count({a, b}), is_pair ? 1u : 0u) << a << " " << b;
      }
    for (const auto& [a, b] : pairs) EXPECT_TRUE(shown.contains(a) && shown.contains(b));
  }
}

TEST(OutlineTree, what_is_hidden_or_removed_is_not_found_and_what_becomes_endless_always_is) {
  OutlineTree tree;
  add_ball(tree, 3, {}, 1);
  add_ball(tree, 5, {9, 0, 0}, 1);
  tree.update();
  const auto found = [&](double within) {
    std::set<std::uint32_t> all;
    tree.near({}, within, [&](std::uint32_t each, const Outline&) { return all.insert(each), within; });
    return all;
  };
  EXPECT_EQ(found(1), std::set<std::uint32_t>{3});
  EXPECT_FALSE(tree.has(4));
  tree.hide(3), tree.update();
  EXPECT_TRUE(tree.has(3));
  EXPECT_TRUE(found(1).empty());
  tree.show(3), tree.update();
  EXPECT_EQ(found(1), std::set<std::uint32_t>{3});
  tree.make(5).solids.push_back({make_form(HalfSpace{}), 0, {9, 0, 0}, {}});
  tree.show(5), tree.update();
  EXPECT_EQ(found(0), (std::set<std::uint32_t>{3, 5}));
  add_ball(tree, 5, {9, 0, 0}, 1);
  tree.update();
  EXPECT_EQ(found(1), std::set<std::uint32_t>{3});
  tree.remove(3), tree.update();
  EXPECT_TRUE(found(1).empty());
  tree.clear(), tree.update();
  EXPECT_TRUE(found(1e9).empty());
}

}  // namespace
}  // namespace iota::contact
