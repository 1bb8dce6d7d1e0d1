// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shape/traits.h"

#include <numbers>

namespace iota::shape {

///        y
///      .-|-.
///     (  o--)-- x      o: origin, at the center; o-): radius
///      '---'
/// phi = (|p|^2 - r^2) / 2r.
template <>
struct Traits<Sphere> {
  static constexpr std::string_view name = "sphere", doc = "A ball.";
  static constexpr std::tuple sizes{Size{"radius", &Sphere::radius, Range::length, "m"}};
  static void check(const Sphere&) {}
  static double scale(const Sphere& s) { return s.radius; }

  static MassProperties mass(const Sphere& s) {
    const double r2 = s.radius * s.radius;
    return {4 * std::numbers::pi / 3 * r2 * s.radius, {}, mean_squares(r2 / 5, r2 / 5, r2 / 5)};
  }
  static Level level(const Sphere& s, const Vec3& p) {
    const double k = 1 / s.radius;
    return {(k * dot(p, p) - s.radius) / 2, k * p, Mat3::diagonal(k)};
  }
  static bool is_within(const Sphere& s, const Vec3& p) { return norm(p) <= s.radius; }
  static Vec3 closest(const Sphere& s, const Vec3& p) {
    const double distance = norm(p);
    return distance > 0 ? (s.radius / distance) * p : Vec3{s.radius, 0, 0};
  }
  static Vec3 support(const Sphere& s, const Vec3& d) { return (s.radius / norm(d)) * d; }
  template <class Number>
  static Vec3 inside(const Sphere& s, Number& number) {
    return s.radius * in_ball(number);
  }
};

}  // namespace iota::shape
