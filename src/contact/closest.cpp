// SPDX-License-Identifier: Apache-2.0
// Gilbert, Johnson, Keerthi 1988: the point nearest to the origin of all differences of points of two sets is searched by
// simplices of support points.
#include "contact/closest.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace iota::contact {

namespace {

constexpr double touching_squared = 1e-30;  ///< of the squared extent
constexpr double surely_apart = 1e-12;      ///< of the extent
constexpr int most_gjk_steps = 100;

struct GjkCorner {
  Vec3 place, first, second;  ///< place = first - second
  std::uint32_t of_first = 0, of_second = 0;
};

struct GjkSimplex {
  std::array<GjkCorner, 4> corners;
  std::array<double, 4> share{};
  std::size_t count = 0;
};

Vec3 take_corner(GjkSimplex& s) {
  s.count = 1, s.share[0] = 1;
  return s.corners[0].place;
}

/// The corners that the point nearest to the origin needs, and that point.
Vec3 reduce_segment(GjkSimplex& s) {
  const Vec3 a = s.corners[0].place, along = s.corners[1].place - a;
  const double squared = dot(along, along), share = squared > 0 ? -dot(a, along) / squared : 0;
  if (share > 0 && share < 1) {
    s.share[0] = 1 - share, s.share[1] = share;
    return a + share * along;
  }
  if (share >= 1) s.corners[0] = s.corners[1];
  return take_corner(s);
}

Vec3 reduce_triangle(GjkSimplex& s) {
  const Vec3 a = s.corners[0].place, b = s.corners[1].place, c = s.corners[2].place;
  const Vec3 normal = cross(b - a, c - a);
  const double squared = dot(normal, normal);
  const double of_c = dot(cross(b - a, normal), a), of_a = dot(cross(c - b, normal), b),
               of_b = dot(cross(a - c, normal), c);
  if (of_a >= 0 && of_b >= 0 && of_c >= 0 && squared > 0) {
    const double sum = of_a + of_b + of_c;
    if (sum > 0) {
      s.share = {of_a / sum, of_b / sum, of_c / sum, 0};
      return dot(a, normal) / squared * normal;
    }
  }
  GjkSimplex best;
  Vec3 nearest;
  double least = std::numeric_limits<double>::infinity();
  constexpr std::size_t sides[3][2] = {{0, 1}, {1, 2}, {2, 0}};
  for (const auto& side : sides) {
    GjkSimplex part;
    part.corners[0] = s.corners[side[0]], part.corners[1] = s.corners[side[1]], part.count = 2;
    const Vec3 point = reduce_segment(part);
    if (const double apart = dot(point, point); apart < least) least = apart, nearest = point, best = part;
  }
  s = best;
  return nearest;
}

/// Zero if the origin is inside.
Vec3 reduce_tetrahedron(GjkSimplex& s) {
  constexpr std::size_t faces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
  GjkSimplex best;
  Vec3 nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& face : faces) {
    const Vec3 a = s.corners[face[0]].place, b = s.corners[face[1]].place, c = s.corners[face[2]].place;
    const Vec3 normal = cross(b - a, c - a);
    // A flat one has no inside: then all its sides count.
    if (dot(normal, s.corners[face[3]].place - a) * -dot(normal, a) > 0) continue;
    GjkSimplex part;
    for (std::size_t k = 0; k < 3; ++k) part.corners[k] = s.corners[face[k]];
    part.count = 3;
    const Vec3 point = reduce_triangle(part);
    if (const double apart = dot(point, point); apart < least) least = apart, nearest = point, best = part;
  }
  if (best.count > 0) s = best;
  return nearest;
}

Vec3 reduce(GjkSimplex& s) {
  if (s.count == 1) return take_corner(s);
  if (s.count == 2) return reduce_segment(s);
  return s.count == 3 ? reduce_triangle(s) : reduce_tetrahedron(s);
}

bool has(const GjkSimplex& s, const GjkCorner& corner) {
  for (std::size_t k = 0; k < s.count; ++k)
    if (s.corners[k].place == corner.place) return true;
  return false;
}

}  // namespace

Closest closest(SupportOf first, SupportOf second, const Vec3& start, double exactness) {
  const auto support = [&](const Vec3& direction) {
    const Support a = first(direction), b = second(-1.0 * direction);
    return GjkCorner{a.place - b.place, a.place, b.place, a.number, b.number};
  };
  GjkSimplex simplex;
  simplex.corners[0] = support(dot(start, start) > 0 ? -1.0 * start : Vec3{1, 0, 0});
  simplex.count = 1;
  Vec3 nearest = reduce(simplex);
  double extent = dot(nearest, nearest), apart = 0;  // squared; along the best plane between the sets
  bool is_inside = false;
  for (int step = 0; step < most_gjk_steps; ++step) {
    const double squared = dot(nearest, nearest);
    is_inside = squared <= touching_squared * extent;
    if (is_inside) break;
    const GjkCorner farther = support(-1.0 * nearest);
    extent = std::max(extent, dot(farther.place, farther.place));
    const double along = dot(nearest, farther.place);
    apart = std::max(apart, along / std::sqrt(squared));
    if (squared - along <= exactness * squared || has(simplex, farther)) break;
    GjkSimplex next = simplex;
    next.corners[next.count++] = farther;
    const Vec3 point = reduce(next);
    // With a plane between the sets the origin is not inside: round-off.
    is_inside = next.count == 4 && !(apart > surely_apart * std::sqrt(extent));
    if (!is_inside && (next.count == 4 || dot(point, point) >= squared)) break;
    simplex = next, nearest = point;
    if (is_inside) break;
  }
  Closest result;
  result.count = static_cast<std::uint32_t>(simplex.count);
  for (std::size_t k = 0; k < simplex.count; ++k) {
    result.on_first += simplex.share[k] * simplex.corners[k].first;
    result.on_second += simplex.share[k] * simplex.corners[k].second;
    result.first[k] = simplex.corners[k].of_first, result.second[k] = simplex.corners[k].of_second;
  }
  if (is_inside) return result;
  result.distance = norm(nearest);
  result.normal = (1 / result.distance) * nearest;
  return result;
}

}  // namespace iota::contact
