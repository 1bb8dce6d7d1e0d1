// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/meridian.h"

#include <algorithm>
#include <numbers>

namespace iota::shape {

///           y
///     .-----|-----.  -
///     |     o-----|--x   radius: half its height here; its edges rounded by arcs of `rounding`
///     '-----------'  -
///     |--length---|
/// With the signed distance d (inside: from the nearer of side and ends), phi = d + d^2 / 2 radius: along the side that
/// is (y^2 + z^2 - radius^2) / 2 radius.
template <>
struct Traits<Cylinder> {
  static constexpr std::string_view name = "cylinder", doc = "A cylinder along x with flat ends.";
  static constexpr std::tuple sizes{Size{"radius", &Cylinder::radius, Range::length, "m"},
                                    Size{"length", &Cylinder::length, Range::length, "from end to end, m"},
                                    Size{"rounding", &Cylinder::rounding, Range::length_or_0,
                                         "radius of its edges, m: at most radius and length / 2"}};
  static void check(const Cylinder& c) {
    if (c.rounding > scale(c))
      refuse("the rounding of a cylinder (", c.rounding, " m) must not be above its radius and half its length (",
             scale(c), " m)");
  }
  static double scale(const Cylinder& c) { return std::min(c.radius, c.length / 2); }
  static double skin(const Cylinder& c) { return c.rounding < 0.5 * edge_skin * scale(c) ? edge_skin * scale(c) : 0; }
  static double skin_level(const Cylinder& c) { return skin(c) * (1 + skin(c) / (2 * c.radius)); }

  static MassProperties mass(const Cylinder& c) {
    const double pi = std::numbers::pi, r2 = c.radius * c.radius;
    if (c.rounding == 0) return {pi * r2 * c.length, {}, mean_squares(c.length * c.length / 12, r2 / 4, r2 / 4)};
    // The long thin core, the wide short one without it, and a ring of quarter discs at each edge: each by its volume, by
    // the integral of x^2 and by that of the squared distance from the axis.
    const double e = c.rounding, in = c.radius - e, h = c.length / 2 - e, e2 = e * e, e3 = e2 * e, in2 = in * in;
    double volume = pi * in2 * c.length, x2 = volume * c.length * c.length / 12, rho2 = volume * in2 / 2;
    const double shell = 2 * pi * (r2 - in2) * h;
    volume += shell, x2 += shell * h * h / 3, rho2 += shell * (r2 + in2) / 2;
    const double area = pi * e2 / 4, first = e3 / 3, second = pi * e2 * e2 / 16, third = 2 * e2 * e3 / 15;
    volume += 4 * pi * (in * area + first);
    x2 += 4 * pi * (in * (h * h * area + 2 * h * first + second) + h * h * first + h * e2 * e2 / 4 + e2 * e3 / 15);
    rho2 += 4 * pi * (in2 * in * area + 3 * in2 * first + 3 * in * second + third);
    return {volume, {}, mean_squares(x2 / volume, rho2 / 2 / volume, rho2 / 2 / volume)};
  }
  static Level level(const Cylinder& c, const Vec3& p) {
    const Meridian m(p);
    const double in = c.radius - c.rounding, h = c.length / 2 - c.rounding, sign = p.x < 0 ? -1 : 1;
    const double side = m.rho - in, end = std::abs(p.x) - h;
    if (side > 0 && end > 0) {
      Level edge = m.edge(sign * h, in, edge_bluntness * scale(c));
      edge.value -= c.rounding;
      return bent(edge, c.radius);
    }
    if (side < end) return bent({end - c.rounding, {sign, 0, 0}, {}}, c.radius);
    const double k = 1 / c.radius;
    return {(k * (p.y * p.y + p.z * p.z) - c.radius) / 2, {0, k * p.y, k * p.z}, {{{0, 0, 0}, {0, k, 0}, {0, 0, k}}}};
  }
  static bool is_within(const Cylinder& c, const Vec3& p) {
    const Meridian m(p);
    const double side = m.rho - c.radius + c.rounding, end = std::abs(p.x) - c.length / 2 + c.rounding;
    return std::hypot(std::max(side, 0.0), std::max(end, 0.0)) <= c.rounding;
  }
  static Vec3 closest(const Cylinder& c, const Vec3& p) {
    const Meridian m(p);
    const double in = c.radius - c.rounding, h = c.length / 2 - c.rounding, sign = p.x < 0 ? -1 : 1;
    const double side = std::max(m.rho - in, 0.0), end = std::max(std::abs(p.x) - h, 0.0);
    if (const double from_core = std::hypot(side, end); from_core > 0) {
      const double part = c.rounding / from_core;
      return m.at(sign * (std::min(std::abs(p.x), h) + part * end), std::min(m.rho, in) + part * side);
    }
    const bool to_side = c.radius - m.rho < c.length / 2 - std::abs(p.x);
    return to_side ? m.at(p.x, c.radius) : m.at(sign * c.length / 2, m.rho);
  }
  static Vec3 support(const Cylinder& c, const Vec3& d) {
    const Meridian m(d);
    const double h = c.length / 2 - c.rounding;
    return m.at(d.x < 0 ? -h : h, m.rho > 0 ? c.radius - c.rounding : 0) + (c.rounding / norm(d)) * d;
  }
  template <class Number>
  static Vec3 inside(const Cylinder& c, Number& number) {
    for (;;) {
      const auto [y, z] = in_disc(number);
      const Vec3 p{number(-c.length / 2, c.length / 2), c.radius * y, c.radius * z};
      if (c.rounding == 0 || is_within(c, p)) return p;
    }
  }
};

}  // namespace iota::shape
