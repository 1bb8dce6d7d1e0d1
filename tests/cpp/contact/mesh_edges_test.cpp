// SPDX-License-Identifier: Apache-2.0
// Edges of meshes, on which bodies lie without corners.
#include "contact/mesh_edges.h"

#include "placed.h"
#include "tests/cpp/allocations.h"

#include <gtest/gtest.h>

#include <cmath>

namespace iota::contact {
namespace {

/// A box of triangles; `is_split`: each triangle has corners of its own.
Mesh box_of_triangles(const Vec3& half, bool is_split) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back({k & 4 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 1 ? half.z : -half.z});
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  if (!is_split) return mesh;
  Mesh split;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(split.vertices.size());
    for (const std::uint32_t corner : triangle) split.vertices.push_back(mesh.vertices[corner]);
    split.triangles.push_back({first, first + 1, first + 2});
  }
  return split;
}

TEST(MeshEdges, are_those_where_faces_bend_and_not_those_within_a_face) {
  for (const bool is_closed : {true, false})
    for (const bool is_split : {true, false})
      EXPECT_EQ(MeshEdges(box_of_triangles({1, 2, 3}, is_split), is_closed).size(), 12u);
  EXPECT_EQ(MeshEdges(step_mesh(), true).size(), 17u);  // of 18 one is in the hollow
}

TEST(MeshEdges, push_between_the_normals_of_their_faces) {
  const MeshEdges edges(box_of_triangles({1, 1, 1}, false), true);
  int count = 0;
  edges.overlapping({{0.9, 0.9, -0.1}, {1.1, 1.1, 0.1}}, [&](std::uint32_t, const MeshEdges::Edge& edge) {
    ++count;
    EXPECT_TRUE(edge.may_push({0.6, 0.8, 0}));
    EXPECT_TRUE(edge.may_push({0, 1, 0}));
    EXPECT_FALSE(edge.may_push({-0.6, 0.8, 0}));
    EXPECT_FALSE(edge.may_push({0, -1, 0}));
  });
  EXPECT_EQ(count, 1);
}

TEST(MeshEdges, hold_a_beam_of_any_shape_that_lies_across_them) {
  const Outline rail = placed(box_of_triangles({0.1, 0.1, 1}, false), {});
  Outline open = rail;
  open.solids[0].form = make_open_form(box_of_triangles({0.1, 0.1, 1}, true));
  const Vec3 above{0.03, 0.2 - 1e-3, 0.2};
  for (const Shape& beam : {Shape{Box{{2, 0.2, 0.2}}}, Shape{Box{{2, 0.2, 0.2}, 0.02}}, Shape{Capsule{0.1, 2}},
                            Shape{Cylinder{0.1, 2}}, Shape{Ellipsoid{{20, 0.2, 0.2}}}}) {
    const auto touches = touches_of(placed(beam, above), open, 0.01);
    ASSERT_FALSE(touches.empty()) << beam.index();
    for (const Touch& touch : touches) {
      EXPECT_NEAR((touch.is_turned ? -1 : 1) * touch.normal.y, 1, 0.02) << beam.index();
      EXPECT_NEAR(touch.gap, -1e-3, 1e-3) << beam.index();
      for (const Touch& other : touches)
        EXPECT_TRUE(&other == &touch || other.feature != touch.feature || other.other_feature != touch.other_feature);
    }
    EXPECT_NEAR(least_gap_of(touches_of(open, placed(beam, above), 0.01)), least_gap_of(touches), 1e-12);
  }
}

TEST(MeshEdges, of_two_meshes_touch_where_they_cross) {
  const double turned = std::sqrt(0.5);
  const Outline lower = placed(step_mesh(), {}), upper = placed(step_mesh(), {}, {0, 0, 0, 1}, 8);
  for (const double gap : {1e-3, -1e-3}) {
    // Upside down and turned, so that the upper edges of both cross at a right angle.
    Outline crossed = upper;
    crossed.solids[0].turn = Quaternion{turned, 0, turned, 0};
    crossed.solids[0].position = {0.5, 4 + gap, 0.5};
    for (const bool is_swapped : {false, true}) {
      const auto found = is_swapped ? touches_of(crossed, lower, 0.01) : touches_of(lower, crossed, 0.01);
      int edges = 0;
      for (const Touch& touch : found) {
        EXPECT_NEAR(touch.gap, gap, 1e-9);
        if (touch.form != TouchForm::edges) continue;
        ++edges;
        EXPECT_NEAR(norm(touch.normal - Vec3{0, is_swapped ? 1.0 : -1.0, 0}), 0, 1e-9);
      }
      EXPECT_GT(edges, 0);
    }
  }
}

TEST(MeshEdges, are_made_when_a_mesh_comes_and_not_when_something_touches_it) {
  constexpr std::size_t count = 60;
  std::vector<double> heights;
  for (std::size_t k = 0; k < count * count; ++k)
    heights.push_back(0.1 * std::sin(0.3 * static_cast<double>(k % count)) *
                      std::cos(0.2 * static_cast<double>(k / count)));
  Outline land = placed(Box{{1, 1, 1}}, {});
  land.solids[0].form = make_open_form(height_field(heights, count, count, 10, 10));
  const auto bytes_of_a_touch = [&](bool is_prepared) {
    TouchFinder finder;
    if (is_prepared) finder.prepare(land);
    const long before = allocated_bytes;
    std::vector<Touch> found;
    finder.find(placed(Sphere{0.3}, {0, 0.3, 0}), {}, land, {}, 0.1, found);
    EXPECT_FALSE(found.empty());
    return allocated_bytes - before;
  };
  EXPECT_LT(bytes_of_a_touch(true), 0.01 * static_cast<double>(bytes_of_a_touch(false)));
}

}  // namespace
}  // namespace iota::contact
