// SPDX-License-Identifier: Apache-2.0
#include "geometry/triangle_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace iota::geometry {

// Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
Vec3 closest_of_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return a;
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  const double inverse = 1 / (va + vb + vc);
  return a + vb * inverse * ab + vc * inverse * ac;
}

// van Oosterom, Strackee 1983.
double solid_angle(Vec3 a, Vec3 b, Vec3 c, const Vec3& p) {
  a -= p, b -= p, c -= p;
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

namespace {

/// The point in which a line meets the plane of a triangle: the distance along the line, and the shares of b and c.
struct Crossing {
  double distance = 0, b = 0, c = 0;
  bool is_outward = false;  ///< the line leaves what the triangle bounds
};

// Moeller, Trumbore 1997.
std::optional<Crossing> crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from, const Vec3& unit) {
  const Vec3 ab = b - a, ac = c - a, across = cross(unit, ac), start = from - a;
  const double area = dot(ab, across);
  if (area == 0) return std::nullopt;
  const Vec3 side = cross(start, ab);
  return Crossing{dot(ac, side) / area, dot(start, across) / area, dot(unit, side) / area, area < 0};
}

/// The share by which a crossing is within a triangle; negative outside.
double depth(const Crossing& met) { return std::min({met.b, met.c, 1 - met.b - met.c}); }

}  // namespace

std::optional<double> ray_to_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& from, const Vec3& unit) {
  // A ray through an edge must not pass between its two triangles.
  constexpr double round_off = 1e-12;
  const auto met = crossing(a, b, c, from, unit);
  if (!met || depth(*met) < -round_off || !(met->distance >= 0)) return std::nullopt;
  return met->distance;
}

TriangleTree::TriangleTree(Mesh mesh, bool is_closed) : mesh_(std::move(mesh)), is_closed_(is_closed) {
  std::vector<Bounds> boxes;
  boxes.reserve(mesh_.triangles.size());
  for (const auto& [a, b, c] : mesh_.triangles)
    boxes.push_back(joined(around(mesh_.vertices[a], mesh_.vertices[b]), {mesh_.vertices[c], mesh_.vertices[c]}));
  tree_.build(boxes);
  if (boxes.empty()) return;
  box_ = boxes[0];
  for (const Bounds& other : boxes) box_ = joined(box_, other);
}

Vec3 TriangleTree::closest(const Vec3& place) const {
  Vec3 best;
  double least = std::numeric_limits<double>::infinity();
  tree_.near(place, least, [&](std::uint32_t triangle) {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const Vec3 point = closest_of_triangle(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c], place);
    if (const double apart = norm(point - place); apart < least) least = apart, best = point;
    return least;
  });
  return best;
}

// By how often a ray leaves the surface more than it enters it. Near an edge that is not sure: then by solid angles, which
// look at each triangle.
bool TriangleTree::is_within(const Vec3& place) const {
  if (!is_closed_ || distance(box_, place) > 0) return false;
  constexpr Vec3 unit{0.48038446141526142, 0.61257153012461, 0.62762987};  // in no symmetry of a usual mesh
  constexpr double unsure = 1e-9, endless = std::numeric_limits<double>::infinity();
  int leaves = 0;
  bool is_sure = true;
  tree_.along(place, unit, 0, endless, [&](std::uint32_t triangle) {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const auto met = crossing(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c], place, unit);
    if (!met || depth(*met) < -unsure || met->distance < 0) return endless;
    if (depth(*met) < unsure) is_sure = false;
    leaves += met->is_outward ? 1 : -1;
    return endless;
  });
  if (is_sure) return leaves > 0;
  double angle = 0;
  for (const auto& [a, b, c] : mesh_.triangles)
    angle += solid_angle(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c], place);
  return angle > 2 * std::numbers::pi;
}

std::optional<double> TriangleTree::ray(const Vec3& from, const Vec3& unit, double farthest) const {
  if (is_within(from)) return 0.0;
  std::optional<double> first;
  tree_.along(from, unit, 0, farthest, [&](std::uint32_t triangle) {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    const auto met = ray_to_triangle(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c], from, unit);
    if (met && *met <= farthest) first = met, farthest = *met;
    return farthest;
  });
  return first;
}

}  // namespace iota::geometry
