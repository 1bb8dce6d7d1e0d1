// SPDX-License-Identifier: Apache-2.0
// The nearest points of segments, against many pairs of points.
#include "contact/segments.h"

#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

TEST(Segments, have_no_points_nearer_than_the_nearest) {
  RandomShapes random(4);
  for (int round = 0; round < 2000; ++round) {
    const Vec3 a = random.vector(1), b = random.vector(1);
    // Some are parallel, or have no length.
    const Vec3 u = round % 7 == 0 ? Vec3{} : random.vector(1),
               v = round % 5 == 0 ? random.number(-2, 2) * u : random.vector(1);
    const NearestOfSegments found = nearest_of_segments(a, a + u, b, b + v);
    const double distance = norm(found.on_first - found.on_second);
    EXPECT_NEAR(norm(a + found.of_first * u - found.on_first) + norm(b + found.of_second * v - found.on_second), 0,
                1e-15);
    for (int i = 0; i <= 20; ++i)
      for (int k = 0; k <= 20; ++k) EXPECT_GE(norm(a + i / 20.0 * u - b - k / 20.0 * v), distance - 1e-12);
  }
}

}  // namespace
}  // namespace iota::contact
