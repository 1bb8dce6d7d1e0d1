// SPDX-License-Identifier: Apache-2.0
// Balls, capsules and rods, at places where their touches are known.
#include "contact/round_pairs.h"

#include "placed.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota::contact {
namespace {

TEST(RoundPairs, of_balls_touch_at_one_point) {
  const auto found = touches_of(placed(Sphere{0.1}, {0, 0.31, 0}), placed(Sphere{0.2}, {}), 0.1);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].form, TouchForm::round);
  EXPECT_EQ(found[0].axis, Vec3{});
  EXPECT_NEAR(found[0].gap, 0.01, 1e-15);
  EXPECT_NEAR(norm(found[0].place - Vec3{0, 0.21, 0}), 0, 1e-15);
}

TEST(RoundPairs, at_one_place_have_a_fixed_direction) {
  for (const Shape& shape : {Shape{Sphere{0.1}}, Shape{Capsule{0.1, 1}}, Shape{Box{{1, 1, 1}, 0.1}},
                             Shape{Cylinder{0.2, 0.4}}, Shape{Ellipsoid{{0.2, 0.3, 0.4}}}, Shape{Cone{0.2, 0.4}}}) {
    const auto found = touches_of(placed(shape, {1, 2, 3}), placed(shape, {1, 2, 3}), 0.1);
    ASSERT_FALSE(found.empty());
    for (const Touch& touch : found) {
      EXPECT_NEAR(norm(touch.normal), 1, 1e-12);
      EXPECT_LT(touch.gap, 0);
    }
  }
}

TEST(RoundPairs, of_parallel_rods_touch_at_the_ends_of_their_common_length) {
  for (const double shift : {0.0, 0.3, -0.4}) {
    const auto found = touches_of(placed(Capsule{0.1, 1}, {shift, 0.2, 0}), placed(Capsule{0.1, 1}, {}), 0.01);
    ASSERT_EQ(found.size(), 2u);
    double low = 1, high = -1;
    for (const Touch& touch : found) {
      EXPECT_EQ(touch.form, TouchForm::round);
      EXPECT_NEAR(std::abs(touch.axis.x), 1, 1e-15);
      low = std::min(low, touch.place.x), high = std::max(high, touch.place.x);
    }
    EXPECT_NEAR(low, std::max(-0.5, -0.5 + shift), 1e-12);
    EXPECT_NEAR(high, std::min(0.5, 0.5 + shift), 1e-12);
  }
}

TEST(RoundPairs, of_crossed_rods_have_their_common_normal) {
  const auto found =
      touches_of(placed(Capsule{0.1, 1}, {0, 0.21, 0}, axis_angle({0, 1, 0}, 1)), placed(Capsule{0.1, 1}, {}), 0.02);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].form, TouchForm::wires);
  EXPECT_NEAR(norm(found[0].normal - Vec3{0, 1, 0}), 0, 1e-15);
  EXPECT_NEAR(found[0].gap, 0.01, 1e-15);
  const auto deep =
      touches_of(placed(Capsule{0.1, 1}, {0, 0.05, 0}, axis_angle({0, 1, 0}, 1)), placed(Capsule{0.1, 1}, {}), 0.02);
  ASSERT_EQ(deep.size(), 1u);
  EXPECT_EQ(deep[0].form, TouchForm::edges);
}

TEST(RoundPairs, of_rounded_boxes_with_parallel_edges_touch_at_two_points) {
  const Box box{{1, 1, 1}, 0.1};
  const double apart = 0.8 + 0.2 * std::sqrt(0.5);
  const auto found = touches_of(placed(box, {apart, apart, 0.2}), placed(box, {}), 0.02);
  ASSERT_EQ(found.size(), 2u);
  for (const Touch& touch : found) {
    EXPECT_EQ(touch.form, TouchForm::round);
    EXPECT_NEAR(touch.gap, 0, 1e-15);
    EXPECT_NEAR(std::abs(touch.axis.z), 1, 1e-15);
  }
}

TEST(RoundPairs, of_lines_that_share_a_point_touch_there_once) {
  Outline rope;
  rope.lines = {{1, 2, 0.1, {-0.3, 0.6, 0}, {0, 0.6, 0}}, {2, 3, 0.1, {0, 0.6, 0}, {0.7, 0.6, 0}}};
  const auto found = touches_of(rope, placed(Box{{1, 1, 1}}, {}), 0.01);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(std::ranges::count_if(found, [](const Touch& touch) { return touch.part == 2 && touch.feature == 0; }), 1);
  for (const Touch& touch : found) EXPECT_NEAR(touch.gap, 0, 1e-15);
}

}  // namespace
}  // namespace iota::contact
