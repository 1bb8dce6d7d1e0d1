// SPDX-License-Identifier: Apache-2.0
// Pairs that are told apart at once have no touch, by the distance of the shapes.
#include "contact/apart.h"

#include "contact/gap.h"
#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

struct RandomPairs {
  RandomShapes random{11};

  Shape shape(bool is_ball) {
    if (is_ball) return Sphere{random.number(0.05, 0.6)};
    const Vec3 size{random.number(0.1, 1), random.number(0.1, 1), random.number(0.1, 1)};
    return Box{size, random.number(0, 1) < 0.5 ? 0 : random.number(0, 0.5) * std::min({size.x, size.y, size.z})};
  }
  Outline outline(bool is_ball, double far) {
    return placed(shape(is_ball), random.number(0, far) * rotate(random.turn(), {1, 0, 0}), random.turn());
  }
};

TEST(Apart, is_said_of_nothing_that_is_nearer) {
  RandomPairs pairs;
  int known = 0, apart = 0;
  for (int round = 0; round < 4000; ++round) {
    const Outline one = pairs.outline(round % 2, 1), other = pairs.outline(round / 2 % 2, 1);
    const double within = pairs.random.number(0, 0.2), distance = gap(one, other).distance;
    const bool is_told = are_clearly_apart(one.solids[0], other.solids[0], within);
    EXPECT_EQ(is_told, are_clearly_apart(other.solids[0], one.solids[0], within));
    if (is_told) {
      EXPECT_GT(distance, within);
    }
    apart += distance > within, known += is_told;
  }
  EXPECT_GT(apart, 500);
  EXPECT_GT(known, 0.8 * apart);
}

TEST(Apart, is_said_of_balls_by_their_distance) {
  RandomPairs pairs;
  for (int round = 0; round < 4000; ++round) {
    const Outline ball = pairs.outline(true, 1), other = pairs.outline(round % 2, 1);
    const double distance = gap(ball, other).distance;
    if (!(distance > 1e-3)) continue;
    EXPECT_TRUE(are_clearly_apart(ball.solids[0], other.solids[0], distance * (1 - 1e-4) - 1e-5));
    EXPECT_FALSE(are_clearly_apart(ball.solids[0], other.solids[0], distance * (1 + 1e-9)));
  }
}

TEST(Apart, is_not_said_of_other_shapes) {
  const auto are_apart = [](const Outline& one, const Outline& other) {
    return are_clearly_apart(one.solids[0], other.solids[0], 0);
  };
  EXPECT_FALSE(are_apart(placed(Cylinder{0.1, 0.1}, {5, 0, 0}), placed(Sphere{0.1}, {})));
  EXPECT_FALSE(are_apart(placed(Box{{1, 1, 1}}, {5, 0, 0}), placed(HalfSpace{}, {})));
}

}  // namespace
}  // namespace iota::contact
