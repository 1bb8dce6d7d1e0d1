// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/meridian.h"

#include <algorithm>
#include <numbers>

namespace iota::shape {

///           y
///     .-----|-----.  -
///     |     o-----|--x   radius: half its height here
///     '-----------'  -
///     |--length---|
/// With the signed distance d (inside: from the nearer of side and faces), phi = d + d^2 / 2 radius: along the side that is
/// (y^2 + z^2 - radius^2) / 2 radius.
template <>
struct Traits<Cylinder> {
  static constexpr std::string_view name = "cylinder", doc = "A cylinder along x with flat ends.";
  static constexpr std::tuple sizes{Size{"radius", &Cylinder::radius, Range::length, "m"},
                                    Size{"length", &Cylinder::length, Range::length, "from end to end, m"}};
  static void check(const Cylinder&) {}
  static double scale(const Cylinder& c) { return std::min(c.radius, c.length / 2); }
  static double skin(const Cylinder& c) { return edge_skin * scale(c); }
  static double skin_level(const Cylinder& c) { return skin(c) * (1 + skin(c) / (2 * c.radius)); }

  static MassProperties mass(const Cylinder& c) {
    const double r2 = c.radius * c.radius;
    return {std::numbers::pi * r2 * c.length, {}, mean_squares(c.length * c.length / 12, r2 / 4, r2 / 4)};
  }
  static Level level(const Cylinder& c, const Vec3& p) {
    const Meridian m(p);
    const double side = m.rho - c.radius, end = std::abs(p.x) - c.length / 2, sign = p.x < 0 ? -1 : 1;
    if (side > 0 && end > 0)
      return bent(m.edge(sign * c.length / 2, c.radius, edge_bluntness * scale(c)), c.radius);
    if (side < end) return bent({end, {sign, 0, 0}, {}}, c.radius);
    const double k = 1 / c.radius;
    return {(k * (p.y * p.y + p.z * p.z) - c.radius) / 2, {0, k * p.y, k * p.z}, {{{0, 0, 0}, {0, k, 0}, {0, 0, k}}}};
  }
  static bool is_within(const Cylinder& c, const Vec3& p) {
    return Meridian(p).rho <= c.radius && std::abs(p.x) <= c.length / 2;
  }
  static Vec3 closest(const Cylinder& c, const Vec3& p) {
    const Meridian m(p);
    const double half = c.length / 2, side = m.rho - c.radius, end = std::abs(p.x) - half;
    if (side > 0 || end > 0) return m.at(std::clamp(p.x, -half, half), std::min(m.rho, c.radius));
    return side > end ? m.at(p.x, c.radius) : m.at(p.x < 0 ? -half : half, m.rho);
  }
  static Vec3 support(const Cylinder& c, const Vec3& d) {
    const Meridian m(d);
    return m.at(d.x < 0 ? -c.length / 2 : c.length / 2, m.rho > 0 ? c.radius : 0);
  }
  template <class Number>
  static Vec3 inside(const Cylinder& c, Number& number) {
    const auto [y, z] = in_disc(number);
    return {number(-c.length / 2, c.length / 2), c.radius * y, c.radius * z};
  }
};

}  // namespace iota::shape
