// SPDX-License-Identifier: Apache-2.0
// Distances of outlines, and how far shapes go until they touch.
#include "contact/gap.h"

#include "placed.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota::contact {
namespace {

TEST(Gap, between_convex_shapes_is_that_of_alternating_projections) {
  RandomShapes random(1);
  for (int k = 0; k < 200; ++k) {
    const Shape one = random.make(k % RandomShapes::kinds, 0.5),
                other = random.make(k / RandomShapes::kinds % RandomShapes::kinds, 0.5);
    const Outline a = placed(one, random.vector(0.2), random.turn()),
                  b = placed(other, random.vector(2), random.turn());
    const Gap found = gap(a, b);
    if (!(found.distance > 0)) continue;
    EXPECT_NEAR(found.distance, upper_distance(a.solids[0], b.solids[0], 20000), 1e-5) << one.index() << other.index();
    EXPECT_NEAR(norm(found.on_first - found.on_second), found.distance, 1e-9);
    EXPECT_NEAR(gap(b, a).distance, found.distance, 1e-8);
  }
}

TEST(Gap, to_a_mesh_that_is_not_convex_is_that_to_its_nearest_triangle) {
  const Outline step = placed(step_mesh(), {});
  EXPECT_NEAR(gap(placed(Sphere{0.1}, {0.5, 1.5, 0}), step).distance, 0.4, 1e-9);
  EXPECT_NEAR(gap(step, placed(Box{{0.2, 0.2, 0.2}}, {0.5, 1.3, 0})).distance, 0.2, 1e-9);
  EXPECT_EQ(gap(placed(Sphere{0.1}, {-0.5, 0.5, 0}), step).distance, 0);
  EXPECT_NEAR(gap(step, placed(step_mesh(), {0, 2.5, 0})).distance, 0.5, 1e-9);
  EXPECT_EQ(gap(step, placed(step_mesh(), {0.1, 0.1, 0.1})).distance, 0);
}

TEST(Cast, of_a_ball_over_a_step_stops_at_its_wall_and_at_its_edge) {
  const Outline step = placed(step_mesh(), {});
  const auto go = [&](const Vec3& from, const Vec3& unit, double farthest = 10) {
    return cast(step, placed(Sphere{0.1}, from).solids[0], unit, farthest);
  };
  const auto wall = go({3, 1.5, 0}, {-1, 0, 0});
  ASSERT_TRUE(wall);
  EXPECT_NEAR(wall->distance, 2.9, 1e-8);
  EXPECT_NEAR(norm(wall->point - Vec3{0, 1.5, 0}), 0, 1e-8);
  const auto edge = go({3, 2.06, 0}, {-1, 0, 0});
  ASSERT_TRUE(edge);
  EXPECT_NEAR(edge->distance, 3 - 0.08, 1e-8);
  EXPECT_FALSE(go({3, 2.101, 0}, {-1, 0, 0}));
  EXPECT_FALSE(go({3, 1.5, 0}, {-1, 0, 0}, 2.89));
  EXPECT_FALSE(go({3, 1.5, 0}, {1, 0, 0}));
  EXPECT_EQ(go({-0.5, 0.5, 0}, {1, 0, 0})->distance, 0);
}

}  // namespace
}  // namespace iota::contact
