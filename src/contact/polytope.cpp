// SPDX-License-Identifier: Apache-2.0
#include "contact/polytope.h"

#include <iota/shapes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>
#include <stdexcept>
#include <utility>

namespace iota::contact {

namespace {

constexpr double face_flatness = 1e-9;   ///< of the extent: corners that are so near to a plane are in it
constexpr double face_tilt = 1e-6;       ///< rad: between the triangles of one face
constexpr double lacking_volume = 1e-6;  ///< a mesh that lacks so much of its hull's volume counts as convex

using Way = std::pair<std::uint32_t, std::uint32_t>;

double volume_of(const Mesh& mesh) {
  double six = 0;
  for (const auto& [a, b, c] : mesh.triangles) six += dot(mesh.vertices[a], cross(mesh.vertices[b], mesh.vertices[c]));
  return six / 6;
}

double extent_of_places(const std::vector<Vec3>& places) {
  double extent = 0;
  for (const Vec3& place : places) extent = std::max(extent, norm(place - places.front()));
  return extent;
}

/// Gives each triangle the number of its face: neighbors in one plane have the same.
std::vector<std::uint32_t> merge_triangles(const Mesh& hull, const std::map<Way, std::uint32_t>& triangle_of,
                                           std::vector<Vec3>& normals) {
  const double flat = face_flatness * extent_of_places(hull.vertices);
  std::vector<Vec3> areas;
  for (const auto& [a, b, c] : hull.triangles)
    areas.push_back(cross(hull.vertices[b] - hull.vertices[a], hull.vertices[c] - hull.vertices[a]));
  std::vector<std::uint32_t> order(areas.size()), face_of(areas.size(), Polytope::none);
  for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
  // The largest triangle of a face has the best normal.
  std::stable_sort(order.begin(), order.end(), [&](auto i, auto k) { return norm(areas[i]) > norm(areas[k]); });
  for (const std::uint32_t seed : order) {
    if (face_of[seed] != Polytope::none || !(norm(areas[seed]) > 0)) continue;
    const auto face = static_cast<std::uint32_t>(normals.size());
    const Vec3 normal = (1 / norm(areas[seed])) * areas[seed], origin = hull.vertices[hull.triangles[seed][0]];
    normals.push_back(normal);
    face_of[seed] = face;
    std::vector<std::uint32_t> waiting{seed};
    while (!waiting.empty()) {
      const auto triangle = hull.triangles[waiting.back()];
      waiting.pop_back();
      for (int k = 0; k < 3; ++k) {
        const auto found = triangle_of.find({triangle[(k + 1) % 3], triangle[k]});
        if (found == triangle_of.end() || face_of[found->second] != Polytope::none) continue;
        const auto next = found->second;
        const bool is_flat = std::ranges::all_of(hull.triangles[next], [&](std::uint32_t corner) {
          return std::abs(dot(normal, hull.vertices[corner] - origin)) <= flat;
        });
        if (!is_flat || norm(cross(normal, areas[next])) > face_tilt * norm(areas[next]) ||
            dot(normal, areas[next]) < 0)
          continue;
        face_of[next] = face;
        waiting.push_back(next);
      }
    }
  }
  return face_of;
}

/// loop: its corners, counter-clockwise seen from outside.
void add_face(Polytope& polytope, std::span<const std::uint32_t> loop) {
  const auto face = static_cast<std::uint32_t>(polytope.faces.size()),
             begin = static_cast<std::uint32_t>(polytope.sides.size());
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const std::uint32_t from = loop[k], to = loop[(k + 1) % loop.size()];
    auto edge = std::ranges::find_if(polytope.edges, [&](const Polytope::Edge& e) {
      return (e.from == from && e.to == to) || (e.from == to && e.to == from);
    });
    if (edge == polytope.edges.end()) edge = polytope.edges.insert(edge, {from, to});
    (edge->from == from ? edge->left : edge->right) = face;
    polytope.sides.push_back({from, static_cast<std::uint32_t>(edge - polytope.edges.begin())});
  }
  const Vec3 area = cross(polytope.corners[loop[1]] - polytope.corners[loop[0]],
                          polytope.corners[loop[2]] - polytope.corners[loop[0]]);
  polytope.faces.push_back({(1 / norm(area)) * area, begin, begin + static_cast<std::uint32_t>(loop.size())});
}

/// Both ends of a prism, or the base of a pyramid, and the faces between them.
Polytope make_round(bool is_prism) {
  constexpr std::uint32_t n = corners_of_rim;
  Polytope polytope;
  const auto add_rim = [&](double x) {
    for (std::uint32_t k = 0; k < n; ++k) {
      const double turn = 2 * std::numbers::pi * k / n;
      polytope.corners.push_back({x, std::cos(turn), std::sin(turn)});
    }
  };
  add_rim(-1);
  std::vector<std::uint32_t> base, top;
  for (std::uint32_t k = 0; k < n; ++k) base.push_back(n - 1 - k), top.push_back(n + k);
  add_face(polytope, base);
  if (is_prism) {
    add_rim(1);
    add_face(polytope, top);
  } else {
    polytope.corners.push_back({1, 0, 0});
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    if (is_prism)
      add_face(polytope, std::array{k, next, n + next, n + k});
    else
      add_face(polytope, std::array{k, next, n});
  }
  return polytope;
}

Polytope make_cube() {
  Polytope cube;
  for (std::uint32_t k = 0; k < 8; ++k)
    cube.corners.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
  for (std::uint32_t axis = 0; axis < 3; ++axis)
    for (std::uint32_t place = 0; place < 4; ++place) {
      const std::uint32_t from = (place / 2) << ((axis + 1) % 3) | (place % 2) << ((axis + 2) % 3);
      cube.edges.push_back({from, from | 1u << axis});
    }
  for (std::uint32_t axis = 0; axis < 3; ++axis)
    for (std::uint32_t end = 0; end < 2; ++end) {
      const std::uint32_t u = (axis + 1) % 3, v = (axis + 2) % 3, base = end << axis;
      std::array<std::uint32_t, 4> loop{base, base | 1u << u, base | 1u << u | 1u << v, base | 1u << v};
      if (end == 0) std::swap(loop[1], loop[3]);
      add_face(cube, loop);
    }
  return cube;
}

}  // namespace

const Polytope& point_polytope() {
  static const Polytope point{{{}}, {}, {}, {}};
  return point;
}

const Polytope& segment_polytope() {
  static const Polytope segment{{{-1, 0, 0}, {1, 0, 0}}, {{0, 1}}, {}, {}};
  return segment;
}

const Polytope& cube_polytope() {
  static const Polytope cube = make_cube();
  return cube;
}

const Polytope& prism_polytope() {
  static const Polytope prism = make_round(true);
  return prism;
}

const Polytope& pyramid_polytope() {
  static const Polytope pyramid = make_round(false);
  return pyramid;
}

Polytope make_polytope(const Mesh& hull) {
  std::map<Way, std::uint32_t> triangle_of;
  for (std::uint32_t t = 0; t < hull.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) triangle_of[{hull.triangles[t][k], hull.triangles[t][(k + 1) % 3]}] = t;
  std::vector<Vec3> normals;
  const std::vector<std::uint32_t> face_of = merge_triangles(hull, triangle_of, normals);
  Polytope polytope;
  polytope.corners = hull.vertices;
  // The border of each face: its ways whose reverse is another face's.
  std::vector<std::map<std::uint32_t, std::uint32_t>> borders(normals.size());
  for (const auto& [way, triangle] : triangle_of) {
    const auto back = triangle_of.find({way.second, way.first});
    if (face_of[triangle] == Polytope::none) continue;
    if (back == triangle_of.end() || face_of[back->second] != face_of[triangle])
      borders[face_of[triangle]][way.first] = way.second;
  }
  std::map<Way, std::uint32_t> edge_of;
  for (std::uint32_t f = 0; f < normals.size(); ++f) {
    const auto begin = static_cast<std::uint32_t>(polytope.sides.size());
    if (borders[f].empty()) continue;
    const auto face = static_cast<std::uint32_t>(polytope.faces.size());
    const std::uint32_t start = borders[f].begin()->first;
    std::uint32_t from = start;
    for (std::size_t step = 0; step < borders[f].size(); ++step) {
      const auto next = borders[f].find(from);
      if (next == borders[f].end()) break;
      const std::uint32_t to = next->second;
      const auto [known, is_new] =
          edge_of.insert({{std::min(from, to), std::max(from, to)}, static_cast<std::uint32_t>(polytope.edges.size())});
      if (is_new) polytope.edges.push_back({from, to});
      Polytope::Edge& edge = polytope.edges[known->second];
      (edge.from == from ? edge.left : edge.right) = face;
      polytope.sides.push_back({from, known->second});
      from = to;
      if (from == start) break;
    }
    polytope.faces.push_back({normals[f], begin, static_cast<std::uint32_t>(polytope.sides.size())});
  }
  return polytope;
}

std::optional<Polytope> try_polytope(const Mesh& mesh) try {
  const Mesh hull = convex_hull(mesh.vertices);
  if (volume_of(mesh) < (1 - lacking_volume) * volume_of(hull)) return {};
  return make_polytope(hull);
} catch (const std::invalid_argument&) {
  return {};  // flat
}

}  // namespace iota::contact
