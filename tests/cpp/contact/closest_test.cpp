// SPDX-License-Identifier: Apache-2.0
// The nearest points of two sets, against closed forms and bounds.
#include "contact/closest.h"

#include "contact/segments.h"
#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

Closest closest_of_solids(const Solid& a, const Solid& b) {
  const auto of_a = [&](const Vec3& d) { return Support{farthest_of(a, d)}; };
  const auto of_b = [&](const Vec3& d) { return Support{farthest_of(b, d)}; };
  return closest(of_a, of_b, a.position - b.position);
}

TEST(Closest, is_between_the_bounds_of_the_distance_of_random_shapes) {
  RandomShapes random(3);
  for (int round = 0; round < 2000; ++round) {
    const Outline a = placed(random.make(round % RandomShapes::kinds, 1), random.vector(3), random.turn());
    const Outline b =
        placed(random.make(round / RandomShapes::kinds % RandomShapes::kinds, 1), random.vector(3), random.turn());
    const Closest found = closest_of_solids(a.solids[0], b.solids[0]);
    EXPECT_LE(found.distance, upper_distance(a.solids[0], b.solids[0]) + 1e-9);
    if (found.distance == 0) continue;
    // A plane that is between them says the other bound.
    const double apart =
        dot(found.normal, farthest_of(a.solids[0], -found.normal) - farthest_of(b.solids[0], found.normal));
    EXPECT_NEAR(found.distance, apart, 1e-9);
    EXPECT_NEAR(norm(found.on_first - found.on_second), found.distance, 1e-9);
  }
}

TEST(Closest, is_zero_for_sets_that_overlap) {
  const Outline a = placed(Box{{1, 1, 1}}, {0.9, 0.9, 0.9}), b = placed(Box{{1, 1, 1}}, {});
  EXPECT_EQ(closest_of_solids(a.solids[0], b.solids[0]).distance, 0);
  EXPECT_EQ(closest_of_solids(a.solids[0], a.solids[0]).distance, 0);
}

}  // namespace
}  // namespace iota::contact
