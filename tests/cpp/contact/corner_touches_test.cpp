// SPDX-License-Identifier: Apache-2.0
// Corners against surfaces that are not convex.
#include "contact/corner_touches.h"

#include "placed.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota::contact {
namespace {

/// Two faces that meet at right angles along the axis z.
Outline open_valley() {
  Mesh valley;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double z : {-1.0, 1.0}) valley.vertices.push_back({x, std::abs(x), z});
  valley.triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}};
  Outline open = placed(Box{{1, 1, 1}}, {});
  open.solids[0].form = make_open_form(valley);
  return open;
}

TEST(CornerTouches, of_a_box_on_a_step_are_its_corners) {
  const auto found = touches_of(placed(Box{{0.2, 0.2, 0.2}}, {0.5, 1.1, 0}), placed(step_mesh(), {}), 0.01);
  ASSERT_EQ(found.size(), 4u);
  for (const Touch& touch : found) {
    EXPECT_FALSE(touch.is_turned);
    EXPECT_NEAR(norm(touch.normal - Vec3{0, 1, 0}), 0, 1e-9);
    EXPECT_NEAR(touch.gap, 0, 1e-12);
  }
}

TEST(CornerTouches, of_a_mesh_and_a_box_are_the_corners_of_both) {
  const Outline table = placed(Box{{4, 1, 4}}, {0, -0.5, 0}, {}, 3), step = placed(step_mesh(), {});
  EXPECT_EQ(touches_of(step, table, 0.01).size(), 4u);
  const auto found = touches_of(step, placed(Box{{0.2, 0.2, 0.2}}, {0.5, 1.1, 0}, {}, 3), 0.01);
  ASSERT_EQ(found.size(), 4u);
  for (const Touch& touch : found) {
    EXPECT_TRUE(touch.is_turned);
    EXPECT_EQ(touch.other_part, 3u);
    EXPECT_NEAR(touch.gap, 0, 1e-12);
  }
}

TEST(CornerTouches, of_what_lies_in_a_hollow_are_those_with_both_faces) {
  const Outline step = placed(step_mesh(), {});
  Outline open = step;
  open.solids[0].form = make_open_form(step_mesh());
  const double gap = 1e-3;
  struct Lying {
    Shape shape;
    std::size_t on_floor, on_wall;
  };
  for (const auto& [shape, on_floor, on_wall] : {Lying{Sphere{0.2}, 1, 1},
                                                 {Box{{0.4, 0.4, 0.4}}, 4, 4},
                                                 {Cylinder{0.2, 0.4}, 2, 6},
                                                 {Ellipsoid{{0.4, 0.4, 0.6}}, 1, 1}})
    for (const Outline& mesh : {step, open}) {
      const auto found = touches_of(placed(shape, {0.2 + gap, 1.2 + gap, 0}), mesh, 0.01);
      std::size_t floor = 0, wall = 0;
      for (const Touch& touch : found) {
        floor += norm(touch.normal - Vec3{0, 1, 0}) < 1e-9;
        wall += norm(touch.normal - Vec3{1, 0, 0}) < 1e-9;
        EXPECT_NEAR(touch.gap, gap, 1e-9) << shape.index();
        for (const Touch& other : found)
          EXPECT_TRUE(&other == &touch || other.feature != touch.feature || other.other_feature != touch.other_feature);
      }
      EXPECT_EQ(floor, on_floor) << shape.index();
      EXPECT_EQ(wall, on_wall) << shape.index();
      EXPECT_EQ(found.size(), floor + wall);
    }
}

TEST(CornerTouches, of_what_is_round_are_with_the_face_beneath_it_where_another_is_nearer_to_its_lowest_point) {
  const Outline step = placed(step_mesh(), {});
  Outline open = step;
  open.solids[0].form = make_open_form(step_mesh());
  const double to_edge = 0.02, depth = 0.04;
  for (const Shape& shape : {Shape(Sphere{0.2}), Shape(Ellipsoid{{0.4, 0.4, 0.4}}), Shape(Cylinder{0.2, 0.4})})
    for (const Outline& mesh : {step, open}) {
      const auto found = touches_of(placed(shape, {1 - to_edge, 1.2 - depth, 0}), mesh, 0.01);
      ASSERT_FALSE(found.empty()) << shape.index();
      EXPECT_NEAR(least_gap_of(found), -depth, 1e-9) << shape.index();
      for (const Touch& touch : found) EXPECT_NEAR(norm(touch.normal - Vec3{0, 1, 0}), 0, 1e-9) << shape.index();
    }
}

TEST(CornerTouches, of_a_body_keep_their_names_on_all_triangles_of_a_floor) {
  const Outline step = placed(step_mesh(), {});
  std::uint32_t name = 0;
  for (double x = 0.25; x < 0.8; x += 0.05)
    for (double z = -0.8; z < 0.8; z += 0.05) {
      const auto found = touches_of(placed(Sphere{0.2}, {x, 1.2, z}), step, 0.01);
      ASSERT_EQ(found.size(), 1u);
      if (name == 0) name = found[0].other_feature + 1;
      EXPECT_EQ(found[0].other_feature + 1, name);
    }
}

TEST(CornerTouches, push_a_corner_out_of_the_bottom_of_a_valley) {
  const Outline open = open_valley();
  const Quaternion tip_down{0, 0, -std::sqrt(0.5), std::sqrt(0.5)};
  const auto found = touches_of(placed(Cone{0.1, 0.8}, {0, 0.35, 0}, tip_down), open, 0.01);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(least_gap_of(found), -0.05, 1e-9);
  for (const Touch& touch : found) EXPECT_GT(touch.normal.y, 0);
}

TEST(CornerTouches, push_a_disk_out_of_the_bottom_of_a_valley) {
  const double radius = 0.3, depth = 0.02;  // beneath the bottom line, which is nearest
  const auto found = touches_of(placed(Cylinder{radius, 0.002}, {0, radius - depth, 0}), open_valley(), 0.01);
  ASSERT_FALSE(found.empty());
  EXPECT_NEAR(least_gap_of(found), -depth, 1e-4);
  for (const Touch& touch : found) EXPECT_GT(touch.normal.y, 0);
}

TEST(CornerTouches, of_a_tip_that_leaves_a_table_are_none_with_its_side) {
  const double tilt = std::atan(0.25), beyond = 1e-4;  // the side of the cone lies on the table
  const Quaternion turn{0, 0, -std::sin(tilt / 2), std::cos(tilt / 2)};
  const Vec3 tip{1 + beyond, 1 - beyond, 0}, middle = tip - 0.2 * Vec3{std::cos(tilt), -std::sin(tilt), 0};
  for (const Touch& touch : touches_of(placed(Cone{0.1, 0.4}, middle, turn), placed(step_mesh(), {}), 0.01))
    EXPECT_LT(touch.normal.x, 0.9);
}

}  // namespace
}  // namespace iota::contact
