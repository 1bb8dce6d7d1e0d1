// SPDX-License-Identifier: Apache-2.0
// Corners against surfaces that are not convex.
#include "contact/corner_touches.h"

#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

/// An L of two boxes as one mesh: a step of height 1 at x = 0.
Mesh step_mesh() {
  const std::vector<Vec3> front{{-1, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0, 2, 1}, {-1, 2, 1}};
  Mesh mesh;
  mesh.vertices = front;
  for (Vec3 place : front) place.z = -1, mesh.vertices.push_back(place);
  for (const auto& [a, b, c] : {std::array{0u, 1u, 2u}, {0u, 2u, 3u}, {0u, 3u, 5u}, {3u, 4u, 5u}}) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a + 6, c + 6, b + 6});
  }
  for (std::uint32_t k = 0; k < 6; ++k) {
    const std::uint32_t next = (k + 1) % 6;
    mesh.triangles.push_back({k, k + 6, next}), mesh.triangles.push_back({next, k + 6, next + 6});
  }
  return mesh;
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

}  // namespace
}  // namespace iota::contact
