// SPDX-License-Identifier: Apache-2.0
// Rings that cross open meshes, or go around them.
#include "contact/ring_sides.h"

#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

/// A strip along z in the plane y = 0.
Outline strip(double width) {
  Mesh mesh;
  for (const double x : {-0.5 * width, 0.5 * width})
    for (const double z : {-2.0, 2.0}) mesh.vertices.push_back({x, 0, z});
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
  Outline outline = placed(Box{{1, 1, 1}}, {3, 0, 0});
  outline.solids[0].form = make_open_form(mesh);
  return outline;
}

/// A ring around the z axis with this middle.
RingSides sides_of(const Vec3& middle, double width) {
  return {placed(Torus{0.3, 0.05}, Vec3{3, 0, 0} + middle).solids[0], strip(width).solids[0]};
}

TEST(RingSides, are_one_of_a_ring_that_hangs_on_a_strip) {
  const RingSides sides = sides_of({0, -0.2, 0}, 0.2);
  for (const double y : {0.1, -0.5}) EXPECT_FALSE(sides.is_through({3, y, 0}));
}

TEST(RingSides, tell_the_smaller_part_of_a_ring_that_has_come_through) {
  for (const double side : {1.0, -1.0}) {
    const RingSides sides = sides_of({0, 0.2 * side, 0}, 4);
    EXPECT_TRUE(sides.is_through({3, -0.1 * side, 0}));
    EXPECT_FALSE(sides.is_through({3, 0.5 * side, 0}));
    EXPECT_FALSE(sides.is_through({3.3, 0.2 * side, 0}));
  }
}

TEST(RingSides, are_one_of_a_ring_that_goes_around_a_border) {
  EXPECT_FALSE(sides_of({0.1, -0.2, 0}, 0.3).is_through({3.1, 0.1, 0}));
  EXPECT_FALSE(sides_of({-0.15, 0, 0}, 0.3).is_through({2.55, 0, 0}));
}

}  // namespace
}  // namespace iota::contact
