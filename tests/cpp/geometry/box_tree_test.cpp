// SPDX-License-Identifier: Apache-2.0
// A tree of boxes against a look at each box.
#include "geometry/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <utility>

namespace iota::geometry {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct RandomBoxes {
  explicit RandomBoxes(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) boxes.push_back(around(place(10), number(0, 0.5)));
  }
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 place(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  static Bounds around(const Vec3& at, double half) {
    return {at - Vec3{half, half, half}, at + Vec3{half, half, half}};
  }
  std::mt19937 random{7};
  std::vector<Bounds> boxes;
};

std::multiset<std::uint32_t> near(const BoxTree& tree, const Vec3& place, double within) {
  std::multiset<std::uint32_t> found;
  tree.near(place, within, [&](std::uint32_t item) { return found.insert(item), within; });
  return found;
}

void expect_all_near(const BoxTree& tree, RandomBoxes& scene) {
  for (int question = 0; question < 50; ++question) {
    const Vec3 place = scene.place(12);
    const double within = scene.number(0, 3);
    std::multiset<std::uint32_t> all;
    for (std::uint32_t i = 0; i < scene.boxes.size(); ++i)
      if (distance(scene.boxes[i], place) <= within) all.insert(i);
    EXPECT_EQ(near(tree, place, within), all);
  }
}

TEST(Boxes, are_as_far_apart_as_their_nearest_corners_and_not_where_they_overlap) {
  constexpr double endless = std::numeric_limits<double>::infinity();
  const Bounds box{{0, 0, 0}, {1, 1, 1}}, ground{{-endless, -endless, -endless}, {endless, 0, endless}};
  EXPECT_DOUBLE_EQ(distance(box, Bounds{{3, 4, 0}, {5, 6, 1}}), std::sqrt(13));
  EXPECT_DOUBLE_EQ(distance(Bounds{{-2, 0, 0.5}, {-1, 1, 3}}, box), 1);
  EXPECT_EQ(distance(box, Bounds{{0.5, 0.5, -1}, {2, 2, 2}}), 0);
  EXPECT_EQ(distance(grown(box, -0.25), ground), 0.25);
  EXPECT_EQ(distance(ground, ground), 0);
}

TEST(BoxTree, finds_each_item_that_is_near_once) {
  for (const std::size_t count : {0u, 1u, 2u, 3u, 500u}) {
    RandomBoxes scene(count);
    BoxTree tree;
    tree.build(scene.boxes);
    EXPECT_EQ(tree.size(), count);
    expect_all_near(tree, scene);
  }
}

/// Items that come, move and go, and the tree that follows them.
struct Crowd : RandomBoxes {
  Crowd() : RandomBoxes(0) {}

  void move(std::uint32_t item, const Bounds& box) { tree.set(item, there[item] = box); }
  void change() {
    const auto item = static_cast<std::uint32_t>(random() % 300);
    const bool is_there = there.contains(item);
    switch (random() % 4) {
      case 0: return move(item, around(place(10), number(0, 0.5)));
      case 1: return tree.remove(item), void(there.erase(item));
      default:
        if (!is_there) return;
        move(item, around(0.5 * (there[item].low + there[item].high) + place(0.1), number(0, 0.5)));
    }
  }
  /// Nothing that is near may be missing; what is found is at most as far as fattened boxes reach.
  void compare() {
    EXPECT_EQ(tree.size(), there.size());
    const Vec3 at = place(12);
    const double within = number(0, 3);
    const std::multiset<std::uint32_t> found = near(tree, at, within);
    std::multiset<std::uint32_t> overlapped;
    const Bounds box = around(at, within);
    tree.overlapping(box, [&](std::uint32_t item) { overlapped.insert(item); });
    for (const auto& [item, own] : there) {
      EXPECT_GE(found.count(item), distance(own, at) <= within ? 1u : 0u);
      EXPECT_LE(found.count(item), distance(own, at) > within + 4 ? 0u : 1u);
      EXPECT_GE(overlapped.count(item), overlap(own, box) ? 1u : 0u);
      EXPECT_LE(overlapped.count(item), 1u);
    }
    for (const std::uint32_t item : found) EXPECT_TRUE(there.contains(item));
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> pairs;
    tree.for_each_pair([&](std::uint32_t a, std::uint32_t b) { pairs.insert(std::minmax(a, b)); });
    for (const auto& [a, one] : there)
      for (const auto& [b, other] : there)
        if (a < b) {
          EXPECT_LE(pairs.count({a, b}), 1u);
          EXPECT_GE(pairs.count({a, b}), overlap(one, other) ? 1u : 0u) << a << " " << b;
        }
    for (const auto& [a, b] : pairs) EXPECT_TRUE(there.contains(a) && there.contains(b) && a != b);
  }

  BoxTree tree;
  std::map<std::uint32_t, Bounds> there;
};

TEST(BoxTree, of_items_that_come_move_and_go_finds_what_a_look_at_each_finds) {
  Crowd crowd;
  for (int round = 0; round < 200; ++round) {
    for (int i = round % 40; i >= 0; --i) crowd.change();
    crowd.tree.update();
    crowd.compare();
  }
  for (std::uint32_t item = 0; item < 300; ++item) crowd.tree.remove(item);
  crowd.there.clear();
  crowd.tree.update();
  crowd.compare();
}

TEST(BoxTree, of_items_that_come_in_a_row_and_fly_apart_is_no_deeper_than_its_search_allows) {
  BoxTree tree;
  const auto all = [&] {
    std::size_t count = 0;
    tree.near({}, infinity, [&](std::uint32_t) { return ++count, infinity; });
    return count;
  };
  for (std::uint32_t item = 0; item < 2000; ++item) {
    tree.set(item, RandomBoxes::around({std::pow(1.01, item), 0, 0}, 0.1));
    tree.update();
  }
  EXPECT_EQ(all(), 2000u);
  for (std::uint32_t item = 0; item < 2000; ++item) tree.set(item, RandomBoxes::around({0, 1e3 * item, 0}, 0.1));
  tree.update();
  EXPECT_EQ(all(), 2000u);
}

TEST(BoxTree, is_as_good_after_a_long_motion_as_a_new_one) {
  RandomBoxes scene(2000);
  BoxTree tree, fresh;
  std::vector<Vec3> speeds;
  for (std::size_t i = 0; i < scene.boxes.size(); ++i) speeds.push_back(scene.place(0.2));
  for (int step = 0; step < 100; ++step) {
    for (std::uint32_t i = 0; i < scene.boxes.size(); ++i) {
      scene.boxes[i] = {scene.boxes[i].low + speeds[i], scene.boxes[i].high + speeds[i]};
      tree.set(i, scene.boxes[i]);
    }
    tree.update();
  }
  for (std::uint32_t i = 0; i < scene.boxes.size(); ++i) fresh.set(i, scene.boxes[i]);
  fresh.update();
  const auto visits = [&](const BoxTree& each) {
    std::mt19937 random(1);
    std::size_t count = 0;
    for (int question = 0; question < 200; ++question) {
      const auto at = [&] { return std::uniform_real_distribution<double>(-20, 20)(random); };
      const Vec3 place{at(), at(), at()};
      double best = infinity;
      each.near(place, infinity, [&](std::uint32_t item) {
        ++count;
        return best = std::min(best, distance(scene.boxes[item], place));
      });
    }
    return count;
  };
  EXPECT_LT(visits(tree), 3 * visits(fresh));
}

TEST(BoxTree, finds_the_nearest_with_few_visits) {
  RandomBoxes scene(10'000);
  BoxTree tree;
  tree.build(scene.boxes);
  std::size_t visits = 0;
  for (int question = 0; question < 100; ++question) {
    const Vec3 place = scene.place(10);
    double best = infinity, least = infinity;
    tree.near(place, infinity, [&](std::uint32_t item) {
      ++visits;
      return best = std::min(best, distance(scene.boxes[item], place));
    });
    for (const Bounds& box : scene.boxes) least = std::min(least, distance(box, place));
    EXPECT_EQ(best, least);
  }
  EXPECT_LT(visits / 100, 30u);
}

TEST(BoxTree, finds_all_along_a_ray_also_in_the_plane_of_a_face) {
  RandomBoxes scene(2000);
  BoxTree tree;
  tree.build(scene.boxes);
  for (int question = 0; question < 100; ++question) {
    const Vec3 from = scene.place(12);
    Vec3 unit = scene.place(1);
    if (question % 3 == 0) unit.y = unit.z = 0;
    unit = (1 / norm(unit)) * unit;
    std::set<std::uint32_t> found, all;
    tree.along(from, unit, 0, infinity, [&](std::uint32_t item) { return found.insert(item), infinity; });
    const Vec3 inverse{1 / unit.x, 1 / unit.y, 1 / unit.z};
    for (std::uint32_t i = 0; i < scene.boxes.size(); ++i)
      if (entry(scene.boxes[i], from, inverse) < infinity) all.insert(i);
    EXPECT_EQ(found, all);
  }
  const Bounds box{{0, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(entry(box, {-2, 0.5, 0.5}, {1, infinity, infinity}), 2);
  EXPECT_EQ(entry(box, {0.5, 0.5, 0.5}, {1, infinity, infinity}), 0) << "it starts inside";
  EXPECT_EQ(entry(box, {-2, 1, 0.5}, {1, infinity, infinity}), 2) << "along the upper face";
  EXPECT_EQ(entry(box, {-2, 1.1, 0.5}, {1, infinity, infinity}), infinity);
  EXPECT_EQ(entry(box, {2, 0.5, 0.5}, {1, infinity, infinity}), infinity) << "it is behind";
}

TEST(BoxTree, of_many_items_at_one_place_is_no_deeper_than_its_search_allows) {
  const std::vector<Bounds> boxes(50'000, Bounds{{0, 0, 0}, {1, 1, 1}});
  BoxTree tree;
  tree.build(boxes);
  EXPECT_EQ(near(tree, {0.5, 0.5, 0.5}, 0).size(), boxes.size());
}

}  // namespace
}  // namespace iota::geometry
