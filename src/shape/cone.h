// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/meridian.h"

#include <algorithm>
#include <numbers>

namespace iota::shape {

///        y
///     |\ |
///     | \|            base: a disc of `radius` at x = -length / 2
///     |  o---)-- x    tip: at x = +length / 2
///     |  /
///     |/
///     |--length-|
/// phi = the distance, inside from the nearer of side and base. The center of mass is length / 4 behind the origin.
template <>
struct Traits<Cone> {
  static constexpr std::string_view name = "cone", doc = "A cone along x: its base at -length/2, its tip at +length/2.";
  static constexpr std::tuple sizes{Size{"radius", &Cone::radius, Range::length, "of its base, m"},
                                    Size{"length", &Cone::length, Range::length, "from base to tip, m"}};
  static void check(const Cone&) {}
  static double scale(const Cone& c) { return 0.5 * std::min(c.radius, c.length); }
  static double skin(const Cone& c) { return edge_skin * scale(c); }
  static double skin_level(const Cone& c) { return skin(c); }

  static MassProperties mass(const Cone& c) {
    const double r2 = c.radius * c.radius, l2 = c.length * c.length;
    return {
        std::numbers::pi / 3 * r2 * c.length, {-c.length / 4, 0, 0}, mean_squares(3 * l2 / 80, 0.15 * r2, 0.15 * r2)};
  }
  static Level level(const Cone& c, const Vec3& p) {
    const Meridian m(p);
    const From from(c, m);
    const double blunt = edge_bluntness * scale(c);
    switch (from.nearest) {
      case From::base: return m.level(from.base_distance, -1, 0, 0, 0, 0);
      case From::side: return m.level(from.side_distance, from.normal_x, from.normal_rho, 0, 0, 0);
      case From::rim: return m.edge(-c.length / 2, c.radius, blunt);
      case From::tip: break;
    }
    return m.edge(c.length / 2, 0, blunt);
  }
  static bool is_within(const Cone& c, const Vec3& p) {
    const From from(c, Meridian(p));
    return from.base_distance <= 0 && from.side_distance <= 0;
  }
  static Vec3 closest(const Cone& c, const Vec3& p) {
    const Meridian m(p);
    const From from(c, m);
    switch (from.nearest) {
      case From::base: return m.at(-c.length / 2, m.rho);
      case From::side:
        return m.at(p.x - from.side_distance * from.normal_x, m.rho - from.side_distance * from.normal_rho);
      case From::rim: return m.at(-c.length / 2, c.radius);
      case From::tip: break;
    }
    return {c.length / 2, 0, 0};
  }
  static Vec3 support(const Cone& c, const Vec3& d) {
    const Meridian m(d);
    const bool tip = d.x * c.length > m.rho * c.radius;
    return tip ? Vec3{c.length / 2, 0, 0} : m.at(-c.length / 2, m.rho > 0 ? c.radius : 0);
  }
  template <class Number>
  static Vec3 inside(const Cone& c, Number& number) {
    const double part = std::cbrt(number(0, 1));  // share of the distance from the tip
    const auto [y, z] = in_disc(number);
    return {c.length * (0.5 - part), c.radius * part * y, c.radius * part * z};
  }

 private:
  /// A point relative to the cone's triangle in a half plane through its axis.
  struct From {
    enum { base, side, rim, tip } nearest;
    double base_distance, side_distance;  // from the lines, negative inside
    double normal_x, normal_rho;          // of the side
    From(const Cone& c, const Meridian& m) {
      const double slant = std::hypot(c.length, c.radius), x = m.x - c.length / 2;
      normal_x = c.radius / slant, normal_rho = c.length / slant;
      base_distance = -c.length / 2 - m.x;
      side_distance = x * normal_x + m.rho * normal_rho;
      const double down = -x * normal_rho + m.rho * normal_x;  // along the side, from the tip
      if (base_distance <= 0 && side_distance <= 0)
        nearest = base_distance > side_distance ? base : side;
      else if (base_distance > 0 && m.rho <= c.radius)
        nearest = base;
      else
        nearest = down <= 0 ? tip : down < slant ? side : rim;
    }
  };
};

}  // namespace iota::shape
