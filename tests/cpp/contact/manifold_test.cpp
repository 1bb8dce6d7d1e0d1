// SPDX-License-Identifier: Apache-2.0
// The points at which faces touch, at places where they are known.
#include "contact/manifold.h"

#include "placed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

namespace iota::contact {
namespace {

using Named = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, bool>;

std::set<Named> names_of(const std::vector<Touch>& found) {
  std::set<Named> names;
  for (const Touch& touch : found)
    names.insert({touch.part, touch.feature, touch.other_part, touch.other_feature, touch.is_turned});
  EXPECT_EQ(names.size(), found.size()) << "names are not unique";
  return names;
}

bool has_place(const std::vector<Touch>& found, const Vec3& place) {
  return std::ranges::any_of(found, [&](const Touch& touch) { return norm(touch.place - place) < 1e-6; });
}

TEST(Manifolds, of_a_flush_stack_are_its_four_corners_with_the_normal_of_the_face) {
  for (const double size : {0.01, 1.0, 30.0})
    for (const double share : {-1e-9, 0.0, 1e-9})
      for (const double shift : {0.0, 1e-12, -1e-9}) {
        const Outline upper = placed(Box{{size, size, size}}, {shift * size, size * (1 + share), -shift * size});
        const auto found = touches_of(upper, placed(Box{{size, size, size}}, {}, {}, 3), 0.02 * size);
        ASSERT_EQ(found.size(), 4u);
        for (const Touch& touch : found) {
          EXPECT_EQ(touch.normal, (Vec3{0, 1, 0}));
          EXPECT_NEAR(touch.gap, share * size, 1e-15 * size);
          EXPECT_FALSE(touch.is_turned);
          EXPECT_EQ(std::pair(touch.part, touch.other_part), std::pair(7u, 3u));
        }
      }
}

TEST(Manifolds, over_the_edge_of_a_table_have_points_at_the_edge) {
  const auto found = touches_of(placed(Box{{0.2, 0.2, 0.2}}, {1, 0.1, 0}), placed(Box{{2, 1, 2}}, {0, -0.5, 0}), 0.01);
  ASSERT_EQ(found.size(), 4u);
  for (const double z : {-0.1, 0.1}) EXPECT_TRUE(has_place(found, {0.9, 0, z}) && has_place(found, {1, 0, z}));
}

TEST(Manifolds, of_a_plank_on_a_peg_are_the_corners_of_the_peg) {
  const auto found =
      touches_of(placed(Box{{2, 0.1, 0.5}}, {0, 0.05, 0}), placed(Box{{0.1, 1, 0.1}}, {0, -0.5, 0}), 0.01);
  ASSERT_EQ(found.size(), 4u);
  for (const double x : {-0.05, 0.05}) EXPECT_TRUE(has_place(found, {x, 0, -0.05}) && has_place(found, {x, 0, 0.05}));
}

TEST(Manifolds, of_crossed_boxes_are_the_four_crossings) {
  const auto found = touches_of(placed(Box{{2, 0.2, 0.2}}, {0, 0.2, 0}), placed(Box{{0.2, 0.2, 2}}, {}), 0.01);
  ASSERT_EQ(found.size(), 4u);
  for (const double x : {-0.1, 0.1}) EXPECT_TRUE(has_place(found, {x, 0.1, -0.1}) && has_place(found, {x, 0.1, 0.1}));
}

TEST(Manifolds, keep_their_names_over_small_motions) {
  RandomShapes random(6);
  const Box box{{1, 1, 1}};
  for (const Vec3& place : {Vec3{0, 1, 0}, Vec3{0.4, 1, 0.2}, Vec3{-0.7, 1, 0.3}})
    for (const double turn : {0.0, 0.3, 0.785398163397448}) {
      const Quaternion q = axis_angle({0, 1, 0}, turn);
      const auto names = names_of(touches_of(placed(box, place, q), placed(box, {}), 0.02));
      for (int k = 0; k < 50; ++k) {
        const Quaternion noise = turn_by(random.vector(1e-9));
        EXPECT_EQ(
            names_of(touches_of(placed(box, place + random.vector(1e-9), multiply(noise, q)), placed(box, {}), 0.02)),
            names);
      }
    }
}

TEST(Manifolds, over_a_seam_of_two_boxes_have_only_the_normal_of_their_tops) {
  const Box box{{1, 1, 1}};
  for (double x = -0.99; x < 0.99; x += 0.0137)
    for (const double side : {-0.5, 0.5}) {
      if (x - side > 1) continue;  // it is behind
      const auto found = touches_of(placed(box, {x, 1 - 1e-9, 0}), placed(box, {side, 0, 0}), 0.05, {0.04, 0, 0});
      for (const Touch& touch : found) {
        EXPECT_LT(norm((touch.is_turned ? -1.0 : 1.0) * touch.normal - Vec3{0, 1, 0}), 1e-9) << x;
        EXPECT_LE(std::abs(touch.place.x - side), 0.5 + 1e-6);
      }
      EXPECT_EQ(found.size(), std::abs(x - side) < 1 ? 4u : 0u) << x;
    }
}

TEST(Manifolds, of_a_rounded_plate_end_with_its_edge) {
  // The edge is a face without width; the log crosses its line beyond its end.
  const double h = std::sqrt(0.5);
  const Quaternion turn = multiply(axis_angle({0, 1, 0}, 0.785398163397448), {0, 0, h, h});
  const Outline plate = placed(Box{{1, 0.5, 1}, 0.25}, {0, -1, 0}, turn);
  const Outline log = placed(Cylinder{0.5, 1}, {-0.5, 1e-9, -0.25});
  const double distance = upper_distance(plate.solids[0], log.solids[0], 2000);
  EXPECT_GT(distance, 1e-3);
  EXPECT_NEAR(least_gap_of(touches_of(plate, log, 0.05)), distance, 1e-9);
  EXPECT_NEAR(least_gap_of(touches_of(log, plate, 0.05)), distance, 1e-9);
}

TEST(Manifolds, of_a_cylinder_that_stands_span_its_rim) {
  const Quaternion up = axis_angle({0, 0, 1}, std::acos(0.0));
  const auto found =
      touches_of(placed(Cylinder{0.2, 0.4}, {0, 0.2, 0}, up), placed(Box{{2, 1, 2}}, {0, -0.5, 0}), 0.01);
  ASSERT_EQ(found.size(), 6u);
  for (const Touch& touch : found) {
    EXPECT_NEAR(norm(touch.place), 0.2, 1e-12);
    EXPECT_NEAR(touch.gap, 0, 1e-15);
  }
  names_of(found);
}

}  // namespace
}  // namespace iota::contact
