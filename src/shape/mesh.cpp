// SPDX-License-Identifier: Apache-2.0
#include "shape/mesh.h"

#include "base/archive.h"
#include "base/text.h"
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

namespace iota::shape {

namespace {

constexpr std::string_view or_open = "; an obstacle takes an open one (Python: closed=False)";

/// Why it is not closed, empty if it is: every edge must occur once in each direction.
std::string gap_of(const Mesh& mesh) {
  struct Edge {
    std::uint32_t from, to;
    std::size_t triangle;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) edges.push_back({mesh.triangles[t][i], mesh.triangles[t][(i + 1) % 3], t});
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 1; i < edges.size(); ++i)
    if (edges[i - 1].from == edges[i].from && edges[i - 1].to == edges[i].to)
      return text("the mesh is wound inconsistently: triangles ", edges[i - 1].triangle, " and ", edges[i].triangle,
                  " both run along the edge ", edges[i].from, " -> ", edges[i].to, "; turn one of them round");
  for (const Edge& e : edges) {
    const auto opposite = std::lower_bound(edges.begin(), edges.end(), Edge{e.to, e.from, 0});
    if (opposite == edges.end() || opposite->from != e.to || opposite->to != e.from)
      return text("the mesh is not closed: triangle ", e.triangle, " has no neighbor at the edge ", e.from, " - ", e.to,
                  "; close the hole, or join vertices that are at one place", or_open);
  }
  return {};
}

/// Why the triangles enclose no volume, empty if they do: `out` is then what they enclose.
std::string measure(const Mesh& mesh, MassProperties& out) {
  if (mesh.triangles.size() < 4)
    return text("a closed mesh has at least 4 triangles, this one has ", mesh.triangles.size(), or_open);
  if (std::string gap = gap_of(mesh); !gap.empty()) return gap;
  Vec3 mean;
  for (const Vec3& vertex : mesh.vertices) mean += (1.0 / static_cast<double>(mesh.vertices.size())) * vertex;
  double extent = 0;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) extent = std::max(extent, norm(mesh.vertices[v] - mean));

  // Tetrahedra from the vertices' mean to each triangle; a tetrahedron that faces inward has negative volume.
  double volume = 0;
  Vec3 first;
  Mat3 second;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vec3 a = mesh.vertices[ia] - mean, b = mesh.vertices[ib] - mean, c = mesh.vertices[ic] - mean;
    const Vec3 sum = a + b + c;
    const double v = dot(a, cross(b, c)) / 6;
    volume += v;
    first += (v / 4) * sum;
    second += (v / 20) * (Mat3::outer(sum, sum) + Mat3::outer(a, a) + Mat3::outer(b, b) + Mat3::outer(c, c));
  }
  if (volume < -1e-9 * extent * extent * extent)
    return text("the mesh is inside out (its volume is ", volume, " m^3): turn all triangles round");
  if (!(volume > 1e-9 * extent * extent * extent))
    return text("the mesh encloses no volume (", volume, " m^3 at ", extent,
                " m): it is flat, or folds back on itself");
  const Vec3 center = (1 / volume) * first;
  const Mat3 about_center = (1 / volume) * second + -1.0 * Mat3::outer(center, center);
  out = {volume, mean + center, {}};
  for (int i = 0; i < 3; ++i) out.mean_squares[i] = {about_center.m[i][0], about_center.m[i][1], about_center.m[i][2]};
  return {};
}

}  // namespace

std::uint64_t Traits<Mesh>::key(const Mesh& mesh) {
  Hasher hasher;
  hasher.bytes(mesh.vertices.data(), mesh.vertices.size() * sizeof(Vec3));
  hasher.bytes(mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0]);
  return hasher.result();
}

Vec3 Traits<Mesh>::closest(const Mesh& mesh, const Vec3& p) {
  Vec3 best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 q = geometry::closest_of_triangle(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], p);
    if (const double distance = dot(q - p, q - p); distance < least) least = distance, best = q;
  }
  return best;
}

bool Traits<Mesh>::is_within(const Mesh& mesh, const Vec3& p) {
  double angle = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    angle += geometry::solid_angle(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], p);
  return angle > 2 * std::numbers::pi;
}

Vec3 Traits<Mesh>::support(const Mesh& mesh, const Vec3& d) {
  return *std::max_element(mesh.vertices.begin(), mesh.vertices.end(),
                           [&](const Vec3& a, const Vec3& b) { return dot(a, d) < dot(b, d); });
}

double Traits<Mesh>::scale(const Mesh& mesh) {
  double extent = 0;
  for (const Vec3& v : mesh.vertices) extent = std::max(extent, norm(v));
  return extent;
}

void Traits<Mesh>::check_triangles(const Mesh& mesh) {
  if (mesh.triangles.empty()) refuse("the mesh has no triangle");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& at = mesh.vertices[v];
    if (!is_finite(at)) refuse("vertex ", v, " of the mesh is not finite");
    if (std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) > 1e9)
      refuse("vertex ", v, " of the mesh is more than 1e9 m from its origin");
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    for (const std::uint32_t v : {a, b, c})
      if (v >= mesh.vertices.size())
        refuse("triangle ", t, " of the mesh names vertex ", v, ", but there are only ", mesh.vertices.size());
    if (a == b || b == c || c == a) refuse("triangle ", t, " of the mesh names a vertex twice");
  }
}

bool Traits<Mesh>::has_volume(const Mesh& mesh) {
  MassProperties unused;
  return measure(mesh, unused).empty();
}

MassProperties Traits<Mesh>::mass(const Mesh& mesh) {
  check_triangles(mesh);
  MassProperties properties;
  if (const std::string why_not = measure(mesh, properties); !why_not.empty()) refuse(why_not);
  return properties;
}

}  // namespace iota::shape
