// SPDX-License-Identifier: Apache-2.0
// Cylinders, cones and ellipsoids, at places where their touches are known.
#include "contact/round_touches.h"

#include "placed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <tuple>

namespace iota::contact {
namespace {

const Outline& round_table() {
  static const Outline table = placed(Box{{2, 1, 2}}, {0, -0.5, 0});
  return table;
}
Quaternion upright() { return axis_angle({0, 0, 1}, std::acos(0.0)); }

TEST(RoundTouches, of_a_lying_cylinder_roll_on_its_middle_line) {
  const auto found = touches_of(placed(Cylinder{0.2, 0.4}, {1, 0.2, 0}), round_table(), 0.01);
  ASSERT_EQ(found.size(), 2u);
  for (const Touch& touch : found) {
    EXPECT_NEAR(touch.radius, 0.2, 1e-15);
    EXPECT_NEAR(touch.center.y, 0.2, 1e-15);
    EXPECT_NEAR(touch.gap, 0, 1e-15);
  }
  EXPECT_NEAR(std::max(found[0].place.x, found[1].place.x), 1, 1e-9) << "not at the edge of the table";
}

TEST(RoundTouches, of_a_lying_cone_roll_on_its_side) {
  const double half_angle = std::atan2(0.2, 0.4), height = 0.2 * std::cos(half_angle) - 0.2 * std::sin(half_angle);
  const auto found =
      touches_of(placed(Cone{0.2, 0.4}, {0, height, 0}, axis_angle({0, 0, 1}, -half_angle)), round_table(), 0.01);
  ASSERT_EQ(found.size(), 2u);
  for (const Touch& touch : found) EXPECT_NEAR(touch.gap, 0, 1e-12);
}

TEST(RoundTouches, of_parallel_and_crossed_cylinders_are_those_of_their_middle_lines) {
  const Cylinder log{0.2, 1};
  EXPECT_EQ(touches_of(placed(log, {0, 0.4 - 1e-9, 0}), placed(log, {}), 0.01).size(), 2u);
  const auto found = touches_of(placed(log, {0, 0.4, 0}, axis_angle({0, 1, 0}, 1)), placed(log, {}), 0.01);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].form, TouchForm::wires);
  EXPECT_NEAR(found[0].gap, 0, 1e-12);
}

// A single touch let it tip by 5 degrees in a step, and kept heaps with cylinders awake.
TEST(RoundTouches, of_a_cylinder_that_nearly_stands_are_around_its_rim) {
  for (const double overlap : {1e-8, 1e-6, 1e-4})
    for (const double lean : {1e-9, 1e-7, 1e-5, 5e-4})
      for (double way = 0; way < 6; way += 0.1) {
        const Quaternion turn = multiply(axis_angle({std::cos(way), 0, std::sin(way)}, lean), upright());
        const auto found = touches_of(placed(Cylinder{0.2, 0.4}, {0.3, 0.2 - overlap, 0.1}, turn), round_table(), 1e-3);
        ASSERT_GE(found.size(), 4u) << overlap << " " << lean << " " << way;
        for (const Touch& touch : found) EXPECT_NEAR(std::abs(touch.normal.y), 1, 1e-12);
      }
}

TEST(RoundTouches, of_a_box_on_a_standing_cylinder_are_its_corners) {
  const auto found =
      touches_of(placed(Box{{0.2, 0.2, 0.2}}, {0, 0.3, 0}), placed(Cylinder{0.2, 0.4}, {}, upright()), 0.01);
  ASSERT_EQ(found.size(), 4u);
  for (const Touch& touch : found) EXPECT_NEAR(touch.gap, 0, 1e-15);
}

TEST(RoundTouches, of_an_ellipsoid_are_those_of_the_ball_of_its_curvature) {
  const Ellipsoid egg{{0.2, 0.4, 0.2}};
  const auto found = touches_of(placed(egg, {0, 0.2, 0}), round_table(), 0.01);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].radius, 0.1 * 0.1 / 0.2, 1e-12);
  EXPECT_NEAR(found[0].gap, 0, 1e-12);
}

// With the ball of the middle of the step, which is not the lowest one now.
TEST(RoundTouches, of_an_ellipsoid_that_turns_fast_are_those_of_a_ball_too) {
  const Outline egg = placed(Ellipsoid{{0.5, 0.4, 0.2}}, {0, 0.2, 0}), floor = placed(Box{{10, 1, 10}}, {0, -0.5, 0});
  for (const double turn : {1e-3, 0.01, 0.1}) {  // rad in half a step
    TouchFinder finder;
    std::vector<Touch> found;
    finder.find(egg, {turn, 0, 0}, floor, {}, 0.1, found);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].radius, 0.1 * 0.1 / 0.2, 0.1 * turn) << "about x it is as curved as a circle of 0.05 m";
  }
}

TEST(RoundTouches, keep_their_names_and_number_over_noise) {
  const Cylinder log{0.2, 0.4};
  const Capsule rod{0.1, 1};
  const Box table{{2, 1, 2}}, soft{{1, 1, 1}, 0.1};
  const Ellipsoid egg{{0.2, 0.4, 0.6}};
  const struct {
    Shape shape;
    Vec3 place;
    Quaternion turn;
    Shape other;
    Vec3 other_place;
    Quaternion other_turn;
    std::size_t count;
  } pairs[] = {{log, {0, 0.2, 0}, {}, table, {0, -0.5, 0}, {}, 2},
               {log, {0.9, 0.2, 0.1}, upright(), table, {0, -0.5, 0}, {}, 6},
               {log, {0.1, 0.4, 0.05}, upright(), log, {}, upright(), 6},
               {log, {0, 0.4, 0}, {}, log, {}, {}, 2},
               {log, {0, 0.4, 0}, axis_angle({0, 1, 0}, 1), log, {}, {}, 1},
               {egg, {0, 0.4, 0}, {}, egg, {}, {}, 1},
               {rod, {0, 0.2, 0}, {}, rod, {}, {}, 2},
               {rod, {0.2, 0.2, 0}, {}, rod, {}, {}, 2},
               {rod, {0, 0.1, 0}, {}, table, {0, -0.5, 0}, {}, 2},
               {soft, {0, 1, 0}, {}, soft, {}, {}, 4}};
  RandomShapes random(14);
  for (const auto& pair : pairs) {
    using Name = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t, bool>;
    std::set<Name> names;
    const Outline other = placed(pair.other, pair.other_place, pair.other_turn);
    for (int k = 0; k < 100; ++k) {
      const Quaternion turn = multiply(turn_by(random.vector(1e-8)), pair.turn);
      const auto found = touches_of(placed(pair.shape, pair.place + random.vector(1e-8), turn), other, 0.004);
      EXPECT_EQ(found.size(), pair.count);
      for (const Touch& t : found) {
        names.insert({t.part, t.feature, t.other_part, t.other_feature, t.is_turned});
        EXPECT_NEAR(t.gap, 0, 3e-8);
      }
    }
    EXPECT_EQ(names.size(), pair.count);
  }
}

}  // namespace
}  // namespace iota::contact
