// SPDX-License-Identifier: Apache-2.0
// A tree of boxes against a look at each box.
#include "geometry/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

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

TEST(BoxTree, finds_each_item_that_is_near_once_also_after_it_moved) {
  for (const std::size_t count : {0u, 1u, 2u, 3u, 500u}) {
    RandomBoxes scene(count);
    BoxTree tree;
    tree.build(scene.boxes);
    EXPECT_EQ(tree.size(), count);
    expect_all_near(tree, scene);
    for (Bounds& box : scene.boxes) box = RandomBoxes::around(box.low + scene.place(0.5), 0.2);
    tree.refit(scene.boxes);
    expect_all_near(tree, scene);
    for (Bounds& box : scene.boxes) box = RandomBoxes::around(scene.place(10), 0.2);  // all elsewhere
    tree.refit(scene.boxes);
    expect_all_near(tree, scene);
  }
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
    tree.along(from, unit, infinity, [&](std::uint32_t item) { return found.insert(item), infinity; });
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
