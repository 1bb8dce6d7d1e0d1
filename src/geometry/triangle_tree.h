// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/box_tree.h"

#include <iota/shapes.h>

#include <optional>

namespace iota::geometry {

/// The triangles of a mesh in a tree, for meshes of many. In the mesh's frame, m.
class TriangleTree {
 public:
  /// is_closed: it has an inside.
  explicit TriangleTree(Mesh mesh, bool is_closed = true);

  /// The nearest point of the surface.
  Vec3 closest(const Vec3& place) const;
  bool is_within(const Vec3& place) const;
  /// Distance along a ray to the surface; 0 for a start inside.
  std::optional<double> ray(const Vec3& from, const Vec3& unit, double farthest) const;

  /// Calls visit(a, b, c) with the corners of each triangle whose box is at most `within` m away, and maybe others.
  template <class Visit>
  void near(const Vec3& place, double within, Visit visit) const {
    tree_.near(place, within, [&](std::uint32_t triangle) {
      const auto& [a, b, c] = mesh_.triangles[triangle];
      visit(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
      return within;
    });
  }

  /// Calls visit(a, b, c) with the corners of each triangle whose box a ball meets that goes along a ray, and maybe others, by the
  /// distance. visit returns the new limit, m.
  template <class Visit>
  void along(const Vec3& from, const Vec3& unit, double radius, double within, Visit visit) const {
    tree_.along(from, unit, radius, within, [&](std::uint32_t triangle) {
      const auto& [a, b, c] = mesh_.triangles[triangle];
      return visit(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
    });
  }

  bool is_closed() const { return is_closed_; }
  const std::vector<Vec3>& vertices() const { return mesh_.vertices; }
  const Mesh& mesh() const { return mesh_; }
  /// Around all of them.
  const Bounds& box() const { return box_; }

 private:
  Mesh mesh_;
  bool is_closed_;
  Bounds box_;
  BoxTree tree_;
};

/// The point of triangle a b c nearest to p.
Vec3 closest_of_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);
/// Solid angle of a triangle as seen from p: over a closed surface 4 pi inside, 0 outside.
double solid_angle(Vec3 a, Vec3 b, Vec3 c, const Vec3& p);
/// Distance along a ray to a triangle, from either side.
std::optional<double> ray_to_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from, const Vec3& unit);

}  // namespace iota::geometry
