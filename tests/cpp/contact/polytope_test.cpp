// SPDX-License-Identifier: Apache-2.0
// The faces and edges of polytopes, by Euler's formula and by planes.
#include "contact/polytope.h"

#include "placed.h"

#include <gtest/gtest.h>

namespace iota::contact {
namespace {

void expect_closed(const Polytope& polytope) {
  EXPECT_EQ(polytope.sides.size(), 2 * polytope.edges.size());
  for (const Polytope::Edge& edge : polytope.edges)
    EXPECT_TRUE(edge.left != Polytope::none && edge.right != Polytope::none);
  for (const Polytope::Face& face : polytope.faces) {
    EXPECT_NEAR(norm(face.normal), 1, 1e-15);
    const Vec3 origin = polytope.corners[polytope.sides[face.begin].corner];
    for (const Vec3& corner : polytope.corners) EXPECT_LE(dot(face.normal, corner - origin), 1e-9);
    for (std::uint32_t s = face.begin; s < face.end; ++s) {
      const std::uint32_t next = s + 1 < face.end ? s + 1 : face.begin;
      const Polytope::Side &side = polytope.sides[s], &after = polytope.sides[next];
      const Polytope::Edge& edge = polytope.edges[side.edge];
      EXPECT_TRUE((edge.from == side.corner && edge.to == after.corner) ||
                  (edge.to == side.corner && edge.from == after.corner));
      EXPECT_NEAR(dot(face.normal, polytope.corners[side.corner] - origin), 0, 1e-9);
    }
  }
}

TEST(Polytopes, of_a_cube_a_prism_and_a_pyramid_are_closed) {
  EXPECT_EQ(cube_polytope().faces.size(), 6u);
  EXPECT_EQ(prism_polytope().faces.size(), 14u);
  EXPECT_EQ(pyramid_polytope().faces.size(), 13u);
  for (const Polytope* const each : {&cube_polytope(), &prism_polytope(), &pyramid_polytope()}) {
    expect_closed(*each);
    EXPECT_EQ(each->corners.size() + each->faces.size(), each->edges.size() + 2);
  }
  EXPECT_EQ(prism_polytope().faces[1].normal, (Vec3{1, 0, 0}));
}

TEST(Polytopes, have_one_face_for_coplanar_triangles) {
  std::vector<Vec3> places;
  for (double x : {-1.0, 0.0, 1.0})
    for (double y : {-1.0, 0.5, 1.0})
      for (double z : {-2.0, 2.0}) places.push_back({x, y, z});
  const Polytope box = make_polytope(convex_hull(places));
  EXPECT_EQ(box.faces.size(), 6u);
  EXPECT_EQ(box.edges.size(), 12u);
  expect_closed(box);
}

TEST(Polytopes, of_random_hulls_are_closed) {
  RandomShapes random(1);
  for (int k = 0; k < 100; ++k) expect_closed(make_polytope(std::get<Mesh>(random.make(8, 1))));
}

TEST(Polytopes, of_a_mesh_with_a_notch_do_not_exist) {
  Mesh cube = convex_hull(cube_polytope().corners);
  EXPECT_TRUE(try_polytope(cube));
  cube.vertices[7] = {0, 0, 0};
  EXPECT_FALSE(try_polytope(cube));
}

}  // namespace
}  // namespace iota::contact
