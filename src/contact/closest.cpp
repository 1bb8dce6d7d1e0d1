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

/// The corners of a simplex that the point nearest to the origin needs, by their numbers, and that point. A corner takes 80 bytes: they
/// stay where they are.
struct GjkNearest {
  std::array<std::uint8_t, 4> corners{};
  std::size_t count = 0;
  std::array<double, 4> share{};
  Vec3 point;
};

GjkNearest nearest_of_corner(const GjkSimplex& s, std::uint8_t i) { return {{i}, 1, {1}, s.corners[i].place}; }

GjkNearest nearest_of_segment(const GjkSimplex& s, std::uint8_t i, std::uint8_t j) {
  const Vec3& a = s.corners[i].place;
  const Vec3 along = s.corners[j].place - a;
  const double squared = dot(along, along), share = squared > 0 ? -dot(a, along) / squared : 0;
  if (share > 0 && share < 1) return {{i, j}, 2, {1 - share, share}, a + share * along};
  return nearest_of_corner(s, share >= 1 ? j : i);
}

GjkNearest nearest_of_triangle(const GjkSimplex& s, std::uint8_t i, std::uint8_t j, std::uint8_t k) {
  const Vec3 &a = s.corners[i].place, &b = s.corners[j].place, &c = s.corners[k].place;
  const Vec3 normal = cross(b - a, c - a);
  const double squared = dot(normal, normal);
  const double of_c = dot(cross(b - a, normal), a), of_a = dot(cross(c - b, normal), b),
               of_b = dot(cross(a - c, normal), c);
  if (of_a >= 0 && of_b >= 0 && of_c >= 0 && squared > 0) {
    const double sum = of_a + of_b + of_c;
    if (sum > 0) return {{i, j, k}, 3, {of_a / sum, of_b / sum, of_c / sum}, dot(a, normal) / squared * normal};
  }
  GjkNearest best;
  double least = std::numeric_limits<double>::infinity();
  const std::uint8_t sides[3][2] = {{i, j}, {j, k}, {k, i}};
  for (const auto& side : sides) {
    const GjkNearest part = nearest_of_segment(s, side[0], side[1]);
    if (const double apart = dot(part.point, part.point); apart < least) least = apart, best = part;
  }
  return best;
}

/// All four, and zero, if the origin is inside.
GjkNearest nearest_of_tetrahedron(const GjkSimplex& s) {
  constexpr std::uint8_t faces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
  GjkNearest best{{0, 1, 2, 3}, 4, s.share, {}};
  double least = std::numeric_limits<double>::infinity();
  for (const auto& face : faces) {
    const Vec3 &a = s.corners[face[0]].place, &b = s.corners[face[1]].place, &c = s.corners[face[2]].place;
    const Vec3 normal = cross(b - a, c - a);
    // A flat one has no inside: then all its sides count.
    if (dot(normal, s.corners[face[3]].place - a) * -dot(normal, a) > 0) continue;
    const GjkNearest part = nearest_of_triangle(s, face[0], face[1], face[2]);
    if (const double apart = dot(part.point, part.point); apart < least) least = apart, best = part;
  }
  return best;
}

GjkNearest nearest_of(const GjkSimplex& s) {
  if (s.count == 1) return nearest_of_corner(s, 0);
  if (s.count == 2) return nearest_of_segment(s, 0, 1);
  return s.count == 3 ? nearest_of_triangle(s, 0, 1, 2) : nearest_of_tetrahedron(s);
}

/// Keeps the corners that the nearest point needs.
void reduce(GjkSimplex& s, const GjkNearest& to) {
  // A corner that is kept may lie where an earlier one goes: of a triangle the third and the first.
  const std::array<GjkCorner, 4> before = s.corners;
  for (std::size_t k = 0; k < to.count; ++k) s.corners[k] = before[to.corners[k]];
  s.count = to.count, s.share = to.share;
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
  simplex.count = 1, simplex.share[0] = 1;
  Vec3 nearest = simplex.corners[0].place;
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
    simplex.corners[simplex.count++] = farther;
    const GjkNearest next = nearest_of(simplex);
    // With a plane between the sets the origin is not inside: round-off.
    is_inside = next.count == 4 && !(apart > surely_apart * std::sqrt(extent));
    if (!is_inside && (next.count == 4 || dot(next.point, next.point) >= squared)) {
      --simplex.count;
      break;
    }
    reduce(simplex, next), nearest = next.point;
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
