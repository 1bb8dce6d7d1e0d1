// SPDX-License-Identifier: Apache-2.0
// Questions about one outline, against geometry by hand and samples.
#include "contact/outline.h"

#include "math/mat3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace iota::contact {
namespace {

const std::vector<Shape> bounded{
    Sphere{0.3},          Box{{0.6, 0.4, 0.2}, 0.05},
    Cylinder{0.2, 0.7},   Capsule{0.1, 0.5},
    Torus{0.3, 0.1, 0.2}, Ellipsoid{{0.5, 0.3, 0.2}},
    Cone{0.2, 0.5},       convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})};

struct Random {
  std::mt19937 engine{3};
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine); }
  Vec3 place(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Quaternion turn() { return normalized({number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)}); }
};

/// Two parts, each somewhere.
Outline of(Random& random, const Shape& shape) {
  Outline outline;
  outline.solids.push_back({make_form(shape), 0, random.place(1), random.turn()});
  outline.lines.push_back({0, 1, 0.1, random.place(1), random.place(1)});
  return outline;
}

TEST(Outline, a_line_is_a_capsule_and_a_ball_if_its_ends_are_one) {
  Outline outline;
  outline.lines.push_back({0, 1, 0.1, {-1, 0, 0}, {1, 0, 0}});
  outline.lines.push_back({2, 2, 0.5, {0, 5, 0}, {0, 5, 0}});
  EXPECT_NEAR(near(outline, {0, 1, 0}).distance, 0.9, 1e-15);
  EXPECT_EQ(near(outline, {0, 1, 0}).point, (Vec3{0, 0.1, 0}));
  EXPECT_NEAR(near(outline, {2, 0, 0}).distance, 0.9, 1e-15);
  EXPECT_NEAR(near(outline, {0, 0.05, 0}).distance, -0.05, 1e-15) << "inside";
  EXPECT_NEAR(near(outline, {0, 7, 0}).distance, 1.5, 1e-15);
  EXPECT_NEAR(*meet(outline, {0.5, 3, 0}, {0, -1, 0}, 9), 2.9, 1e-6);
  EXPECT_NEAR(*meet(outline, {0, 9, 0}, {0, -1, 0}, 9), 3.5, 1e-6);
  EXPECT_FALSE(meet(outline, {0, 9, 0}, {0, -1, 0}, 3.4));
  EXPECT_EQ(*meet(outline, {0, 5, 0.2}, {0, -1, 0}, 9), 0) << "it starts inside";
  const geometry::Bounds box = bounds(outline);
  EXPECT_EQ(box.low, (Vec3{-1.1, -0.1, -0.5}));
  EXPECT_EQ(box.high, (Vec3{1.1, 5.5, 0.5}));
}

TEST(Outline, a_box_holds_all_of_its_surface_and_has_no_room_to_spare) {
  Random random;
  for (const Shape& shape : bounded) {
    Outline outline = of(random, shape);
    outline.lines.clear();
    const geometry::Bounds box = bounds(outline);
    Vec3 most = box.low;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 point = near(outline, outline.solids[0].position + random.place(3)).point;
      for (const auto& [low, at, high] : {std::tuple{box.low.x, point.x, box.high.x},
                                          {box.low.y, point.y, box.high.y},
                                          {box.low.z, point.z, box.high.z}}) {
        EXPECT_LE(low, at + 1e-9);
        EXPECT_GE(high, at - 1e-9);
      }
      most = {std::max(most.x, point.x), std::max(most.y, point.y), std::max(most.z, point.z)};
    }
    // The box of the turned box of a ball, say, is larger by up to the root of 3.
    EXPECT_LT(norm(box.high - box.low), 2.3 * norm(most - box.low) + 0.2);
  }
  Outline endless;
  endless.solids.push_back({make_form(HalfSpace{}), 0, {}, {}});
  EXPECT_TRUE(std::isinf(bounds(endless).high.y));
}

TEST(Outline, a_ray_a_near_place_and_an_overlap_agree) {
  Random random;
  for (const Shape& shape : bounded) {
    const Outline outline = of(random, shape);
    int hits = 0;
    for (int i = 0; i < 100; ++i) {
      const Vec3 from = random.place(3), to = outline.solids[0].position + random.place(0.2);
      const Vec3 along = (1 / norm(to - from)) * (to - from);
      const Near nearest = near(outline, from);
      EXPECT_NEAR(norm(nearest.point - from), std::abs(nearest.distance), 1e-9);
      EXPECT_NEAR(near(outline, nearest.point).distance, 0, 1e-6) << "it is on the surface";
      if (!std::holds_alternative<Torus>(shape)) {  // whose triangles are a little within it
        const Solid ball{make_form(Sphere{std::abs(nearest.distance) * 1.001 + 1e-6}), 0, from, {}};
        EXPECT_TRUE(is_overlapped(outline, ball));
        const Solid smaller{make_form(Sphere{std::abs(nearest.distance) * 0.999 - 1e-6}), 0, from, {}};
        EXPECT_EQ(is_overlapped(outline, smaller), nearest.distance < 0);
      }
      if (const std::optional<double> met = meet(outline, from, along, 10)) {
        ++hits;
        EXPECT_LT(near(outline, from + *met * along).distance, 1e-4);
        EXPECT_GE(*met, nearest.distance - 1e-4) << "nothing is nearer than the nearest";
      }
    }
    EXPECT_GT(hits, 5);
  }
}

TEST(Outline, an_open_surface_has_two_sides_and_no_inside) {
  Outline outline;
  const Mesh wall{{{0, 0, -1}, {0, 0, 1}, {0, 2, 1}, {0, 2, -1}}, {{0, 1, 2}, {0, 2, 3}}};
  outline.solids.push_back({make_open_form(wall), 0, {3, 0, 0}, {}});
  for (const double side : {-1.0, 1.0}) {
    EXPECT_NEAR(near(outline, {3 + 0.1 * side, 1, 0}).distance, 0.1, 1e-12);
    EXPECT_NEAR(*meet(outline, {3 + side, 1, 0}, {-side, 0, 0}, 9), 1, 1e-12);
  }
}

}  // namespace
}  // namespace iota::contact
