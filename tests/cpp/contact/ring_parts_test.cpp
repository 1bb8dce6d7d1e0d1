// SPDX-License-Identifier: Apache-2.0
// Rings against convex solids, by many points of their middle lines.
#include "contact/ring_parts.h"

#include "contact/ring_pairs.h"
#include "placed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

namespace iota::contact {
namespace {

std::vector<std::pair<std::string, Shape>> convex_shapes(RandomShapes& random) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 14; ++k) corners.push_back(random.vector(0.25));
  return {{"box", Box{{0.4, 0.2, 0.3}}},     {"rounded box", Box{{0.4, 0.2, 0.3}, 0.05}},
          {"cylinder", Cylinder{0.12, 0.4}}, {"rounded cylinder", Cylinder{0.12, 0.4, 0.03}},
          {"cone", Cone{0.2, 0.4}},          {"ellipsoid", Ellipsoid{{0.4, 0.2, 0.3}}},
          {"hull", convex_hull(corners)}};
}

TEST(RingParts, have_the_gap_of_their_distance_in_any_order) {
  constexpr int points = 4000;
  constexpr double within = 0.1;
  RandomShapes random(5);
  int count = 0;
  for (int round = 0; round < 60; ++round)
    for (const auto& [name, shape] : convex_shapes(random)) {
      const Torus torus{0.2, 0.03, round % 3 == 0 ? 0.2 : 0};
      const Outline one = placed(torus, random.vector(0.35), random.turn()), other = placed(shape, {}, random.turn());
      const Ring ring = make_ring(one.solids[0], {});
      const Solid& solid = other.solids[0];
      double least = 1e300;
      bool is_inside = false;
      for (int k = 0; k < points; ++k) {
        const Vec3 local = rotate(conjugate(solid.turn), ring.point(k / double{points}));
        is_inside = is_inside || is_within(*solid.form, local);
        least = std::min(least, norm(local - closest(*solid.form, local)) - torus.tube);
      }
      if (is_inside || least > within - 1e-3) continue;
      ++count;
      const auto touches = touches_of(one, other, within), turned = touches_of(other, one, within);
      EXPECT_NEAR(least_gap_of(touches), least, 1e-5) << name << " " << round;
      EXPECT_NEAR(least_gap_of(turned), least, 1e-5) << name << " " << round;
      for (const Touch& touch : touches) {
        EXPECT_NEAR(norm(touch.normal), 1, 1e-12);
        EXPECT_NEAR(dot(touch.normal, touch.center - touch.origin) - touch.radius, touch.gap, 1e-12) << name;
        const Vec3 place = touch.place + touch.gap * (touch.is_turned ? touch.normal : -touch.normal);
        const Vec3 local = rotate(conjugate(solid.turn), touch.is_turned ? touch.place : place);
        EXPECT_NEAR(norm(local - closest(*solid.form, local)), 0, 1e-5) << name << " " << round;
      }
    }
  EXPECT_GT(count, 100);
}

TEST(RingParts, are_as_those_with_a_rod_on_the_side_of_a_cylinder) {
  RandomShapes random(6);
  int count = 0;
  for (int round = 0; round < 200; ++round) {
    const Outline ring = placed(Torus{0.2, 0.03}, random.vector(0.1), random.turn());
    const auto by_cylinder = touches_of(ring, placed(Cylinder{0.05, 4}, {}), 0.05),
               by_rod = touches_of(ring, placed(Capsule{0.05, 4}, {}), 0.05);
    if (by_rod.empty() || least_gap_of(by_rod) < -0.03) continue;
    ++count;
    ASSERT_FALSE(by_cylinder.empty());
    EXPECT_NEAR(least_gap_of(by_cylinder), least_gap_of(by_rod), 1e-9);
  }
  EXPECT_GT(count, 40);
}

TEST(RingParts, have_six_places_at_least_around_a_ring_that_lies_on_a_face) {
  for (const double stretch : {0.0, 0.3})
    for (const double tilt : {0.0, 1e-9, 1e-3, 0.2}) {
      const Outline ring = placed(Torus{0.2, 0.03, stretch}, {0, 0.03 + 0.2 * std::sin(tilt), 0},
                                  {std::sin((M_PI / 2 + tilt) / 2), 0, 0, std::cos((M_PI / 2 + tilt) / 2)});
      const auto touches = touches_of(ring, placed(Box{{2, 1, 2}}, {0, -0.5, 0}), 0.2);
      EXPECT_GE(touches.size(), 6u) << tilt;
      EXPECT_LE(touches.size(), 8u) << tilt;
      EXPECT_NEAR(least_gap_of(touches), 0, 1e-9) << tilt;
    }
}

TEST(RingParts, push_a_ring_out_of_a_face_behind_which_its_middle_line_is) {
  for (const Shape& shape : {Shape{Box{{0.3, 0.3, 4}}}, Shape{Cylinder{0.15, 0.3}}}) {
    const Outline ring = placed(Torus{0.2, 0.03}, {0.29, 0, 0}), solid = placed(shape, {});
    const auto touches = touches_of(ring, solid, 0.01);
    ASSERT_FALSE(touches.empty());
    EXPECT_NEAR(least_gap_of(touches), -0.06 - 0.03, 1e-6);  // its middle line is 6 cm deep
    for (const Touch& touch : touches) EXPECT_GT((touch.is_turned ? -1 : 1) * touch.normal.x, 0.9);
  }
}

TEST(RingParts, have_two_places_of_a_link_that_stands_on_its_side) {
  for (const double lean : {0.0, 1e-6}) {
    const Outline link = placed(Torus{0.2, 0.03, 0.3}, {0, 0.23 + 0.15 * std::sin(lean), 0},
                                {0, 0, std::sin(lean / 2), std::cos(lean / 2)});
    const auto touches = touches_of(link, placed(Box{{2, 1, 2}}, {0, -0.5, 0}), 0.01);
    ASSERT_EQ(touches.size(), 2u) << lean;
    EXPECT_NEAR(norm(touches[0].place - touches[1].place), 0.3, 1e-5);
    EXPECT_NEAR(least_gap_of(touches), 0, 1e-7);
  }
}

}  // namespace
}  // namespace iota::contact
