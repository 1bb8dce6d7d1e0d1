// SPDX-License-Identifier: Apache-2.0
// Gilbert, Johnson, Keerthi 1988: the point nearest to the origin of all differences of points of two sets is searched by
// simplices of support points; the sets are apart as soon as a plane lies between them.
#include "geometry/overlap.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

namespace iota::geometry {

namespace {

constexpr double touching = 1e-9;  ///< of the extent
constexpr int most_steps = 100;

struct Simplex {
  std::array<Vec3, 4> points;
  std::size_t count = 0;
};

/// The points of a segment that its point nearest to the origin needs, and that point.
Vec3 reduce_segment(Simplex& s) {
  const Vec3 a = s.points[0], along = s.points[1] - a;
  const double squared = dot(along, along), share = squared > 0 ? -dot(a, along) / squared : 0;
  if (share > 0 && share < 1) return a + share * along;
  if (share >= 1) s.points[0] = s.points[1];
  s.count = 1;
  return s.points[0];
}

Vec3 reduce_triangle(Simplex& s) {
  const auto [a, b, c, unused] = s.points;
  const Vec3 normal = cross(b - a, c - a);
  const bool is_within = dot(cross(b - a, normal), a) >= 0 && dot(cross(c - b, normal), b) >= 0 &&
                         dot(cross(a - c, normal), c) >= 0 && dot(normal, normal) > 0;
  if (is_within) return dot(a, normal) / dot(normal, normal) * normal;
  Simplex best;
  Vec3 nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    Simplex side{{from, to}, 2};
    const Vec3 point = reduce_segment(side);
    if (const double apart = dot(point, point); apart < least) least = apart, nearest = point, best = side;
  }
  s = best;
  return nearest;
}

/// Zero where the origin is inside.
Vec3 reduce_tetrahedron(Simplex& s) {
  constexpr std::size_t faces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
  Simplex best;
  Vec3 nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& face : faces) {
    const Vec3 a = s.points[face[0]], b = s.points[face[1]], c = s.points[face[2]];
    const Vec3 normal = cross(b - a, c - a);
    // A flat one has no inside, and its sides are all that counts.
    if (const double inward = dot(normal, s.points[face[3]] - a); inward * -dot(normal, a) > 0) continue;
    Simplex side{{a, b, c}, 3};
    const Vec3 point = reduce_triangle(side);
    if (const double apart = dot(point, point); apart < least) least = apart, nearest = point, best = side;
  }
  if (best.count > 0) s = best;
  return nearest;
}

Vec3 reduce(Simplex& s) {
  if (s.count == 2) return reduce_segment(s);
  if (s.count == 3) return reduce_triangle(s);
  return s.count == 4 ? reduce_tetrahedron(s) : s.points[0];
}

}  // namespace

bool overlap(Support a, Support b) {
  const auto support = [&](const Vec3& direction) { return a(direction) - b(-1.0 * direction); };
  Simplex simplex{{support({1, 0, 0})}, 1};
  Vec3 nearest = simplex.points[0];
  double extent = norm(nearest);
  for (int step = 0; step < most_steps; ++step) {
    if (norm(nearest) <= touching * extent) return true;
    const Vec3 farther = support(-1.0 * nearest);
    extent = std::max(extent, norm(farther));
    const double apart = dot(nearest, farther) / norm(nearest);  // a plane is between them at this distance
    if (apart > touching * extent) return false;
    simplex.points[simplex.count++] = farther;
    nearest = reduce(simplex);
    if (simplex.count == 4) return true;
  }
  return norm(nearest) <= 1e-6 * extent;
}

}  // namespace iota::geometry
