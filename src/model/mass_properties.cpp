// SPDX-License-Identifier: Apache-2.0
#include "math/mat3.h"

#include <iota/shapes.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace iota {

namespace {

using std::numbers::pi;

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw std::invalid_argument(text.str());
}

void require_length(std::string_view what, double v) {
  if (!(v >= 1e-9 && v <= 1e9)) refuse(what, " must be between 1e-9 and 1e9 m, got ", v);
}

Matrix3 diagonal(double x, double y, double z) { return {Vec3{x, 0, 0}, Vec3{0, y, 0}, Vec3{0, 0, z}}; }

MassProperties properties(const Sphere& s) {
  require_length("a sphere's radius", s.radius);
  const double r2 = s.radius * s.radius;
  return {4 * pi / 3 * r2 * s.radius, {}, diagonal(r2 / 5, r2 / 5, r2 / 5)};
}

MassProperties properties(const Box& b) {
  for (const double edge : {b.size.x, b.size.y, b.size.z}) require_length("each edge of a box", edge);
  const auto& [x, y, z] = b.size;
  return {x * y * z, {}, diagonal(x * x / 12, y * y / 12, z * z / 12)};
}

MassProperties properties(const Cylinder& c) {
  require_length("a cylinder's radius", c.radius);
  require_length("a cylinder's length", c.length);
  const double r2 = c.radius * c.radius;
  return {pi * r2 * c.length, {}, diagonal(c.length * c.length / 12, r2 / 4, r2 / 4)};
}

MassProperties properties(const Capsule& c) {
  require_length("a capsule's radius", c.radius);
  require_length("a capsule's length", c.length);
  const double r2 = c.radius * c.radius, l2 = c.length * c.length;
  const double tube = pi * r2 * c.length, ends = 4 * pi / 3 * r2 * c.radius, volume = tube + ends;
  // A half sphere's mean distance from its flat face is 3/8 r.
  const double along = tube * l2 / 12 + ends * (l2 / 4 + 3 * c.length * c.radius / 8 + r2 / 5);
  const double across = tube * r2 / 4 + ends * r2 / 5;
  return {volume, {}, diagonal(along / volume, across / volume, across / volume)};
}

MassProperties properties(const Torus& t) {
  require_length("a torus' radius", t.radius);
  require_length("a torus' tube", t.tube);
  if (t.tube > t.radius)
    refuse("a torus' tube (", t.tube, " m) must not be thicker than its radius (", t.radius,
           " m): it would cut itself");
  const double a2 = t.tube * t.tube, across = (t.radius * t.radius + 0.75 * a2) / 2;
  return {2 * pi * pi * t.radius * a2, {}, diagonal(across, across, a2 / 4)};
}

/// Every edge must be run through once each way.
void require_closed(const Mesh& mesh) {
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
      refuse("the mesh is wound inconsistently: triangles ", edges[i - 1].triangle, " and ", edges[i].triangle,
             " both run along the edge ", edges[i].from, " -> ", edges[i].to, "; turn one of them round");
  for (const Edge& e : edges) {
    const auto opposite = std::lower_bound(edges.begin(), edges.end(), Edge{e.to, e.from, 0});
    if (opposite == edges.end() || opposite->from != e.to || opposite->to != e.from)
      refuse("the mesh is not closed: triangle ", e.triangle, " has no neighbor at the edge ", e.from, " - ", e.to,
             "; close the hole, or join vertices that are at one place");
  }
}

MassProperties properties(const Mesh& mesh) {
  if (mesh.triangles.size() < 4) refuse("a closed mesh has at least 4 triangles, this one has ", mesh.triangles.size());
  double extent = 0;
  Vec3 mean;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3& at = mesh.vertices[v];
    if (!is_finite(at)) refuse("vertex ", v, " of the mesh is not finite");
    if (std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) > 1e9)
      refuse("vertex ", v, " of the mesh is more than 1e9 m from its origin");
    mean += (1.0 / static_cast<double>(mesh.vertices.size())) * mesh.vertices[v];
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    for (const std::uint32_t v : {a, b, c}) {
      if (v >= mesh.vertices.size())
        refuse("triangle ", t, " of the mesh names vertex ", v, ", but there are only ", mesh.vertices.size());
      extent = std::max(extent, norm(mesh.vertices[v] - mean));
    }
    if (a == b || b == c || c == a) refuse("triangle ", t, " of the mesh names a vertex twice");
  }
  require_closed(mesh);

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
    refuse("the mesh is inside out (its volume is ", volume, " m^3): turn all triangles round");
  if (!(volume > 1e-9 * extent * extent * extent))
    refuse("the mesh encloses no volume (", volume, " m^3 at ", extent, " m): it is flat, or folds back on itself");
  const Vec3 center = (1 / volume) * first;
  const Mat3 about_center = (1 / volume) * second + -1.0 * Mat3::outer(center, center);
  MassProperties p{volume, mean + center, {}};
  for (int i = 0; i < 3; ++i) p.mean_squares[i] = {about_center.m[i][0], about_center.m[i][1], about_center.m[i][2]};
  return p;
}

}  // namespace

MassProperties mass_properties(const Shape& shape) {
  return std::visit([](const auto& s) { return properties(s); }, shape);
}

}  // namespace iota
