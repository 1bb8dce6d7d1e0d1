// SPDX-License-Identifier: Apache-2.0
// Convex parts at their places, against the supports of the shapes.
#include "contact/convex_part.h"

#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

TEST(ConvexParts, reach_as_far_as_their_shapes_in_every_direction) {
  RandomShapes random(2);
  for (int round = 0; round < 900; ++round) {
    const Outline outline = placed(random.make(round % RandomShapes::kinds, 1), random.vector(5), random.turn());
    const Solid& solid = outline.solids[0];
    const Vec3 anchor = random.vector(5), direction = rotate(random.turn(), {1, 0, 0});
    std::optional<Polytope> hull;
    if (solid.form->mesh) hull = try_polytope(solid.form->mesh->mesh());
    ConvexPart part;
    place_part(solid, hull ? &*hull : nullptr, anchor, part);
    const double reach = dot(direction, farthest(part, direction)) + part.radius;
    EXPECT_NEAR(reach, dot(direction, farthest_of(solid, direction) - anchor), 1e-12)
        << "kind " << round % RandomShapes::kinds;
    // The polytope of what is round is within it, and its ends are at the same places.
    for (const Vec3& corner : part.corners) EXPECT_LE(dot(direction, corner) + part.radius, reach + 1e-12);
  }
}

TEST(ConvexParts, of_thin_rounded_cylinders_are_rods) {
  const Outline outline = placed(Cylinder{0.1, 1, 0.1}, {});
  ConvexPart part;
  place_part(outline.solids[0], nullptr, {}, part);
  EXPECT_TRUE(part.is_polytope());
  ASSERT_EQ(part.corners.size(), 2u);
  EXPECT_NEAR(norm(part.corners[1] - Vec3{0.4, 0, 0}), 0, 1e-15);
  EXPECT_EQ(part.radius, 0.1);
}

}  // namespace
}  // namespace iota::contact
