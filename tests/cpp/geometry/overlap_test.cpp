// SPDX-License-Identifier: Apache-2.0
// Convex sets in common, against distances of points, separating axes, and sets a hair apart.
#include "geometry/overlap.h"

#include "math/mat3.h"
#include "shape/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace iota::geometry {
namespace {

struct Placed {
  Shape shape;
  Vec3 position;
  Quaternion turn;

  Vec3 operator()(const Vec3& direction) const {
    const Quaternion back{-turn.x, -turn.y, -turn.z, turn.w};
    return position + rotate(turn, shape::support(shape, rotate(back, direction)));
  }
};

struct Chance {
  std::mt19937 random{7};
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 place(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Quaternion turn() {
    const Vec3 v = place(1);
    const double w = number(-1, 1), size = std::sqrt(dot(v, v) + w * w);
    return {v.x / size, v.y / size, v.z / size, w / size};
  }
};

/// Gottschalk, Lin, Manocha 1996: two boxes are apart if they are along one of 15 axes.
bool boxes_overlap(const Placed& a, const Placed& b) {
  const auto axes_of = [](const Placed& box) {
    return std::vector{rotate(box.turn, {1, 0, 0}), rotate(box.turn, {0, 1, 0}), rotate(box.turn, {0, 0, 1})};
  };
  std::vector<Vec3> axes = axes_of(a);
  for (const Vec3& axis : axes_of(b)) axes.push_back(axis);
  for (const Vec3& first : axes_of(a))
    for (const Vec3& second : axes_of(b)) axes.push_back(cross(first, second));
  const auto reach = [&](const Placed& box, const Vec3& axis) {
    const Vec3 half = 0.5 * std::get<Box>(box.shape).size;
    const std::vector<Vec3> own = axes_of(box);
    return half.x * std::abs(dot(own[0], axis)) + half.y * std::abs(dot(own[1], axis)) +
           half.z * std::abs(dot(own[2], axis));
  };
  for (const Vec3& axis : axes)
    if (std::abs(dot(b.position - a.position, axis)) > reach(a, axis) + reach(b, axis)) return false;
  return true;
}

TEST(Overlap, of_a_ball_and_a_convex_shape_is_where_the_shape_is_nearer_than_the_radius) {
  Chance chance;
  const Shape shapes[] = {Sphere{0.4},     Box{{1, 0.5, 0.2}, 0}, Box{{1, 0.5, 0.4}, 0.1}, Cylinder{0.3, 0.8},
                          Capsule{0.2, 1}, Cone{0.4, 0.9},        Ellipsoid{{1, 0.3, 0.6}}};
  int met = 0, tried = 0;
  for (const Shape& shape : shapes)
    for (int question = 0; question < 500; ++question) {
      const Placed placed{shape, chance.place(0.3), chance.turn()};
      const Placed ball{Sphere{chance.number(0.01, 0.6)}, chance.place(1.2), {}};
      const Quaternion back{-placed.turn.x, -placed.turn.y, -placed.turn.z, placed.turn.w};
      const double apart = shape::distance(shape, rotate(back, ball.position - placed.position));
      const double gap = apart - std::get<Sphere>(ball.shape).radius;
      if (std::abs(gap) < 1e-7) continue;
      EXPECT_EQ(overlap(placed, ball), gap < 0) << shape::name(shape) << ", " << gap << " m apart";
      EXPECT_EQ(overlap(ball, placed), gap < 0);
      met += gap < 0, ++tried;
    }
  EXPECT_GT(met, tried / 10);
  EXPECT_LT(met, 9 * tried / 10);
}

TEST(Overlap, of_boxes_equals_that_by_separating_axes) {
  Chance chance;
  int met = 0;
  for (int question = 0; question < 3000; ++question) {
    const auto box = [&] {
      return Placed{Box{{chance.number(0.1, 1), chance.number(0.1, 1), chance.number(0.1, 1)}, 0}, chance.place(0.6),
                    question % 3 == 0 ? Quaternion{} : chance.turn()};
    };
    const Placed a = box(), b = box();
    const bool expected = boxes_overlap(a, b);
    EXPECT_EQ(overlap(a, b), expected) << question;
    met += expected;
  }
  EXPECT_GT(met, 300);
  EXPECT_LT(met, 2700);
}

TEST(Overlap, begins_at_the_surfaces_at_any_size) {
  for (const double size : {1e-6, 1.0, 1e4}) {
    const Placed crate{Box{{size, size, size}, 0}, {0, 0.5 * size, 0}, {}};
    for (const double gap : {-1e-3, -1e-6, 1e-6, 1e-3}) {
      const Placed floor{Box{{20 * size, size, 20 * size}, 0}, {3 * size, -(0.5 + gap) * size, size}, {}};
      EXPECT_EQ(overlap(crate, floor), gap < 0) << size << ", " << gap;
      const Placed ball{Sphere{0.5 * size}, {(1 + gap) * size, 0.5 * size, 0}, {}};
      EXPECT_EQ(overlap(crate, ball), gap < 0) << size << ", " << gap;
    }
  }
}

}  // namespace
}  // namespace iota::geometry
