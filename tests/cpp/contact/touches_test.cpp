// SPDX-License-Identifier: Apache-2.0
// The gaps of touches, against the least distance of many points of the surface from a plane.
#include "contact/touches.h"

#include "math/mat3.h"
#include "shape/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace iota::contact {
namespace {

Outline outline_of(const Shape& shape, const Vec3& position, const Quaternion& turn) {
  Outline outline;
  outline.solids.push_back({make_form(shape), 7, position, turn});
  return outline;
}

TEST(Touches, have_the_gap_of_the_lowest_point_of_the_shape) {
  std::mt19937 random(3);
  const auto number = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const Outline ground = outline_of(HalfSpace{{0, 1, 0}}, {}, {});
  const Shape shapes[] = {
      Sphere{0.3},    Box{{0.6, 0.4, 0.2}, 0.05}, Capsule{0.1, 0.5},     Cylinder{0.2, 0.5, 0.02},
      Cone{0.2, 0.5}, Torus{0.3, 0.05},           Torus{0.2, 0.03, 0.4}, Ellipsoid{{0.3, 0.5, 0.2}}};
  TouchFinder finder;
  for (int round = 0; round < 400; ++round) {
    const Shape& shape = shapes[round % std::size(shapes)];
    const Quaternion q = normalized({number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)});
    const Vec3 position{number(-1, 1), number(0, 1), number(-1, 1)};
    const Vec3 down = rotate(conjugate(q), {0, -1, 0});
    const double lowest = (position + rotate(q, shape::support(shape, down))).y;
    std::vector<Touch> found;
    finder.find(outline_of(shape, position, q), {1, 2, 3}, ground, {}, 10, found);
    ASSERT_FALSE(found.empty());
    double least = std::numeric_limits<double>::infinity();
    for (const Touch& touch : found) {
      EXPECT_NEAR(dot(touch.normal, touch.center - touch.origin) - touch.radius, touch.gap, 1e-12);
      EXPECT_NEAR(dot(touch.normal, touch.place - touch.origin), touch.gap, 1e-12);
      EXPECT_EQ(touch.part, 7u);
      least = std::min(least, touch.gap);
    }
    EXPECT_NEAR(least, lowest, 1e-9) << "shape " << shape.index();
  }
}

TEST(Touches, of_a_corner_on_a_face_know_its_normal) {
  const Outline table = outline_of(Box{{2, 1, 2}}, {0, -0.5, 0}, {});
  TouchFinder finder;
  for (const double height : {0.0, 1e-12, 1e-3, -1e-3}) {
    std::vector<Touch> found;
    finder.find(outline_of(Box{{0.2, 0.2, 0.2}}, {0.3, 0.1 + height, 0.2}, {}), {}, table, {}, 0.01, found);
    ASSERT_EQ(found.size(), 4u) << height;
    for (const Touch& touch : found) {
      EXPECT_LT(norm(touch.normal - Vec3{0, 1, 0}), 1e-9);
      EXPECT_NEAR(touch.gap, height, 1e-12);
    }
  }
}

TEST(Touches, of_a_corner_behind_an_open_mesh_are_on_the_side_of_the_middle_of_the_body) {
  Outline floor;
  floor.solids.push_back(
      {make_open_form({{{-2, 0, -2}, {-2, 0, 2}, {2, 0, -2}, {2, 0, 2}}, {{0, 1, 2}, {1, 3, 2}}}), 1, {}, {}});
  TouchFinder finder;
  for (const double height : {0.0, 1e-3, -1e-3})
    for (const double side : {1.0, -1.0}) {
      std::vector<Touch> found;
      finder.find(outline_of(Box{{0.2, 0.2, 0.2}}, {0.3, side * (0.1 + height), 0.2}, {}), {}, floor, {}, 0.01, found);
      ASSERT_EQ(found.size(), 4u) << height;
      for (const Touch& touch : found) {
        EXPECT_LT(norm(touch.normal - Vec3{0, side, 0}), 1e-9);
        EXPECT_NEAR(touch.gap, height, 1e-12);
      }
    }
}

TEST(Touches, of_lines_are_at_their_ends_each_once) {
  const Outline ground = outline_of(HalfSpace{{0, 1, 0}}, {}, {});
  Outline rods;
  rods.lines = {{1, 2, 0.1, {0, 0.1, 0}, {1, 0.2, 0}}, {2, 3, 0.1, {1, 0.2, 0}, {2, 0.1, 0}}};
  std::vector<Touch> found;
  TouchFinder().find(rods, {}, ground, {}, 1, found);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found[1].gap, 0.1, 1e-12);
}

}  // namespace
}  // namespace iota::contact
