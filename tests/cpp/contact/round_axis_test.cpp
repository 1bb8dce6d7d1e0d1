// SPDX-License-Identifier: Apache-2.0
// The direction of the largest separation, against many directions near it.
#include "contact/round_axis.h"

#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

TEST(RoundAxes, are_better_than_directions_near_them_for_parts_that_touch_or_overlap) {
  RandomShapes random(8);
  for (int round = 0; round < 400; ++round) {
    const Outline one = placed(random.make(4 + round % 4, 1), {}, random.turn());
    const Outline other = placed(random.make(round / 4 % 8, 1), {}, random.turn());
    ConvexPart a, b;
    place_part(one.solids[0], nullptr, {}, a);
    const Vec3 way = rotate(random.turn(), {1, 0, 0});
    // Until they overlap by up to a hundredth.
    double low = 0, high = 10;
    for (int k = 0; k < 50; ++k) {
      place_part({other.solids[0].form, 1, 0.5 * (low + high) * way, other.solids[0].turn}, nullptr, {}, b);
      const auto axis = find_round_axis(a, b, guess_round_axis(a, b), 100);
      (axis->apart - a.radius - b.radius > -0.01 * random.number(0, 1) ? high : low) = 0.5 * (low + high);
    }
    const auto axis = find_round_axis(a, b, guess_round_axis(a, b), 100);
    EXPECT_NEAR(apart_along(a, b, axis->normal), axis->apart, 1e-12);
    for (int k = 0; k < 200; ++k) {
      const Vec3 off = axis->normal + random.vector(k % 2 ? 1e-3 : 1e-5);
      EXPECT_LE(apart_along(a, b, (1 / norm(off)) * off), axis->apart + 1e-9);
    }
  }
}

}  // namespace
}  // namespace iota::contact
