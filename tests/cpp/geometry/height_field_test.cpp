// SPDX-License-Identifier: Apache-2.0
// Land made of heights.
#include "geometry/triangle_tree.h"

#include <iota/shapes.h>

#include <gtest/gtest.h>

#include <cmath>

namespace iota {
namespace {

TEST(HeightField, has_its_heights_at_the_corners_of_a_grid_about_the_origin) {
  const std::vector<double> heights{0, 1, 2, 3, 4, 5};
  const Mesh land = height_field(heights, 2, 3, 4, 6);
  ASSERT_EQ(land.vertices.size(), 6u);
  EXPECT_EQ(land.vertices[0], (Vec3{-2, 0, -3}));
  EXPECT_EQ(land.vertices[2], (Vec3{-2, 2, 3}));
  EXPECT_EQ(land.vertices[4], (Vec3{2, 4, 0}));
  EXPECT_EQ(land.triangles.size(), 4u);
  for (const auto& [a, b, c] : land.triangles)
    EXPECT_GT(cross(land.vertices[b] - land.vertices[a], land.vertices[c] - land.vertices[a]).y, 0);
  const geometry::TriangleTree tree(land, false);
  EXPECT_NEAR(tree.ray({0.1, 9, 0.2}, {0, -1, 0}, 100).value(), 9 - (2.5 + 0.1 * 0.75 + 0.2 / 3), 1e-12);
}

TEST(HeightField, refuses_what_is_no_land) {
  const std::vector<double> heights{0, 1, 2, std::nan("")};
  EXPECT_THROW(height_field(heights, 2, 2, 1, 1), std::invalid_argument);
  EXPECT_THROW(height_field(std::span(heights).first(3), 1, 3, 1, 1), std::invalid_argument);
  EXPECT_THROW(height_field(std::span(heights).first(3), 2, 2, 1, 1), std::invalid_argument);
  for (const double size : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(height_field(std::vector<double>(4), 2, 2, 1, size), std::invalid_argument);
}

}  // namespace
}  // namespace iota
