// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace iota::shape {

/// It lacks a level, so constraints refuse to hold points on it.
template <>
struct Traits<Octahedron> {
  static constexpr std::string_view name = "octahedron", doc = "An octahedron: |x| + |y| + |z| <= radius.";
  static constexpr std::tuple sizes{
      Size{"radius", &Octahedron::radius, Range::length, "from its center to a corner, m"}};
  static void check(const Octahedron&) {}
  static double scale(const Octahedron& o) { return o.radius; }

  static MassProperties mass(const Octahedron& o) {
    const double square = o.radius * o.radius / 10;
    return {4.0 / 3 * o.radius * o.radius * o.radius, {}, mean_squares(square, square, square)};
  }
  static double sum(const Vec3& p) { return std::abs(p.x) + std::abs(p.y) + std::abs(p.z); }
  static bool is_within(const Octahedron& o, const Vec3& p) { return sum(p) <= o.radius; }
  // All coordinates move by the same amount towards zero, but not beyond (Duchi et al., Efficient Projections onto the
  // l1-Ball, 2008); inside, outwards.
  static Vec3 closest(const Octahedron& o, const Vec3& p) {
    std::array<double, 3> sorted{std::abs(p.x), std::abs(p.y), std::abs(p.z)};
    std::sort(sorted.begin(), sorted.end(), std::greater<>());
    double less = (sum(p) - o.radius) / 3;
    double total = 0;
    if (less > 0)
      for (int k = 0; k < 3; ++k) {
        total += sorted[k];
        less = (total - o.radius) / (k + 1);
        if (k < 2 && less >= sorted[k + 1]) break;
      }
    const auto moved = [&](double x) { return std::copysign(std::max(std::abs(x) - less, 0.0), x); };
    return {moved(p.x), moved(p.y), moved(p.z)};
  }
  static Vec3 support(const Octahedron& o, const Vec3& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    if (x >= y && x >= z) return {std::copysign(o.radius, d.x), 0, 0};
    return y >= z ? Vec3{0, std::copysign(o.radius, d.y), 0} : Vec3{0, 0, std::copysign(o.radius, d.z)};
  }
  template <class Number>
  static Vec3 inside(const Octahedron& o, Number& number) {
    for (;;)
      if (const Vec3 p{number(-1, 1), number(-1, 1), number(-1, 1)}; sum(p) <= 1) return o.radius * p;
  }
};

}  // namespace iota::shape
