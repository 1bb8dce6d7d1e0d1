// SPDX-License-Identifier: Apache-2.0
#include "shape/mesh.h"

#include "shape/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

namespace iota::shape {
namespace {

using MeshTraits = Traits<Mesh>;

/// A box with corners at `low` and `high`, by twelve triangles.
Mesh box_mesh(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

std::string why_refused(const Mesh& mesh) {
  try {
    (void)MeshTraits::mass(mesh);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Mesh, of_a_box_has_the_mass_properties_of_that_box) {
  const Vec3 low{-1, 2, 5}, high{2, 2.5, 9}, size = high - low;
  const MassProperties p = MeshTraits::mass(box_mesh(low, high));
  EXPECT_NEAR(p.volume, size.x * size.y * size.z, 1e-13);
  EXPECT_LT(norm(p.center - 0.5 * (low + high)), 1e-13);
  const std::array<double, 3> sizes{size.x, size.y, size.z};
  for (int i = 0; i < 3; ++i) {
    const std::array<double, 3> row{p.mean_squares[i].x, p.mean_squares[i].y, p.mean_squares[i].z};
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(row[j], i == j ? sizes[i] * sizes[i] / 12 : 0, 1e-12) << i << j;
  }
}

TEST(Mesh, of_a_box_has_the_nearest_point_and_the_inside_of_that_box) {
  const Vec3 low{-1, -2, -3}, high{1, 2, 3};
  const Mesh mesh = box_mesh(low, high);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-5, 5);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p{number(random), number(random), number(random)};
    Vec3 nearest{std::clamp(p.x, -1.0, 1.0), std::clamp(p.y, -2.0, 2.0), std::clamp(p.z, -3.0, 3.0)};
    const bool within = nearest == p;
    if (within) {  // then the nearest of the six faces
      const std::array<double, 3> left{1 - std::abs(p.x), 2 - std::abs(p.y), 3 - std::abs(p.z)};
      const auto face = std::min_element(left.begin(), left.end()) - left.begin();
      if (face == 0) nearest.x = std::copysign(1, p.x);
      if (face == 1) nearest.y = std::copysign(2, p.y);
      if (face == 2) nearest.z = std::copysign(3, p.z);
    }
    EXPECT_LT(norm(MeshTraits::closest(mesh, p) - nearest), 1e-14);
    EXPECT_EQ(MeshTraits::is_within(mesh, p), within);
    const Vec3 support = MeshTraits::support(mesh, p);
    EXPECT_EQ(support, (Vec3{std::copysign(1, p.x), std::copysign(2, p.y), std::copysign(3, p.z)}));
  }
}

TEST(Mesh, that_is_two_solids_is_outside_between_them) {
  Mesh two = box_mesh({0, 0, 0}, {1, 1, 1});
  const Mesh other = box_mesh({2, 0, 0}, {3, 1, 1});
  for (const Vec3& v : other.vertices) two.vertices.push_back(v);
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + 8, b + 8, c + 8});
  EXPECT_TRUE(MeshTraits::is_within(two, {0.5, 0.5, 0.5}));
  EXPECT_FALSE(MeshTraits::is_within(two, {1.5, 0.5, 0.5}));
  EXPECT_TRUE(MeshTraits::is_within(two, {2.5, 0.5, 0.5}));
  EXPECT_NEAR(MeshTraits::mass(two).volume, 2, 1e-13);
}

TEST(Mesh, of_equal_numbers_has_an_equal_key_and_of_others_another) {
  const Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  Mesh moved = mesh, turned = mesh;
  moved.vertices[3].x += 1e-15;
  std::swap(turned.triangles[0], turned.triangles[1]);
  EXPECT_EQ(MeshTraits::key(mesh), MeshTraits::key(box_mesh({0, 0, 0}, {1, 1, 1})));
  EXPECT_NE(MeshTraits::key(mesh), MeshTraits::key(moved));
  EXPECT_NE(MeshTraits::key(mesh), MeshTraits::key(turned));
}

TEST(Mesh, that_encloses_nothing_is_refused_with_the_place_and_the_way_out) {
  const Mesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  const auto refused = [&](auto damage) {
    Mesh mesh = box;
    damage(mesh);
    return why_refused(mesh);
  };
  const auto tells = [](const std::string& text, const char* words) { return text.find(words) != std::string::npos; };
  EXPECT_EQ(why_refused(box), "");
  EXPECT_TRUE(tells(refused([](Mesh& m) { m.triangles.resize(3); }), "at least 4 triangles"));
  EXPECT_TRUE(tells(refused([](Mesh& m) { m.triangles.pop_back(); }), "is not closed"));
  EXPECT_TRUE(tells(refused([](Mesh& m) { m.triangles.pop_back(); }), "an obstacle takes an open one"));
  EXPECT_TRUE(tells(refused([](Mesh& m) { std::swap(m.triangles[5][0], m.triangles[5][1]); }), "inconsistently"));
  EXPECT_TRUE(tells(refused([](Mesh& m) {
                      for (auto& t : m.triangles) std::swap(t[0], t[1]);
                    }),
                    "inside out"));
  EXPECT_TRUE(tells(refused([](Mesh& m) {
                      for (Vec3& v : m.vertices) v.z = 0;
                    }),
                    "no volume"));
  EXPECT_TRUE(tells(refused([](Mesh& m) { m.triangles[7][2] = 8; }), "names vertex 8"));
  EXPECT_TRUE(tells(refused([](Mesh& m) { m.triangles[7][2] = m.triangles[7][0]; }), "names a vertex twice"));
  EXPECT_TRUE(tells(refused([](Mesh& m) { m.vertices[4].y = std::nan(""); }), "vertex 4"));
  EXPECT_TRUE(tells(refused([](Mesh& m) { m.vertices[4].y = 2e9; }), "more than 1e9 m"));
}

}  // namespace
}  // namespace iota::shape
