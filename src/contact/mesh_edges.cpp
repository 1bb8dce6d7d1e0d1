// SPDX-License-Identifier: Apache-2.0
#include "contact/mesh_edges.h"

#include "math/mat3.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace iota::contact {

namespace {

geometry::Bounds box_of(const Vec3& a, const Vec3& b) {
  return {{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
          {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}};
}

}  // namespace

bool MeshEdges::Edge::may_push(const Vec3& away) const {
  constexpr double along_face = 0.02, along_normal = 0.5;
  if (dot(away, into[0]) > along_face || dot(away, into[1]) > along_face) return false;
  return has_two() || std::abs(dot(away, normal)) > along_normal;
}

MeshEdges::MeshEdges(const Mesh& mesh, bool is_closed) {
  constexpr double flat = 1e-3;  // sine of the angle between two faces
  // Corners at the same place are one: files have one for each color and normal.
  std::map<std::array<double, 3>, std::uint32_t> places;
  std::vector<std::uint32_t> corner_of;
  for (const Vec3& v : mesh.vertices)
    corner_of.push_back(
        places.try_emplace({v.x, v.y, v.z}, static_cast<std::uint32_t>(corner_of.size())).first->second);
  struct Face {
    Vec3 normal, into;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Face>> faces;
  for (const auto& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = mesh.vertices[triangle[k]], &b = mesh.vertices[triangle[(k + 1) % 3]],
                 &c = mesh.vertices[triangle[(k + 2) % 3]];
      const Vec3 normal = unit_or(cross(b - a, c - a), {});
      const auto ends = std::minmax(corner_of[triangle[k]], corner_of[triangle[(k + 1) % 3]]);
      if (ends.first != ends.second && normal != Vec3{})
        faces[{ends.first, ends.second}].push_back({normal, unit_or(cross(normal, b - a), {})});
    }
  for (const auto& [ends, there] : faces) {
    if (there.size() > 2) continue;
    Edge edge{.a = mesh.vertices[ends.first],
              .b = mesh.vertices[ends.second],
              .into = {there[0].into},
              .normal = there[0].normal};
    if (there.size() == 2) {
      const Vec3& next = there[1].into;
      if (norm(cross(there[0].into, next)) < flat && dot(there[0].into, next) < 0) continue;
      if (is_closed && dot(there[0].normal, next) > 0) continue;  // a hollow
      edge.into[1] = next;
    }
    edges_.push_back(edge);
  }
  std::vector<geometry::Bounds> boxes;
  for (const Edge& edge : edges_) boxes.push_back(box_of(edge.a, edge.b));
  tree_.build(boxes);
}

}  // namespace iota::contact
