// SPDX-License-Identifier: Apache-2.0
#include <iota/shapes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace iota {
namespace {

/// How far the farthest point is outside of any facet.
double farthest_outside(const Mesh& hull, std::span<const Vec3> points) {
  double worst = -1e300;
  for (const auto& [a, b, c] : hull.triangles) {
    const Vec3 n = cross(hull.vertices[b] - hull.vertices[a], hull.vertices[c] - hull.vertices[a]);
    for (const Vec3& p : points) worst = std::max(worst, dot(n, p - hull.vertices[a]) / norm(n));
  }
  return worst;
}

std::vector<Vec3> grid(int n) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) points.push_back({1.0 * i, 1.0 * j, 1.0 * k});
  return points;
}

TEST(ConvexHull, of_a_grid_is_a_cube_whatever_lies_within_on_faces_or_on_edges) {
  std::vector<Vec3> points = grid(5);
  const std::vector<Vec3> once = points;
  points.insert(points.end(), once.begin(), once.end());
  std::mt19937 random(1);
  for (int turn = 0; turn < 20; ++turn) {
    std::shuffle(points.begin(), points.end(), random);
    const Mesh hull = convex_hull(points);
    EXPECT_NEAR(mass_properties(hull).volume, 64, 1e-12);  // and so closed, and seen from outside counter-clockwise
    EXPECT_LT(farthest_outside(hull, points), 1e-12);
    EXPECT_EQ(hull.vertices.size(), 8u);
    EXPECT_EQ(hull.triangles.size(), 12u);
  }
}

TEST(ConvexHull, holds_all_of_many_points_and_obeys_eulers_formula) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (const double flatness : {1.0, 1e-3, 1e-6}) {
    for (int run = 0; run < 20; ++run) {
      std::vector<Vec3> points;
      for (int i = 0; i < 300; ++i) {
        Vec3 p{normal(random), normal(random), normal(random)};
        if (run % 2) p = (1 / norm(p)) * p;  // all of them on the hull
        points.push_back({p.x, flatness * p.y, p.z + 5});
      }
      const Mesh hull = convex_hull(points);
      EXPECT_GT(mass_properties(hull).volume, 0);
      EXPECT_LT(farthest_outside(hull, points), 1e-10);
      EXPECT_EQ(hull.triangles.size() + 4, 2 * hull.vertices.size());
      if (run % 2 && flatness == 1) {
        EXPECT_EQ(hull.vertices.size(), points.size());
      }
    }
  }
}

TEST(ConvexHull, of_a_ball_of_points_has_the_mass_of_a_ball) {
  std::vector<Vec3> points;
  for (int i = 0; i < 4000; ++i) {  // a Fibonacci lattice
    const double z = 1 - (2 * i + 1) / 4000.0, r = std::sqrt(1 - z * z), turn = 2.399963229728653 * i;
    points.push_back({r * std::cos(turn), r * std::sin(turn), z});
  }
  const MassProperties hull = mass_properties(convex_hull(points)), ball = mass_properties(Sphere{1});
  EXPECT_NEAR(hull.volume, ball.volume, 0.01);
  EXPECT_NEAR(hull.mean_squares[0].x, ball.mean_squares[0].x, 5e-4);
}

TEST(ConvexHull, refuses_points_that_enclose_no_volume) {
  const auto refusal = [](std::vector<Vec3> points) -> std::string {
    try {
      (void)convex_hull(points);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).find("at least 4"), std::string::npos);
  EXPECT_NE(refusal(std::vector<Vec3>(9, Vec3{1, 2, 3})).find("one place"), std::string::npos);
  EXPECT_NE(refusal({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}).find("one line"), std::string::npos);
  EXPECT_NE(refusal({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}, {3, 2, 1}}).find("one plane"), std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, nan}}).find("point 3"), std::string::npos);
}

}  // namespace
}  // namespace iota
