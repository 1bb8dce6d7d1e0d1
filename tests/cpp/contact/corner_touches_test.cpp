// SPDX-License-Identifier: Apache-2.0
// Corners against surfaces that are not convex.
#include "contact/corner_touches.h"

#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

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
