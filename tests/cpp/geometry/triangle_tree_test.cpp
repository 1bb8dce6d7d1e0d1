// SPDX-License-Identifier: Apache-2.0
// A tree of triangles against the shape of the same mesh, which looks at each one.
#include "geometry/triangle_tree.h"

#include "shape/shape.h"

#include <gtest/gtest.h>

#include <optional>
#include <random>

namespace iota::geometry {
namespace {

Vec3 random_place(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> number(-size, size);
  return {number(random), number(random), number(random)};
}

/// By a look at each triangle.
std::optional<double> met_slowly(const Mesh& mesh, const Vec3& from, const Vec3& unit, double farthest) {
  if (shape::is_within(mesh, from)) return 0.0;
  std::optional<double> first;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto met = ray_to_triangle(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], from, unit);
    if (met && *met <= farthest) first = met, farthest = *met;
  }
  return first;
}

TEST(TriangleTree, answers_as_a_look_at_each_triangle) {
  for (const Shape& shape : {Shape(Ellipsoid{{2, 1, 1.5}}), Shape(Box{{1, 2, 0.5}, 0})}) {
    const Mesh mesh = shape::triangulate(shape, 200);
    const TriangleTree tree(mesh);
    std::mt19937 random(3);
    int hits = 0;
    for (int question = 0; question < 200; ++question) {
      const Vec3 place = random_place(random, question % 2 == 0 ? 2 : 0.9);
      EXPECT_NEAR(norm(tree.closest(place) - place), norm(shape::closest(mesh, place) - place), 1e-12);
      EXPECT_EQ(tree.is_within(place), shape::is_within(mesh, place));
      Vec3 unit = random_place(random, 0.4) - place;
      unit = (1 / norm(unit)) * unit;
      const auto met = tree.ray(place, unit, 5);
      EXPECT_EQ(met, met_slowly(mesh, place, unit, 5));
      hits += met.has_value();
    }
    EXPECT_GT(hits, 100);
  }
}

TEST(TriangleTree, meets_a_ball_where_it_is) {
  const Mesh mesh = shape::triangulate(Sphere{1}, 2000);
  const TriangleTree tree(mesh);
  std::mt19937 random(4);
  for (int question = 0; question < 50; ++question) {
    Vec3 out = random_place(random, 1);
    out = (1 / norm(out)) * out;
    const auto met = tree.ray(3 * out, -out, 5);
    ASSERT_TRUE(met);
    EXPECT_NEAR(*met, 2, 5e-3);
  }
}

TEST(TriangleTree, lets_no_ray_through_at_edges_and_corners) {
  const Mesh cube = convex_hull(std::vector<Vec3>{
      {-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}});
  const TriangleTree tree(cube);
  std::mt19937 random(5);
  for (int question = 0; question < 2000; ++question) {
    Vec3 goal = random_place(random, 1);
    goal.x = -1;
    if (question % 2 == 0) goal.y = goal.z;  // on a diagonal of the face, which is an edge of its triangles
    const Vec3 from{-3, goal.y * 1.5, goal.z * 1.5};
    const Vec3 unit = (1 / norm(goal - from)) * (goal - from);
    const auto met = tree.ray(from, unit, 10);
    ASSERT_TRUE(met) << question;
    EXPECT_NEAR(*met, norm(goal - from), 1e-9);
  }
  EXPECT_FALSE(tree.ray({-3, 0, 0}, {1, 0, 0}, 1.9));
  EXPECT_FALSE(tree.ray({-3, 0, 0}, {-1, 0, 0}, 10));
  EXPECT_EQ(tree.ray({0.5, 0, 0}, {1, 0, 0}, 10), 0.0) << "it starts inside";
}

}  // namespace
}  // namespace iota::geometry
