// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

#include <algorithm>
#include <numbers>

namespace iota::shape {

///           y
///     .-----|-----.
///    (|     o     |)-- x   half balls of `radius` at both ends
///     '-----------'
///     |--length---|
/// All points within `radius` of a piece of the x axis: with the distance d from that piece, phi = (d^2 - r^2) / 2r.
template <>
struct Traits<Capsule> {
  static constexpr std::string_view name = "capsule", doc = "A cylinder along x with half balls at its ends.";
  static constexpr std::tuple sizes{Size{"radius", &Capsule::radius, Range::length, "m"},
                                    Size{"length", &Capsule::length, Range::length, "of the cylinder alone, m"}};
  static void check(const Capsule&) {}
  static double scale(const Capsule& c) { return c.radius; }

  static MassProperties mass(const Capsule& c) {
    const double pi = std::numbers::pi, r2 = c.radius * c.radius, l2 = c.length * c.length;
    const double tube = pi * r2 * c.length, ends = 4 * pi / 3 * r2 * c.radius, volume = tube + ends;
    // A half sphere's mean distance from its flat face is 3/8 r.
    const double along = tube * l2 / 12 + ends * (l2 / 4 + 3 * c.length * c.radius / 8 + r2 / 5);
    const double across = tube * r2 / 4 + ends * r2 / 5;
    return {volume, {}, mean_squares(along / volume, across / volume, across / volume)};
  }
  static Level level(const Capsule& c, const Vec3& p) {
    const Vec3 d = p - nearest_on_axis(c, p);
    const double k = 1 / c.radius;
    return {(k * dot(d, d) - c.radius) / 2, k * d, {{{d.x == 0 ? 0 : k, 0, 0}, {0, k, 0}, {0, 0, k}}}};
  }
  static bool is_within(const Capsule& c, const Vec3& p) { return norm(p - nearest_on_axis(c, p)) <= c.radius; }
  static Vec3 closest(const Capsule& c, const Vec3& p) {
    const Vec3 on_axis = nearest_on_axis(c, p), d = p - on_axis;
    const double distance = norm(d);
    return on_axis + (distance > 0 ? (c.radius / distance) * d : Vec3{0, c.radius, 0});
  }
  static Vec3 support(const Capsule& c, const Vec3& d) {
    return Vec3{d.x < 0 ? -c.length / 2 : c.length / 2, 0, 0} + (c.radius / norm(d)) * d;
  }
  template <class Number>
  static Vec3 inside(const Capsule& c, Number& number) {
    const double half = (c.length + 2 * c.radius) / 2;
    for (;;) {
      const auto [y, z] = in_disc(number);
      const Vec3 p{number(-half, half), c.radius * y, c.radius * z};
      if (is_within(c, p)) return p;
    }
  }

 private:
  static Vec3 nearest_on_axis(const Capsule& c, const Vec3& p) {
    return {std::clamp(p.x, -c.length / 2, c.length / 2), 0, 0};
  }
};

}  // namespace iota::shape
